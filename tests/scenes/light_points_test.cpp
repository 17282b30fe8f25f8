// Lights with a size: their points, and the frames that are means of points.

#include "scenes/draw/light_points.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/shadows/shadow_truth.h"
#include "tests/support/shadow_scene.h"

using namespace softfocus;

namespace {

constexpr int kPoints = 1024;

Light ball(glm::vec3 middle, double radius_m) {
  Light light;
  light.kind = LightKind::point;
  light.position_or_direction = middle;
  light.shadows = ShadowKind::projected;
  light.radius_m = radius_m;
  return light;
}

std::vector<glm::dvec3> points_of(const Light& light) {
  std::vector<glm::dvec3> points;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    points.emplace_back(lights_at_point({&light, 1}, i)[0].position_or_direction);
  }
  return points;
}

Scene soft_scene(int points) {
  Scene scene = test::shadow_scene(ShadowKind::projected);
  for (Light& light : scene.lights) {
    light.radius_m = 0.2;
    light.angular_radius_degrees = 3.0;
  }
  scene.light_points = points;
  return scene;
}

Image drawn(const Scene& scene, ThreadPool& pool) {
  return draw_scene(scene, camera_matrices(scene.camera, 5.0, 120, 80), 5.0, 120, 80, {}, pool);
}

int pixels_apart(const Image& a, const Image& b) {
  int apart = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      apart += load_texel<Format::rgba16f>(a, x, y) != load_texel<Format::rgba16f>(b, x, y) ? 1 : 0;
    }
  }
  return apart;
}

// The scene as one point of its lights lights it.
Scene at_point(Scene scene, int point) {
  scene.lights = lights_at_point(scene.lights, static_cast<std::uint32_t>(point));
  for (Light& light : scene.lights) light.radius_m = light.angular_radius_degrees = 0.0;
  return scene;
}

}  // namespace

TEST_CASE("a ball of points looks like a uniform disc from every side") {
  const glm::dvec3 middle{1.0, 2.0, -3.0};
  const std::vector<glm::dvec3> points = points_of(ball(glm::vec3{middle}, 0.5));
  for (const glm::dvec3 from : {glm::dvec3{0, 0, 1}, glm::dvec3{0, 1, 0}, glm::dvec3{1, 0, 0},
                                glm::dvec3{1, 1, 1}, glm::dvec3{-2, 1, 0.3}}) {
    const glm::dvec3 along = normalize(from);
    for (const double part : {0.3, 0.6, 0.9, 1.0001}) {
      int inside = 0;
      for (const glm::dvec3& point : points) {
        const glm::dvec3 p = (point - middle) / 0.5;
        const glm::dvec3 across = p - along * dot(p, along);
        inside += dot(across, across) <= part * part ? 1 : 0;
      }
      CAPTURE(part);
      CHECK(std::fabs(static_cast<double>(inside) / kPoints - std::fmin(part * part, 1.0)) < 0.03);
    }
  }
}

TEST_CASE("a directional light's points are spread evenly over its disc of the sky") {
  Light sun;
  sun.position_or_direction = {1.0f, 3.0f, -2.0f};
  sun.shadows = ShadowKind::projected;
  sun.angular_radius_degrees = 20.0;
  const glm::dvec3 middle = normalize(glm::dvec3{sun.position_or_direction});
  const double height = 1.0 - exact_math::cos_degrees(20.0);
  glm::dvec3 sum{0.0};
  std::vector<glm::dvec3> points = points_of(sun);
  points[0] = normalize(points[0]);
  for (const double part : {0.25, 0.5, 0.75, 1.0001}) {
    int inside = 0;
    for (const glm::dvec3& point : points) {
      CHECK(std::fabs(dot(point, point) - 1.0) < 1e-6);
      inside += 1.0 - dot(point, middle) <= part * height ? 1 : 0;
      sum += point;
    }
    CHECK(std::fabs(static_cast<double>(inside) / kPoints - std::fmin(part, 1.0)) < 0.01);
  }
  CHECK(dot(normalize(sum), middle) > 0.9999);
}

TEST_CASE("lights without a size or without shadows stay where they are") {
  std::vector<Light> lights{ball({1, 2, 3}, 0.0), ball({1, 2, 3}, 1.0)};
  lights[1].shadows = ShadowKind::none;
  for (const Light& light : lights_at_point(lights, 7)) {
    CHECK(light.position_or_direction == glm::vec3{1, 2, 3});
  }
  lights[1].shadows = ShadowKind::map;
  CHECK(lights_at_point(lights, 7)[1].position_or_direction != glm::vec3{1, 2, 3});
}

