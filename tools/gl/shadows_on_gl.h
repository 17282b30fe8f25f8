#pragma once
// Projected shadows drawn by a GL driver: the triangles of scenes/shadows/shadow_mask.h.

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/shadows/maps/draw_map_side.h"
#include "scenes/shadows/maps/map_lookup.h"
#include "scenes/shadows/shadow_mask.h"
#include "scenes/shadows/volumes/volume_mask.h"
#include "tools/gl/doubles_on_gl.h"
#include "tools/gl/objects.h"

namespace softfocus {

// Shadow volumes counted by a GL driver: the faces and samples of
// scenes/shadows/volumes/volume_mask.h.

/// A face is drawn as rectangles that hold all pixels which it may count.
struct GlVolumes {
  GlProgram program;
  GlTexture faces, samples;
  GlListed rectangles;
  GlTarget target;  ///< R32F: a pixel has what VolumeCounts::counts has
};

/// Uploads the faces and samples of `of`, which count_volumes() gave. Throws DriverError if the
/// driver has no doubles in shaders. 2^24 faces at most.
GlVolumes make_gl_volumes(const GlContext& context, const Shaders& shaders,
                          const ShadowVolumes& volumes, const VolumeCounts& of,
                          const ShadowView& view, glm::dvec3 eye, VolumeCount count);

void draw(const GlVolumes& volumes);

struct GlShadows {
  int width, height;
  GlProgram program;
  GlTexture receivers;
  /// For each light.
  struct OfLight {
    GlBuffer vertices;
    GLsizei count;
    GlTarget target;
  };
  std::vector<OfLight> lights;
};

/// Uploads all of it. `lights` counts the bits. Receivers are numbered by binary32: up to 2^24 of
/// them.
GlShadows make_gl_shadows(const GlContext& context, const Shaders& shaders, const MaskDraws& draws,
                          int lights, int width, int height);

void draw(const GlShadows& shadows);

/// As draw_shadow_mask() has it; `dark` is MaskDraws'.
std::vector<std::uint8_t> read_mask(const GlShadows& shadows, std::span<const std::uint8_t> dark);

// Shadow maps drawn and looked up by a GL driver: the cut casters of
// scenes/shadows/maps/draw_map_side.h, the comparisons of map_lookup.h.

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
