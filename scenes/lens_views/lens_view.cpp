#include "scenes/lens_views/lens_view.h"

namespace softfocus {

View lens_view(const View& pinhole, glm::dvec2 lens_point_m, double focus_m, glm::dvec2 offset_px,
               int width_px, int height_px) {
  View moved = pinhole;
  const double size_px[] = {static_cast<double>(width_px), static_cast<double>(height_px)};
  for (int axis = 0; axis < 2; ++axis) {
    moved.view[3][axis] -= lens_point_m[axis];
    const double shear = pinhole.projection[axis][axis] * lens_point_m[axis] / focus_m -
                         2.0 * offset_px[axis] / size_px[axis];
    moved.projection[2][axis] -= shear;  // w = -z_eye
    // Rows of the view are the camera's axes in the world.
    for (int i = 0; i < 3; ++i) moved.eye[i] += pinhole.view[i][axis] * lens_point_m[axis];
  }
  return moved;
}

}  // namespace softfocus
