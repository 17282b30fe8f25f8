#pragma once
// Triangle set-up: viewport transform, snapping, facing, and the three edge functions
// in 64-bit integers, by which coverage is exact.

#include <array>
#include <cstdint>
#include <glm/vec4.hpp>
#include <optional>

#include "raster/numbers/profile.h"
#include "raster/pipeline/state.h"

namespace softfocus {

/// A vertex in the window.
struct WindowVertex {
  float x;      ///< pixels, unsnapped; pixel 0 spans 0 to 1
  float y;      ///< pixels, downwards
  float depth;  ///< 0 (near) to 1 (far)
  float inverse_w;
};

/// Edge i runs between the two vertices other than vertex i. Its function
///   E_i(x, y) = at_origin + x * per_x + y * per_y
/// at the centre of pixel (x, y) counts 1/65536 of a square pixel, is positive inside,
/// and E_0 + E_1 + E_2 = area. A centre exactly on an edge (E_i = 0) is inside if the
/// edge is a left or an upper one, half-open in row order: least x and least y belong.
struct EdgeFunction {
  std::int64_t at_origin;
  std::int64_t per_x;
  std::int64_t per_y;
  bool owns_centres;  ///< a left or upper edge
};

struct TriangleSetup {
  std::array<WindowVertex, 3> vertices;
  std::array<EdgeFunction, 3> edges;
  std::int64_t area;  ///< twice the triangle's, in 1/65536 of a square pixel; positive
  bool front_facing;
  Rectangle bounds;  ///< the pixels whose centres the bounding box holds, in the clip
};

inline std::int64_t edge_at(const EdgeFunction& edge, int x, int y) {
  return edge.at_origin + x * edge.per_x + y * edge.per_y;
}

inline bool inside(const EdgeFunction& edge, std::int64_t value) {
  return value > 0 || (value == 0 && edge.owns_centres);
}

/// Clip coordinates to the window, in this order: r = 1 / w; ndc = (x r, y r, z r);
/// x_window = ndc.x * (width/2) + width/2, likewise y; depth = ndc.z * 0.5 + 0.5;
/// each product and sum fused as the profile's viewport says. Needs w > 0.
WindowVertex to_window(const glm::vec4& position, int width, int height, const Profile& profile);

/// Nothing for a triangle of no area, a culled one, one outside `clip`, or one with a
/// coordinate that is not finite. `clip` lies within the target.
std::optional<TriangleSetup> set_up_triangle(const std::array<WindowVertex, 3>& vertices, Cull cull,
                                             FrontFace front_face, const Rectangle& clip);

}  // namespace softfocus
