#include "scenes/draw/velocity.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <optional>

#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"
#include "scenes/load/load_scene.h"
#include "scenes/make/shapes.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

constexpr int kWidth = 71, kHeight = 53;

/// Objects that spin, sway or stand, before a camera that goes around them.
Scene moving_scene() {
  Scene scene;
  scene.camera = {.position = {0.4, 1.0, 4.0},
                  .target = {0.2, 0.1, 0.0},
                  .near_m = 0.5,
                  .far_m = 30.0,
                  .orbit_degrees_per_frame = 1.5};
  scene.meshes.push_back(make_cube(1.0, 1));
  scene.materials.emplace_back();
  scene.objects.push_back({.position = {-0.9, 0, 0.3},
                           .rotation_degrees = {20, 30, 0},
                           .spin_degrees_per_frame = {3, -5, 8}});
  scene.objects.push_back({.position = {0.8, 0.2, -0.5},
                           .rotation_degrees = {10, 50, 5},
                           .scale = {0.7, 1.1, 0.5},
                           .sway = {0.5, 0.3, 0.8},
                           .sway_period_frames = 20.0});
  scene.objects.push_back({.position = {0.1, -1.6, -1.0}, .scale = {4, 1, 3}});
  return scene;
}

glm::dvec3 clip_xyw(const glm::dmat4& m, glm::dvec3 p) {
  const glm::dvec4 clip = m * glm::dvec4{p, 1.0};
  return {clip.x, clip.y, clip.w};
}

glm::dmat4 to_clip(const Scene& scene, std::size_t object, const Instant& at) {
  return at.camera.eye_to_clip * at.camera.world_to_eye *
         object_matrix(scene.objects[object], at.frame);
}

/// The surface that a pixel's centre shows.
struct Hit {
  std::size_t object;
  glm::dvec3 place;  ///< on the object
  double depth_m;
  double edge;  ///< how near to an edge of the triangle, 0 on it
};

std::optional<Hit> hit_at(const Scene& scene, const Instant& shown, double ndc_x, double ndc_y) {
  std::optional<Hit> nearest;
  for (std::size_t object = 0; object < scene.objects.size(); ++object) {
    const glm::dmat4 clip = to_clip(scene, object, shown);
    const Mesh& mesh = scene.meshes[scene.objects[object].mesh];
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      std::array<glm::dvec3, 3> corner, seen;
      for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = glm::dvec3{mesh.positions[mesh.indices[i + k]]};
        seen[k] = clip_xyw(clip, corner[k]);
      }
      // a seen0 + b seen1 + c seen2 = (x, y, 1), by Cramer's rule.
      const glm::dvec3 ray{ndc_x, ndc_y, 1.0};
      const double all = dot(seen[0], cross(seen[1], seen[2]));
      if (all >= 0.0) continue;  // y is down: what faces away is positive
      const glm::dvec3 share{dot(ray, cross(seen[1], seen[2])) / all,
                             dot(seen[0], cross(ray, seen[2])) / all,
                             dot(seen[0], cross(seen[1], ray)) / all};
      const double least = std::min({share.x, share.y, share.z});
      if (least < 0.0) continue;
      const double sum = share.x + share.y + share.z;
      const Hit hit{object, (corner[0] * share.x + corner[1] * share.y + corner[2] * share.z) / sum,
                    1.0 / sum, least / sum};
      if (!nearest || hit.depth_m < nearest->depth_m) nearest = hit;
    }
  }
  return nearest;
}

glm::dvec2 in_picture(glm::dvec3 clip) {
  return {clip.x / clip.z * 0.5 * kWidth, clip.y / clip.z * 0.5 * kHeight};
}

glm::dvec2 expected_motion(const Scene& scene, const Hit& hit, const MotionSpan& span) {
  return in_picture(clip_xyw(to_clip(scene, hit.object, span.to), hit.place)) -
         in_picture(clip_xyw(to_clip(scene, hit.object, span.from), hit.place));
}

