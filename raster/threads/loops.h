#pragma once
// Loops over rows and tiles, and memory that their tasks use one after the other.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "raster/threads/parallel.h"

namespace softfocus {

/// At most one piece of memory per running task.
template <class Memory>
class ScratchShelf {
 public:
  /// A piece that was put back, or a new one.
  std::unique_ptr<Memory> take() {
    const std::lock_guard lock(mutex_);
    if (pieces_.empty()) return std::make_unique<Memory>();
    std::unique_ptr<Memory> piece = std::move(pieces_.back());
    pieces_.pop_back();
    return piece;
  }
  void put_back(std::unique_ptr<Memory> piece) {
    const std::lock_guard lock(mutex_);
    pieces_.push_back(std::move(piece));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Memory>> pieces_;
};

/// Runs body(i, memory) for i from 0 to count - 1, as ThreadPool::for_each() does. The memory is as
/// an earlier iteration, of this loop or of one before, has left it; or it is new.
template <class Memory, class Body>
void for_each_with(ScratchShelf<Memory>& shelf, ThreadPool& pool, int count, const Body& body) {
  pool.for_each(count, [&](int i) {
    std::unique_ptr<Memory> memory = shelf.take();
    body(i, *memory);
    shelf.put_back(std::move(memory));
  });
}
template <class Memory, class Body>
void for_each_with(ThreadPool& pool, int count, const Body& body) {
  ScratchShelf<Memory> shelf;
  for_each_with(shelf, pool, count, body);
}

/// Runs body(begin, end) for parts, `size` each, of what is numbered from 0 to count - 1; without a
/// pool one after the other.
template <class Body>
void for_each_part(ThreadPool* pool, std::size_t count, std::size_t size, const Body& body) {
  const auto run = [&](std::size_t begin) { body(begin, std::min(begin + size, count)); };
  if (pool != nullptr) {
    pool->for_each(static_cast<int>((count + size - 1) / size),
                   [&](int part) { run(static_cast<std::size_t>(part) * size); });
  } else {
    for (std::size_t begin = 0; begin < count; begin += size) run(begin);
  }
}

/// Runs body(first, end) for bands of rows from 0 to height - 1, some rows each.
template <class Body>
void for_each_band(ThreadPool& pool, int height, int rows, const Body& body) {
  pool.for_each((height + rows - 1) / rows, [&](int band) {
    const int first = band * rows;
    body(first, height - first < rows ? height : first + rows);
  });
}
/// body(first, end, memory)
template <class Memory, class Body>
void for_each_band_with(ThreadPool& pool, int height, int rows, const Body& body) {
  for_each_with<Memory>(pool, (height + rows - 1) / rows, [&](int band, Memory& memory) {
    const int first = band * rows;
    body(first, height - first < rows ? height : first + rows, memory);
  });
}

/// Runs body(y) for rows from 0 to height - 1, some rows a task.
template <class Body>
void for_each_row(ThreadPool& pool, int height, int rows, const Body& body) {
  for_each_band(pool, height, rows, [&](int first, int end) {
    for (int y = first; y < end; ++y) body(y);
  });
}
/// body(y, memory)
template <class Memory, class Body>
void for_each_row_with(ThreadPool& pool, int height, int rows, const Body& body) {
  for_each_band_with<Memory>(pool, height, rows, [&](int first, int end, Memory& memory) {
    for (int y = first; y < end; ++y) body(y, memory);
  });
}

}  // namespace softfocus
