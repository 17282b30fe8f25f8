// Pictures with shadows: every pixel against the oracle, and against the scene without the light.

#include "scenes/draw/shadowed_layers.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/draw/seen_facets.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/load/load_scene.h"
#include "scenes/shadows/maps/map_errors.h"
#include "scenes/shadows/shadow_truth.h"
#include "tests/support/shadow_scene.h"

using namespace softfocus;

namespace {

Scene shadowed(const std::string& name) {
  Scene scene = load_scene(name, scene_search_path({}));
  set_shadows(scene, ShadowKind::projected);
  return scene;
}

struct Drawn {
  Image picture;
  PreparedScene prepared;
};

constexpr double kFrame = 5.0;

Drawn drawn(const Scene& scene, int width, int height, ThreadPool& pool,
            const Profile& profile = {}) {
  Drawn made{make_image(Format::rgba16f, width, height), prepare_scene(scene, profile, pool)};
  draw_scene(made.prepared, camera_matrices(scene.camera, kFrame, width, height), kFrame,
             made.picture, pool);
  return made;
}

ShadowErrors errors_of(const Scene& scene, int width, int height, bool by_grid) {
  ThreadPool pool{2};
  const Drawn made = drawn(scene, width, height, pool);
  const SceneShadows& shadows = *made.prepared.shadows;
  const CameraMatrices camera = camera_matrices(scene.camera, kFrame, width, height);
  std::vector<ShadowLight> lights;
  for (const Light& light : scene.lights) lights.push_back(shadow_light(light));
  return shadow_errors(shadows.facets, lights, shadows.seen[0], shadows.masks[0],
                       {multiply(camera.eye_to_clip, camera.world_to_eye), width, height, {}},
                       camera.eye, by_grid, pool);
}

void check_errors(const ShadowErrors& errors) {
  CHECK(errors.seen > 1000);
  CHECK(errors.in_shadow > errors.seen / 100);
  CHECK(errors.in_shadow < errors.seen);
  CHECK(errors.wrong == 0);
  CHECK(errors.near_edge * 1000 < errors.seen);
}

std::uint64_t texel_bits(const Image& picture, int x, int y) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, row<std::uint16_t>(picture, y).data() + 4 * x, sizeof bits);
  return bits;
}

// Each pixel of the layers must have the bits that it has without the lights that its mask names.
// Returns how many lie in shadow.
std::size_t check_masked_pixels(const Scene& scene, std::size_t layers, int width = 96,
                                int height = 72) {
  ThreadPool pool{2};
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, width, height);
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  std::vector<Image> pictures(layers, make_image(Format::rgba16f, width, height));
  draw_layers(prepared, camera, 0.0, pictures[0], std::span{pictures}.subspan(1), pool);
  std::size_t in_shadow = 0;
  for (std::uint8_t of = 0; of < 4; ++of) {
    Scene without = scene;
    without.lights.clear();
    for (std::size_t i = 0; i < 2; ++i) {
      if ((of >> i & 1) == 0) without.lights.push_back(scene.lights[i]);
    }
    set_shadows(without, ShadowKind::none);
    const std::vector<Image> expected =
        draw_layers(without, camera, 0.0, width, height, layers, {}, pool);
    for (std::size_t layer = 0; layer < layers; ++layer) {
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const auto at = static_cast<std::size_t>(y * width + x);
          if (prepared.shadows->masks[layer][at] != of) continue;
          in_shadow += of != 0 ? 1 : 0;
          REQUIRE(texel_bits(pictures[layer], x, y) == texel_bits(expected[layer], x, y));
        }
      }
    }
  }
  return in_shadow;
}

}  // namespace

TEST_CASE("cube-room's shadows are those of every ray against every triangle" *
          doctest::test_suite("long")) {
  check_errors(errors_of(shadowed("cube-room"), 64, 40, false));
}

TEST_CASE("figures' shadows are those of rays" * doctest::test_suite("long")) {
  check_errors(errors_of(shadowed("figures"), 160, 120, true));
}

TEST_CASE("sphere-world's shadows are those of rays" * doctest::test_suite("long")) {
  check_errors(errors_of(shadowed("sphere-world"), 200, 150, true));
}

TEST_CASE("shadows have the same bits on every vector unit and number of threads") {
  for (const char* name : {"cube-room", "foliage"}) {
    const Scene scene = shadowed(name);
    ThreadPool scalar{1, Isa::scalar};
    const Image expected = drawn(scene, 150, 97, scalar).picture;
    for (const Isa isa : std::set{available_isas()[1], widest_isa()}) {
      ThreadPool pool{3, isa};
      CHECK(equal(drawn(scene, 150, 97, pool).picture, expected));
    }
  }
}

