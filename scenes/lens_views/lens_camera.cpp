#include "scenes/lens_views/lens_camera.h"

namespace softfocus {

CameraMatrices lens_camera(const CameraMatrices& pinhole, glm::dvec2 lens_point_m, double focus_m,
                           glm::dvec2 offset_px, int width_px, int height_px) {
  CameraMatrices moved = pinhole;
  const double size_px[] = {static_cast<double>(width_px), static_cast<double>(height_px)};
  for (int axis = 0; axis < 2; ++axis) {
    moved.world_to_eye[3][axis] -= lens_point_m[axis];
    const double shear = pinhole.eye_to_clip[axis][axis] * lens_point_m[axis] / focus_m -
                         2.0 * offset_px[axis] / size_px[axis];
    moved.eye_to_clip[2][axis] -= shear;  // w = -z_eye
    // Rows of the matrix are the camera's axes in the world.
    for (int i = 0; i < 3; ++i) moved.eye[i] += pinhole.world_to_eye[i][axis] * lens_point_m[axis];
  }
  return moved;
}

}  // namespace softfocus
