#pragma once
// Projected shadows seen by a camera: a stencil with a bit for each light, set where the light does
// not reach.
//
// A receiver's own pixels take its shadows and no others: a picture of the facets that are seen
// stands in for the first of the two stencil values of direct shadow projection. Coverage is the
// pipeline's (raster/pipeline/setup.h), so a GL driver that draws the same triangles into its
// stencil covers the same pixels.

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "raster/numbers/profile.h"
#include "raster/pipeline/state.h"
#include "raster/threads/parallel.h"
#include "scenes/shadows/projected_shadows.h"

namespace softfocus {

/// The facet that a pixel shows: 0 for none, else 1 + 2 * facet + (1 if it is seen from its back).
using SeenFacet = std::uint32_t;

inline bool shows_facet(SeenFacet seen) { return seen != 0; }
inline std::uint32_t facet_of(SeenFacet seen) { return (seen - 1) / 2; }
inline bool seen_from_back(SeenFacet seen) { return (seen - 1) % 2 != 0; }

struct ShadowView {
  glm::dmat4 world_to_clip;  ///< -w <= x, y, z <= w, y downwards
  int width;
  int height;
  Profile profile;
};

/// A triangle of a shadow as it is drawn, on the pixels of its receiver alone: corners in
/// normalised device coordinates, cut to little more than where these pixels lie.
struct MaskTriangle {
  std::array<glm::vec2, 3> corners;
  std::uint32_t receiver;
  std::uint8_t bit;  ///< of its light
};

inline constexpr std::uint32_t kShowsNone = ~std::uint32_t{0};

/// What a camera sees of shadows, cut for drawing.
struct MaskDraws {
  std::vector<std::uint32_t> receivers;  ///< of each pixel; kShowsNone
  std::vector<std::uint8_t> dark;        ///< bits of lights that do not reach a pixel's side
  /// In parts, in the order of receivers. A triangle covers nothing outside its `pixels`.
  struct Part {
    std::vector<MaskTriangle> triangles;
    std::vector<Rectangle> pixels;
  };
  std::vector<Part> parts;
};

/// The receivers that any layer shows, in their order, each with little more of its outline than
/// what the view shows.
std::vector<WantedReceiver> seen_receivers(const Facets& facets,
                                           std::span<const std::vector<SeenFacet>> layers,
                                           const ShadowView& view);

/// `seen` has rows from the top, without gaps. Bit i is that of the light of `shadows`[i], 8 at
/// most; one whose shadows have no triangles has its dark sides alone, and null has no bits.
MaskDraws cut_shadows(const Facets& facets, std::span<const ProjectedShadows* const> shadows,
                      std::span<const SeenFacet> seen, const ShadowView& view, ThreadPool& pool);

/// Bit i of a pixel's byte is set where light i does not reach what the pixel shows. `mask` is as
/// large as what was seen.
void draw_shadow_mask(const MaskDraws& draws, const ShadowView& view, std::span<std::uint8_t> mask,
                      ThreadPool& pool);

}  // namespace softfocus
