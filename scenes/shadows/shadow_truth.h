#pragma once
// The definition of a shadow, as an oracle: a ray from a point towards the light against every
// facet, in binary64.

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "raster/threads/loops.h"
#include "scenes/shadows/facets.h"
#include "scenes/shadows/light_grid.h"
#include "scenes/shadows/shadow_mask.h"

namespace softfocus {

/// How many `direction`s away a ray hits a facet, or a negative number (Moeller and Trumbore 1997).
double ray_hit(const Facet& facet, glm::dvec3 from, glm::dvec3 direction);

/// Whether a point on the front or the back of a facet is in shadow. It is if the light does not
/// reach that side (projected_shadows.h, lit_side()), or if the ray from the point to the light
/// meets one of `casters` that stops light, is of another receiver, and is hit more than epsilon_m
/// over the receiver's plane.
bool point_in_shadow(const Facets& facets, std::uint32_t facet, bool seen_from_back,
                     glm::dvec3 point, const ShadowLight& light,
                     std::span<const std::uint32_t> casters);

/// The point of a facet's plane that is seen at a place in the window, in pixels from its upper
/// left corner. `eye` is the camera's.
glm::dvec3 seen_point(const FacetPlane& plane, const glm::dmat4& world_to_clip, glm::dvec3 eye,
                      glm::dvec2 window, int width, int height);

/// A pixel that shows a facet.
struct SeenPixel {
  SeenFacet seen;
  int y;
  std::size_t index;  ///< in rows from the top, without gaps
  glm::dvec2 centre;  ///< in the window
};

/// Runs body(pixel, memory) for each of them, on all threads. `memory` is for casters.
template <class Body>
void for_each_seen(std::span<const SeenFacet> seen, int width, int height, ThreadPool& pool,
                   const Body& body) {
  for_each_with<std::vector<std::uint32_t>>(pool, height, [&](int y, auto& memory) {
    std::size_t index = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    for (int x = 0; x < width; ++x, ++index) {
      if (!shows_facet(seen[index])) continue;
      body(SeenPixel{seen[index], y, index, {x + 0.5, y + 0.5}}, memory);
    }
  });
}

/// body(pixel, memory, sum), a row's. Returns the sum of the rows' sums, in their order.
template <class Sum, class Body>
Sum sum_over_seen(std::span<const SeenFacet> seen, int width, int height, ThreadPool& pool,
                  const Body& body) {
  std::vector<Sum> of_rows(static_cast<std::size_t>(height));
  for_each_seen(seen, width, height, pool, [&](const SeenPixel& at, auto& memory) {
    body(at, memory, of_rows[static_cast<std::size_t>(at.y)]);
  });
  Sum sum;
  for (const Sum& of_row : of_rows) sum += of_row;
  return sum;
}

// What a pixel shows of one light's shadow, by the definition.

class ShadowTruth {
 public:
  /// All outlive it. With `by_grid` the rays ask the casters that a LightGrid finds; without, all.
  ShadowTruth(const Facets& facets, const ShadowLight& light, const ShadowView& view,
              glm::dvec3 eye, bool by_grid);

  /// Of the facet's plane at a place in the window. `memory` is of the thread.
  bool is_dark(SeenFacet seen, glm::dvec2 window, std::vector<std::uint32_t>& memory) const;

  /// Whether the answer is another as at one of 16 points at this distance from there.
  bool is_near_edge(SeenFacet seen, glm::dvec2 window, std::vector<std::uint32_t>& memory,
                    double distance_px = 1.0 / 256.0) const;

  /// Of a point of the facet's plane.
  bool is_dark_at(SeenFacet seen, glm::dvec3 point, std::vector<std::uint32_t>& memory) const;

  glm::dvec3 point(SeenFacet seen, glm::dvec2 window) const;

 private:
  const Facets& facets_;
  const ShadowLight& light_;
  const ShadowView& view_;
  glm::dvec3 eye_;
  LightGrid grid_;
  std::vector<std::uint32_t> all_;
};

/// Whether each pixel is dark, 0 or 1, by rays.
std::vector<std::uint8_t> dark_pixels(const ShadowTruth& truth, std::span<const SeenFacet> seen,
                                      int width, int height, ThreadPool& pool);

// How right a shadow mask is: every pixel against the definition.

/// Pixels times lights.
struct ShadowErrors {
  std::size_t seen = 0;       ///< that show a facet
  std::size_t in_shadow = 0;  ///< of these
  std::size_t near_edge = 0;  ///< answered otherwise than at the centre, but as 1/256 pixel from it
  std::size_t wrong = 0;      ///< answered otherwise than anywhere within 1/256 pixel
};

ShadowErrors& operator+=(ShadowErrors& sum, const ShadowErrors& more);

/// `lights` are those of the mask's bits. With `by_grid` the rays ask the casters that a LightGrid
/// finds; without, all.
ShadowErrors shadow_errors(const Facets& facets, std::span<const ShadowLight> lights,
                           std::span<const SeenFacet> seen, std::span<const std::uint8_t> mask,
                           const ShadowView& view, glm::dvec3 eye, bool by_grid, ThreadPool& pool);

}  // namespace softfocus
