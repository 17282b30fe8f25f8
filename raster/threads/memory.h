#pragma once
// Large memory that is needed again and again: what the system gives anew it gives page by page,
// and a frame's worth takes it longer than many filters.

#include <cstddef>

namespace softfocus {

/// Tells the system that memory will be used as a whole: it may give it in large pages. For images:
/// a command at 3840x2160 takes up to a fifth less time. Filters' memory, which is larger, is
/// slower with them at its first use on a virtual machine.
void prefer_large_pages(void* memory, std::size_t bytes);

inline constexpr std::size_t kRowAlignment = 64;

/// Memory from such a boundary on, as operator new.
void* allocate_rows(std::size_t bytes);
void free_rows(void* memory);

/// Keeps what was given back: of pieces that differ by less than a factor of two, at most as many
/// as were lent at once. Threads may share it.
class MemoryShelf {
 public:
  MemoryShelf();
  ~MemoryShelf();
  MemoryShelf(const MemoryShelf&) = delete;
  MemoryShelf& operator=(const MemoryShelf&) = delete;

  /// As allocate_rows(), but as an earlier user has left it. To be given back before the shelf
  /// ends.
  void* lend(std::size_t bytes);
  void take_back(void* memory);

 private:
  struct State;
  State* state_;  // owned; <memory> is more to parse than all of this header
};

}  // namespace softfocus
