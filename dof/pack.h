#pragma once
// Between pictures as other programs keep them and RGBA16F with depth in alpha: colour as
// planes or interleaved, in halves, floats or bytes, and the depth beside it.

#include <cstddef>
#include <cstdint>

#include "raster/images/image_view.h"
#include "raster/numbers/half.h"
#include "raster/threads/parallel.h"

namespace softfocus {

enum class ChannelType : std::uint8_t {
  half,    ///< binary16: its bits pass as they are
  single,  ///< binary32
  unorm8,  ///< 0 to 255 for 0 to 1, linear
  srgb8,   ///< 0 to 255 along the sRGB curve
};

constexpr std::ptrdiff_t bytes_per_channel(ChannelType type) {
  return type == ChannelType::half ? 2 : type == ChannelType::single ? 4 : 1;
}

/// Colours to read. Each pointer leads to the top left pixel's value; the right neighbour's
/// is `pixel_bytes` on, the one below `row_bytes`. A picture whose bottom row comes first,
/// as OpenGL reads it, is given by its last row and negative `row_bytes`. Nothing need be
/// aligned.
struct ColourSource {
  ChannelType type;
  const void* red;
  const void* green;
  const void* blue;
  std::ptrdiff_t pixel_bytes;
  std::ptrdiff_t row_bytes;
};

/// Colours to write.
struct ColourTarget {
  ChannelType type;
  void* red;
  void* green;
  void* blue;
  std::ptrdiff_t pixel_bytes;
  std::ptrdiff_t row_bytes;

  operator ColourSource() const {  // NOLINT(google-explicit-constructor)
    return {type, red, green, blue, pixel_bytes, row_bytes};
  }
};

/// Pixels of `channels` values each, 3 or more, that begin with red, green and blue.
inline ColourSource interleaved(ChannelType type, const void* first, int channels,
                                std::ptrdiff_t row_bytes) {
  const auto* red = static_cast<const std::byte*>(first);
  const std::ptrdiff_t bytes = bytes_per_channel(type);
  return {type, red, red + bytes, red + 2 * bytes, channels * bytes, row_bytes};
}
inline ColourTarget interleaved(ChannelType type, void* first, int channels,
                                std::ptrdiff_t row_bytes) {
  auto* red = static_cast<std::byte*>(first);
  const std::ptrdiff_t bytes = bytes_per_channel(type);
  return {type, red, red + bytes, red + 2 * bytes, channels * bytes, row_bytes};
}

/// Depths to read: metres along the camera's axis.
struct DepthSource {
  const float* first;  ///< of the top left pixel; need not be aligned
  std::ptrdiff_t pixel_bytes = sizeof(float);
  std::ptrdiff_t row_bytes;
};

/// Writes every texel of `picture`, RGBA16F. A float becomes the half that `rounding` says,
/// a byte the half nearest to its linear value.
void pack(const ColourSource& colour, const DepthSource& depth, HalfRounding rounding,
          const ImageView& picture, ThreadPool& pool);

/// Writes the colours of every texel of `picture`, RGBA16F, and nothing between them. Bytes
/// are rounded to nearest, cut to 0 and 1.
void unpack(const ConstImageView& picture, const ColourTarget& colour, ThreadPool& pool);

}  // namespace softfocus
