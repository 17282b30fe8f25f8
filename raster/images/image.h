#pragma once
// An image: texels of one format in rows, row 0 on top. Rows begin on 64-byte
// boundaries, so that vector code can read and write whole lines.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <vector>

#include "raster/images/image_view.h"
#include "raster/numbers/hash.h"
#include "raster/threads/memory.h"

namespace softfocus {

template <class T>
struct RowAllocator {
  using value_type = T;
  RowAllocator() = default;
  template <class U>
  RowAllocator(const RowAllocator<U>&) {}  // NOLINT(google-explicit-constructor)
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_rows(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t) { free_rows(memory); }
  bool operator==(const RowAllocator&) const = default;
};

struct RowDelete {
  MemoryShelf* shelf = nullptr;  ///< from which it was lent, if from one
  void operator()(void* memory) const {
    shelf != nullptr ? shelf->take_back(memory) : free_rows(memory);
  }
};
/// Numbers from a boundary of kRowAlignment bytes on.
template <class T>
using RowMemory = std::unique_ptr<T[], RowDelete>;

/// `count` numbers, not initialised. A shelf, as of a pool, keeps their memory, and must outlive
/// them.
template <class T>
RowMemory<T> make_row_memory(std::size_t count, MemoryShelf* shelf = nullptr) {
  const std::size_t bytes = count * sizeof(T);
  void* memory = shelf != nullptr ? shelf->lend(bytes) : allocate_rows(bytes);
  return RowMemory<T>(static_cast<T*>(memory), RowDelete{shelf});
}

/// Bytes from such a boundary on, 0 at first. Memory that the system gives as zeros is touched when
/// it is used, by the thread that uses it.
class RowBytes {
 public:
  RowBytes() = default;
  explicit RowBytes(std::size_t size);
  RowBytes(const RowBytes& other);
  RowBytes(RowBytes&&) = default;
  RowBytes& operator=(const RowBytes& other) { return *this = RowBytes{other}; }
  RowBytes& operator=(RowBytes&&) = default;
  ~RowBytes() = default;

  std::byte* data() { return bytes_.get(); }
  const std::byte* data() const { return bytes_.get(); }
  std::size_t size() const { return bytes_ ? bytes_.get_deleter().size : 0; }
  bool empty() const { return size() == 0; }
  std::byte* begin() { return data(); }
  std::byte* end() { return data() + size(); }
  const std::byte* begin() const { return data(); }
  const std::byte* end() const { return data() + size(); }
  std::byte& operator[](std::size_t at) { return bytes_[at]; }
  const std::byte& operator[](std::size_t at) const { return bytes_[at]; }
  bool operator==(const RowBytes& other) const;

 private:
  struct Free {
    void* memory;
    std::size_t size;
    void operator()(std::byte*) const { std::free(memory); }
  };
  std::unique_ptr<std::byte[], Free> bytes_;
};

struct Image {
  Format format = Format::rgba16f;
  int width = 0;
  int height = 0;
  std::size_t stride_bytes = 0;  ///< from one row to the next, a multiple of 64
  RowBytes bytes;

  // A view of an image ends with it.
  operator ImageView() {  // NOLINT(google-explicit-constructor)
    return {format, width, height, static_cast<std::ptrdiff_t>(stride_bytes), bytes.data()};
  }
  operator ConstImageView() const {  // NOLINT(google-explicit-constructor)
    return {format, width, height, static_cast<std::ptrdiff_t>(stride_bytes), bytes.data()};
  }
};

/// An image of zeros. Needs 1 <= width, height <= kMaxImageSize.
Image make_image(Format format, int width, int height);

/// Row `y`, as of a view.
template <class Channel>
std::span<Channel> row(Image& image, int y) {
  const ImageView view = image;
  return row<Channel>(view, y);
}
template <class Channel>
std::span<const Channel> row(const Image& image, int y) {
  const ConstImageView view = image;
  return row<Channel>(view, y);
}

/// FNV-1a of the size, the format and every texel's bits, row by row; padding is left out.
std::uint64_t hash_image(const ConstImageView& image);

/// Same format, size and bits.
bool equal(const ConstImageView& a, const ConstImageView& b);

// hash_image() of an image that comes in bands of rows.

/// What the hash of an image of that size begins with.
Hash begin_image_hash(Format format, int width, int height);

/// Adds the next rows.
void add_rows_to_hash(Hash& hash, const ConstImageView& rows);

}  // namespace softfocus
