#pragma once
// Where the camera and the objects stand at a frame: matrices, in binary64.

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "scenes/scene.h"

namespace softfocus {

/// A camera's two matrices and its place. Clip space is OpenGL's (-w <= z <= w) with y
/// pointing down, so that row 0 of the image is the top of the picture; clip w is the
/// depth in metres along the axis.
struct CameraMatrices {
  glm::dmat4 world_to_eye;  ///< the eye looks along -z, y up
  glm::dmat4 eye_to_clip;
  glm::dvec3 eye;  ///< in the world
};

/// The scene's camera at a frame, for a picture of `width` x `height` square pixels.
CameraMatrices camera_matrices(const Camera& camera, double frame, int width, int height);

/// Object to world at a frame: move * turn z * turn y * turn x * scale.
glm::dmat4 object_matrix(const Object& object, double frame);

}  // namespace softfocus