TEST_CASE("one point of a light with a size is the light without, to the bit") {
  ThreadPool pool{2};
  CHECK(equal(drawn(soft_scene(1), pool), drawn(at_point(soft_scene(1), 0), pool)));
}

TEST_CASE("a frame with soft shadows is the exact mean of its points' frames") {
  constexpr int kFew = 5;
  ThreadPool pool{2};
  const Scene scene = soft_scene(kFew);
  const Image picture = drawn(scene, pool);
  std::vector<Image> frames;
  frames.reserve(kFew);
  for (int i = 0; i < kFew; ++i) frames.push_back(drawn(at_point(scene, i), pool));
  CHECK_FALSE(equal(frames[0], frames[1]));
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      const glm::vec4 here = load_texel<Format::rgba16f>(picture, x, y);
      for (int c = 0; c < 3; ++c) {
        double sum = 0.0;
        for (int i = kFew; i-- > 0;) {
          sum += static_cast<double>(
              load_texel<Format::rgba16f>(frames[static_cast<std::size_t>(i)], x, y)[c]);
        }
        const auto mean = static_cast<float>(sum / kFew);
        REQUIRE(here[c] == half_to_float(float_to_half(mean, HalfRounding::nearest_even)));
      }
      REQUIRE(here.w == load_texel<Format::rgba16f>(frames[0], x, y).w);
    }
  }
}

TEST_CASE("of every point of a light the shadows are those of rays") {
  ThreadPool pool{2};
  const Scene soft = soft_scene(4);
  const CameraMatrices camera = camera_matrices(soft.camera, 5.0, 64, 40);
  Image picture = make_image(Format::rgba16f, 64, 40);
  std::vector<int> counts(64 * 40);
  std::size_t near_edge = 0;
  for (int point = 0; point < 4; ++point) {
    const Scene scene = at_point(soft, point);
    PreparedScene prepared = prepare_scene(scene, {}, pool);
    draw_scene(prepared, camera, 5.0, picture, pool);
    const SceneShadows& shadows = *prepared.shadows;
    std::vector<ShadowLight> lights;
    for (const Light& light : scene.lights) lights.push_back(shadow_light(light));
    const ShadowErrors errors = shadow_errors(
        shadows.facets, lights, shadows.seen[0], shadows.masks[0],
        {multiply(camera.eye_to_clip, camera.world_to_eye), 64, 40, {}}, camera.eye, true, pool);
    CHECK(errors.wrong == 0);
    near_edge += errors.near_edge;
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += shadows.masks[0][i] & 1;
  }
  CHECK(near_edge < 10);
  int penumbra = 0;
  for (const int count : counts) penumbra += count > 0 && count < 4 ? 1 : 0;
  CHECK(penumbra > 50);
}

TEST_CASE("soft shadows have the same bits on every vector unit and number of threads") {
  const Scene scene = soft_scene(3);
  ThreadPool scalar{1, Isa::scalar};
  const Image expected = drawn(scene, scalar);
  for (const Isa isa : {available_isas()[1], widest_isa()}) {
    ThreadPool pool{3, isa};
    CHECK(equal(drawn(scene, pool), expected));
  }
}

TEST_CASE("accumulation of one pinhole view shows the soft shadows of the picture") {
  ThreadPool pool{2};
  const Scene scene = soft_scene(3);
  const CameraMatrices camera = camera_matrices(scene.camera, 5.0, 120, 80);
  const Image pinhole = drawn(scene, pool);
  const LensViewInput input{scene, camera, 5.0, pinhole, 1.0, 0.0, {.samples = 1}, {}, {}};
  CHECK(equal(accumulation(input, pool).picture, pinhole));
}

TEST_CASE("soft shadows lie on the surfaces behind the first, and volumes and maps have them") {
  ThreadPool pool{2};
  Scene scene = soft_scene(3);
  const CameraMatrices camera = camera_matrices(scene.camera, 5.0, 120, 80);
  const std::vector<Image> layers = draw_layers(scene, camera, 5.0, 120, 80, 2, {}, pool);
  CHECK(equal(layers[0], drawn(scene, pool)));
  Scene hard = at_point(scene, 0);
  CHECK_FALSE(equal(layers[1], draw_layers(hard, camera, 5.0, 120, 80, 2, {}, pool)[1]));
  set_shadows(scene, ShadowKind::volumes);
  CHECK(pixels_apart(drawn(scene, pool), layers[0]) < 20);  // within 1/256 pixel of edges
  set_shadows(scene, ShadowKind::map);
  set_shadows(hard, ShadowKind::map);
  CHECK_FALSE(equal(drawn(scene, pool), drawn(hard, pool)));
}
