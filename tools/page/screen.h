#pragma once
// A picture as a browser's canvas takes it.

#include <cstdint>
#include <cstring>

#include "tools/page/page.h"

namespace softfocus {

/// RGBA16F, linear light, as RGBA of 8 bits: sRGB as in PNG files, alpha 255. NaN is black.
void show_on_screen(const Image& picture, Pixels& pixels, ThreadPool& pool);

/// A binary32 number in the place of each pixel's colour, in the module's byte order, row by row:
/// `number_at(x, y)`.
template <class NumberAt>
void put_numbers(int width, int height, const NumberAt& number_at, Pixels& pixels) {
  pixels.width = width;
  pixels.height = height;
  pixels.rgba.resize(sizeof(float) * static_cast<std::size_t>(width) *
                     static_cast<std::size_t>(height));
  std::uint8_t* to = pixels.rgba.data();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x, to += sizeof(float)) {
      const float number = number_at(x, y);
      std::memcpy(to, &number, sizeof(float));
    }
  }
}

}  // namespace softfocus
