#include "scenes/shadows/shadow_truth.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <vector>

#include "scenes/shadows/embree_shadows.h"
#include "scenes/shadows/light_grid.h"
#include "scenes/shadows/projected_shadows.h"

namespace softfocus {

double ray_hit(const Facet& facet, glm::dvec3 from, glm::dvec3 direction) {
  const auto& [a, b, c] = facet.corners;
  const glm::dvec3 edge1 = b - a, edge2 = c - a;
  const glm::dvec3 p = cross(direction, edge2);
  const double determinant = dot(edge1, p);
  if (determinant == 0.0) return -1.0;
  const glm::dvec3 from_a = from - a;
  const double u = dot(from_a, p) / determinant;
  const glm::dvec3 q = cross(from_a, edge1);
  const double v = dot(direction, q) / determinant;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 ? dot(edge2, q) / determinant : -1.0;
}

bool point_in_shadow(const Facets& facets, std::uint32_t facet, bool seen_from_back,
                     glm::dvec3 point, const ShadowLight& light,
                     std::span<const std::uint32_t> casters) {
  const std::uint32_t number = facets.receiver_of[facet];
  const Receiver& receiver = facets.receivers[number];
  const LitSide lit = lit_side(receiver, light, facets.epsilon_m);
  if (lit == LitSide::both) return false;
  if (lit != (seen_from_back ? LitSide::back : LitSide::front)) return true;
  const glm::dvec3 towards = light.place - point * light.w;
  for (const std::uint32_t caster : casters) {
    if (facets.receiver_of[caster] == number ||
        !stops_light(facets.facets[caster], facets.planes[caster], light)) {
      continue;
    }
    const double t = ray_hit(facets.facets[caster], point, towards);
    if (!(t > 0.0) || (light.w != 0.0 && t >= 1.0)) continue;
    const double height = height_over(receiver.plane, point + towards * t);
    if ((lit == LitSide::front ? height : -height) > facets.epsilon_m) return true;
  }
  return false;
}

glm::dvec3 seen_point(const FacetPlane& plane, const glm::dmat4& world_to_clip, glm::dvec3 eye,
                      glm::dvec2 window, int width, int height) {
  // The rows of the matrix say where a point is: (row_x - ndc_x row_w) . p = 0, likewise y. Both
  // planes hold the eye, and meet in the ray.
  const double x = window.x / width * 2.0 - 1.0, y = window.y / height * 2.0 - 1.0;
  const auto plane_through_eye = [&](int row, double ndc) {
    return glm::dvec3{world_to_clip[0][row] - ndc * world_to_clip[0][3],
                      world_to_clip[1][row] - ndc * world_to_clip[1][3],
                      world_to_clip[2][row] - ndc * world_to_clip[2][3]};
  };
  const glm::dvec3 ray = cross(plane_through_eye(0, x), plane_through_eye(1, y));
  const double slope = dot(plane.normal, ray);
  if (slope == 0.0) return eye;
  return eye + ray * ((plane.offset - dot(plane.normal, eye)) / slope);
}

namespace {

// On a circle of 1 pixel: cosines and sines of 0, 22.5 and 45 degrees.
constexpr double kCos1 = 0.92387953251128674, kSin1 = 0.38268343236508977,
                 kDiagonal = 0.70710678118654752;
constexpr std::array<glm::dvec2, 16> kAround{{{1, 0},
                                              {kCos1, kSin1},
                                              {kDiagonal, kDiagonal},
                                              {kSin1, kCos1},
                                              {0, 1},
                                              {-kSin1, kCos1},
                                              {-kDiagonal, kDiagonal},
                                              {-kCos1, kSin1},
                                              {-1, 0},
                                              {-kCos1, -kSin1},
                                              {-kDiagonal, -kDiagonal},
                                              {-kSin1, -kCos1},
                                              {0, -1},
                                              {kSin1, -kCos1},
                                              {kDiagonal, -kDiagonal},
                                              {kCos1, -kSin1}}};

}  // namespace

ShadowTruth::ShadowTruth(const Facets& facets, const ShadowLight& light, const ShadowView& view,
                         glm::dvec3 eye, bool by_grid)
    : facets_(facets), light_(light), view_(view), eye_(eye) {
  if (by_grid) {
    grid_ = make_light_grid(facets, light);
  } else {
    all_.resize(facets.facets.size());
    std::iota(all_.begin(), all_.end(), 0u);
  }
}

glm::dvec3 ShadowTruth::point(SeenFacet seen, glm::dvec2 window) const {
  return seen_point(facets_.planes[facet_of(seen)], view_.world_to_clip, eye_, window, view_.width,
                    view_.height);
}

bool ShadowTruth::is_dark_at(SeenFacet seen, glm::dvec3 point,
                             std::vector<std::uint32_t>& memory) const {
  if (all_.empty()) find_casters(grid_, {&point, 1}, memory);
  return point_in_shadow(facets_, facet_of(seen), seen_from_back(seen), point, light_,
                         all_.empty() ? memory : all_);
}

bool ShadowTruth::is_dark(SeenFacet seen, glm::dvec2 window,
                          std::vector<std::uint32_t>& memory) const {
  return is_dark_at(seen, point(seen, window), memory);
}

bool ShadowTruth::is_near_edge(SeenFacet seen, glm::dvec2 window,
                               std::vector<std::uint32_t>& memory, double distance_px) const {
  const bool here = is_dark(seen, window, memory);
  return std::any_of(kAround.begin(), kAround.end(), [&](glm::dvec2 around) {
    return is_dark(seen, window + around * distance_px, memory) != here;
  });
}

std::vector<std::uint8_t> dark_pixels(const ShadowTruth& truth, std::span<const SeenFacet> seen,
                                      int width, int height, ThreadPool& pool) {
  std::vector<std::uint8_t> is_dark(seen.size());
  for_each_seen(seen, width, height, pool, [&](const SeenPixel& at, auto& memory) {
    is_dark[at.index] = truth.is_dark(at.seen, at.centre, memory) ? 1 : 0;
  });
  return is_dark;
}

ShadowErrors& operator+=(ShadowErrors& sum, const ShadowErrors& more) {
  sum.seen += more.seen;
  sum.in_shadow += more.in_shadow;
  sum.near_edge += more.near_edge;
  sum.wrong += more.wrong;
  return sum;
}

ShadowErrors shadow_errors(const Facets& facets, std::span<const ShadowLight> lights,
                           std::span<const SeenFacet> seen, std::span<const std::uint8_t> mask,
                           const ShadowView& view, glm::dvec3 eye, bool by_grid, ThreadPool& pool) {
  ShadowErrors sum;
  for (std::size_t light = 0; light < lights.size(); ++light) {
    const ShadowTruth truth{facets, lights[light], view, eye, by_grid};
    const auto judge = [&](const SeenPixel& at, auto& memory, ShadowErrors& errors) {
      const bool answer = (mask[at.index] >> light & 1) != 0;
      ++errors.seen;
      errors.in_shadow += answer ? 1 : 0;
      if (truth.is_dark(at.seen, at.centre, memory) == answer) return;
      ++(truth.is_near_edge(at.seen, at.centre, memory) ? errors.near_edge : errors.wrong);
    };
    sum += sum_over_seen<ShadowErrors>(seen, view.width, view.height, pool, judge);
  }
  return sum;
}

EmbreeDifferences& operator+=(EmbreeDifferences& sum, const EmbreeDifferences& more) {
  sum.seen += more.seen;
  for (std::size_t i = 0; i < sum.differ.size(); ++i) sum.differ[i] += more.differ[i];
  return sum;
}

EmbreeDifferences embree_differences(const Facets& facets, std::span<const ShadowLight> lights,
                                     std::span<const SeenFacet> seen, const ShadowView& view,
                                     glm::dvec3 eye, ThreadPool& pool) {
  const EmbreeShadows embree{facets};
  EmbreeDifferences sum;
  for (const ShadowLight& light : lights) {
    const ShadowTruth truth{facets, light, view, eye, true};
    const auto compare = [&](const SeenPixel& at, auto& memory, EmbreeDifferences& found) {
      ++found.seen;
      const glm::dvec3 point = truth.point(at.seen, at.centre);
      const bool answer = embree.is_dark(facet_of(at.seen), seen_from_back(at.seen), point, light);
      if (answer == truth.is_dark_at(at.seen, point, memory)) return;
      std::size_t reach = 0;
      while (reach < kDifferenceReaches.size() &&
             !truth.is_near_edge(at.seen, at.centre, memory, kDifferenceReaches[reach])) {
        ++reach;
      }
      ++found.differ[reach];
    };
    sum += sum_over_seen<EmbreeDifferences>(seen, view.width, view.height, pool, compare);
  }
  return sum;
}

}  // namespace softfocus
