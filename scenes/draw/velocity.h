#pragma once
// How what each pixel shows moves in the picture (raster/effects/motion/velocity.h): objects and
// camera, by place and by turn.

#include <glm/mat4x4.hpp>
#include <vector>

#include "raster/effects/motion/velocity.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/surfaces/surface_stages.h"

namespace softfocus {

/// A time and a view.
struct Instant {
  CameraMatrices camera;
  double frame;
};

/// By the scene's camera.
Instant instant_at(const Scene& scene, double frame, int width, int height);

/// A surface's position at `to` less that at `from`, times `factor`.
struct MotionSpan {
  Instant from, to;
  double factor = 1.0;
};

/// RG16F of the picture's size: the motion of the surface that draw_scene() shows at each pixel's
/// centre at the instant `shown`, which the span need not touch. Transparent surfaces have none:
/// the one behind counts. Where nothing is, the camera turns before points at infinity. What stands
/// still has exactly 0.
Image draw_velocity(const Scene& scene, const Instant& shown, const MotionSpan& span, int width,
                    int height, const Profile& profile, ThreadPool& pool);

/// As above, into RG16F, with memory to use again.
void draw_velocity(PreparedScene& prepared, const Instant& shown, const MotionSpan& span,
                   Image& velocity, ThreadPool& pool);

/// For camera_velocity(): the motion of a picture from `shown` if the camera alone moves.
CameraMotion camera_motion(const Scene& scene, const CameraMatrices& shown, const MotionSpan& span,
                           int width, int height);

/// The velocity that an effect reads, in pixels a frame: over its shutter around the frame, of a
/// picture of the scene's that is seen by the scene's camera.
Image velocity_for(const ChosenEffect& chosen, const Scene& scene, double frame,
                   const Image& picture, const Profile& profile, ThreadPool& pool);

// --- the draws, for the emulation and for a GL driver ---

/// What the stages read. A motion's clip x, y and w come from rows 0, 1 and 3.
struct VelocityInput {
  const Mesh* mesh;
  glm::mat4 shown, to, from;  ///< to clip space
  glm::vec2 half_size_px;
  float least_w;
};

struct VelocityDraw {
  DrawState state;
  VelocityInput input;
  const Material* material;  ///< of the surface; the background has none
  SurfaceOpacity opacity;    ///< with a texture if the surface has holes
};

/// The background, which fills the picture, then the opaque objects.
std::vector<VelocityDraw> velocity_draws(const Scene& scene, const Instant& shown,
                                         const MotionSpan& span, int width, int height);

}  // namespace softfocus
