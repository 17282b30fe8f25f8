#include "scenes/shadows/maps/shadow_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "raster/numbers/exact_math.h"
#include "scenes/shadows/facets.h"
#include "scenes/shadows/light_grid.h"
#include "scenes/shadows/maps/draw_map_side.h"

namespace softfocus {
namespace {

bool is_empty(const PlaceBox& box) { return !(box.low.x <= box.high.x && box.low.y <= box.high.y); }

PlaceBox intersection(const PlaceBox& a, const PlaceBox& b) {
  return {{std::max(a.low.x, b.low.x), std::max(a.low.y, b.low.y)},
          {std::min(a.high.x, b.high.x), std::min(a.high.y, b.high.y)}};
}

struct SceneBox {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
};

SceneBox box_of(const Facets& facets) {
  SceneBox box;
  for (const Facet& facet : facets.facets) {
    for (const glm::dvec3& corner : facet.corners) {
      for (int i = 0; i < 3; ++i) {
        box.low[i] = std::min(box.low[i], corner[i]);
        box.high[i] = std::max(box.high[i], corner[i]);
      }
    }
  }
  return box;
}

glm::dvec3 row_of(const glm::dmat4& m, int row) { return {m[0][row], m[1][row], m[2][row]}; }

double depth_m(const MapCamera& camera, glm::dvec3 p) {
  return dot(row_of(camera.world_to_clip, 3), p) + camera.world_to_clip[3][3];
}

// Ends of the rays through the picture's corners at a depth of one metre, from the eye, around the
// picture. A little outside, so that things seen in a corner lie inside.
std::array<glm::dvec3, 4> corner_rays(const MapCamera& camera) {
  constexpr double kEdge = 1.0 + 1e-6;
  constexpr std::array<glm::dvec2, 4> kCorners{
      {{-kEdge, -kEdge}, {kEdge, -kEdge}, {kEdge, kEdge}, {-kEdge, kEdge}}};
  const glm::dvec3 ahead = row_of(camera.world_to_clip, 3);
  std::array<glm::dvec3, 4> rays{};
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec3 ray = cross(row_of(camera.world_to_clip, 0) - ahead * kCorners[i].x,
                                 row_of(camera.world_to_clip, 1) - ahead * kCorners[i].y);
    rays[i] = ray / dot(ahead, ray);
  }
  return rays;
}

// A part of the camera's pyramid: four corners near, four far.
using Frustum = std::array<glm::dvec3, 8>;

Frustum frustum_of(const MapCamera& camera, double near_m, double far_m) {
  const std::array<glm::dvec3, 4> rays = corner_rays(camera);
  Frustum frustum{};
  for (std::size_t i = 0; i < 4; ++i) {
    frustum[i] = camera.eye + rays[i] * near_m;
    frustum[i + 4] = camera.eye + rays[i] * far_m;
  }
  return frustum;
}

// Depths of the scene, as the camera sees it.
struct DepthRange {
  double near_m, far_m;
};

DepthRange depth_range(const MapCamera& camera, const SceneBox& box) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p{(corner & 1) != 0 ? box.high.x : box.low.x,
                       (corner & 2) != 0 ? box.high.y : box.low.y,
                       (corner & 4) != 0 ? box.high.z : box.low.z};
    least = std::min(least, depth_m(camera, p));
    most = std::max(most, depth_m(camera, p));
  }
  const double near_m = std::clamp(least, camera.near_m, camera.far_m);
  const double far_m = std::clamp(most, near_m, camera.far_m);
  // A little more, for what rounding does to a point at an end.
  constexpr double kMore = 1e-6;
  return {near_m * (1.0 - kMore), far_m * (1.0 + kMore)};
}

// `inner` holds what is looked up; the kernel reaches texels around it.
void set_texels(MapSide& side, const PlaceBox& inner, const ShadowMapSettings& settings,
                double least_size) {
  const int margin = (settings.kernel + 1) / 2;
  const double texels = settings.size - 2 * margin;
  for (int i = 0; i < 2; ++i) {
    const double size = std::max(inner.high[i] - inner.low[i], least_size);
    side.texels[i] = texels / size;
    side.low[i] = inner.low[i] - margin / side.texels[i];
  }
}

glm::dvec3 in_side(const MapSide& side, glm::dvec3 p) {
  const glm::dvec3 q = p - side.origin;
  return {dot(q, side.axes[0]), dot(q, side.axes[1]), dot(q, side.axes[2])};
}

