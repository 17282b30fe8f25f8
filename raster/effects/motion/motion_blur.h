#pragma once
// Motion blur: what a shutter that is open for a part of the frame does to what moves, from one
// picture and its velocity. docs/effects/motion-blur.md has the equations.

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

enum class MotionFilter : std::uint8_t {
  one_way,   ///< McGuire et al. 2012: along the neighbourhood's longest motion
  two_ways,  ///< after Guertin et al. 2014: along it and along the pixel's own
};

struct MotionBlurSettings {
  float shutter = 0.5f;  ///< the part of a frame that it is open, centred on the frame
  int samples = 16;      ///< a pixel, 1 to 64
  int radius_px = 32;    ///< the longest way to either side, 1 to 256, and the size of the tiles
  float depth = 0.1f;    ///< what is nearer than that part of the depth covers softly, above 0
  MotionFilter filter = MotionFilter::two_ways;
};

/// What the passes compute with; the shaders get it so.
struct MotionBlurPass {
  int samples;         ///< along the neighbourhood's motion
  float sample_part;   ///< 1 / samples
  float step;          ///< 2 / samples
  int across_samples;  ///< along the pixel's own; with one_way none
  float across_part, across_step;
  int radius_px;
  /// Of the gap between two depths over the nearer: 1 / depth, with two_ways 2 / depth.
  float inverse_depth;
  float to_half;  ///< shutter / 2: from pixels a frame to the way to either side
  MotionFilter filter;
};
MotionBlurPass pass_of(const MotionBlurSettings& settings);

/// The picture, RGBA16F with depth in alpha, and its velocity, RG16F in pixels a frame. Alpha
/// stays; a depth of infinity is 65504 m. Where nothing moves by more than half a pixel to either
/// side, the picture stays, and costs next to nothing.
void motion_blur(const MotionBlurSettings& settings, const ConstImageView& picture,
                 const ConstImageView& velocity, const ImageView& result, const Profile& profile,
                 ThreadPool& pool);

/// The mean of samples along the pixel's own motion: what moves stays sharp at its outline.
void motion_blur_along_own(float shutter, int samples, const ConstImageView& picture,
                           const ConstImageView& velocity, const ImageView& result,
                           const Profile& profile, ThreadPool& pool);

/// Evenly spread numbers for a pixel, whole, below 2^24: of Roberts' sequence in two dimensions
/// (2018), x steps on by 1/g and y by 1/g^2 with g^3 = g + 1.
inline constexpr std::uint32_t kJitterX = 3242174889u, kJitterY = 2447445414u;
inline std::uint32_t jitter_bits(int x, int y) {
  return (static_cast<std::uint32_t>(x) * kJitterX + static_cast<std::uint32_t>(y) * kJitterY) >> 8;
}

// --- the steps before the last ---

/// The way to either side: v, and in b 1 / max(|v|, 1/2). RGBA16F, 0 in a. A part of the velocity
/// that is not finite is 0, and v no longer than the radius.
void motion_to_either_side(const MotionBlurPass& pass, const ConstImageView& velocity,
                           const ImageView& spread, const Profile& profile, ThreadPool& pool);

/// A tile each: v of the longest, of equally long ones the one with the largest x, then y.
struct MotionTiles {
  int columns, rows;
  std::vector<glm::vec2> v;
};
MotionTiles longest_of_tiles(const MotionBlurPass& pass, const ConstImageView& spread,
                             ThreadPool& pool);

/// The longest of a tile and its eight neighbours; two_ways leaves out those at the corners that do
/// not move along the diagonal towards the tile.
MotionTiles longest_of_neighbours(const MotionTiles& tiles, MotionFilter filter);

}  // namespace softfocus
