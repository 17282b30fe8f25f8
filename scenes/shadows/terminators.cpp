#include "scenes/shadows/terminators.h"

#include <algorithm>
#include <cmath>

#include "scenes/shadows/light_grid.h"
#include "scenes/shadows/point_in_shadow.h"
#include "scenes/shadows/projected_shadows.h"

namespace softfocus {
namespace {

glm::dvec3 way_to(const ShadowLight& light, glm::dvec3 point) {
  return light.place - point * light.w;
}

double length_of(glm::dvec3 v) { return std::sqrt(dot(v, v)); }

double longest_edge_m(const Facet& facet) {
  const auto& [a, b, c] = facet.corners;
  return std::max({length_of(b - a), length_of(c - b), length_of(a - c)});
}

// The normal between the corners', by the areas of the triangles that the point makes with the
// edges. Outside the facet, too, where a pixel's centre may lie by a rounding.
glm::dvec3 normal_at(const Facet& facet, const std::array<glm::vec3, 3>& normals,
                     glm::dvec3 plane_normal, glm::dvec3 point) {
  const auto& [a, b, c] = facet.corners;
  const double of_a = dot(plane_normal, cross(c - b, point - b));
  const double of_b = dot(plane_normal, cross(a - c, point - c));
  const double of_c = dot(plane_normal, cross(b - a, point - a));
  return normalize((glm::dvec3{normals[0]} * of_a + glm::dvec3{normals[1]} * of_b) +
                   glm::dvec3{normals[2]} * of_c);
}

LitSide side_of(bool seen_from_back) { return seen_from_back ? LitSide::back : LitSide::front; }

// The light of a frame, and what finds the casters before a point.
struct SoftenedLight {
  const TerminatorLight& given;
  LightGrid grid;
  std::vector<LitSide> lit;
  std::vector<std::uint8_t> has_corner;  // of each side of each facet, as SeenFacet numbers them
};

std::vector<SoftenedLight> softened_lights(const Facets& facets, const CurvedSurfaces& surfaces,
                                           std::span<const TerminatorLight> lights,
                                           ThreadPool& pool) {
  std::vector<SoftenedLight> made;
  for (const TerminatorLight& light : lights) {
    made.push_back({light, {}, lit_sides(facets, light.light), {}});
    if (light.rule != Terminator::normals) continue;
    SoftenedLight& last = made.back();
    last.grid = make_light_grid(facets, light.light);
    last.has_corner.resize(2 * facets.facets.size());
    constexpr std::size_t kOfTask = 1024;
    const std::size_t tasks = (last.has_corner.size() + kOfTask - 1) / kOfTask;
    pool.for_each(static_cast<int>(tasks), [&](int task) {
      const std::size_t begin = static_cast<std::size_t>(task) * kOfTask;
      for (std::size_t i = begin; i < std::min(begin + kOfTask, last.has_corner.size()); ++i) {
        const auto seen = static_cast<SeenFacet>(i + 1);
        last.has_corner[i] =
            has_lit_corner(facets, surfaces, facet_of(seen), seen_from_back(seen), light.light);
      }
    });
  }
  return made;
}

void soften_pixel(const Facets& facets, const CurvedSurfaces& surfaces, const SoftenedLight& light,
                  SeenFacet seen, glm::dvec3 point, std::size_t pixel, std::uint8_t& mask,
                  std::vector<std::uint32_t>& memory) {
  const std::uint32_t facet = facet_of(seen);
  const auto bit = static_cast<std::uint8_t>(1u << light.given.bit);
  if (light.given.rule == Terminator::normals) {
    if ((mask & bit) == 0 || light.has_corner[seen - 1] == 0) return;
    find_casters(light.grid, {&point, 1}, memory);
    if (!behind_own_curve_in_shadow(facets, surfaces, facet, point, light.given.light, memory)) {
      mask = static_cast<std::uint8_t>(mask & ~bit);
    }
    return;
  }
  if ((mask & bit) != 0 || light.lit[facets.receiver_of[facet]] != side_of(seen_from_back(seen))) {
    return;
  }
  const double kept =
      kept_by_fade(facets, surfaces, facet, seen_from_back(seen), point, light.given.light);
  std::uint8_t& taken = light.given.taken[pixel];
  taken = static_cast<std::uint8_t>(255.0 - (255.0 - taken) * kept + 0.5);
}

}  // namespace

bool has_lit_corner(const Facets& facets, const CurvedSurfaces& surfaces, std::uint32_t facet,
                    bool seen_from_back, const ShadowLight& light) {
  const LitSide lit =
      lit_side(facets.receivers[facets.receiver_of[facet]], light, facets.epsilon_m);
  if (lit == LitSide::both || lit == side_of(seen_from_back)) return false;
  const double side = seen_from_back ? -1.0 : 1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 normal{surfaces.normals[facet][i]};
    if (side * dot(normal, way_to(light, facets.facets[facet].corners[i])) > 0.0) return true;
  }
  return false;
}

