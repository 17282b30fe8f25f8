#pragma once
// Smooth edges in a filtered picture. A filter reads one surface a pixel, with that surface's
// depth: a mean of two would lie between them, where nothing is. So it blurs first, and the edge
// becomes smooth afterwards: a pixel that two surfaces share gets the filtered colour of both, each
// by its part of the pixel. The filtered colour of a surface is that of the pixel itself, or of the
// nearest neighbour that shows the surface; in focus, with the difference that the two had before
// the filter. So whatever a method does to a surface, its edge has too: sharp against a blurred
// background, or blurred.
//
// Known failures: what is thinner than a pixel, and shown by none, has its own colour as far as it
// is in focus, and vanishes in the blur.

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dof/dof.h"
#include "raster/pipeline/multisample.h"

namespace softfocus {

/// Whether an edge lies between a and b, of four neighbours in a row, each given as 1 / depth.
/// Along a plane 1 / depth is linear: at an edge it differs by more than twice what it does from
/// either of the two to the pixel beyond, which the picture may not have.
inline bool is_step(std::optional<float> before, float a, float b, std::optional<float> behind) {
  if (is_one_surface(a, b)) return false;
  const float step = std::fabs(a - b);
  const bool has_both = before && behind;
  const float slope = has_both ? std::fmin(std::fabs(*before - a), std::fabs(b - *behind))
                      : before ? std::fabs(*before - a)
                      : behind ? std::fabs(b - *behind)
                               : 0.0f;
  return step > 2.0f * slope;
}

/// Rows of an input and of its filtered picture. The first and the last of three are the row above
/// and below; at the picture's border they are the row itself.
struct EdgeRows {
  std::array<std::span<const std::uint16_t>, 3> scene;
  std::array<std::span<const std::uint16_t>, 3> filtered;
  std::span<const std::uint16_t> other;
  std::span<const std::uint8_t> coverage;
};

/// A pixel of a row, RGBA16F.
struct SmoothPixel {
  int x;
  std::array<std::uint16_t, 4> texel;
};

/// Appends the pixels that change, from left to right. Alpha stays the filtered picture's.
void smooth_row(const EdgeRows& rows, const DofSettings& settings, HalfRounding rounding,
                std::vector<SmoothPixel>& changed);

/// Gives the other surface of each pixel the colour of the neighbour that shows it, or without such
/// the pixel's own. For a scene whose light changed after its edges were drawn, as by shadows.
void take_shown_colours(const ConstImageView& scene, const ConstImageView& coverage,
                        const ImageView& other, ThreadPool& pool);

/// Smooths the edges of `filtered`, made from `input`; without DofInput::edges it does nothing. A
/// lens without circles, as of a picture that nothing blurs, has radius_at_infinity_px 0.
void smooth_edges(const DofInput& input, const ImageView& filtered, ThreadPool& pool);

}  // namespace softfocus
