#pragma once
// Triangle set-up: what a triangle covers, facing, culling, and bounds.

#include <array>
#include <optional>
#include <variant>

#include "raster/numbers/profile.h"
#include "raster/pipeline/edge_functions.h"
#include "raster/pipeline/scanlines.h"
#include "raster/pipeline/state.h"
#include "raster/pipeline/viewport.h"

namespace softfocus {

/// In pixels. The guard band keeps positions far below this; set-up treats those beyond as not
/// finite.
inline constexpr float kLargestPosition = 0x1p20f;

struct TriangleSetup {
  std::array<WindowVertex, 3> vertices;
  std::variant<EdgeFunctions, Scanlines> coverage;
  bool clockwise;  ///< the order of the vertices, as seen in the picture
  bool front_facing;
  Rectangle bounds;  ///< holds all covered pixels; lies within the clip
};

/// Nothing for a triangle that has no area, is culled, lies outside `clip`, or has a coordinate
/// that is not finite. `clip` lies within the target.
std::optional<TriangleSetup> set_up_triangle(const std::array<WindowVertex, 3>& vertices, Cull cull,
                                             FrontFace front_face, const Rectangle& clip,
                                             const Profile& profile);

/// Culling by unsnapped positions; no area counts as a back face. Mesa's drivers do this, too, to
/// all triangles that they send through their clipping stages.
bool is_culled_unsnapped(const std::array<WindowVertex, 3>& vertices, Cull cull,
                         FrontFace front_face);

/// The covered pixels of row y among x_begin <= x < x_end. Row and pixels lie in the bounds.
Span covered_span(const TriangleSetup& setup, int y, int x_begin, int x_end);

}  // namespace softfocus