TEST_CASE("shadows lie on the surfaces behind the first, too") {
  const Scene scene = shadowed("cube-room");
  ThreadPool pool{2};
  const CameraMatrices camera = camera_matrices(scene.camera, kFrame, 150, 97);
  const std::vector<Image> layers = draw_layers(scene, camera, kFrame, 150, 97, 2, {}, pool);
  CHECK(equal(layers[0], drawn(scene, 150, 97, pool).picture));
  // Without the cubes the wall behind them is the first surface. They still cast.
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  Image first = make_image(Format::rgba16f, 150, 97);
  std::vector<Image> behind(1, first);
  draw_layers(prepared, camera, kFrame, first, behind, pool);
  std::size_t in_shadow = 0;
  for (const std::uint8_t mask : prepared.shadows->masks[1]) in_shadow += mask != 0 ? 1 : 0;
  CHECK(in_shadow > 100);
  Scene unshadowed = scene;
  set_shadows(unshadowed, ShadowKind::none);
  CHECK_FALSE(equal(layers[1], draw_layers(unshadowed, camera, kFrame, 150, 97, 2, {}, pool)[1]));
}

TEST_CASE("a pixel of any layer in shadow has the bits that it has without the light") {
  CHECK(check_masked_pixels(shadowed("cube-room"), 1, 150, 97) > 500);
  Scene scene = test::shadow_scene(ShadowKind::projected);
  CHECK(check_masked_pixels(scene, 3) > 1000);
  // Shadows that nothing in the first layer shows: the ball and the ground behind a pane before
  // the eye, that is lit by all lights.
  Object pane = scene.objects[1];
  pane.scale = {9.0, 0.001, 9.0};
  pane.position = {0.5, 1.5, 3.0};
  pane.rotation_degrees = {45, 0, 0};
  scene.objects.push_back(pane);
  scene.lights[0].position_or_direction = {0.6f, 1.0f, 1.5f};
  scene.lights[1].position_or_direction = {-1.0f, 1.2f, 0.4f};
  CHECK(check_masked_pixels(scene, 3) > 1000);
}

TEST_CASE("a scene without shadows is prepared without any") {
  const Scene scene = load_scene("figures", scene_search_path({}));
  ThreadPool pool{1};
  CHECK(prepare_scene(scene, {}, pool).shadows == nullptr);
}

TEST_CASE("accumulation of one pinhole view shows the shadows of the picture") {
  const Scene scene = shadowed("cube-room");
  ThreadPool pool{2};
  const CameraMatrices camera = camera_matrices(scene.camera, kFrame, 150, 97);
  const Image pinhole = drawn(scene, 150, 97, pool).picture;
  const LensViewInput input{scene, camera, kFrame, pinhole, 1.0, 0.0, {.samples = 1}, {}, {}};
  CHECK(equal(accumulation(input, pool).picture, pinhole));
}

// Shadow maps.

namespace {

Scene mapped(const std::string& name, const ShadowMapSettings& settings) {
  Scene scene = load_scene(name, scene_search_path({}));
  set_shadows(scene, ShadowKind::map);
  for (Light& light : scene.lights) light.map = settings;
  return scene;
}

MapErrors map_errors_of(const ShadowMapSettings& settings) {
  ThreadPool pool{2};
  const Scene scene = mapped("cube-room", settings);
  const Drawn made = drawn(scene, 160, 120, pool);
  const SceneShadows& shadows = *made.prepared.shadows;
  const CameraMatrices camera = camera_matrices(scene.camera, kFrame, 160, 120);
  const ShadowView view{multiply(camera.eye_to_clip, camera.world_to_eye), 160, 120, {}};
  MapErrors sum;
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const ShadowLight light = shadow_light(scene.lights[i]);
    const ShadowTruth truth{shadows.facets, light, view, camera.eye, true};
    const std::vector<std::uint8_t> dark = dark_pixels(truth, shadows.seen[0], 160, 120, pool);
    sum += map_errors(shadows.facets, shadows.maps[i], truth, dark, shadows.seen[0],
                      shadows.masks[0], static_cast<int>(i), shadows.shares[0][i], 160, 120, pool);
  }
  return sum;
}

}  // namespace

