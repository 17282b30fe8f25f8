#pragma once
// The two filters of motion_blur(), and what they share: a pixel, a sample, and a row for the
// kernels.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "raster/effects/motion/motion_samples.h"
#include "raster/lanes/isa.h"

namespace softfocus {

struct BlurInput {
  const MotionBlurPass& pass;
  const ConstImageView& picture;
  const ConstImageView& spread;  ///< motion_to_either_side()
  const MotionTiles& tiles;
};

/// A row of it.
struct BlurRow {
  const MotionBlurPass& pass;
  BlurSource picture, spread;
  int width, height;  ///< of the picture
  const MotionTiles& tiles;
  int y;
};

/// What a pixel and a sample have to do with each other.
struct Pair {
  float of_there, of_own;  ///< the distance in lengths of either's motion
  float gap;               ///< how much farther the sample is (MotionBlurPass::inverse_depth)
};

struct BlurredPixel {
  glm::vec4 own;  ///< with its compared_depth()
  glm::vec3 v;    ///< its motion, and in z 1 / its length
  float per_depth;
};

inline BlurredPixel blurred_pixel(const BlurInput& input, int x, int y) {
  glm::vec4 own = load_texel<Format::rgba16f>(input.picture, x, y);
  own.w = compared_depth(own.w);
  const glm::vec4 v = load_texel<Format::rgba16f>(input.spread, x, y);
  return {own, glm::vec3{v}, own.w > 0.0f ? input.pass.inverse_depth / own.w : 0.0f};
}

inline Pair pair_of(const BlurredPixel& pixel, const glm::vec4& there, const glm::vec4& w,
                    float distance) {
  return {distance * w.z, distance * pixel.v.z,
          (compared_depth(there.w) - pixel.own.w) * pixel.per_depth};
}

// A pixel near which n moves, of that length, above half a pixel: its colour.

/// McGuire et al. 2012, along the longest motion.
glm::vec3 blurred_one_way(const BlurInput& input, int x, int y, glm::vec2 n, float length);
/// After Guertin et al. 2014, along the longest motion and along the pixel's own.
glm::vec3 blurred_two_ways(const BlurInput& input, int x, int y, glm::vec2 n, float length);

// By the kernels of any vector unit but scalar, with the same bits, and what stays copied: RGBA16F
// from `begin` on. They return the first pixel that is not done.

int blur_row_one_way(Isa isa, const BlurRow& row, int begin, int end, std::uint16_t* to,
                     HalfRounding rounding);
int blur_row_two_ways(Isa isa, const BlurRow& row, int begin, int end, std::uint16_t* to,
                      HalfRounding rounding);

}  // namespace softfocus
