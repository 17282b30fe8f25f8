#pragma once
// Triangle set-up: what a triangle covers, facing, culling, and bounds.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <variant>

#include "raster/numbers/lerp.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/state.h"

namespace softfocus {

// The viewport transform: from clip coordinates to the window.

/// A vertex in the window.
struct WindowVertex {
  float x;      ///< pixels, unsnapped; pixel 0 spans 0 to 1
  float y;      ///< pixels, downwards
  float depth;  ///< 0 (near) to 1 (far)
  float inverse_w;
};

/// In this order: r = 1 / w; ndc = (x r, y r, z r); x_window = ndc.x * (width/2) + (width/2 + x),
/// likewise y, (x, y) the viewport's corner; depth = ndc.z * 0.5 + 0.5. If fused, a product and its
/// sum are rounded once. w = 0 gives infinities and NaN.
inline WindowVertex to_window(const glm::vec4& position, int width, int height,
                              Contraction contraction, int x = 0, int y = 0) {
  const float inverse_w = 1.0f / position.w;
  const float half_width = static_cast<float>(width) * 0.5f;
  const float half_height = static_cast<float>(height) * 0.5f;
  const float middle_x = half_width + static_cast<float>(x);
  const float middle_y = half_height + static_cast<float>(y);
  return {multiply_add(position.x * inverse_w, half_width, middle_x, contraction),
          multiply_add(position.y * inverse_w, half_height, middle_y, contraction),
          multiply_add(position.z * inverse_w, 0.5f, 0.5f, contraction), inverse_w};
}

/// Twice the area in square pixels, positive if the vertices run clockwise as seen. The order of
/// operations is that of Mesa's drivers. A sliver's sign can differ from that of its snapped area.
inline float unsnapped_area(const std::array<WindowVertex, 3>& v) {
  return (v[0].x - v[2].x) * (v[1].y - v[2].y) - (v[0].y - v[2].y) * (v[1].x - v[2].x);
}

// Exact coverage (Pineda 1988): vertices are snapped to the subpixel grid; each edge has a
// linear function in 64-bit integers, positive on the triangle's side.

/// The function of one edge,
///   E(x, y) = at_origin + x * per_x + y * per_y
/// at the centre of pixel (x, y), counts 1/65536 of a square pixel.
struct EdgeFunction {
  std::int64_t at_origin;
  std::int64_t per_x;
  std::int64_t per_y;
  bool owns_centres;  ///< a centre exactly on the edge (E = 0) is inside
};

/// Edge i lies opposite to vertex i, and E_0 + E_1 + E_2 = area. Left edges own the centres on
/// them; of level edges the upper or the lower one does, as the profile's fill rule says.
struct EdgeFunctions {
  std::array<EdgeFunction, 3> edges;
  std::int64_t area;  ///< twice the triangle's, in 1/65536 of a square pixel; positive
  bool clockwise;     ///< the order of the vertices, as seen in the picture
  Rectangle bounds;   ///< the pixels whose samples the bounding box can hold
};

/// `place`: from the pixel's centre, in 1/256 pixel.
inline std::int64_t edge_at(const EdgeFunction& edge, int x, int y, const glm::ivec2& place = {}) {
  return edge.at_origin + x * edge.per_x + y * edge.per_y +
         (place.x * edge.per_x + place.y * edge.per_y) / 256;
}

inline bool inside(const EdgeFunction& edge, std::int64_t value) {
  return value > 0 || (value == 0 && edge.owns_centres);
}

/// Positions are snapped by round-to-nearest-even of (window - 0.5) * 2^subpixel_bits,
/// both operations in binary32; with more samples than 1, of window * 2^subpixel_bits, as llvmpipe
/// does. Bounds hold the pixels' samples, or, with `edge_samples`, so many besides their centres.
/// Needs |x|, |y| <= 2^20. Nothing for a triangle of no area.
std::optional<EdgeFunctions> make_edge_functions(const std::array<WindowVertex, 3>& vertices,
                                                 const Profile& profile, int samples = 1,
                                                 int edge_samples = 1);

/// The covered pixels of row y among x_begin <= x < x_end: one span, as a triangle is convex.
/// `place`: of the sample that is looked at, from a pixel's centre.
Span covered_span(const EdgeFunctions& functions, int y, int x_begin, int x_end,
                  const glm::ivec2& place = {});

// Coverage by spans between floating-point edges, as in Mesa's softpipe (22.3, sp_setup.c). The
// triangle is cut at its middle vertex into an upper and a lower half; each half is filled row by
// row from its left edge to its right one. Positions are not snapped, nothing is fused.

/// An edge of a half, walked downwards. In the half's row r, the first pixel whose centre is on
/// its right is trunc(x + r * per_row); x includes the 1/2 that rounds up.
struct EdgeWalk {
  float x;
  float per_row;
};

/// Rows y_begin <= y < y_end.
struct HalfTriangle {
  int y_begin;
  int y_end;
  EdgeWalk left;
  EdgeWalk right;
};

struct Scanlines {
  std::array<HalfTriangle, 2> halves;  ///< the upper one, then the lower one
  bool clockwise;                      ///< the order of the vertices, as seen in the picture
  Rectangle bounds;                    ///< all spans are within
};

/// The vertices' numbers from the least y to the greatest. If two are equal, the lower number
/// comes first, except that vertex 2 comes first if it shares the least y.
std::array<std::size_t, 3> from_top_to_bottom(const std::array<WindowVertex, 3>& vertices);

/// Needs |x|, |y| <= 2^20. Nothing for a triangle whose area has no finite reciprocal.
std::optional<Scanlines> make_scanlines(const std::array<WindowVertex, 3>& vertices);

/// The covered pixels of row y among x_begin <= x < x_end; needs x_begin >= 0.
Span covered_span(const Scanlines& scanlines, int y, int x_begin, int x_end);

/// In pixels. The guard band keeps positions far below this; set-up treats those beyond as not
/// finite.
inline constexpr float kLargestPosition = 0x1p20f;

struct TriangleSetup {
  std::array<WindowVertex, 3> vertices;
  std::variant<EdgeFunctions, Scanlines> coverage;
  bool clockwise;  ///< the order of the vertices, as seen in the picture
  bool front_facing;
  Rectangle bounds;  ///< holds all covered pixels; lies within the clip
  int samples;       ///< of a pixel
};

/// Nothing for a triangle that has no area, is culled, lies outside `clip`, or has a coordinate
/// that is not finite. `clip` lies within the target.
std::optional<TriangleSetup> set_up_triangle(const std::array<WindowVertex, 3>& vertices, Cull cull,
                                             FrontFace front_face, const Rectangle& clip,
                                             const Profile& profile, int samples = 1,
                                             int edge_samples = 1);

/// Culling by unsnapped positions; no area counts as a back face. Mesa's drivers do this, too, to
/// all triangles that they send through their clipping stages.
bool is_culled_unsnapped(const std::array<WindowVertex, 3>& vertices, Cull cull,
                         FrontFace front_face);

/// The covered pixels of row y among x_begin <= x < x_end. Row and pixels lie in the bounds.
Span covered_span(const TriangleSetup& setup, int y, int x_begin, int x_end,
                  const glm::ivec2& place = {});

}  // namespace softfocus
