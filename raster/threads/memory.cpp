#include "raster/threads/memory.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace softfocus {

void prefer_large_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::size_t kLargePage = std::size_t{1} << 21;
  if (bytes < 2 * kLargePage) return;
  void* begin = memory;
  std::size_t room = bytes;
  if (std::align(kLargePage, kLargePage, begin, room) == nullptr) return;
  madvise(begin, room / kLargePage * kLargePage, MADV_HUGEPAGE);  // a wish: it may fail
#endif
}

void* allocate_rows(std::size_t bytes) {
  void* memory = ::operator new (bytes, std::align_val_t{kRowAlignment});
  prefer_large_pages(memory, bytes);
  return memory;
}

void free_rows(void* memory) { ::operator delete (memory, std::align_val_t{kRowAlignment}); }

struct MemoryShelf::State {
  struct Piece {
    void* memory;
    std::size_t bytes;
    bool is_lent;
  };

  std::mutex mutex;
  std::vector<Piece> pieces;
};

MemoryShelf::MemoryShelf() : state_(new State) {}

MemoryShelf::~MemoryShelf() {
  for (const State::Piece& piece : state_->pieces) free_rows(piece.memory);
  delete state_;
}

void* MemoryShelf::lend(std::size_t bytes) {
  const std::lock_guard lock(state_->mutex);
  using Piece = State::Piece;
  std::vector<Piece>& pieces = state_->pieces;
  Piece* smallest = nullptr;  // that is large enough
  for (Piece& piece : pieces) {
    if (piece.is_lent || piece.bytes < bytes) continue;
    if (smallest == nullptr || piece.bytes < smallest->bytes) smallest = &piece;
  }
  if (smallest != nullptr) {
    smallest->is_lent = true;
    return smallest->memory;
  }
  // Where one is too small, this one stands for it from now on.
  const auto largest =
      std::max_element(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
        return a.is_lent != b.is_lent ? a.is_lent : a.bytes < b.bytes;
      });
  if (largest != pieces.end() && !largest->is_lent) {
    free_rows(largest->memory);
    pieces.erase(largest);
  }
  pieces.reserve(pieces.size() + 1);
  pieces.push_back({allocate_rows(bytes), bytes, true});
  return pieces.back().memory;
}

void MemoryShelf::take_back(void* memory) {
  const std::lock_guard lock(state_->mutex);
  for (State::Piece& piece : state_->pieces)
    piece.is_lent = piece.is_lent && piece.memory != memory;
}

}  // namespace softfocus
