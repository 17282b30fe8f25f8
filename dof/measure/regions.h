#pragma once
// A label for each pixel, from its depth and the lens: depth of field fails differently in each
// region, and a mean over the whole picture hides it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "dof/lens.h"
#include "dof/measure/difference.h"
#include "raster/images/image.h"

namespace softfocus {

// How far the outline of what a picture shows lies from where it should.

/// Which pixels of an RGBA16F picture show something: 1 where alpha, the depth, is not the
/// background's; row by row.
std::vector<std::uint8_t> coverage_of(const Image& picture, std::uint16_t background_depth);

struct OutlineError {
  double mean_px = 0.0;  ///< wrong pixels a pixel of outline; 0 if nothing is drawn
  double most_px = 0.0;  ///< how deep the deepest wrong pixel lies, up to 31.5
  std::size_t lost = 0;  ///< pixels
  std::size_t gained = 0;
  std::size_t seen = 0;  ///< drawn ones
};

/// Of coverages of width x height pixels.
OutlineError outline_error(const std::vector<std::uint8_t>& drawn,
                           const std::vector<std::uint8_t>& shown, int width, int height);

enum class Region : std::uint8_t {
  /// Within reach of the blur of an edge in depth: leaks, halos, hard edges.
  silhouette,
  near_field,  ///< nearer than focus and blurred
  focus,       ///< in focus: must stay as it is
  far_field,   ///< farther than focus and blurred
  edge,        ///< on the outline of something in focus: stairs
};
inline constexpr std::size_t kRegions = 5;

inline constexpr std::array<Region, kRegions> kAllRegions{
    Region::silhouette, Region::near_field, Region::focus, Region::far_field, Region::edge};

/// "silhouette", "near", "focus", "far" or "edge".
std::string_view region_name(Region region);

/// Radius in pixels up to which a pixel is in focus: a disc of it covers the pixel and
/// no neighbour's centre, and the filters leave it as it is.
inline constexpr float kFocusRadiusPx = 1.0f;

/// Two neighbours whose signed radii differ by more are two sides of an edge in depth. No
/// slope has such a step, and two surfaces of like blur need no edge.
inline constexpr float kEdgeStepPx = 1.0f;

/// Whether a depth in metres has a region: above 0, infinity too.
inline bool is_depth(float depth_m) { return depth_m > 0.0f; }

/// A label, of Region, for each pixel of an RGBA16F picture with depths in alpha: an image
/// of r8. Every pixel nearer to an edge in depth than the larger radius on its two sides,
/// at least 1, is of its silhouette band, measured from the centres of the pixels beside the
/// edge. The rest is in focus, near or far by its own radius, in focus up to `focus_px`.
///
/// Before all these: two neighbours of different surfaces (is_one_surface()) are on an edge if the
/// nearer one is in focus. What slopes is one surface: along a plane 1 / depth is linear, so it
/// differs at an edge by more than twice what it does from either of the two to the pixel beyond.
/// Needs is_depth() everywhere.
Image label_regions(const Image& scene, const PixelCoc& coc, float focus_px = kFocusRadiusPx);

/// kFocusRadiusPx, or, of a picture whose labels have nothing so sharp, as much more than the
/// smallest radius beside silhouettes.
float fitting_focus_px(const Image& scene, const PixelCoc& coc, const Image& labels);

/// The mean of a map over a region, and the number of its pixels.
struct RegionMean {
  std::uint64_t pixels = 0;
  double mean = 0.0;  ///< NaN where there are no pixels
};
std::array<RegionMean, kRegions> means_by_region(const PixelMap& map, const Image& labels);

}  // namespace softfocus