bool behind_own_curve_in_shadow(const Facets& facets, const CurvedSurfaces& surfaces,
                                std::uint32_t facet, glm::dvec3 point, const ShadowLight& light,
                                std::span<const std::uint32_t> casters) {
  const glm::dvec3 ray = way_to(light, point);
  const double metres = length_of(ray);
  const double own_m = kOwnReach * longest_edge_m(facets.facets[facet]);
  for (const std::uint32_t caster : casters) {
    if (facets.receiver_of[caster] == facets.receiver_of[facet] ||
        !stops_light(facets.facets[caster], facets.planes[caster], light)) {
      continue;
    }
    const double t = ray_hit(facets.facets[caster], point, ray);
    if (light.w != 0.0 && t >= 1.0) continue;
    const bool is_own = surfaces.object_of[caster] == surfaces.object_of[facet];
    if (t * metres > (is_own ? own_m : facets.epsilon_m)) return true;
  }
  return false;
}

double kept_by_fade(const Facets& facets, const CurvedSurfaces& surfaces, std::uint32_t facet,
                    bool seen_from_back, glm::dvec3 point, const ShadowLight& light) {
  const double side = seen_from_back ? -1.0 : 1.0;
  const glm::dvec3 plane = facets.planes[facet].normal;
  const glm::dvec3 by_plane = plane * side;
  const glm::dvec3 by_corners =
      normal_at(facets.facets[facet], surfaces.normals[facet], plane, point) * side;
  const glm::dvec3 to_light = normalize(way_to(light, point));
  const double faces = dot(by_corners, to_light), agree = dot(by_plane, by_corners);
  if (!(faces > 0.0) || !(agree > 0.0)) return 1.0;
  const double g = std::clamp(dot(by_plane, to_light) / (faces * agree), 0.0, 1.0);
  return ((1.0 - g) * g + 1.0) * g;
}

void soften_terminators(const Facets& facets, const CurvedSurfaces& surfaces,
                        std::span<const TerminatorLight> lights, std::span<const SeenFacet> seen,
                        const ShadowView& view, glm::dvec3 eye, std::span<std::uint8_t> mask,
                        ThreadPool& pool) {
  const std::vector<SoftenedLight> softened = softened_lights(facets, surfaces, lights, pool);
  pool.for_each(view.height, [&](int y) {
    std::vector<std::uint32_t> memory;
    for (int x = 0; x < view.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                                static_cast<std::size_t>(x);
      if (!shows_facet(seen[pixel])) continue;
      const glm::dvec3 point = seen_point(facets.planes[facet_of(seen[pixel])], view.world_to_clip,
                                          eye, {x + 0.5, y + 0.5}, view.width, view.height);
      for (const SoftenedLight& light : softened) {
        soften_pixel(facets, surfaces, light, seen[pixel], point, pixel, mask[pixel], memory);
      }
    }
  });
}

}  // namespace softfocus