TEST_CASE("cube-room's map is wrong near edges alone, and less so if it is larger" *
          doctest::test_suite("long")) {
  const MapErrors small = map_errors_of({.size = 128, .bias = 0.25, .slope_bias = 1.0});
  const MapErrors large = map_errors_of({.size = 1024, .bias = 0.25, .slope_bias = 1.0});
  CHECK(small.in_shadow > 1000);
  CHECK(small.acne == 0);
  CHECK(large.acne == 0);
  CHECK(small.wrong() > 3 * large.wrong());
  CHECK(large.wrong() * 200 < large.seen);
}

TEST_CASE("a map's errors are told apart: no bias is acne, much of it is peter-panning") {
  const MapErrors without = map_errors_of({.size = 512, .bias = 0.0, .slope_bias = 0.0});
  CHECK(without.acne > without.seen / 10);
  CHECK(without.peter_panning == 0);
  const MapErrors much = map_errors_of({.size = 512, .bias = 60.0, .slope_bias = 1.0});
  CHECK(much.acne == 0);
  CHECK(much.peter_panning > much.in_shadow / 50);
}

TEST_CASE("a map of one texel's kernel darkens pixels to the bits of the scene without the light") {
  const Scene scene = mapped("cube-room", {.size = 256});
  ThreadPool pool{2};
  const Drawn made = drawn(scene, 150, 97, pool);
  Scene without = scene;
  set_shadows(without, ShadowKind::none);
  const Image all = drawn(without, 150, 97, pool).picture;
  without.lights.erase(without.lights.begin());
  const Image second = drawn(without, 150, 97, pool).picture;
  std::size_t dark = 0;
  for (int y = 0; y < 97; ++y) {
    for (int x = 0; x < 150; ++x) {
      const std::uint8_t mask =
          made.prepared.shadows->masks[0][static_cast<std::size_t>(150 * y + x)];
      if (mask > 1) continue;
      dark += mask;
      REQUIRE(texel_bits(made.picture, x, y) == texel_bits(mask == 0 ? all : second, x, y));
    }
  }
  CHECK(dark > 300);
}

TEST_CASE("where a kernel is partly in shadow the light's share is taken in part") {
  Scene scene = mapped("cube-room", {.size = 256, .kernel = 5});
  scene.lights.resize(1);
  ThreadPool pool{2};
  const Drawn made = drawn(scene, 150, 97, pool);
  Scene without = scene;
  set_shadows(without, ShadowKind::none);
  const Image lit = drawn(without, 150, 97, pool).picture;
  without.lights.clear();
  const Image unlit = drawn(without, 150, 97, pool).picture;
  std::size_t partly = 0;
  for (int y = 0; y < 97; ++y) {
    for (int x = 0; x < 150; ++x) {
      const std::uint8_t share =
          made.prepared.shadows->shares[0][0][static_cast<std::size_t>(150 * y + x)];
      if (share == 0) continue;
      ++partly;
      const glm::vec4 with = load_texel<Format::rgba16f>(lit, x, y);
      const glm::vec4 dark = load_texel<Format::rgba16f>(unlit, x, y);
      const glm::vec4 here = load_texel<Format::rgba16f>(made.picture, x, y);
      for (int i = 0; i < 3; ++i) {
        const float part = static_cast<float>(share) / 25.0f;
        const float wanted = with[i] + part * (dark[i] - with[i]);
        REQUIRE(here[i] == half_to_float(float_to_half(wanted, HalfRounding::nearest_even)));
      }
      REQUIRE(here.w == with.w);
    }
  }
  CHECK(partly > 200);
}

TEST_CASE("shadow maps have the same bits on every vector unit and number of threads") {
  for (const int kernel : {1, 3}) {
    const Scene scene = mapped("cube-room", {.size = 200, .kernel = kernel, .cascades = 2});
    ThreadPool scalar{1, Isa::scalar};
    const Image expected = drawn(scene, 150, 97, scalar).picture;
    for (const Isa isa : std::set{available_isas()[1], widest_isa()}) {
      ThreadPool pool{3, isa};
      CHECK(equal(drawn(scene, 150, 97, pool).picture, expected));
    }
  }
}

