#pragma once
// Passes from earlier frames to one frame, on a GL driver with the project's shaders.

#include "raster/effects/motion/motion_blur.h"
#include "raster/effects/motion/velocity.h"
#include "raster/temporal/frame_passes.h"
#include "tools/gl/effects_on_gl.h"

namespace softfocus {

// Velocity from a picture's depth, and motion blur, on a GL driver with the project's shaders.

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

/// As FrameSources.
struct GlFrameSources {
  const GlTexture& drawn;
  const GlTexture& velocity;
  const GlTexture& before;
  const GlTexture& frames;
  int turn;
  int width;
  int height;
};

/// As make_frame(): RGBA16F, and R32F as well unless it is Reproject with holes that are not drawn.
/// Begins `passes`.
const GlTarget& make_frame_on_gl(EffectPasses& passes, const FrameEffect& effect,
                                 const GlFrameSources& sources);

/// The passes, which begin nothing. As reverse_reproject(): RGBA16F in the target's one texture.
const GlTarget& reverse_reproject_on_gl(EffectPasses& passes, const ReprojectSettings& settings,
                                        const GlFrameSources& sources);

/// As accumulate() and refresh(): RGBA16F and R32F.
const GlTarget& accumulate_on_gl(EffectPasses& passes, const AccumulateSettings& settings,
                                 const GlTexture& now, const GlTexture& old, int width, int height);
const GlTarget& refresh_on_gl(EffectPasses& passes, int groups, int turn, const GlTexture& drawn,
                              const GlTexture& found, int width, int height);

/// As forward_reproject(), fill_holes() and put_depths(): RGBA16F. The driver scatters points, and
/// its depth test keeps the nearest.
const GlTarget& forward_reproject_on_gl(EffectPasses& passes, const GlTexture& before,
                                        const GlTexture& velocity, int width, int height);
const GlTarget& fill_holes_on_gl(EffectPasses& passes, const GlTexture& scattered, int width,
                                 int height);
const GlTarget& put_depths_on_gl(EffectPasses& passes, const GlTexture& drawn,
                                 const GlTexture& found, int width, int height);

}  // namespace softfocus
