// A scene's layers in lanes against the scalar pipeline, whose layers tests/raster/pipeline holds
// against an oracle.

#include <doctest/doctest.h>

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/load/load_scene.h"
#include "tests/support/sanitizers.h"

using namespace softfocus;

namespace {

constexpr int kAcross = 150, kDown = 97;

std::vector<Image> layers_of(const Scene& scene, std::size_t layers, Isa isa, int threads = 1,
                             const Profile& profile = {}) {
  ThreadPool pool{threads, isa};
  return draw_layers(scene, camera_matrices(scene.camera, 3, kAcross, kDown), 3, kAcross, kDown,
                     layers, profile, pool);
}

void check_layers(const std::vector<Image>& a, const std::vector<Image>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    INFO("layer ", i);
    CHECK(equal(a[i], b[i]));
  }
}

// Unlit squares across the axis: in order of submission at these depths, red 1, 2, 3, ...
Scene squares_at(const std::vector<double>& depths) {
  Scene scene;
  scene.camera = {.position = {0, 0, 0}, .target = {0, 0, -1}, .near_m = 0.5, .far_m = 50};
  Mesh mesh;
  mesh.positions = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back(mesh);
  for (std::size_t i = 0; i < depths.size(); ++i) {
    Material material;
    material.lit = false;
    material.diffuse = glm::vec3{static_cast<float>(i + 1), 0.0f, 0.0f};
    scene.materials.push_back(material);
    Object object;
    object.material = static_cast<std::uint32_t>(i);
    object.position = {0, 0, -depths[i]};
    scene.objects.push_back(object);
  }
  return scene;
}

std::vector<float> reds(const std::vector<Image>& layers) {
  std::vector<float> values;
  values.reserve(layers.size());
  for (const Image& layer : layers) values.push_back(load_texel(layer, 70, 40).x);
  return values;
}

}  // namespace

TEST_CASE("layers of scenes: the same on every vector unit and for any number of threads") {
  for (const char* name : {"sphere-world", "near-fence", "foliage", "random:6"}) {
    INFO(name);
    const Scene scene = load_scene(name, scene_search_path({}));
    for (const std::size_t layers : {2u, 3u, 4u}) {
      if (kHasSanitizers && layers == 3) continue;
      const std::vector<Image> expected = layers_of(scene, layers, Isa::scalar);
      for (const Isa isa : available_isas()) {
        INFO("isa ", isa_name(isa), ", ", layers, " layers");
        check_layers(layers_of(scene, layers, isa, isa == Isa::scalar ? 1 : 3), expected);
      }
    }
  }
}

TEST_CASE("layers of scenes: the same on every vector unit with a driver's planes") {
  const Scene scene = load_scene("clutter", scene_search_path({}));
  const Profile profile = find_profile("llvmpipe").value();
  const std::vector<Image> expected = layers_of(scene, 3, Isa::scalar, 1, profile);
  for (const Isa isa : available_isas()) {
    INFO("isa ", isa_name(isa));
    check_layers(layers_of(scene, 3, isa, 1, profile), expected);
  }
}

TEST_CASE("layers of scenes: the first is draw_scene()'s picture") {
  const Scene scene = load_scene("foliage", scene_search_path({}));
  ThreadPool pool{1};
  const CameraMatrices camera = camera_matrices(scene.camera, 3, kAcross, kDown);
  CHECK(equal(layers_of(scene, 4, Isa::scalar)[0],
              draw_scene(scene, camera, 3, kAcross, kDown, {}, pool)));
}

TEST_CASE("layers of scenes: nearest first, at one depth the first submitted, then background") {
  for (const Isa isa : available_isas()) {
    INFO("isa ", isa_name(isa));
    const std::vector<Image> layers = layers_of(squares_at({4, 2, 3, 2}), 4, isa);
    CHECK(reds(layers) == std::vector<float>{2, 4, 3, 1});
    CHECK(load_texel(layers[3], 70, 40).w == 4.0f);
    CHECK(reds(layers_of(squares_at({5, 6}), 4, isa)) == std::vector<float>{1, 2, 0, 0});
  }
}

// Draws in lanes keep what a scalar draw has left, and the other way round.
TEST_CASE("layers of scenes: draws in lanes and scalar draws mixed in a pass") {
  const Scene scene = load_scene("foliage", scene_search_path({}));
  const std::vector<Image> expected = layers_of(scene, 4, Isa::scalar);
  const CameraMatrices camera = camera_matrices(scene.camera, 3, kAcross, kDown);
  for (const Isa isa : available_isas()) {
    INFO("isa ", isa_name(isa));
    ThreadPool pool{1, isa};
    std::vector<Image> layers, depths;
    PreparedScene prepared = prepare_scene(scene, {}, pool);
    for (int i = 0; i < 4; ++i) {
      layers.push_back(make_image(Format::rgba16f, kAcross, kDown));
      depths.push_back(make_image(Format::r32f, kAcross, kDown));
    }
    RenderTargets targets;
    targets.colour[0] = &layers[0];
    targets.depth = &depths[0];
    for (std::size_t i = 0; i < 3; ++i) targets.behind[i] = {&layers[i + 1], &depths[i + 1]};
    // Every third object is drawn fragment by fragment.
    RenderPass scalar, in_lanes;
    scalar.targets = in_lanes.targets = targets;
    in_lanes.isa = isa;
    record_scene(prepared, camera, 3, scalar);
    record_scene(prepared, camera, 3, in_lanes);
    REQUIRE(scalar.draws.size() == in_lanes.draws.size());
    for (std::size_t i = 0; i < scalar.draws.size(); i += 3) in_lanes.draws[i] = scalar.draws[i];
    finish(in_lanes, pool);
    check_layers(layers, expected);
  }
}