TEST_CASE("a map that is fitted to the scene is drawn once, one fitted to the camera for each") {
  for (const bool fits_camera : {false, true}) {
    const Scene scene = mapped("figures", {.size = 64, .fits_camera = fits_camera});
    ThreadPool pool{1};
    Drawn made = drawn(scene, 64, 48, pool);
    std::vector<ShadowMap>& maps = made.prepared.shadows->maps;
    const float mark = 12345.0f;
    maps[0].sides[0].nearness[0] = mark;
    CameraMatrices camera = camera_matrices(scene.camera, kFrame, 64, 48);
    draw_scene(made.prepared, camera, kFrame, made.picture, pool);
    CHECK(maps[0].sides[0].nearness[0] == mark);
    camera.eye.x += 0.01;
    draw_scene(made.prepared, camera, kFrame, made.picture, pool);
    CHECK((maps[0].sides[0].nearness[0] == mark) == !fits_camera);
  }
}

TEST_CASE("what is kept of shadows changes no bit, whatever moves from frame to frame") {
  constexpr int kWidth = 96, kHeight = 72;
  ThreadPool pool{2};
  for (const ShadowKind kind : {ShadowKind::projected, ShadowKind::volumes, ShadowKind::map}) {
    CAPTURE(static_cast<int>(kind));
    for (const double spin : {0.0, 20.0}) {
      Scene scene = test::shadow_scene(kind);
      scene.objects[1].spin_degrees_per_frame = {0.0, spin, 0.0};
      PreparedScene kept = prepare_scene(scene, Profile{}, pool);
      double frame = 0.0;
      int step = 0;
      const auto check = [&] {
        CAPTURE(step++);
        const CameraMatrices camera = camera_matrices(scene.camera, frame, kWidth, kHeight);
        Image own = make_image(Format::rgba16f, kWidth, kHeight);
        draw_scene(kept, camera, frame, own, pool);
        const Image right = draw_scene(scene, camera, frame, kWidth, kHeight, Profile{}, pool);
        CHECK(hash_image(own) == hash_image(right));
      };
      check();
      scene.lights[0].position_or_direction.x -= 0.4f;
      check();
      check();
      scene.lights[1].position_or_direction.z += 0.5f;
      check();
      scene.camera.position.x += 0.7;
      check();
      frame = 1.0;
      check();
      scene.lights[0].position_or_direction.x += 0.4f;
      scene.camera.position.x -= 0.7;
      check();
      frame = 0.0;
      check();
      // A part of the ground alone, then all of it.
      for (const double degrees : {6.0, 60.0}) {
        scene.camera.fov_y_degrees = degrees;
        scene.lights[0].position_or_direction.x -= 0.2f;
        scene.lights[1].position_or_direction.z -= 0.3f;
        check();
      }
    }
  }
}

TEST_CASE("of a receiver is wanted what the view shows of it, and little more") {
  constexpr int kWidth = 96, kHeight = 72;
  Scene scene = test::shadow_scene(ShadowKind::projected);
  scene.camera.fov_y_degrees = 20.0;  // the ground goes on beyond the picture
  ThreadPool pool{2};
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, kWidth, kHeight);
  PreparedScene prepared = prepare_scene(scene, Profile{}, pool);
  Image picture = make_image(Format::rgba16f, kWidth, kHeight);
  draw_scene(prepared, camera, 0.0, picture, pool);
  const SceneShadows& shadows = *prepared.shadows;
  REQUIRE(shadows.wanted);
  const auto area = [](std::span<const glm::dvec3> outline) {
    glm::dvec3 sum{0.0};
    for (std::size_t i = 2; i < outline.size(); ++i) {
      sum += cross(outline[i - 1] - outline[0], outline[i] - outline[0]) * 0.5;
    }
    return std::sqrt(dot(sum, sum));
  };
  const PixelRays rays = pixel_rays(camera, kWidth, kHeight);
  std::set<std::uint32_t> seen;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const SeenFacet facet = shadows.seen[0][static_cast<std::size_t>(y * kWidth + x)];
      if (!shows_facet(facet)) continue;
      const std::uint32_t number = shadows.facets.receiver_of[facet_of(facet)];
      seen.insert(number);
      const auto wanted =
          std::find_if(shadows.wanted->begin(), shadows.wanted->end(),
                       [&](const WantedReceiver& w) { return w.receiver == number; });
      REQUIRE(wanted != shadows.wanted->end());
      const FacetPlane& plane = shadows.facets.receivers[number].plane;
      const glm::dvec3 ray = rays.at(x, y);
      const glm::dvec3 p =
          camera.eye - ray * (height_over(plane, camera.eye) / dot(plane.normal, ray));
      const std::span<const glm::dvec3> outline = wanted->corners_of_outline();
      for (std::size_t i = 0; i < outline.size(); ++i) {
        const glm::dvec3 a = outline[i], b = outline[(i + 1) % outline.size()];
        REQUIRE(dot(plane.normal, cross(b - a, p - a)) > -1e-6);
      }
    }
  }
  CHECK(seen.size() == shadows.wanted->size());
  const glm::dmat4 to_clip = multiply(camera.eye_to_clip, camera.world_to_eye);
  for (const WantedReceiver& wanted : *shadows.wanted) {
    if (shadows.facets.receivers[wanted.receiver].corners != 4) continue;
    for (const glm::dvec3& p : wanted.corners_of_outline()) {
      const glm::dvec4 clip =
          ((to_clip[0] * p.x + to_clip[1] * p.y) + to_clip[2] * p.z) + to_clip[3];
      CHECK(clip.w > 0.0);
      CHECK(std::max(std::fabs(clip.x), std::fabs(clip.y)) <= clip.w * (1.0 + 1e-9));
    }
  }
  const std::uint32_t ground = shadows.facets.receiver_of[0];
  const auto of_ground =
      std::find_if(shadows.wanted->begin(), shadows.wanted->end(),
                   [&](const WantedReceiver& w) { return w.receiver == ground; });
  REQUIRE(of_ground != shadows.wanted->end());
  CHECK(area(of_ground->corners_of_outline()) <
        0.5 * area(shadows.facets.receivers[ground].corners_of_outline()));
}

