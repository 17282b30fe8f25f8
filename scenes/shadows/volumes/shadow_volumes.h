#pragma once
// Shadow volumes (Crow 1977): the faces around what a light's casters keep in the dark.
//
// A casting triangle's volume is what lies behind it as the light sees it. The volumes of all
// casters are counted together, so a side face stands only where an edge's triangles do not cancel
// out: an edge whose sum of directions is not 0 (Bergeron 1986; Kim, Kim and Turk 2008). Meshes
// may be open, and three or more triangles may share an edge.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scenes/shadows/facets.h"
#include "scenes/shadows/light_grid.h"
#include "scenes/shadows/shadow_mask.h"

namespace softfocus {

// Facets as a mesh: corners that are equal in the world, and edges between them, are one.

struct JoinedFacets {
  std::vector<glm::dvec3> corners;
  std::vector<std::array<std::uint32_t, 3>> facets;  ///< the corners of each
  /// The ends of each edge, the lower number first.
  std::vector<std::array<std::uint32_t, 2>> edges;
  /// Of each facet, from corner i to corner i + 1.
  std::vector<std::array<std::uint32_t, 3>> edges_of;
};

/// Corners are equal if their bits are; 0 and -0 are equal, too.
JoinedFacets join_facets(const Facets& facets);

// The world about a camera's eye, in pixels.

/// f(x, y) = a x + b y + c, in this order.
struct Linear {
  double a, b, c;
};

inline double at(const Linear& f, double x, double y) { return (f.a * x + f.b * y) + f.c; }

/// Corners (x, y, w) about the eye: x / w and y / w are pixels from the picture's upper left
/// corner, w is the depth along the axis.
struct PixelSpace {
  glm::dvec3 eye;
  std::array<glm::dvec3, 3> rows;     // of the matrix from the world to x, y and w
  std::array<glm::dvec3, 3> columns;  // of its inverse
  double least_w;                     // of a sample
  double facing;                      // det(v_0, v_1, v_2) has this sign for what faces the eye
};

PixelSpace pixel_space(const ShadowView& view, glm::dvec3 eye);

glm::dvec3 to_pixels(const PixelSpace& space, glm::dvec3 from_eye);
glm::dvec3 from_pixels(const PixelSpace& space, glm::dvec3 v);
glm::dvec3 to_light(const PixelSpace& space, const ShadowLight& light);

/// Corner i below the number of joined corners is that corner. Above, it is infinitely far from
/// the light: for a point light in the direction of corner i - corners, for a directional light in
/// the one direction that there is.
struct VolumeFace {
  std::array<std::uint32_t, 3> corners;  ///< counter-clockwise, seen from outside the volume
  std::int32_t times;                    ///< counted; negative if seen from inside
};

/// All volumes of one light. They depend on no camera.
struct ShadowVolumes {
  ShadowLight light;
  std::vector<std::uint32_t> casters;  ///< facets
  std::size_t silhouette_edges = 0;
  /// The casters, then the sides, then the caps at infinity, which a directional light does not
  /// need: all is at one point there.
  std::vector<VolumeFace> faces;
  std::size_t faces_before_far_caps = 0;
  std::optional<LightGrid> grid;  ///< of the casters; draw_volume_mask() makes it if it needs it
};

/// z-fail counts the faces behind a sample. z-pass counts those before it, from the number of
/// volumes that hold the eye. Either gives the number of volumes that hold the sample.
enum class VolumeCount : std::uint8_t { z_fail, z_pass };

ShadowVolumes make_shadow_volumes(const Facets& facets, const JoinedFacets& joined,
                                  const ShadowLight& light);

/// How many of the volumes of `casters` hold a point: how many of them the ray from the point to
/// the light meets. A ray through a common edge meets one of its two triangles. Facets that cast no
/// volume are left out.
int volumes_that_hold(const Facets& facets, const JoinedFacets& joined, const ShadowLight& light,
                      std::span<const std::uint32_t> casters, glm::dvec3 point);

}  // namespace softfocus
