#pragma once
// Shadow maps (Williams 1978): a picture of the casters as the light sees them, which holds how
// near they are. A point is in shadow if the map holds something nearer to the light at its place.
//
// A side of a map looks along its third axis. With q = p - origin and x, y, z its products with the
// axes, a point's place and nearness are, in binary64,
//
//   directional   (x, y)           -z      in metres
//   point light   (x / z, y / z)   1 / z
//
// so that nearness is linear over the places of a plane. It is rounded to binary32 in the map.

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"
#include "scenes/scene.h"
#include "scenes/shadows/facets.h"

namespace softfocus {

/// Of whom the map is to hold what is seen.
struct MapCamera {
  glm::dmat4 world_to_clip{1.0};  ///< a point's clip w is its depth along the axis; 0 at the eye
  glm::dvec3 eye{0.0};
  double near_m = 0.1;
  double far_m = 100.0;
  bool operator==(const MapCamera&) const = default;
};

/// A square of texels. Texel (i, j) compares at its centre, u = i + 1/2 and v = j + 1/2 with
/// u = (place.x - low.x) * texels.x, likewise v.
struct MapSide {
  glm::dvec3 origin{0.0};
  std::array<glm::dvec3, 3> axes{};
  glm::dvec2 low{0.0};
  glm::dvec2 texels{0.0};       ///< per unit of a place; 0 if nobody can look into the side
  std::vector<float> nearness;  ///< rows; -infinity where no caster is. Empty if none is anywhere
};

struct ShadowMap {
  ShadowLight light;
  ShadowMapSettings settings;
  std::optional<MapCamera> camera;  ///< that it is fitted to
  /// Of a point light the sides of a cube: x, -x, y, -y, z, -z. Of a directional one its cascades.
  std::vector<MapSide> sides;
  /// In metres along the camera's axis: cascade i ends at ends_m[i], the last one never.
  std::vector<double> ends_m;
};

/// Where `count` cascades end between near and far, the last one at far: half the logarithmic and
/// half the even split (Zhang et al. 2006).
std::vector<double> cascade_ends_m(double near_m, double far_m, int count);

/// A map of all casters of a light. It is the same on any number of threads. `camera` is for
/// settings that fit it.
ShadowMap draw_shadow_map(const Facets& facets, const ShadowLight& light,
                          const ShadowMapSettings& settings, const MapCamera& camera,
                          const Profile& profile, ThreadPool& pool);

/// The sides of a map before anything is drawn: places, without nearness.
ShadowMap fit_shadow_map(const Facets& facets, const ShadowLight& light,
                         const ShadowMapSettings& settings, const MapCamera& camera);

/// A point of a receiver as a side of the map sees it.
struct MapPlace {
  const MapSide* side = nullptr;
  double u = 0.0, v = 0.0;  ///< in texels
  double z = 0.0;           ///< metres before the side's origin
  double reach_m = 0.0;     ///< what the kernel reaches there: its width
  double slope = 0.0;       ///< of the plane: z's change over a metre across
};

MapPlace map_place(const ShadowMap& map, const Receiver& receiver, glm::dvec3 point);

/// What is compared: the texels of the kernel around (u, v) that the side has, each with `own`, the
/// nearness of the place moved towards the light by reach_m * (bias + slope_bias * slope).
struct MapComparison {
  int u, v;
  double own;
};

/// Nothing for a place that is lit without a look.
std::optional<MapComparison> map_comparison(const ShadowMap& map, const MapPlace& place);

/// How many of the kernel's texels hold something nearer to the light than the moved place: 0 to
/// kernel * kernel (percentage closer filtering, Reeves, Salesin and Cook 1987).
int blocked_texels(const ShadowMap& map, const MapPlace& place);

}  // namespace softfocus
