#pragma once
// From a scene to draw calls.

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/parallel.h"
#include "scenes/scene.h"

namespace softfocus {

/// A camera's two matrices and its place. Clip space is OpenGL's (-w <= z <= w)
/// with y pointing down, so that row 0 of the image is the top of the picture.
struct View {
  glm::dmat4 view;        ///< world to eye; the eye looks along -z
  glm::dmat4 projection;  ///< eye to clip
  glm::dvec3 eye;         ///< in the world
};

/// The scene's camera at a frame, for a picture of `width` x `height` pixels.
View camera_view(const Camera& camera, double frame, int width, int height);

/// Draws one frame into an RGBA16F image of any size: linear colour, and in alpha the
/// depth in metres along the axis (the camera's far distance where nothing was drawn).
/// The same bits for any number of threads.
Image draw_scene(const Scene& scene, const View& view, double frame, int width, int height,
                 const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
