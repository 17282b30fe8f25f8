#include "scenes/draw/frame_matrices.h"

#include <doctest/doctest.h>

#include <glm/vec4.hpp>

using namespace softfocus;

namespace {

// A world point's place in the picture: (x, y) in pixels, row 0 on top, and the clip w.
struct Landing {
  double x, y, depth, w;
};

Landing project(const CameraMatrices& matrices, glm::dvec3 point, int width, int height) {
  const glm::dvec4 clip = matrices.eye_to_clip * (matrices.world_to_eye * glm::dvec4{point, 1.0});
  return {(clip.x / clip.w + 1.0) * width / 2.0, (clip.y / clip.w + 1.0) * height / 2.0,
          clip.z / clip.w, clip.w};
}

const Camera kCamera{.position = {1.0, 2.0, 5.0},
                     .target = {1.0, 2.0, 0.0},
                     .fov_y_degrees = 90.0,
                     .near_m = 0.5,
                     .far_m = 50.0};

doctest::Approx near(double value) { return doctest::Approx(value).epsilon(1e-12).scale(1.0); }

}  // namespace

TEST_CASE("the target lies in the middle of the picture, at its distance") {
  const Landing at = project(camera_matrices(kCamera, 0, 640, 480), {1.0, 2.0, 0.0}, 640, 480);
  CHECK(at.x == near(320.0));
  CHECK(at.y == near(240.0));
  CHECK(at.w == near(5.0));
}

TEST_CASE("up in the world is up in the picture, and right is right") {
  const CameraMatrices matrices = camera_matrices(kCamera, 0, 640, 480);
  CHECK(project(matrices, {1.0, 3.0, 0.0}, 640, 480).y < 240.0);
  CHECK(project(matrices, {2.0, 2.0, 0.0}, 640, 480).x > 320.0);
}

TEST_CASE("the field of view is the vertical one and pixels are square") {
  const CameraMatrices matrices = camera_matrices(kCamera, 0, 640, 480);
  // 90 degrees: 5 m away the upper border is 5 m above the axis.
  CHECK(project(matrices, {1.0, 7.0, 0.0}, 640, 480).y == near(0.0));
  const double up = 240.0 - project(matrices, {1.0, 3.0, 0.0}, 640, 480).y;
  const double right = project(matrices, {2.0, 2.0, 0.0}, 640, 480).x - 320.0;
  CHECK(up == near(right));
}

TEST_CASE("the near and the far distance are the ends of clip space") {
  const CameraMatrices matrices = camera_matrices(kCamera, 0, 64, 64);
  CHECK(project(matrices, {1.0, 2.0, 4.5}, 64, 64).depth == near(-1.0));
  CHECK(project(matrices, {1.0, 2.0, -45.0}, 64, 64).depth == near(1.0));
}

TEST_CASE("an orbit of 90 degrees brings the camera to the side, at the same distance") {
  Camera camera = kCamera;
  camera.orbit_degrees_per_frame = 30.0;
  const CameraMatrices matrices = camera_matrices(camera, 3, 64, 64);
  CHECK(matrices.eye.x == near(6.0));
  CHECK(matrices.eye.y == near(2.0));
  CHECK(matrices.eye.z == near(0.0));
  CHECK(project(matrices, camera.target, 64, 64).w == near(5.0));
}

TEST_CASE("an object is scaled, turned about x, y and z in that order, and moved") {
  Object object;
  object.scale = {2.0, 3.0, 4.0};
  object.rotation_degrees = {90.0, 90.0, 90.0};
  object.position = {10.0, 20.0, 30.0};
  const glm::dmat4 m = object_matrix(object, 0);
  // (1, 0, 0) -> scaled (2, 0, 0) -> x: same -> y: (0, 0, -2) -> z: same.
  const glm::dvec4 x = m * glm::dvec4{1.0, 0.0, 0.0, 1.0};
  CHECK(x == glm::dvec4{10.0, 20.0, 28.0, 1.0});
  // (0, 1, 0) -> (0, 3, 0) -> x: (0, 0, 3) -> y: (3, 0, 0) -> z: (0, 3, 0).
  const glm::dvec4 y = m * glm::dvec4{0.0, 1.0, 0.0, 1.0};
  CHECK(y == glm::dvec4{10.0, 23.0, 30.0, 1.0});
}

TEST_CASE("spin turns and sway moves an object by the frame") {
  Object object;
  object.spin_degrees_per_frame = {0.0, 45.0, 0.0};
  object.sway = {0.0, 0.0, 0.5};
  object.sway_period_frames = 8.0;
  const glm::dvec4 at_two = object_matrix(object, 2) * glm::dvec4{1.0, 0.0, 0.0, 1.0};
  CHECK(at_two.x == near(0.0));
  CHECK(at_two.z == near(-1.0 + 0.5));  // turned by 90 degrees, a quarter period on
  const glm::dvec4 centre = object_matrix(object, 8) * glm::dvec4{0.0, 0.0, 0.0, 1.0};
  CHECK(centre.z == near(0.0));
}
