#pragma once
// What a frame file begins with: seven 32-bit words, little-endian. Then for each row
// from the top `width` pixels of RGB565 (16 bits, little-endian, red highest) and `width`
// codes of depth (8 bits: 0 is at near, 255 at far, linear between).

#include <stdint.h>

namespace softfocus::device {

struct FrameSettings {
  uint32_t width;
  uint32_t height;
  uint32_t max_radius_px;
  uint32_t radius_at_infinity_q16;  ///< 1/65536 pixel
  uint32_t focus_um;
  uint32_t near_um;
  uint32_t far_um;
};

}  // namespace softfocus::device
