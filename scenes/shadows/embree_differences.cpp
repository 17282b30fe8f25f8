#include <vector>

#include "scenes/shadows/embree_shadows.h"
#include "scenes/shadows/shadow_truth.h"

namespace softfocus {

EmbreeDifferences embree_differences(const Facets& facets, std::span<const ShadowLight> lights,
                                     std::span<const SeenFacet> seen, const ShadowView& view,
                                     glm::dvec3 eye, ThreadPool& pool) {
  const EmbreeShadows embree{facets};
  std::vector<EmbreeDifferences> of_rows(static_cast<std::size_t>(view.height));
  for (const ShadowLight& light : lights) {
    const ShadowTruth truth{facets, light, view, eye, true};
    pool.for_each(view.height, [&](int y) {
      EmbreeDifferences& found = of_rows[static_cast<std::size_t>(y)];
      std::vector<std::uint32_t> memory;
      for (int x = 0; x < view.width; ++x) {
        const SeenFacet here =
            seen[static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                 static_cast<std::size_t>(x)];
        if (!shows_facet(here)) continue;
        ++found.seen;
        const glm::dvec2 centre{x + 0.5, y + 0.5};
        const glm::dvec3 point = truth.point(here, centre);
        const bool answer = embree.is_dark(facet_of(here), seen_from_back(here), point, light);
        if (answer == truth.is_dark_at(here, point, memory)) continue;
        std::size_t reach = 0;
        while (reach < kDifferenceReaches.size() &&
               !truth.is_near_edge(here, centre, memory, kDifferenceReaches[reach])) {
          ++reach;
        }
        ++found.differ[reach];
      }
    });
  }
  EmbreeDifferences sum;
  for (const EmbreeDifferences& of_row : of_rows) {
    sum.seen += of_row.seen;
    for (std::size_t i = 0; i < sum.differ.size(); ++i) sum.differ[i] += of_row.differ[i];
  }
  return sum;
}

}  // namespace softfocus
