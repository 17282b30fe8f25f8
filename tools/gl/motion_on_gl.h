#pragma once
// Velocity from a picture's depth, and motion blur, on a GL driver with the project's shaders.

#include "raster/effects/motion/motion_blur.h"
#include "raster/effects/motion/velocity.h"
#include "tools/gl/objects.h"
#include "tools/gl/shaders.h"

namespace softfocus {

/// As camera_velocity(): RG16F in the target's one texture.
GlTarget camera_velocity_on_gl(const GlContext& context, const Shaders& shaders,
                               const CameraMotion& motion, const GlTexture& picture, int width,
                               int height);

/// As motion_blur() and motion_blur_along_own(), of an RGBA16F and an RG16F texture of that size.
GlTarget motion_blur_on_gl(const GlContext& context, const Shaders& shaders,
                           const MotionBlurSettings& settings, const GlTexture& picture,
                           const GlTexture& velocity, int width, int height);
GlTarget motion_blur_along_own_on_gl(const GlContext& context, const Shaders& shaders,
                                     float shutter, int samples, const GlTexture& picture,
                                     const GlTexture& velocity, int width, int height);

}  // namespace softfocus
