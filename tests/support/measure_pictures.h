#pragma once
// Pictures for the measures, whose values are known.

#include <algorithm>

#include "dof/measure/difference.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

namespace softfocus {

/// All one colour, at a depth of 2 m.
inline Image plain(int width, int height, float red, float green, float blue) {
  Image image = make_image(Format::rgba16f, width, height);
  clear_image(image, {red, green, blue, 2.0f}, {});
  return image;
}
inline Image plain_grey(int width, int height, float grey) {
  return plain(width, height, grey, grey, grey);
}

/// `grey_at(x, y)` gives each pixel.
template <class GreyAt>
Image grey_picture(int width, int height, const GreyAt& grey_at) {
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto grey = static_cast<float>(grey_at(x, y));
      store_texel(image, x, y, {grey, grey, grey, 2.0f}, {});
    }
  }
  return image;
}

inline double smallest(const PixelMap& map) {
  return *std::min_element(map.values.begin(), map.values.end());
}
inline double largest(const PixelMap& map) {
  return *std::max_element(map.values.begin(), map.values.end());
}

}  // namespace softfocus
