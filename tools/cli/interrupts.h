#pragma once
// What an interrupt (SIGINT, SIGTERM, SIGHUP) leaves behind: nothing.

#include <filesystem>

namespace softfocus {

/// Makes interrupts remove the files below before they end the program. A signal that the program
/// was started to ignore stays ignored.
void prepare_interrupts();

/// A file that an interrupt removes, while this lives. It need not exist yet. Names past 4,095
/// bytes, and more than 64 at once, are not kept; nor are any on Windows.
class RemovedByInterrupt {
 public:
  explicit RemovedByInterrupt(const std::filesystem::path& file);
  ~RemovedByInterrupt();
  RemovedByInterrupt(const RemovedByInterrupt&) = delete;
  RemovedByInterrupt& operator=(const RemovedByInterrupt&) = delete;

 private:
  int slot_ = -1;
};

}  // namespace softfocus
