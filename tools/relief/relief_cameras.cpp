// Where softfocus relief looks from.

#include <cmath>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "tools/relief/relief_options.h"

namespace softfocus {
namespace {

/// To the right by yaw, then up by pitch: where the eye goes.
glm::dvec3 turned_view(glm::dvec3 towards_eye, glm::dvec3 right, glm::dvec3 up,
                       const ReliefOptions& options) {
  const glm::dvec3 lifted = turned_about(towards_eye, right, -options.pitch_degrees);
  return turned_about(lifted, up, options.yaw_degrees);
}

}  // namespace

glm::dvec3 turned_about(glm::dvec3 v, glm::dvec3 axis, double degrees) {
  const double cosine = exact_math::cos_degrees(degrees), sine = exact_math::sin_degrees(degrees);
  return v * cosine + cross(axis, v) * sine + axis * (dot(axis, v) * (1.0 - cosine));
}

glm::dvec3 turned_arm(const ReliefMaker& maker, const Scene& scene, const ReliefOptions& options) {
  const CameraMatrices camera = camera_matrices(scene.camera, options.frame, 1, 1);
  const glm::dvec3 back = camera.eye - maker.middle, up = normalize(scene.camera.up);
  return turned_view(back, normalize(cross(up, back)), up, options);
}

glm::dvec3 relief_middle(const ReliefTexture& relief) {
  return relief_point(relief, 0.5 * (relief.width - 1), 0.5 * (relief.height - 1),
                      0.5 * last_depth(relief.depth_bits));
}

double relief_diagonal(const ReliefTexture& relief) {
  const glm::dvec3 across =
      relief_point(relief, relief.width - 1, relief.height - 1, last_depth(relief.depth_bits)) -
      relief_point(relief, 0, 0, 0);
  return std::sqrt(dot(across, across));
}

Camera camera_before(const ReliefTexture& relief, const ReliefOptions& options) {
  const glm::dvec3 right = normalize(relief.camera.a), up = normalize(relief.camera.b) * -1.0;
  const double diagonal = relief_diagonal(relief);
  Camera camera;
  camera.target = relief_middle(relief);
  camera.position = camera.target + turned_view(relief.camera.f * -1.0, right, up, options) *
                                        (options.distance * diagonal);
  camera.up = up;
  // The box fills the picture a diagonal and a half away.
  camera.near_m = 1e-3 * diagonal;
  camera.far_m = (options.distance + 2.0) * diagonal;
  return camera;
}

Camera camera_about(const ReliefMaker& maker, const Scene& scene, const ReliefOptions& options) {
  const double diagonal = 2.0 * maker.radius_m;
  Camera camera;
  camera.target = maker.middle;
  camera.position =
      maker.middle + normalize(turned_arm(maker, scene, options)) * (options.distance * diagonal);
  camera.up = scene.camera.up;
  camera.near_m = 1e-3 * diagonal;
  camera.far_m = (options.distance + 2.0) * diagonal;
  return camera;
}

}  // namespace softfocus
