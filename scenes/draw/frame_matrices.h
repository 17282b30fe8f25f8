#pragma once
// Where the camera and the objects stand at a frame: matrices, in binary64.

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "scenes/scene.h"

namespace softfocus {

/// A camera's two matrices and its place. Clip space is OpenGL's (-w <= z <= w) with y
/// pointing down, so that row 0 of the image is the top of the picture; clip w is the
/// depth in metres along the axis.
struct CameraMatrices {
  glm::dmat4 world_to_eye;  ///< the eye looks along -z, y up
  glm::dmat4 eye_to_clip;
  glm::dvec3 eye;  ///< in the world

  bool operator==(const CameraMatrices&) const = default;
};

/// In the world, where the eye's x, y or z points.
inline glm::dvec3 eye_axis(const CameraMatrices& camera, int i) {
  return {camera.world_to_eye[0][i], camera.world_to_eye[1][i], camera.world_to_eye[2][i]};
}

/// The rays from the eye through the centres of a picture's pixels, each as far as a metre along
/// the axis.
struct PixelRays {
  glm::dvec3 right, up, back;
  glm::dmat4 to_clip;
  int width, height;

  glm::dvec3 at(int x, int y) const {
    const double aside = ((x + 0.5) * 2.0 / width - 1.0 + to_clip[2][0]) / to_clip[0][0];
    const double above = ((y + 0.5) * 2.0 / height - 1.0 + to_clip[2][1]) / to_clip[1][1];
    return (right * aside + up * above) - back;
  }
};
inline PixelRays pixel_rays(const CameraMatrices& camera, int width, int height) {
  return {eye_axis(camera, 0),
          eye_axis(camera, 1),
          eye_axis(camera, 2),
          camera.eye_to_clip,
          width,
          height};
}

/// Whether it stands elsewhere than at its target, and does not look along `up`: keys can lead
/// there between them.
bool can_look(const Camera& camera, double frame);

/// What the camera looks at.
glm::dvec3 target_at(const Camera& camera, double frame);

/// The scene's camera at a frame, for a picture of `width` x `height` square pixels.
CameraMatrices camera_matrices(const Camera& camera, double frame, int width, int height);

/// Object to world at a frame: move * turn z * turn y * turn x * scale * motion within its model.
glm::dmat4 object_matrix(const Object& object, double frame);

// What a value that is given at some frames is at the others, and the lens at a frame.

/// The value at `frame` of at least one key, whose frames increase. Before the first key and after
/// the last it stands still; a key's own value comes back exactly. In between it lies between the
/// values of the two keys:
///
///   linear   on the straight line
///   smooth   on a cubic for each pair of keys, with one speed for both at a key. It is 0 at the
///            first key, at the last, and where the way turns; else it is the weighted harmonic
///            mean of the two slopes, which never overshoots (Fritsch and Butland 1984).
///
/// In binary64 by + - * / alone: the same bits on every machine.
double value_at(std::span<const Keyframe> keys, Easing easing, double frame);

/// The scene's lens at a frame.
ThinLens lens_at(const SceneLens& lens, double frame);

}  // namespace softfocus
