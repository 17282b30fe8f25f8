#include "scenes/relief/impostors/eye_motion.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/numbers/vector_math.h"
#include "scenes/draw/frame_matrices.h"

using namespace softfocus;

namespace {

double apart_m(glm::dvec3 a, glm::dvec3 b) { return std::sqrt(dot(a - b, a - b)); }

}  // namespace

TEST_CASE("an eye that orbits is foreseen on its orbit, forwards and back") {
  Camera camera;
  camera.position = {1.0, 2.0, 4.0};
  camera.target = {0.0, 2.0, 0.0};
  camera.orbit_degrees_per_frame = 3.0;
  const auto eye_at = [&](int frame) { return camera_matrices(camera, frame, 8, 8).eye; };
  const EyeMotion motion = eye_motion(camera.target, 0.1, eye_at(10), eye_at(11));
  for (const int frames : {0, 1, 20, -11, 100}) {
    CHECK(apart_m(moved_eye(motion, eye_at(11), frames), eye_at(11 + frames)) < 1e-10);
  }
}

TEST_CASE(
    "an eye that comes straight nearer is foreseen on its line, and stops before the object") {
  const EyeMotion motion = eye_motion({1.0, 0.0, 0.0}, 2.0, {1.0, 0.0, 10.0}, {1.0, 0.0, 9.5});
  CHECK(apart_m(moved_eye(motion, {1.0, 0.0, 9.5}, 4), {1.0, 0.0, 7.5}) < 1e-12);
  CHECK(apart_m(moved_eye(motion, {1.0, 0.0, 9.5}, 400), {1.0, 0.0, 2.0}) < 1e-12);
}

TEST_CASE("an eye that stands still stays, and one that leaps to the other side goes nowhere") {
  const EyeMotion still = eye_motion(glm::dvec3{0.0}, 0.1, {1.0, 2.0, 3.0}, {1.0, 2.0, 3.0});
  CHECK(apart_m(moved_eye(still, {1.0, 2.0, 3.0}, 50), {1.0, 2.0, 3.0}) < 1e-12);
  const EyeMotion leap = eye_motion(glm::dvec3{0.0}, 0.1, {0.0, 0.0, 3.0}, {0.0, 0.0, -3.0});
  CHECK(apart_m(moved_eye(leap, {0.0, 0.0, -3.0}, 5), {0.0, 0.0, -3.0}) < 1e-12);
}
