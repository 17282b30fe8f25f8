#pragma once
// What a frame file begins with: eight 32-bit words, little-endian. Then for each row
// from the top `width` pixels of colour, and `width` codes of depth if alpha is not the
// depth: 0 is at near, the largest code at far, linear between. All little-endian.

#include <stddef.h>
#include <stdint.h>

namespace softfocus::device {

enum class FrameFormat : uint32_t {
  rgb565,   ///< 16 bits, red highest; depth of 8 bits
  rgba8,    ///< depth of 16 bits
  rgba16f,  ///< alpha is the depth in metres
};

/// Of a pixel.
constexpr size_t colour_bytes(FrameFormat format) {
  return format == FrameFormat::rgb565 ? 2 : format == FrameFormat::rgba8 ? 4 : 8;
}
constexpr size_t depth_bytes(FrameFormat format) {
  return format == FrameFormat::rgb565 ? 1 : format == FrameFormat::rgba8 ? 2 : 0;
}

struct FrameSettings {
  FrameFormat format;
  uint32_t width;
  uint32_t height;
  uint32_t max_radius_px;
  uint32_t radius_at_infinity_q16;  ///< 1/65536 pixel
  uint32_t focus_um;
  uint32_t near_um;
  uint32_t far_um;
};

}  // namespace softfocus::device
