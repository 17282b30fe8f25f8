#include "scenes/relief/warp/march_relief.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"
#include "tests/support/relief_pictures.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

constexpr int kSize = 80;

CameraMatrices seen_from(glm::dvec3 eye) {
  Camera camera;
  camera.position = eye;
  camera.target = {0.0, 0.0, -0.4};
  return camera_matrices(camera, 0.0, kSize, kSize);
}

Image marched(const ReliefTexture& relief, const CameraMatrices& camera,
              const MarchSettings& settings) {
  ThreadPool pool(2);
  Image picture = make_image(Format::rgba16f, kSize, kSize);
  clear_image(picture, {0.0f, 0.0f, 0.0f, 100.0f}, Profile{});
  march_relief(relief, march_mapping(relief, *relief_extent(relief), camera, kSize, kSize),
               settings, picture, pool);
  return picture;
}

/// The largest error of depth of pixels that are shown, and how many pixels the sphere misses.
struct DepthErrors {
  double largest = 0.0;
  int seen = 0, missed = 0;
};

DepthErrors depth_errors(const ReliefTexture& relief, const Image& picture, glm::dvec3 eye,
                         const CameraMatrices& camera) {
  const double radius = (0.5 * relief.width - 1.0) * 0.01;
  const glm::dvec3 out = eye - glm::dvec3{0.0, 0.0, -radius};
  DepthErrors errors;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double right = ((x + 0.5) * 2.0 / kSize - 1.0) / camera.eye_to_clip[0][0];
      const double above = ((y + 0.5) * 2.0 / kSize - 1.0) / camera.eye_to_clip[1][1];
      glm::dvec3 ray{};
      for (int i = 0; i < 3; ++i) {
        ray[i] = camera.world_to_eye[i][0] * right + camera.world_to_eye[i][1] * above -
                 camera.world_to_eye[i][2];
      }
      const double a = dot(ray, ray), b = dot(ray, out), c = dot(out, out) - radius * radius;
      if (b * b - a * c <= 0.0) continue;
      const double depth = (-b - std::sqrt(b * b - a * c)) / a;
      if (eye.z + ray.z * depth < -0.6 * radius) continue;  // the rim is steep
      ++errors.seen;
      const auto own = static_cast<double>(load_texel(picture, x, y).w);
      if (own > 50.0) {
        ++errors.missed;
      } else {
        errors.largest = std::fmax(errors.largest, std::fabs(own - depth));
      }
    }
  }
  return errors;
}

}  // namespace

TEST_CASE("a marched ray meets the sphere where it is, the nearer the more slices there are") {
  const ReliefTexture relief = sphere_relief(96, 16);
  const glm::dvec3 eye{0.4, 0.3, 1.5};
  const CameraMatrices camera = seen_from(eye);
  const auto errors_by = [&](const MarchSettings& settings) {
    return depth_errors(relief, marched(relief, camera, settings), eye, camera);
  };
  const DepthErrors coarse = errors_by({8, 0}), fine = errors_by({64, 0});
  const DepthErrors bisected = errors_by({16, 6});
  CHECK(fine.seen > 600);
  CHECK(fine.missed < fine.seen / 20);
  // Half a texel each way, where the surface rises by 2.3 a texel and the ray grazes it.
  CHECK(fine.largest < 0.04);
  CHECK(bisected.largest < 0.05);
  CHECK(coarse.largest > 1.5 * bisected.largest);
}

TEST_CASE("a wall under a perspective camera is marched and mapped at its own distance") {
  ReliefTexture wall = seen_from_eye(empty_relief(40, 40, 16, 0.3), {0.1, -0.2, 0.8});
  for (std::uint16_t& code : wall.depths) code = 50000;
  for (std::uint32_t& colour : wall.colours) colour = 0xFF404040u;
  const double d = 50000 * depth_step(wall);
  const double z = d / (1.0 - d / 0.8);
  const glm::dvec3 eye{0.05, 0.1, 1.2};
  Camera ahead;
  ahead.position = eye;
  ahead.target = eye + glm::dvec3{0.0, 0.0, -1.0};
  const CameraMatrices camera = camera_matrices(ahead, 0.0, kSize, kSize);
  ThreadPool pool(1);
  Image mapped = make_image(Format::rgba16f, kSize, kSize);
  clear_image(mapped, {0.0f, 0.0f, 0.0f, 100.0f}, Profile{});
  const WarpedRelief plane = warped(wall, eye, {}, pool);
  map_relief(plane, plane_mapping(wall, camera, plane.place, kSize, kSize), mapped, pool);
  for (const Image& picture : {marched(wall, camera, {64, 8}), mapped}) {
    const auto depth = static_cast<double>(load_texel(picture, kSize / 2, kSize / 2).w);
    CHECK(depth == doctest::Approx(1.2 + z).epsilon(1e-3));
  }
}

TEST_CASE("who does not see the relief's front sees nothing of it") {
  const ReliefTexture relief = sphere_relief(40, 8);
  const Image picture = marched(relief, seen_from({0.1, 0.0, -2.0}), {32, 0});
  CHECK(load_texel(picture, kSize / 2, kSize / 2).w == 100.0f);
}
