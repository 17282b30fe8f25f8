#pragma once
// Direct shadow projection: for each receiver that faces the light, the casters between it and the
// light, cut at its plane and projected onto it (Blinn 1988).

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/shadows/facets.h"
#include "scenes/shadows/light_grid.h"

namespace softfocus {

/// Which side of a receiver a light can reach. A facet without a plane shows no shadow: `both`.
enum class LitSide : std::uint8_t { none, front, back, both };

LitSide lit_side(const Receiver& receiver, const ShadowLight& light, double epsilon_m);

/// Of each receiver; without a pool, by one thread.
std::vector<LitSide> lit_sides(const Facets& facets, const ShadowLight& light,
                               ThreadPool* pool = nullptr);

/// A shadow's triangle in homogeneous coordinates of the world, w >= 0. It lies in its receiver's
/// plane; corners of w = 0 are infinitely far.
using ProjectedTriangle = std::array<glm::dvec4, 3>;

/// The shadows of one light, which depend on no camera.
struct ProjectedShadows {
  std::vector<LitSide> lit;  ///< lit_sides()
  /// CSR: receiver i's triangles are triangles[begins[i]] to triangles[begins[i + 1] - 1].
  std::vector<std::size_t> begins;
  std::vector<ProjectedTriangle> triangles;
  bool of_all = true;  ///< receivers; if not, of those asked for
};

/// Every caster against every receiver, one after the other: O(n^2).
ProjectedShadows project_in_sequence(const Facets& facets, const ShadowLight& light);

/// The same bits. In parallel over receivers, every caster against every receiver to count their
/// triangles; then those that throw a shadow again, to fill a buffer of exactly that size.
ProjectedShadows project_in_parallel(const Facets& facets, const ShadowLight& light,
                                     ThreadPool& pool);

/// The same bits. As project_in_parallel(), but each receiver looks at the casters that a
/// LightGrid finds before it.
ProjectedShadows project_by_grid(const Facets& facets, const ShadowLight& light, ThreadPool& pool);

/// Of the triangles that project_by_grid() has on the wanted receivers, in their order, those that
/// may touch the outlines; and on no others.
ProjectedShadows project_onto(std::span<const WantedReceiver> wanted, const Facets& facets,
                              const ShadowLight& light, ThreadPool& pool);

}  // namespace softfocus
