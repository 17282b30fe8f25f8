#pragma once
// Image-space effects on a GL driver, with the project's shaders.

#include "raster/effects/bloom.h"
#include "raster/effects/lens_flare.h"
#include "raster/effects/tone_map.h"
#include "tools/gl/objects.h"
#include "tools/gl/shaders.h"

namespace softfocus {

/// Each of an RGBA16F texture of that size; the result is the target's one colour texture.
GlTarget bloom_on_gl(const GlContext& context, const Shaders& shaders,
                     const BloomSettings& settings, const GlTexture& picture, int width,
                     int height);
GlTarget lens_flare_on_gl(const GlContext& context, const Shaders& shaders,
                          const LensFlareSettings& settings, const GlTexture& picture, int width,
                          int height);
GlTarget tone_map_on_gl(const GlContext& context, const Shaders& shaders, const ToneCurve& curve,
                        float exposure, const GlTexture& picture, int width, int height);

}  // namespace softfocus
