#pragma once
// The camera at a point of the lens.

#include <glm/vec2.hpp>

#include "scenes/draw/frame_matrices.h"

namespace softfocus {

/// Haeberli and Akeley (1990): the eye moves on the lens, by (e_x, e_y) metres to the right
/// and up, and the frustum is sheared so that the plane in focus stays where it was:
///
///   x_eye' = x_eye - e_x          x_clip' = P_00 x_eye' + (P_00 e_x / focus) w
///
/// At w = focus the two cancel. At another depth z the picture moves by
/// P_00 e_x (1/focus - 1/z) in normalised coordinates: the circle of confusion of
/// dof/lens.h, point by point. `offset_px` is where in the pixel, to the right and down
/// from its centre, a pixel looks: the picture moves the other way. Nothing moved is the
/// pinhole's view, bit for bit.
CameraMatrices lens_camera(const CameraMatrices& pinhole, glm::dvec2 lens_point_m, double focus_m,
                           glm::dvec2 offset_px, int width_px, int height_px);

}  // namespace softfocus