// Along the light, turned so that the camera's direction is upright in the map: what it sees is
// long in this direction, and so fills the map better.
std::array<glm::dvec3, 3> axes_along(glm::dvec3 towards_light, glm::dvec3 upright) {
  glm::dvec3 across = cross(upright, towards_light);
  if (!(dot(across, across) > 1e-6 * dot(upright, upright))) {
    glm::dvec3 least{0.0};
    int axis = 0;
    for (int i = 1; i < 3; ++i) {
      if (std::fabs(towards_light[i]) < std::fabs(towards_light[axis])) axis = i;
    }
    least[axis] = 1.0;
    across = cross(least, towards_light);
  }
  across = normalize(across);
  return {across, cross(towards_light, across), towards_light * -1.0};
}

void fit_to_directional(const Facets& facets, const MapCamera& camera, const SceneBox& scene,
                        ShadowMap& map) {
  const bool fits = map.settings.fits_camera;
  MapSide side;
  side.origin = (scene.low + scene.high) * 0.5;
  side.axes = axes_along(map.light.place,
                         fits ? row_of(camera.world_to_clip, 3) : glm::dvec3{0.0, 0.0, 1.0});
  PlaceBox casters;
  for (std::size_t i = 0; i < facets.facets.size(); ++i) {
    if (!stops_light(facets.facets[i], facets.planes[i], map.light)) continue;
    for (const glm::dvec3& corner : facets.facets[i].corners) {
      add(casters, glm::dvec2{in_side(side, corner)});
    }
  }
  if (!fits) {
    if (!is_empty(casters)) set_texels(side, casters, map.settings, facets.epsilon_m);
    map.sides.push_back(side);
    map.ends_m.push_back(std::numeric_limits<double>::infinity());
    return;
  }
  const DepthRange range = depth_range(camera, scene);
  map.ends_m = cascade_ends_m(range.near_m, range.far_m, map.settings.cascades);
  double begin_m = range.near_m;
  for (const double end_m : map.ends_m) {
    PlaceBox box;
    for (const glm::dvec3& corner : frustum_of(camera, begin_m, end_m)) {
      add(box, glm::dvec2{in_side(side, corner)});
    }
    box = intersection(box, casters);
    if (!is_empty(box)) set_texels(side, box, map.settings, facets.epsilon_m);
    map.sides.push_back(side);
    begin_m = end_m;
  }
}

MapSide cube_side(glm::dvec3 place, int number) {
  const int axis = number / 2;
  MapSide side;
  side.origin = place;
  side.axes[0][(axis + 1) % 3] = 1.0;
  side.axes[1][(axis + 2) % 3] = 1.0;
  side.axes[2][axis] = number % 2 == 0 ? 1.0 : -1.0;
  return side;
}

// A frustum as a cube's side sees it: the box around its faces, cut to the side.
PlaceBox seen_of(const Frustum& frustum, const MapSide& side, double least_z) {
  static constexpr std::array<std::array<std::size_t, 4>, 6> kFaces{
      {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
  PlaceBox box;
  for (const auto& face : kFaces) {
    MapPolygon polygon;
    for (const std::size_t corner : face) {
      polygon.corners[polygon.count++] = in_side(side, frustum[corner]);
    }
    cut_to_side(polygon, {{-1.0, -1.0}, {1.0, 1.0}, least_z});
    for (std::size_t i = 0; i < polygon.count; ++i) {
      add(box, glm::dvec2{polygon.corners[i]} / polygon.corners[i].z);
    }
  }
  return box;
}

void fit_to_point(const Facets& facets, const MapCamera& camera, const SceneBox& scene,
                  ShadowMap& map) {
  const PlaceBox whole{{-1.0, -1.0}, {1.0, 1.0}};
  const DepthRange range = depth_range(camera, scene);
  const Frustum frustum = frustum_of(camera, range.near_m, range.far_m);
  for (int number = 0; number < 6; ++number) {
    MapSide side = cube_side(map.light.place, number);
    PlaceBox box = whole;
    if (map.settings.fits_camera) {
      box = intersection(whole, seen_of(frustum, side, facets.epsilon_m));
    }
    if (!is_empty(box)) set_texels(side, box, map.settings, 0x1p-20);
    map.sides.push_back(side);
  }
  map.ends_m.push_back(std::numeric_limits<double>::infinity());
}

const MapSide& side_for(const ShadowMap& map, glm::dvec3 point) {
  std::size_t number = 0;
  if (map.light.w == 0.0) {
    if (map.camera && map.sides.size() > 1) {
      const double depth = depth_m(*map.camera, point);
      while (number + 1 < map.sides.size() && !(depth <= map.ends_m[number])) ++number;
    }
    return map.sides[number];
  }
  const glm::dvec3 q = point - map.light.place;
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::fabs(q[i]) > std::fabs(q[axis])) axis = i;
  }
  return map.sides[static_cast<std::size_t>(2 * axis + (q[axis] < 0.0 ? 1 : 0))];
}

}  // namespace

