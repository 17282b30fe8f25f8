#pragma once
// Pictures made by rule for the tests.

#include <cstdint>

#include "dof/measure/difference.h"
#include "raster/images/image.h"
#include "raster/images/texel.h"

namespace softfocus {

/// SplitMix64 (Steele, Lea and Flood 2014), the tests' source of chance.
struct Random {
  std::uint64_t state;

  std::uint64_t next() {
    state += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }

  /// 0 <= value < 1, a multiple of 2^-24.
  float unit() { return static_cast<float>(next() >> 40) * 0x1p-24f; }
};

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
