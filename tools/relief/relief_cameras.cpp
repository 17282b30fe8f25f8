// Cameras of softfocus relief.

#include <cmath>
#include <string>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "tools/cli/errors.h"
#include "tools/relief/relief_options.h"

namespace softfocus {
namespace {

/// Below this sine of an angle, a direction is along another.
constexpr double kLeastSine = 1e-6;

double length(glm::dvec3 v) { return std::sqrt(dot(v, v)); }

bool is_along(glm::dvec3 unit, glm::dvec3 v) {
  return length(cross(unit, v)) < kLeastSine * length(v);
}

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
  if (length(back) < kLeastSine * maker.radius_m) {
    throw UsageError("'" + scene.name +
                     "': its eye is in the object's middle; another place of its camera would be "
                     "right");
  }
  // Straight above or below the middle it looks elsewhere, so its own right is one.
  const glm::dvec3 right = is_along(up, back)
                               ? glm::dvec3{camera.world_to_eye[0][0], camera.world_to_eye[1][0],
                                            camera.world_to_eye[2][0]}
                               : normalize(cross(up, back));
  const glm::dvec3 arm = turned_view(back, right, up, options);
  if (is_along(up, arm)) {
    throw UsageError("--pitch: the eye is straight above or below the middle of '" + scene.name +
                     "', where no side is up; a few degrees more or less would be right");
  }
  return arm;
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
