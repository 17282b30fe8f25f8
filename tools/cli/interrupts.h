#pragma once
// Interrupts (SIGINT, SIGTERM, SIGHUP) leave nothing behind.

#include <filesystem>
#include <functional>

namespace softfocus {

/// Makes interrupts remove the files below before they end the program. A signal that the program
/// was started to ignore stays ignored.
void prepare_interrupts();

/// A file that an interrupt removes, while this lives. Names past 4,095 bytes, and more than 64 at
/// once, are not kept; nor are any on Windows.
class RemovedByInterrupt {
 public:
  /// It need not exist yet.
  explicit RemovedByInterrupt(const std::filesystem::path& file)
      : RemovedByInterrupt(file, [] { return true; }) {}
  /// Calls `create`, which makes the file and says whether it did; an interrupt in another thread
  /// waits for it, up to a second. A file that was not made is not removed.
  RemovedByInterrupt(const std::filesystem::path& file, const std::function<bool()>& create);
  ~RemovedByInterrupt();
  RemovedByInterrupt(const RemovedByInterrupt&) = delete;
  RemovedByInterrupt& operator=(const RemovedByInterrupt&) = delete;

 private:
  int slot_ = -1;
};

}  // namespace softfocus
