#pragma once
// Smooth edges in a filtered picture. A filter reads one surface a pixel, with that surface's
// depth: a mean of two would lie between them, where nothing is. So it blurs first, and the edge
// becomes smooth afterwards: a pixel that two surfaces share gets the filtered colour of both, each
// by its part of the pixel. The filtered colour of a surface is that of the pixel itself, or of the
// nearest neighbour that shows the surface; in focus, with the difference that the two had before
// the filter. So whatever a method does to a surface, its edge has too: sharp against a blurred
// background, or blurred.
//
// What is thinner than a pixel is shown by some centres and missed by others: blurred, a strand of
// hair becomes beads. So where the nearer of two surfaces is blurred, which of them a pixel shows
// to the filter follows its part of the pixel, by diffusion of the error along the edge (after
// Floyd and Steinberg 1976): a strand keeps its light.
//
// Known failures: what is thinner than a pixel and blurred by less than kDiffusedPx, or by a method
// that gets layers behind or objects' numbers.

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
  std::span<const std::uint16_t> own;  ///< of the input, before EdgeDiffusion
  std::array<std::span<const std::uint16_t>, 3> filtered;
  std::span<const std::uint16_t> other;
  std::span<const std::uint8_t> coverage;
};

/// A pixel of a row, RGBA16F.
struct SmoothPixel {
  int x;
  std::array<std::uint16_t, 4> texel;
};

/// The nearer surface's circle, from which on edges are diffused. Smaller ones leave dots.
inline constexpr float kDiffusedPx = 2.0f;

/// Chooses what pixels on edges show to a filter, row by row from the top.
class EdgeDiffusion {
 public:
  explicit EdgeDiffusion(int width);

  /// Of the next row of an input: appends the pixels that are to show the other surface.
  void next_row(std::span<const std::uint16_t> scene, std::span<const std::uint16_t> other,
                std::span<const std::uint8_t> coverage, const DofSettings& settings,
                std::vector<int>& show_other);

 private:
  // Runs are pixels of a row that follow each other. Of each pixel, one in from the left: its run's
  // number, from 1 on; of each run, in 1/255 of a pixel: what the nearer surface should have had
  // and did not get.
  std::vector<std::size_t> run_before_, run_;
  std::vector<int> owed_before_{0}, owed_{0};
};

/// Gives those pixels of a row their other surface.
void show_others(std::span<const int> pixels, std::span<const std::uint16_t> other,
                 std::span<std::uint16_t> scene);

/// The picture that a filter gets: `input.scene`, or a copy in the pool's memory.
struct DiffusedScene {
  ConstImageView scene;
  RowMemory<std::uint16_t> memory{};
};
DiffusedScene diffused_scene(const DofInput& input, ThreadPool& pool);

/// Appends the pixels that change, from left to right. Alpha is the filtered picture's, and of the
/// input where that showed another surface.
void smooth_row(const EdgeRows& rows, const DofSettings& settings, HalfRounding rounding,
                std::vector<SmoothPixel>& changed);

/// Gives the other surface of each pixel the colour of the neighbour that shows it, or without such
/// the pixel's own. For a scene whose light changed after its edges were drawn, as by shadows.
void take_shown_colours(const ConstImageView& scene, const ConstImageView& coverage,
                        const ImageView& other, ThreadPool& pool);

/// Smooths the edges of `filtered`, made from `input`'s diffused_scene(); without DofInput::edges
/// it does nothing. A lens without circles, as of a picture that nothing blurs, has
/// radius_at_infinity_px 0.
void smooth_edges(const DofInput& input, const ConstImageView& diffused, const ImageView& filtered,
                  ThreadPool& pool);

}  // namespace softfocus
