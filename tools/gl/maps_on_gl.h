#pragma once
// Shadow maps drawn and looked up by a GL driver: the cut casters of
// scenes/shadows/maps/draw_map_side.h, the comparisons of map_lookup.h.

#include <span>
#include <vector>

#include "scenes/shadows/maps/draw_map_side.h"
#include "scenes/shadows/maps/map_lookup.h"
#include "tools/gl/doubles_on_gl.h"

namespace softfocus {

/// A side of a map: a texel has what MapSide::nearness has.
struct GlMapSide {
  GlListed triangles;
  GlTexture planes;  ///< of the triangles
  GlTarget target;   ///< R32F
};

struct GlMap {
  int size, kernel;
  GlProgram draw, look_up;
  std::vector<GlMapSide> sides;
};

/// A map without sides. Throws DriverError if the driver has no doubles in shaders, or no viewport
/// of 4 times the size.
GlMap make_gl_map(const GlContext& context, const Shaders& shaders,
                  const ShadowMapSettings& settings);

/// Adds a side and uploads its casters: 2^24 triangles at most.
void add_side(GlMap& map, std::span<const CutCasters> casters);

void draw(const GlMap& map);

/// For each pixel how many texels are nearer, as blocked_texels() counts them: R32F.
Image look_up(const GlMap& map, std::span<const PixelComparison> pixels, int width, int height);

}  // namespace softfocus
