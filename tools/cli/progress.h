#pragma once
// One line on a terminal that says what is being done, gone when it is done.

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace softfocus {

// How long work still takes, by the time that each kind of it has taken so far.

/// Work is planned in units of named kinds. The rate of a kind is what its units have taken; of a
/// kind that nothing was done of yet it is a guess, scaled by how long the kinds that were done
/// took beside theirs.
class TimeLeft {
 public:
  /// `clock_s` gives seconds from any start on; the default is the steady clock.
  explicit TimeLeft(std::function<double()> clock_s = {});

  /// `guess` is how long a unit takes, in a measure that all kinds share. The last guess counts.
  void plan(const std::string& kind, double units, double guess);
  /// The time since the last done(), start() or the construction was for these units.
  void done(const std::string& kind, double units);
  /// Units that need no doing.
  void drop(const std::string& kind, double units);
  double units_left(const std::string& kind) const;
  /// Restarts the clock; earlier time counts for no planned work.
  void start() { last_s_ = clock_s_(); }

  /// 0 before anything is done.
  double seconds() const;

 private:
  struct Kind {
    double planned = 0.0;  ///< units that are left
    double guess = 0.0;
    double done = 0.0;
    double seconds = 0.0;  ///< that the done ones took
  };

  std::function<double()> clock_s_;
  double last_s_;
  std::map<std::string, Kind> kinds_;
};

/// "about 2 h left", "about 3 min left", "about 20 s left"; rounded up to quarters of an hour from
/// two hours on, to minutes, to ten seconds below one minute, and to five below twenty.
std::string time_left_text(double seconds);

/// Silent where standard error is no terminal, or if `quiet` (--quiet).
class Progress {
 public:
  explicit Progress(bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::string_view stage);
  void clear();

 private:
  bool on_terminal_;
};

}  // namespace softfocus
