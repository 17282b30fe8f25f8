#pragma once
// Accumulation from few drawings: the scene is drawn from some points of the lens, and these
// pictures are warped to all others (warp.h), as a relief impostor is to the views near its own.

#include <cstddef>
#include <span>
#include <vector>

#include "scenes/lens_views/accumulation.h"
#include "scenes/warped_views/warp.h"

namespace softfocus {

/// The mean of Sampling::samples views at accumulation()'s points: Sampling::drawn_views of the
/// lens's points are drawn, and each view is warped from the nearest of them. What that one has
/// not seen comes from the others, the nearer first, by the depth of the farthest that is seen
/// beside it; what none has seen is filled from beside it, and counted. A surface has the colour
/// that the drawn view gives it: highlights do not move with the point. No jitter, no shutter.
///
/// With as many drawn views as samples nothing is warped: it is accumulation()'s picture, but for
/// the order of the sums.
SampledPicture warped_accumulation(const LensViewInput& input, ThreadPool& pool);

/// Sampling::samples if no number is given.
inline constexpr int kUsualWarpedViews = 64;
inline constexpr int kMostDrawnViews = 64;

/// Made once for many pictures of one scene.
struct WarpedViewsBuffer {
  PreparedScene prepared;
  std::vector<glm::dvec2> views;  ///< points of the lens
  /// Pixels beyond each border of the picture that are drawn too: what other points see there.
  int margin_px = 0;
  Image picture;  ///< with the margin
  std::vector<WarpSource> sources;
  SampleSums sums;
};

WarpedViewsBuffer make_warped_views_buffer(const LensViewInput& input, ThreadPool& pool);

/// Sets the views, and draws the sources: at the points that lens_points_for() makes for their
/// number, or at the views' own if there are no more of these.
void draw_sources(WarpedViewsBuffer& buffer, const LensViewInput& input, ThreadPool& pool);

/// What was not seen from the source nearest to a view's point, in pixels of all views.
struct WarpHoles {
  std::size_t filled = 0;  ///< from other sources
  std::size_t unseen = 0;  ///< by any
};

/// Warps the views and adds them to the sums: in binary32 by 64, those from one source
/// one after the other, and these sums in binary64.
WarpHoles add_warped_views(const WarpedViewsBuffer& buffer, SampleSums& sums, ThreadPool& pool);

/// warped_accumulation() of the buffer's scene.
SampledPicture warped_accumulation(WarpedViewsBuffer& buffer, const LensViewInput& input,
                                   ThreadPool& pool);

}  // namespace softfocus