TEST_CASE("a wall whose corners or edges lie on the picture's keeps its shadows") {
  ThreadPool pool{1};
  for (const double turned : {0.0, 45.0}) {
    CAPTURE(turned);
    Scene scene = test::shadow_scene(ShadowKind::projected);
    scene.camera.position = {0.0, 0.0, 2.0};
    scene.camera.target = {};
    scene.camera.fov_y_degrees = 53.130102354155978;  // 1 m up and down, 2 m away
    scene.lights[0].position_or_direction = {0.3f, 0.4f, 3.0f};
    scene.lights[1].position_or_direction = {-0.2f, 0.1f, 1.0f};
    const double side = turned == 0.0 ? 2.0 : std::sqrt(2.0);
    scene.meshes[0] = make_plane(side, side, 1, 1);
    scene.objects[0].rotation_degrees = {90.0, 0.0, turned};
    scene.objects[1].position = {0.1, 0.05, 0.8};
    scene.objects[1].scale = glm::dvec3{0.3};
    scene.objects.resize(2);
    set_shadows(scene, ShadowKind::projected);
    const CameraMatrices camera = camera_matrices(scene.camera, 0.0, 64, 64);
    PreparedScene onto_seen = prepare_scene(scene, {}, pool);
    PreparedScene onto_all = prepare_scene(scene, {}, pool);
    place_shadows(*onto_all.shadows, scene, scene.lights, 0.0, pool);
    Image a = make_image(Format::rgba16f, 64, 64), b = a;
    draw_scene(onto_seen, camera, 0.0, a, pool);
    draw_scene(onto_all, camera, 0.0, b, pool);
    CHECK(!onto_seen.shadows->projected[0].of_all);
    CHECK(onto_all.shadows->projected[0].of_all);
    CHECK(onto_seen.shadows->masks == onto_all.shadows->masks);
    CHECK(equal(a, b));
    const std::vector<std::uint8_t>& mask = onto_all.shadows->masks[0];
    CHECK(std::count(mask.begin(), mask.end(), 0) + 50 < 64 * 64);
  }
}

TEST_CASE("objects that something else is drawn for are no facets that take shadows") {
  const Scene scene = test::shadow_scene(ShadowKind::projected);
  ThreadPool pool(1);
  constexpr int kWidth = 48, kHeight = 32;
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, kWidth, kHeight);
  NumberedScene numbered = number_triangles(scene, {}, pool.isa());
  const auto seen_of_ball = [&](std::span<const std::uint8_t> hidden) {
    const std::vector<SeenFacet> seen =
        draw_seen_facets(numbered, scene, camera, 0.0, kWidth, kHeight, 1, pool, {}, hidden)[0];
    const std::size_t first =
        (scene.meshes[0].indices.size() + 2 * scene.meshes[1].indices.size()) / 3;
    return std::count_if(seen.begin(), seen.end(), [&](SeenFacet facet) {
      return shows_facet(facet) && facet_of(facet) >= first;
    });
  };
  CHECK(seen_of_ball({}) > 10);
  CHECK(seen_of_ball(std::vector<std::uint8_t>{0, 0, 0, 1}) == 0);
}
