#include "scenes/shadows/shadow_errors.h"

#include <array>
#include <numeric>
#include <vector>

#include "scenes/shadows/light_grid.h"
#include "scenes/shadows/point_in_shadow.h"

namespace softfocus {
namespace {

// On a circle of 1/256 pixel: cosines and sines of 0, 22.5 and 45 degrees.
constexpr double kNear = 1.0 / 256.0;
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

// The truth about one light.
class Truth {
 public:
  Truth(const Facets& facets, const ShadowLight& light, const ShadowView& view, glm::dvec3 eye,
        bool by_grid)
      : facets_(facets), light_(light), view_(view), eye_(eye) {
    if (by_grid) {
      grid_ = make_light_grid(facets, light);
    } else {
      all_.resize(facets.facets.size());
      std::iota(all_.begin(), all_.end(), 0u);
    }
  }

  bool is_dark(SeenFacet seen, glm::dvec2 window, std::vector<std::uint32_t>& memory) const {
    const std::uint32_t facet = facet_of(seen);
    const glm::dvec3 point = seen_point(facets_.planes[facet], view_.world_to_clip, eye_, window,
                                        view_.width, view_.height);
    if (all_.empty()) find_casters(grid_, {&point, 1}, memory);
    return point_in_shadow(facets_, facet, seen_from_back(seen), point, light_,
                           all_.empty() ? memory : all_);
  }

 private:
  const Facets& facets_;
  const ShadowLight& light_;
  const ShadowView& view_;
  glm::dvec3 eye_;
  LightGrid grid_;
  std::vector<std::uint32_t> all_;
};

}  // namespace

ShadowErrors shadow_errors(const Facets& facets, std::span<const ShadowLight> lights,
                           std::span<const SeenFacet> seen, std::span<const std::uint8_t> mask,
                           const ShadowView& view, glm::dvec3 eye, bool by_grid, ThreadPool& pool) {
  std::vector<ShadowErrors> of_rows(static_cast<std::size_t>(view.height));
  for (std::size_t light = 0; light < lights.size(); ++light) {
    const Truth truth{facets, lights[light], view, eye, by_grid};
    pool.for_each(view.height, [&](int y) {
      ShadowErrors& errors = of_rows[static_cast<std::size_t>(y)];
      std::vector<std::uint32_t> memory;
      for (int x = 0; x < view.width; ++x) {
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
            static_cast<std::size_t>(x);
        if (!shows_facet(seen[pixel])) continue;
        const bool answer = (mask[pixel] >> light & 1) != 0;
        const glm::dvec2 centre{x + 0.5, y + 0.5};
        ++errors.seen;
        errors.in_shadow += answer ? 1 : 0;
        if (truth.is_dark(seen[pixel], centre, memory) == answer) continue;
        bool is_near = false;
        for (std::size_t i = 0; i < kAround.size() && !is_near; ++i) {
          is_near = truth.is_dark(seen[pixel], centre + kAround[i] * kNear, memory) == answer;
        }
        ++(is_near ? errors.near_edge : errors.wrong);
      }
    });
  }
  ShadowErrors sum;
  for (const ShadowErrors& errors : of_rows) {
    sum.seen += errors.seen;
    sum.in_shadow += errors.in_shadow;
    sum.near_edge += errors.near_edge;
    sum.wrong += errors.wrong;
  }
  return sum;
}

}  // namespace softfocus