TEST_CASE("layers of a scene: behind what is in focus or farther nothing is drawn, if so wanted") {
  const Scene scene = load_scene("near-fence", scene_search_path({}));
  const double focus_m = scene.lens.lens.focus_m;
  const CameraMatrices view = camera_matrices(scene.camera, 0.0, kAcross, kDown);
  Image cleared = make_image(Format::rgba16f, 1, 1);
  store_texel(cleared, 0, 0, clear_colour(scene), {});
  const glm::vec4 nothing = load_texel(cleared, 0, 0);
  for (const Isa isa : {Isa::scalar, widest_isa()}) {
    ThreadPool pool{2, isa};
    const auto drawn = [&](std::optional<double> limit) {
      std::vector<Image> layers(2, make_image(Format::rgba16f, kAcross, kDown));
      PreparedScene prepared = prepare_scene(scene, {}, pool);
      draw_layers(prepared, view, 0.0, layers[0], std::span{layers}.subspan(1), pool, limit);
      return layers;
    };
    const std::vector<Image> all = drawn({}), some = drawn(focus_m);
    CHECK(equal(all[0], some[0]));
    int kept = 0, wrong = 0, dropped = 0;
    for (int y = 0; y < kDown; ++y) {
      for (int x = 0; x < kAcross; ++x) {
        const double front_m = static_cast<double>(load_texel(all[0], x, y).w);
        const glm::vec4 behind = load_texel(some[1], x, y);
        if (front_m < 0.999 * focus_m) {
          ++kept;
          wrong += behind != load_texel(all[1], x, y);
        } else if (front_m > 1.001 * focus_m) {
          ++dropped;
          wrong += behind != nothing;
        }
      }
    }
    CHECK(wrong == 0);
    CHECK(kept > 1000);
    CHECK(dropped > 1000);
  }
}

TEST_CASE("layers of a scene of more objects than a pass takes have the bits of one pass") {
  std::vector<double> depths(kPassChunks * 9 / 8);
  for (std::size_t i = 0; i < depths.size(); ++i) {
    depths[i] = 1.0 + static_cast<double>(i * 7919 % 4001) / 100.0;
  }
  Scene scene = squares_at(depths);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const auto number = static_cast<double>(i);
    scene.objects[i].scale = glm::dvec3{0.03};
    scene.objects[i].rotation_degrees = {0.0, 0.0, number};
    scene.objects[i].position.x =
        scene.objects[i].position.z * (std::fmod(0.37 * number, 1.0) - 0.5);
    scene.objects[i].position.y =
        scene.objects[i].position.z * (std::fmod(0.71 * number, 0.6) - 0.3);
    if (i % 3 == 0) scene.materials[i].lit = true;
    if (i % 5 == 0) scene.materials[i].opacity = 0.5f;
  }
  scene.lights.emplace_back().position_or_direction = {0, 0, 1};
  const Camera& view = scene.camera;
  const CameraMatrices camera = camera_matrices(view, 0.0, kAcross, kDown);
  constexpr double kLimitM = 2.0;
  const double before =
      view.far_m * (kLimitM - view.near_m) / (kLimitM * (view.far_m - view.near_m));
  for (const Isa isa : {Isa::scalar, widest_isa()}) {
    std::vector<Image> unlimited;
    for (const bool is_limited : {false, true}) {
      CAPTURE(isa_name(isa));
      CAPTURE(is_limited);
      ThreadPool pool{2, isa};
      std::vector<Image> layers(3, make_image(Format::rgba16f, kAcross, kDown));
      std::vector<Image> expected = layers;
      std::vector<Image> depth(3, make_image(Format::r32f, kAcross, kDown));
      PreparedScene prepared = prepare_scene(scene, {}, pool);
      draw_layers(prepared, camera, 0.0, layers[0], std::span{layers}.subspan(1), pool,
                  is_limited ? std::optional{kLimitM} : std::nullopt);
      RenderPass pass;
      pass.isa = pool.isa();
      pass.targets.colour[0] = &expected[0];
      pass.targets.depth = &depth[0];
      for (std::size_t i = 0; i < 2; ++i)
        pass.targets.behind[i] = {&expected[i + 1], &depth[i + 1]};
      if (is_limited) pass.behind_before = static_cast<float>(before);
      record_scene(prepared, camera, 0.0, pass);
      finish(pass, pool);
      check_layers(layers, expected);
      if (is_limited) CHECK(!equal(layers[1], unlimited[1]));
      unlimited = layers;
    }
  }
}
