#pragma once
// Projected shadows drawn by a GL driver: the triangles of scenes/shadows/shadow_mask.h.

#include <cstdint>
#include <vector>

#include "scenes/shadows/shadow_mask.h"
#include "tools/gl/objects.h"

namespace softfocus {

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
