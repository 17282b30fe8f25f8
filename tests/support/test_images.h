#pragma once
// Pictures made by rule for the tests.

#include <cstdint>
#include <utility>

#include "dof/measure/difference.h"
#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "tests/support/random.h"

namespace softfocus {

using test::Random;

/// Random colours in 0..1 over random depths of 0.5 to 8.5 m in patches of 8x8 pixels.
inline Image random_scene_image(int width, int height, std::uint64_t seed) {
  Image image = make_image(Format::rgba16f, width, height);
  Random random{seed};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Random patch{seed * 1000 + static_cast<std::uint64_t>(y / 8 * 1000 + x / 8)};
      const float depth = 0.5f + 8.0f * patch.unit();
      store_texel(image, x, y, {random.unit(), random.unit(), random.unit(), depth}, {});
    }
  }
  return image;
}

/// A picture of one grey and one depth, a pair, at each place.
template <class GreyAndDepth>
Image grey_depth_picture(int width, int height, const GreyAndDepth& grey_and_depth) {
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::pair<float, float> at = grey_and_depth(x, y);
      store_texel(image, x, y, {at.first, at.first, at.first, at.second}, {});
    }
  }
  return image;
}

template <class DepthAt>
void set_depth(Image& image, const DepthAt& depth_at) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      glm::vec4 texel = load_texel(image, x, y);
      texel.w = depth_at(x, y);
      store_texel(image, x, y, texel, {});
    }
  }
}

}  // namespace softfocus
