#pragma once
// How long work still takes, by the time of the parts that are done.

#include <chrono>
#include <string>

namespace softfocus {

/// Parts of about equal length. Those that needed no doing are taken out.
class TimeLeft {
 public:
  explicit TimeLeft(double all_units) : all_units_(all_units) {}

  void done(double units) { done_units_ += units; }
  void skipped(double units) { all_units_ -= units; }

  /// At the pace since the start; 0 before anything is done.
  double seconds() const;
  static double seconds(double all_units, double done_units, double elapsed_s);

 private:
  double all_units_;
  double done_units_ = 0.0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// "about 3 min left", "about 20 s left"; rounded up to minutes, to ten seconds below one.
std::string time_left_text(double seconds);

}  // namespace softfocus
