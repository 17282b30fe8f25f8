#pragma once
// Image-space effects on a GL driver, with the project's shaders.

#include <span>

#include "raster/effects/effect_settings.h"
#include "raster/effects/tone_map.h"
#include "raster/passes/kernel.h"
#include "tools/gl/effect_passes.h"

namespace softfocus {

/// RGBA16F to be read, and its size.
struct GlPicture {
  const GlTexture& texture;
  int width;
  int height;
};

/// The colour of a target of one texture.
inline GlPicture picture_of(const GlTarget& target) {
  return {target.colour[0], target.width, target.height};
}

/// Each begins `passes`; the result is the target's one colour texture. As apply(). Throws
/// DriverError for an effect without a shader. The velocity is of the picture's size, RG16F;
/// effects that read none need none.
const GlTarget& effect_on_gl(EffectPasses& passes, const Effect& effect,
                             std::span<const double> parameters, const GlPicture& picture,
                             const GlTexture* velocity = nullptr);

const GlTarget& bloom_on_gl(EffectPasses& passes, const BloomSettings& settings,
                            const GlPicture& picture);
const GlTarget& bloom_by_gaussian_on_gl(EffectPasses& passes, const GaussianBloomSettings& settings,
                                        const GlPicture& picture);
const GlTarget& lens_flare_on_gl(EffectPasses& passes, const LensFlareSettings& settings,
                                 const GlPicture& picture);
const GlTarget& tone_map_on_gl(EffectPasses& passes, const ToneCurve& curve, float exposure,
                               const GlPicture& picture);
const GlTarget& bilateral_on_gl(EffectPasses& passes, const BilateralSettings& settings,
                                const GlPicture& picture);
const GlTarget& dual_filter_on_gl(EffectPasses& passes, int levels, Widening widening,
                                  const GlPicture& picture);

/// Passes of these, which begin nothing. The result is smaller by the guard band.
const GlTarget& convolved_on_gl(EffectPasses& passes, const Kernel& kernel,
                                const GlPicture& picture, glm::ivec2 guard = {0, 0});
const GlTarget& halved_on_gl(EffectPasses& passes, const GlPicture& above);
const GlTarget& widened_on_gl(EffectPasses& passes, const GlPicture& from, const GlPicture& own,
                              const Upsampling& how);

}  // namespace softfocus