/// Motion of the point at infinity that a pixel shows.
glm::dvec2 expected_far_motion(const CameraMatrices& shown, const MotionSpan& span, double ndc_x,
                               double ndc_y) {
  const glm::dvec3 eye{ndc_x / shown.eye_to_clip[0][0], ndc_y / shown.eye_to_clip[1][1], -1.0};
  const glm::dvec3 world = glm::transpose(glm::dmat3{shown.world_to_eye}) * eye;
  const auto place = [&](const CameraMatrices& by) {
    const glm::dvec4 clip = by.eye_to_clip * glm::dvec4{glm::dmat3{by.world_to_eye} * world, 0.0};
    return in_picture({clip.x, clip.y, clip.w});
  };
  return place(span.to.camera) - place(span.from.camera);
}

glm::dvec2 motion_at(const Image& velocity, int x, int y) {
  const glm::vec4 texel = load_texel<Format::rg16f>(velocity, x, y);
  return {texel.x, texel.y};
}

Image velocity_of(const Scene& scene, const Instant& shown, const MotionSpan& span,
                  ThreadPool& pool, const Profile& profile = {}) {
  return draw_velocity(scene, shown, span, kWidth, kHeight, profile, pool);
}

/// Half a step of the half, and binary32 on the way.
double tolerance(glm::dvec2 motion) { return 2e-3 + length(motion) * 0x1p-11; }

int wrong_motions(const Scene& scene, const Instant& shown, const MotionSpan& span,
                  const Image& velocity) {
  int wrong = 0, background = 0;
  std::array<int, 3> seen{};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double ndc_x = (x + 0.5) * 2.0 / kWidth - 1.0, ndc_y = (y + 0.5) * 2.0 / kHeight - 1.0;
      const std::optional<Hit> hit = hit_at(scene, shown, ndc_x, ndc_y);
      if (hit && hit->edge < 0.01) continue;  // perhaps the neighbour's
      const glm::dvec2 expected = hit ? expected_motion(scene, *hit, span)
                                      : expected_far_motion(shown.camera, span, ndc_x, ndc_y);
      const glm::dvec2 found = motion_at(velocity, x, y);
      // An outline may pass beside the pixel's centre.
      bool beside = false;
      for (const double step : {-0.02, 0.02}) {
        beside = beside ||
                 hit_at(scene, shown, ndc_x + step, ndc_y).has_value() != hit.has_value() ||
                 hit_at(scene, shown, ndc_x, ndc_y + step).has_value() != hit.has_value();
      }
      if (!hit && beside) continue;
      wrong += length(found - expected) > tolerance(expected) ? 1 : 0;
      if (hit) ++seen[hit->object];
      if (!hit) ++background;
    }
  }
  for (const int pixels : seen) CHECK(pixels > 50);
  CHECK(background > 50);
  return wrong;
}

}  // namespace

TEST_CASE("velocity is a surface's place less its place at the instant before, and the sky turns") {
  ThreadPool pool{2};
  const Scene scene = moving_scene();
  for (const double step : {1.0, 0.25}) {
    const Instant now = instant_at(scene, 3.0, kWidth, kHeight);
    const MotionSpan span{instant_at(scene, 3.0 - step, kWidth, kHeight), now};
    CHECK(wrong_motions(scene, now, span, velocity_of(scene, now, span, pool)) == 0);
  }
}

TEST_CASE("velocity around an instant is the way from before it to after it") {
  ThreadPool pool{1};
  const Scene scene = moving_scene();
  const Instant shown = instant_at(scene, 3.0, kWidth, kHeight);
  const MotionSpan span{instant_at(scene, 2.5, kWidth, kHeight),
                        instant_at(scene, 3.5, kWidth, kHeight)};
  CHECK(wrong_motions(scene, shown, span, velocity_of(scene, shown, span, pool)) == 0);
}

