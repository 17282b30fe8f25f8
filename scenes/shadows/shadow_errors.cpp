#include "scenes/shadows/shadow_errors.h"

#include <vector>

#include "scenes/shadows/shadow_truth.h"

namespace softfocus {
ShadowErrors shadow_errors(const Facets& facets, std::span<const ShadowLight> lights,
                           std::span<const SeenFacet> seen, std::span<const std::uint8_t> mask,
                           const ShadowView& view, glm::dvec3 eye, bool by_grid, ThreadPool& pool) {
  std::vector<ShadowErrors> of_rows(static_cast<std::size_t>(view.height));
  for (std::size_t light = 0; light < lights.size(); ++light) {
    const ShadowTruth truth{facets, lights[light], view, eye, by_grid};
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
        ++(truth.is_near_edge(seen[pixel], centre, memory) ? errors.near_edge : errors.wrong);
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
