#pragma once
// What the filters of motion blur share: where samples lie, and how pixels are stored.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "raster/effects/motion/motion_blur.h"
#include "raster/images/texel.h"

namespace softfocus {

/// What the kernels read: texels of 8 bytes, two words each, `stride` texels a row.
struct BlurSource {
  const std::int32_t* texels;
  int stride;
};

// The order of operations is that of the kernels and of the shaders.

inline constexpr float kLeastMotion2 = 0.25f;  ///< half a pixel, squared
/// Of the cosine between two ways: from 1 on they are one.
inline constexpr float kFacing = 1.1f;

inline float jitter(int x, int y) { return static_cast<float>(jitter_bits(x, y)) * 0x1p-24f; }

/// From -1 to 1, evenly.
inline float way_at(int sample, float jitter, float step) {
  return (static_cast<float>(sample) + jitter) * step - 1.0f;
}

inline float cut_to_1(float x) { return x > 0.0f ? (x < 1.0f ? x : 1.0f) : 0.0f; }

inline glm::ivec2 pixel_at(const ConstImageView& picture, int x, int y, glm::vec2 moved) {
  const float at_x = std::floor((static_cast<float>(x) + moved.x) + 0.5f);
  const float at_y = std::floor((static_cast<float>(y) + moved.y) + 0.5f);
  return {std::clamp(static_cast<int>(at_x), 0, picture.width - 1),
          std::clamp(static_cast<int>(at_y), 0, picture.height - 1)};
}

/// Gathers need rows that begin at whole texels.
inline bool has_whole_strides(const ConstImageView& picture) {
  return picture.stride_bytes % 8 == 0;
}

inline Image copy_of(const ConstImageView& picture) {
  Image copy = make_image(picture.format, picture.width, picture.height);
  for (int y = 0; y < copy.height; ++y) {
    const auto from = row<std::uint16_t>(picture, y);
    std::copy(from.begin(), from.end(), row<std::uint16_t>(copy, y).begin());
  }
  return copy;
}

inline BlurSource source_of(const ConstImageView& picture) {
  return {reinterpret_cast<const std::int32_t*>(picture.texels),
          static_cast<int>(picture.stride_bytes / 8)};
}

inline void copy_texels(const ConstImageView& from, const ImageView& to, int y, int begin,
                        int end) {
  std::memcpy(row<std::uint16_t>(to, y).data() + 4 * begin,
              row<std::uint16_t>(from, y).data() + 4 * begin,
              static_cast<std::size_t>(end - begin) * 4 * sizeof(std::uint16_t));
}

/// Alpha keeps its bits, and a pixel without a new colour all of them.
inline void store_colour(const ConstImageView& from, const ImageView& to, int x, int y,
                         const std::optional<glm::vec3>& colour, const Profile& profile) {
  copy_texels(from, to, y, x, x + 1);
  if (!colour) return;
  std::uint16_t* texel = row<std::uint16_t>(to, y).data() + 4 * x;
  for (int i = 0; i < 3; ++i) texel[i] = float_to_half((*colour)[i], profile.half_store);
}

}  // namespace softfocus
