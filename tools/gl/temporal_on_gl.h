#pragma once
// What one frame takes from the frame before, on a GL driver with the project's shaders.

#include "raster/temporal/accumulate.h"
#include "raster/temporal/reproject.h"
#include "tools/gl/objects.h"
#include "tools/gl/shaders.h"

namespace softfocus {

struct ReprojectTextures {
  const GlTexture& depths;
  const GlTexture& velocity;
  const GlTexture& before;
  const GlTexture& frames;
};

/// As reverse_reproject(): RGBA16F in the target's one texture.
GlTarget reverse_reproject_on_gl(const GlContext& context, const Shaders& shaders,
                                 const ReprojectSettings& settings,
                                 const ReprojectTextures& textures, int width, int height);

/// As accumulate() and refresh(): RGBA16F and R32F.
GlTarget accumulate_on_gl(const GlContext& context, const Shaders& shaders,
                          const AccumulateSettings& settings, const GlTexture& now,
                          const GlTexture& old, int width, int height);
GlTarget refresh_on_gl(const GlContext& context, const Shaders& shaders, int groups, int turn,
                       const GlTexture& drawn, const GlTexture& found, int width, int height);

/// As forward_reproject() and fill_holes(): RGBA16F. The driver scatters points, and its depth test
/// keeps the nearest.
GlTarget forward_reproject_on_gl(const GlContext& context, const Shaders& shaders,
                                 const GlTexture& before, const GlTexture& velocity, int width,
                                 int height);
GlTarget fill_holes_on_gl(const GlContext& context, const Shaders& shaders,
                          const GlTexture& scattered, int width, int height);

}  // namespace softfocus
