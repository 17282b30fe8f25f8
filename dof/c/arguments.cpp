#include "dof/c/arguments.h"

#include <algorithm>
#include <limits>

namespace softfocus {

void refuse(const std::string& argument, const std::string& reason) {
  throw BadArgument(argument + ": " + reason);
}

std::size_t struct_bytes(const std::string& argument, const void* given, std::size_t first_bytes,
                         std::size_t our_bytes) {
  constexpr std::size_t kMostBytes = 4096;  // more is memory that was never set
  if (given == nullptr) refuse(argument, "a null pointer");
  std::size_t bytes = 0;
  std::memcpy(&bytes, given, sizeof bytes);
  if (bytes < first_bytes || bytes > kMostBytes) {
    refuse(argument + ".struct_size", std::to_string(bytes) + "; set it to the struct's sizeof, " +
                                          std::to_string(our_bytes) + " in this library");
  }
  const auto* end = static_cast<const std::byte*>(given) + bytes;
  if (bytes > our_bytes && std::any_of(end - (bytes - our_bytes), end,
                                       [](std::byte byte) { return byte != std::byte{0}; })) {
    refuse(argument, "a field is set that this library does not know; a newer libsoftfocus does");
  }
  return bytes;
}

MemoryRange range_of(const PixelPlane& plane, int width, int height) {
  if (plane.first == nullptr) refuse(plane.name, "a null pointer");
  std::ptrdiff_t across = 0, down = 0, low = 0, high = 0;
  const bool is_too_far =
      __builtin_mul_overflow(plane.pixel_bytes, std::ptrdiff_t{width} - 1, &across) ||
      __builtin_mul_overflow(plane.row_bytes, std::ptrdiff_t{height} - 1, &down) ||
      __builtin_add_overflow(std::min(across, std::ptrdiff_t{0}), std::min(down, std::ptrdiff_t{0}),
                             &low) ||
      __builtin_add_overflow(std::max(across, std::ptrdiff_t{0}), std::max(down, std::ptrdiff_t{0}),
                             &high) ||
      __builtin_add_overflow(high, plane.value_bytes, &high);
  const auto first = reinterpret_cast<std::uintptr_t>(plane.first);
  // Of a negative number, as its magnitude.
  const std::uintptr_t before = std::uintptr_t{0} - static_cast<std::uintptr_t>(low);
  if (is_too_far || before > first ||
      static_cast<std::uintptr_t>(high) > std::numeric_limits<std::uintptr_t>::max() - first) {
    refuse(plane.name, "with these strides its pixels lie outside of memory");
  }
  return {first - before, first + static_cast<std::uintptr_t>(high)};
}

void check_apart(const PixelPlane& plane, int width, int height) {
  struct Step {
    std::uint64_t bytes;
    std::uint64_t count;
  };
  const auto step = [](std::ptrdiff_t bytes, int count) {
    const auto magnitude = static_cast<std::uint64_t>(bytes);
    return Step{count == 1  ? 0
                : bytes < 0 ? std::uint64_t{0} - magnitude
                            : magnitude,
                static_cast<std::uint64_t>(count)};
  };
  // Rows of pixels, or columns of them.
  Step shorter = step(plane.pixel_bytes, width), longer = step(plane.row_bytes, height);
  if (longer.bytes < shorter.bytes) std::swap(longer, shorter);
  const auto value_bytes = static_cast<std::uint64_t>(plane.value_bytes);
  const std::uint64_t line_bytes = (shorter.count - 1) * shorter.bytes + value_bytes;
  if ((shorter.count > 1 && shorter.bytes < value_bytes) ||
      (longer.count > 1 && longer.bytes < line_bytes)) {
    refuse(plane.name, "with these strides its pixels lie over each other");
  }
}

}  // namespace softfocus
