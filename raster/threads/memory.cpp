#include "raster/threads/memory.h"

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
  return ::operator new (bytes, std::align_val_t{kRowAlignment});
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
    if (piece.is_lent || piece.bytes < bytes || piece.bytes / 2 > bytes) continue;
    if (smallest == nullptr || piece.bytes < smallest->bytes) smallest = &piece;
  }
  if (smallest != nullptr) {
    smallest->is_lent = true;
    return smallest->memory;
  }
  // Where some are too small, this one stands for the largest of them from now on.
  auto replaced = pieces.end();
  for (auto piece = pieces.begin(); piece != pieces.end(); ++piece) {
    if (piece->is_lent || piece->bytes > bytes) continue;
    if (replaced == pieces.end() || piece->bytes > replaced->bytes) replaced = piece;
  }
  if (replaced != pieces.end()) {
    free_rows(replaced->memory);
    pieces.erase(replaced);
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
