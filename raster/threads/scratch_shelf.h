#pragma once
// Memory that the tasks of a loop use one after the other: at most one piece per running
// task.

#include <mutex>
#include <utility>
#include <vector>

namespace softfocus {

template <class Memory>
class ScratchShelf {
 public:
  /// A piece that was put back, or a new one.
  Memory take() {
    const std::lock_guard lock(mutex_);
    if (pieces_.empty()) return {};
    Memory piece = std::move(pieces_.back());
    pieces_.pop_back();
    return piece;
  }
  void put_back(Memory piece) {
    const std::lock_guard lock(mutex_);
    pieces_.push_back(std::move(piece));
  }

 private:
  std::mutex mutex_;
  std::vector<Memory> pieces_;
};

}  // namespace softfocus