std::vector<double> cascade_ends_m(double near_m, double far_m, int count) {
  std::vector<double> ends;
  for (int i = 1; i < count; ++i) {
    const double part = static_cast<double>(i) / count;
    const double logarithmic = near_m * exact_math::pow(far_m / near_m, part);
    const double even = near_m + (far_m - near_m) * part;
    ends.push_back(0.5 * logarithmic + 0.5 * even);
  }
  ends.push_back(far_m);
  return ends;
}

ShadowMap fit_shadow_map(const Facets& facets, const ShadowLight& light,
                         const ShadowMapSettings& settings, const MapCamera& camera) {
  ShadowMap map{light, settings, {}, {}, {}};
  if (settings.fits_camera) map.camera = camera;
  if (facets.facets.empty()) {
    map.sides.resize(light.w == 0.0 ? 1 : 6);
    return map;
  }
  const SceneBox scene = box_of(facets);
  if (light.w == 0.0) {
    fit_to_directional(facets, camera, scene, map);
  } else {
    fit_to_point(facets, camera, scene, map);
  }
  return map;
}

ShadowMap draw_shadow_map(const Facets& facets, const ShadowLight& light,
                          const ShadowMapSettings& settings, const MapCamera& camera,
                          const Profile& profile, ThreadPool& pool) {
  ShadowMap map = fit_shadow_map(facets, light, settings, camera);
  for (MapSide& side : map.sides) {
    if (side.texels == glm::dvec2{0.0}) continue;
    draw_map_side(facets, light, settings.size, profile, side, pool);
  }
  return map;
}

MapPlace map_place(const ShadowMap& map, const Receiver& receiver, glm::dvec3 point) {
  MapPlace place;
  place.side = &side_for(map, point);
  const MapSide& side = *place.side;
  const FacetPlane& plane = receiver.plane;
  const glm::dvec3 p = in_side(side, point);
  const bool is_point = map.light.w != 0.0;
  const double x = is_point ? p.x / p.z : p.x, y = is_point ? p.y / p.z : p.y;
  place.u = (x - side.low.x) * side.texels.x;
  place.v = (y - side.low.y) * side.texels.y;
  place.z = p.z;
  const double texel = 1.0 / std::min(side.texels.x, side.texels.y);
  place.reach_m = map.settings.kernel * (is_point ? texel * p.z : texel);
  const double n_x = dot(plane.normal, side.axes[0]), n_y = dot(plane.normal, side.axes[1]);
  double n_ahead = dot(plane.normal, side.axes[2]);
  if (is_point) n_ahead = (n_x * x + n_y * y) + n_ahead;
  place.slope = std::sqrt(n_x * n_x + n_y * n_y) / std::fabs(n_ahead);
  return place;
}

std::optional<MapComparison> map_comparison(const ShadowMap& map, const MapPlace& place) {
  const int size = map.settings.size;
  // Not a number, at the light itself, is lit.
  if (place.side->nearness.empty() ||
      !(place.u >= 0.0 && place.u < size && place.v >= 0.0 && place.v < size)) {
    return std::nullopt;
  }
  const double bias_m = place.reach_m * (map.settings.bias + map.settings.slope_bias * place.slope);
  const double z = place.z - bias_m;
  if (map.light.w != 0.0 && !(z > 0.0)) return std::nullopt;
  return MapComparison{static_cast<int>(place.u), static_cast<int>(place.v),
                       map.light.w != 0.0 ? 1.0 / z : -z};
}

int blocked_texels(const ShadowMap& map, const MapPlace& place) {
  const std::optional<MapComparison> compared = map_comparison(map, place);
  if (!compared) return 0;
  const int size = map.settings.size, half = map.settings.kernel / 2;
  int blocked = 0;
  for (int j = std::max(compared->v - half, 0); j <= std::min(compared->v + half, size - 1); ++j) {
    const float* row =
        place.side->nearness.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(size);
    for (int i = std::max(compared->u - half, 0); i <= std::min(compared->u + half, size - 1);
         ++i) {
      blocked += static_cast<double>(row[i]) > compared->own ? 1 : 0;
    }
  }
  return blocked;
}

}  // namespace softfocus