TEST_CASE("velocity of a scene in which nothing moves is exactly 0") {
  ThreadPool pool{2};
  Scene scene = moving_scene();
  scene.camera.orbit_degrees_per_frame = 0.0;
  for (Object& object : scene.objects) object.spin_degrees_per_frame = object.sway = {};
  const Instant now = instant_at(scene, 5.0, kWidth, kHeight);
  const MotionSpan span{instant_at(scene, 4.0, kWidth, kHeight), now};
  const Image nothing = make_image(Format::rg16f, kWidth, kHeight);
  CHECK(equal(velocity_of(scene, now, span, pool), nothing));
  Image from_depth = make_image(Format::rg16f, kWidth, kHeight);
  const Image picture = draw_scene(scene, now.camera, 5.0, kWidth, kHeight, {}, pool);
  camera_velocity(camera_motion(scene, now.camera, span, kWidth, kHeight), picture, from_depth, {},
                  pool);
  CHECK(equal(from_depth, nothing));
}

TEST_CASE("velocity from depth agrees with the drawn one where the camera alone moves") {
  ThreadPool pool{2};
  Scene scene = moving_scene();
  for (Object& object : scene.objects) object.spin_degrees_per_frame = object.sway = {};
  const Instant now = instant_at(scene, 2.0, kWidth, kHeight);
  const MotionSpan span{instant_at(scene, 1.0, kWidth, kHeight),
                        instant_at(scene, 2.25, kWidth, kHeight)};
  const Image drawn = velocity_of(scene, now, span, pool);
  const Image picture = draw_scene(scene, now.camera, 2.0, kWidth, kHeight, {}, pool);
  Image from_depth = make_image(Format::rg16f, kWidth, kHeight);
  camera_velocity(camera_motion(scene, now.camera, span, kWidth, kHeight), picture, from_depth, {},
                  pool);
  // Depth in alpha is a half: the part of the motion that depends on it is as coarse.
  double longest = 0.0;
  int wrong = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const glm::dvec2 motion = motion_at(drawn, x, y);
      const glm::dvec2 off = motion_at(from_depth, x, y) - motion;
      longest = std::max(longest, length(motion));
      wrong += length(off) > 0.01 + 0.002 * length(motion) ? 1 : 0;
    }
  }
  CHECK(longest > 2.0);
  CHECK(wrong == 0);
}

TEST_CASE("velocity has the same bits in every kernel, for any number of threads") {
  ThreadPool one{1, Isa::scalar};
  for (const char* name : {"cube-room", "foliage"}) {
    const Scene scene = load_scene(name, scene_search_path({}));
    const Instant now = instant_at(scene, 7.0, kWidth, kHeight);
    const MotionSpan span{instant_at(scene, 6.0, kWidth, kHeight), now};
    for (const NamedProfile& known : profiles()) {
      const Image scalar = velocity_of(scene, now, span, one, known.profile);
      const Image picture = draw_scene(scene, now.camera, 7.0, kWidth, kHeight, {}, one);
      const CameraMotion motion = camera_motion(scene, now.camera, span, kWidth, kHeight);
      Image from_depth = make_image(Format::rg16f, kWidth, kHeight), other = from_depth;
      camera_velocity(motion, picture, from_depth, known.profile, one);
      for (const Isa isa : available_isas()) {
        ThreadPool pool{3, isa};
        CHECK(equal(velocity_of(scene, now, span, pool, known.profile), scalar));
        camera_velocity(motion, picture, other, known.profile, pool);
        CHECK(equal(other, from_depth));
      }
    }
  }
}

TEST_CASE("a surface that was behind the camera moves the right way, and not without end") {
  const glm::vec2 half_size{100.0f, 100.0f};
  const glm::vec2 motion = motion_px({0.5f, 0.0f, 1.0f}, {-0.1f, 0.0f, -1.0f}, half_size, 0.1f);
  CHECK(motion.x == doctest::Approx(150.0));
  CHECK(motion.y == 0.0f);
  CHECK(motion_px({1e9f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, half_size, 0.1f).x == kMostMotionPx);
  CHECK(motion_px({-1e9f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, half_size, 0.1f).x == -kMostMotionPx);
}
