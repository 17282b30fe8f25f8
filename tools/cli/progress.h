#pragma once
// One line on a terminal that says what is being done, gone when it is done.

#include <string_view>

namespace softfocus {

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
