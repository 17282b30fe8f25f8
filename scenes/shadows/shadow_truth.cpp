#include "scenes/shadows/shadow_truth.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "scenes/shadows/point_in_shadow.h"

namespace softfocus {
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
  pool.for_each(height, [&](int y) {
    std::vector<std::uint32_t> memory;
    for (int x = 0; x < width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                static_cast<std::size_t>(x);
      if (!shows_facet(seen[pixel])) continue;
      is_dark[pixel] = truth.is_dark(seen[pixel], {x + 0.5, y + 0.5}, memory) ? 1 : 0;
    }
  });
  return is_dark;
}

}  // namespace softfocus
