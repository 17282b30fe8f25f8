#include "scenes/lens_views/accumulation.h"

#include <doctest/doctest.h>

#include "dof/lens.h"
#include "raster/numbers/vector_math.h"
#include "scenes/lens_views/lens_view_method.h"

using namespace softfocus;

namespace {

constexpr int kWidth = 640, kHeight = 480;
const Camera kCamera{.position = {1.0, 2.0, 3.0}, .target = {0.5, 0.1, -2.0}, .fov_y_degrees = 45};
const ThinLens kLens{.focal_length_mm = 85, .f_number = 1.8, .focus_m = 2.5};

/// The place in the picture, in pixels, of a point of the pinhole camera's space.
glm::dvec2 seen_at(const CameraMatrices& camera, const CameraMatrices& pinhole,
                   glm::dvec3 camera_space) {
  glm::dvec3 world = pinhole.eye;
  for (int i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis)
      world[i] += pinhole.world_to_eye[i][axis] * camera_space[axis];
  }
  const glm::dmat4 to_clip = multiply(camera.eye_to_clip, camera.world_to_eye);
  const glm::dvec4 clip =
      ((to_clip[0] * world.x + to_clip[1] * world.y) + to_clip[2] * world.z) + to_clip[3];
  return {(clip.x / clip.w + 1.0) * kWidth / 2.0, (clip.y / clip.w + 1.0) * kHeight / 2.0};
}

CameraMatrices pinhole_camera() { return camera_matrices(kCamera, 0.0, kWidth, kHeight); }

}  // namespace

TEST_CASE("a point at the focus distance does not move, from wherever on the lens it is seen") {
  const CameraMatrices pinhole = pinhole_camera();
  const double radius_m = aperture_radius_m(kLens, 1.0);
  for (const glm::dvec2 point : lens_points({0}, 50)) {
    const CameraMatrices camera =
        lens_camera(pinhole, point * radius_m, kLens.focus_m, {0, 0}, kWidth, kHeight);
    for (const glm::dvec3 at : {glm::dvec3{0, 0, -2.5}, glm::dvec3{1, -0.5, -2.5}}) {
      const glm::dvec2 moved = seen_at(camera, pinhole, at) - seen_at(pinhole, pinhole, at);
      CHECK(std::fabs(moved.x) < 1e-9);
      CHECK(std::fabs(moved.y) < 1e-9);
    }
  }
}

TEST_CASE("a point elsewhere moves by its circle of confusion from the lens's edge") {
  const CameraMatrices pinhole = pinhole_camera();
  const double radius_m = aperture_radius_m(kLens, 1.5);
  const PixelCoc coc = pixel_coc(kLens, kCamera.fov_y_degrees, kHeight, 1.5);
  for (const double depth : {0.5, 1.0, 2.0, 3.0, 50.0}) {
    const double radius_px = coc_radius_px(coc, static_cast<float>(depth));
    const glm::dvec3 at{0.1, 0.2, -depth};
    const auto moved_from = [&](glm::dvec2 edge) {
      const CameraMatrices camera =
          lens_camera(pinhole, edge * radius_m, kLens.focus_m, {0, 0}, kWidth, kHeight);
      return seen_at(camera, pinhole, at) - seen_at(pinhole, pinhole, at);
    };
    // Points behind the focus move with the eye.
    CHECK(moved_from({1, 0}).x == doctest::Approx(radius_px).epsilon(1e-6));
    CHECK(std::fabs(moved_from({1, 0}).y) < 1e-9);
    CHECK(moved_from({0, 1}).y == doctest::Approx(-radius_px).epsilon(1e-6));
    CHECK(std::fabs(moved_from({0, 1}).x) < 1e-9);
  }
}

TEST_CASE("looking from elsewhere in the pixel moves the picture the other way") {
  const CameraMatrices pinhole = pinhole_camera();
  const CameraMatrices camera = lens_camera(pinhole, {0, 0}, 2.5, {0.25, -0.5}, kWidth, kHeight);
  const glm::dvec3 at{0.3, 0.4, -7.0};
  const glm::dvec2 moved = seen_at(camera, pinhole, at) - seen_at(pinhole, pinhole, at);
  CHECK(moved.x == doctest::Approx(-0.25));
  CHECK(moved.y == doctest::Approx(0.5));
}

TEST_CASE("the eye stands at the point of the lens") {
  const CameraMatrices pinhole = pinhole_camera();
  const CameraMatrices camera = lens_camera(pinhole, {0.01, 0.02}, 2.5, {0, 0}, kWidth, kHeight);
  const glm::dvec4 in_camera =
      ((pinhole.world_to_eye[0] * camera.eye.x + pinhole.world_to_eye[1] * camera.eye.y) +
       pinhole.world_to_eye[2] * camera.eye.z) +
      pinhole.world_to_eye[3];
  CHECK(in_camera.x == doctest::Approx(0.01));
  CHECK(in_camera.y == doctest::Approx(0.02));
  CHECK(std::fabs(in_camera.z) < 1e-12);
}

TEST_CASE("from the centre the camera is the pinhole's, bit for bit") {
  const CameraMatrices pinhole = pinhole_camera();
  const CameraMatrices camera = lens_camera(pinhole, {0, 0}, 2.5, {0, 0}, kWidth, kHeight);
  CHECK(camera.world_to_eye == pinhole.world_to_eye);
  CHECK(camera.eye_to_clip == pinhole.eye_to_clip);
  CHECK(camera.eye == pinhole.eye);
}
