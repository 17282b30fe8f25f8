#pragma once
// A second truth, which shares no arithmetic with the first: Embree's rays, in binary32. The rules
// are those of shadow_truth.h: which side of a receiver is lit, what stops light, epsilon. An
// answer differs where binary32 does not tell a ray from an edge.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string_view>

#include "raster/threads/parallel.h"
#include "scenes/shadows/shadow_mask.h"

namespace softfocus {

/// Empty, or what is missing: Embree is an optional part of the build.
std::string_view embree_shadows_missing();

class EmbreeShadows {
 public:
  /// `facets` outlive it. Throws std::runtime_error if Embree is missing or fails.
  explicit EmbreeShadows(const Facets& facets);
  ~EmbreeShadows();
  EmbreeShadows(const EmbreeShadows&) = delete;
  EmbreeShadows& operator=(const EmbreeShadows&) = delete;

  /// As point_in_shadow(), of all facets.
  bool is_dark(std::uint32_t facet, bool seen_from_back, glm::dvec3 point,
               const ShadowLight& light) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Two answers are compared at a pixel: where they differ, how far away the first would be the
/// second's. In pixels; the last is farther than all.
inline constexpr std::array kDifferenceReaches{1.0 / 256.0, 1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0};

/// Pixels times lights.
struct EmbreeDifferences {
  std::size_t seen = 0;
  std::array<std::size_t, kDifferenceReaches.size() + 1> differ{};
};

EmbreeDifferences& operator+=(EmbreeDifferences& sum, const EmbreeDifferences& more);

/// Embree's answers against those of point_in_shadow() at every pixel that shows a facet.
EmbreeDifferences embree_differences(const Facets& facets, std::span<const ShadowLight> lights,
                                     std::span<const SeenFacet> seen, const ShadowView& view,
                                     glm::dvec3 eye, ThreadPool& pool);

}  // namespace softfocus
