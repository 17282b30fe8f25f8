#include "scenes/shadows/terminators.h"

#include <algorithm>
#include <cmath>

#include "scenes/shadows/light_grid.h"
#include "scenes/shadows/projected_shadows.h"
#include "scenes/shadows/shadow_truth.h"

namespace softfocus {
namespace {

glm::dvec3 way_to(const ShadowLight& light, glm::dvec3 point) {
  return light.place - point * light.w;
}

double longest_edge_m(const Facet& facet) {
  const auto& [a, b, c] = facet.corners;
  return std::max({length_of(b - a), length_of(c - b), length_of(a - c)});
}

// How much of each corner there is at a point: the areas of the triangles that it makes with the
// edges. Outside the facet, too, where a pixel's centre may lie by a rounding.
std::array<double, 3> corner_parts(const Facet& facet, glm::dvec3 plane_normal, glm::dvec3 point) {
  const auto& [a, b, c] = facet.corners;
  return {dot(plane_normal, cross(c - b, point - b)), dot(plane_normal, cross(a - c, point - c)),
          dot(plane_normal, cross(b - a, point - a))};
}

LitSide side_of(bool seen_from_back) { return seen_from_back ? LitSide::back : LitSide::front; }

// The light of a frame, and what finds the casters before a point.
struct SoftenedLight {
  const TerminatorLight& given;
  LightGrid grid;
  std::vector<LitSide> lit;
  std::vector<std::uint8_t> may_change;  // of each side of each facet, as SeenFacet numbers them
};

bool turns_away(const SoftenedLight& light, const Facets& facets, SeenFacet seen) {
  const LitSide lit = light.lit[facets.receiver_of[facet_of(seen)]];
  return lit != LitSide::both && lit != side_of(seen_from_back(seen));
}

// Some corners are lit, and either not all are or the facet turns away.
bool may_change_by_normals(const SoftenedLight& light, const Facets& facets,
                           const CurvedSurfaces& surfaces, SeenFacet seen) {
  const std::array<double, 3> cosines =
      corner_cosines(facets, surfaces, facet_of(seen), seen_from_back(seen), light.given.light);
  const auto [least, most] = std::minmax({cosines[0], cosines[1], cosines[2]});
  return most > 0.0 && (least < 0.0 || turns_away(light, facets, seen));
}

std::vector<SoftenedLight> softened_lights(const Facets& facets, const CurvedSurfaces& surfaces,
                                           std::span<const TerminatorLight> lights,
                                           ThreadPool& pool) {
  std::vector<SoftenedLight> made;
  for (const TerminatorLight& light : lights) {
    made.push_back({light, {}, lit_sides(facets, light.light), {}});
    if (light.rule != Terminator::normals) continue;
    SoftenedLight& last = made.back();
    last.grid = make_light_grid(facets, light.light);
    last.may_change.resize(2 * facets.facets.size());
    constexpr std::size_t kOfTask = 1024;
    const std::size_t tasks = (last.may_change.size() + kOfTask - 1) / kOfTask;
    pool.for_each(static_cast<int>(tasks), [&](int task) {
      const std::size_t begin = static_cast<std::size_t>(task) * kOfTask;
      for (std::size_t i = begin; i < std::min(begin + kOfTask, last.may_change.size()); ++i) {
        last.may_change[i] =
            may_change_by_normals(last, facets, surfaces, static_cast<SeenFacet>(i + 1));
      }
    });
  }
  return made;
}

void take(std::uint8_t& taken, double kept) {
  taken = static_cast<std::uint8_t>(255.0 - (255.0 - taken) * kept + 0.5);
}

void soften_by_normals(const Facets& facets, const CurvedSurfaces& surfaces,
                       const SoftenedLight& light, SeenFacet seen, glm::dvec3 point,
                       std::size_t pixel, std::uint8_t& mask, std::vector<std::uint32_t>& memory) {
  if (light.may_change[seen - 1] == 0) return;
  const std::uint32_t facet = facet_of(seen);
  const double kept = kept_by_normals(
      facets.facets[facet], facets.planes[facet],
      corner_cosines(facets, surfaces, facet, seen_from_back(seen), light.given.light), point);
  const auto bit = static_cast<std::uint8_t>(1u << light.given.bit);
  if ((mask & bit) != 0) {
    if (!turns_away(light, facets, seen) || kept == 0.0) return;
    find_casters(light.grid, {&point, 1}, memory);
    if (in_shadow_but_for_own_curve(facets, surfaces, facet, point, light.given.light, memory)) {
      return;
    }
    mask = static_cast<std::uint8_t>(mask & ~bit);
  }
  take(light.given.taken[pixel], kept);
}

void soften_pixel(const Facets& facets, const CurvedSurfaces& surfaces, const SoftenedLight& light,
                  SeenFacet seen, glm::dvec3 point, std::size_t pixel, std::uint8_t& mask,
                  std::vector<std::uint32_t>& memory) {
  if (light.given.rule == Terminator::normals) {
    soften_by_normals(facets, surfaces, light, seen, point, pixel, mask, memory);
    return;
  }
  const std::uint32_t facet = facet_of(seen);
  if ((mask >> light.given.bit & 1) != 0 || turns_away(light, facets, seen)) return;
  take(light.given.taken[pixel],
       kept_by_fade(facets, surfaces, facet, seen_from_back(seen), point, light.given.light));
}

}  // namespace

std::array<double, 3> corner_cosines(const Facets& facets, const CurvedSurfaces& surfaces,
                                     std::uint32_t facet, bool seen_from_back,
                                     const ShadowLight& light) {
  const double side = seen_from_back ? -1.0 : 1.0;
  std::array<double, 3> cosines{};
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 to_light = normalize(way_to(light, facets.facets[facet].corners[i]));
    cosines[i] = side * dot(glm::dvec3{surfaces.normals[facet][i]}, to_light);
  }
  return cosines;
}

double kept_by_normals(const Facet& facet, const FacetPlane& plane,
                       const std::array<double, 3>& cosines, glm::dvec3 point) {
  const std::array<double, 3> parts = corner_parts(facet, plane.normal, point);
  double cosine = 0.0, lit = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double part = std::max(parts[i], 0.0);
    cosine += part * cosines[i];
    lit += part * std::max(cosines[i], 0.0);
  }
  return lit > 0.0 ? std::max(cosine, 0.0) / lit : 1.0;
}

bool in_shadow_but_for_own_curve(const Facets& facets, const CurvedSurfaces& surfaces,
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
  const std::array<double, 3> parts = corner_parts(facets.facets[facet], plane, point);
  const std::array<glm::vec3, 3>& normals = surfaces.normals[facet];
  const glm::dvec3 by_corners =
      normalize((glm::dvec3{normals[0]} * parts[0] + glm::dvec3{normals[1]} * parts[1]) +
                glm::dvec3{normals[2]} * parts[2]) *
      side;
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
  for_each_seen(seen, view.width, view.height, pool, [&](const SeenPixel& at, auto& memory) {
    const glm::dvec3 point = seen_point(facets.planes[facet_of(at.seen)], view.world_to_clip, eye,
                                        at.centre, view.width, view.height);
    for (const SoftenedLight& light : softened) {
      soften_pixel(facets, surfaces, light, at.seen, point, at.index, mask[at.index], memory);
    }
  });
}

}  // namespace softfocus
