#pragma once
// Pictures, motions and counts for tests of what a frame takes from the frame before.

#include <cmath>
#include <cstdint>

#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "raster/numbers/random_bits.h"

namespace softfocus::test {

/// Colours from 0 to 1 over depths of 1 to 4 m in patches.
inline Image random_patches(int width, int height, std::uint64_t seed) {
  RandomSequence random{seed};
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto value = [&] { return static_cast<float>(next_between(random, 0.0, 1.0)); };
      const auto depth = static_cast<float>(1 + (x / 6 + y / 5) % 4) + 0.05f * value();
      store_texel(image, x, y, {value(), value(), value(), depth}, {});
    }
  }
  return image;
}

inline Image even_motion(int width, int height, float x_px, float y_px) {
  Image image = make_image(Format::rg16f, width, height);
  clear_image(image, {x_px, y_px, 0.0f, 0.0f}, {});
  return image;
}

inline Image random_motions(int width, int height, std::uint64_t seed, double most_px) {
  RandomSequence random{seed};
  Image image = make_image(Format::rg16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(image, y)) {
      double px = next_between(random, -most_px, most_px);
      if (next_between(random, 0.0, 1.0) < 0.4) px = std::floor(px);
      value = float_to_half(static_cast<float>(px), HalfRounding::nearest_even);
    }
  }
  return image;
}

inline Image even_counts(int width, int height, float count) {
  Image image = make_image(Format::r32f, width, height);
  clear_image(image, {count, 0.0f, 0.0f, 0.0f}, {});
  return image;
}

/// Counts of frames in alpha, of 0 in a third of the pixels.
inline Image with_counts(Image image, std::uint64_t seed) {
  RandomSequence random{seed};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      glm::vec4 texel = load_texel(image, x, y);
      const double count = std::floor(next_between(random, -5.0, 10.0));
      texel.w = count > 0.0 ? static_cast<float>(count) : 0.0f;
      store_texel(image, x, y, texel, {});
    }
  }
  return image;
}

/// Some texels that are not finite.
inline void spoil(Image& image) {
  const auto first = row<std::uint16_t>(image, 0),
             last = row<std::uint16_t>(image, image.height - 1);
  first[0] = 0x7C00;
  first[first.size() - 1] = 0xFC00;
  last[last.size() / 2] = 0x7E01;
}

}  // namespace softfocus::test
