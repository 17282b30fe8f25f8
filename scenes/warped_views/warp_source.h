#pragma once
// A picture that was drawn from a point of the lens, made ready to be warped: planes of binary32,
// and sharpened by as much as reading between texels will blur.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "dof/lens.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// The side in pixels of the blocks of a source that are warped or passed over.
inline constexpr int kWarpBlock = 32;
inline int warp_blocks(int pixels) { return (pixels + kWarpBlock - 1) / kWarpBlock; }

/// Circles count as no larger and no smaller than these.
inline constexpr float kMostWarpRadiusPx = 1024.0f, kLeastWarpRadiusPx = 0x1p-20f;

/// What is farther aside than this, in pixels of the warp, is another surface.
inline constexpr float kSameSurfacePx = 0.75f;

/// A signed radius of a circle in pixels, whose lowest 3 bits say something of its pixel. So one
/// comparison tells what is seen, and one number what it is. 21 bits are left: at 1024 pixels they
/// count 2^-10.
inline constexpr std::uint32_t kRadiusNotes = 7;
/// All eight neighbours are of the same surface, whatever the shift.
inline constexpr std::uint32_t kSmoothNote = 1;

inline float noted_radius(float radius, std::uint32_t note) {
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(radius) & ~kRadiusNotes) | note);
}
inline float radius_of(float noted) { return noted_radius(noted, 0); }
inline std::uint32_t note_of(float noted) {
  return std::bit_cast<std::uint32_t>(noted) & kRadiusNotes;
}

struct RadiusRange {
  float low, high;
};

/// A picture that was drawn, as planes of binary32. Each has a border that repeats the outermost
/// pixels, of one row and kSourceBorder columns: plane_at() has the place of a pixel.
struct WarpSource {
  glm::dvec2 point{0.0};  ///< of the lens
  int width = 0, height = 0;
  std::vector<float> red, green, blue;
  std::vector<float> radii;  ///< noted
  /// Of each block, row by row, of the pixels to the left of it and of those above.
  std::vector<RadiusRange> blocks;
  RadiusRange all{0.0f, 0.0f};
};
inline constexpr int kSourceBorder = 16;

inline int plane_stride(const WarpSource& source) { return source.width + 2 * kSourceBorder; }
inline std::size_t plane_at(const WarpSource& source, int x, int y) {
  return static_cast<std::size_t>((y + 1) * plane_stride(source) + kSourceBorder + x);
}

/// How much reading between texels blurs, to be taken away beforehand. At a part f from a texel the
/// variance along an axis is f (1 - f) square pixels. The colour c of a pixel whose circle is r
/// becomes c + sum over its four neighbours n of v(r) / 2 (c - n), with v(r) the mean variance of
/// all views of the source: then both together have the variance 0. A difference counts as 1 at
/// most, and as 0 to another surface.
struct WarpSharpening {
  /// v / 2 at |r| = 0, 1/16, 2/16, ... pixels; the last beyond. None: colours stay as they are.
  std::vector<float> amounts;
  /// The largest shift that the source is warped by, for a radius of 1: the lens's diameter.
  float most_shift = 2.0f;
};
inline constexpr float kAmountsAPx = 16.0f;

/// Of the views that are warped by these shifts.
WarpSharpening warp_sharpening(std::span<const glm::vec2> shifts);

/// Fills the planes from RGBA16F with depth in alpha. Depths of 0 and NaN count as nearest; colours
/// that are sharpened are cut to what a half holds.
void set_source(WarpSource& source, const Image& picture, const PixelCoc& coc,
                const WarpSharpening& sharpening, ThreadPool& pool);

}  // namespace softfocus
