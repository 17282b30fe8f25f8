#pragma once
// Velocity from a picture's depth, and motion blur, on a GL driver with the project's shaders.

#include "raster/effects/motion/motion_blur.h"
#include "raster/effects/motion/velocity.h"
#include "tools/gl/effects_on_gl.h"

namespace softfocus {

/// As camera_velocity(): RG16F in the target's one texture.
GlTarget camera_velocity_on_gl(const GlContext& context, const Shaders& shaders,
                               const CameraMotion& motion, const GlTexture& picture, int width,
                               int height);

/// RGBA16F and RG16F to be read, and their size.
struct GlMovingPicture {
  const GlTexture& picture;
  const GlTexture& velocity;
  int width;
  int height;
};

/// As motion_blur() and motion_blur_along_own(). Each begins `passes`.
const GlTarget& motion_blur_on_gl(EffectPasses& passes, const MotionBlurSettings& settings,
                                  const GlMovingPicture& of);
const GlTarget& motion_blur_along_own_on_gl(EffectPasses& passes, float shutter, int samples,
                                            const GlMovingPicture& of);

}  // namespace softfocus
