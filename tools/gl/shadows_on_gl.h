#pragma once
// Projected shadows drawn by a GL driver: the triangles of scenes/shadows/shadow_mask.h.

#include <cstdint>
#include <vector>

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

}  // namespace softfocus
