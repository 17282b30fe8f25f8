// Shadow volumes of whole scenes, as draw_layers() and draw_scene() have them.

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "scenes/draw/shadowed_layers.h"
#include "scenes/load/load_scene.h"
#include "scenes/shadows/shadow_truth.h"

using namespace softfocus;

namespace {

void check_scene(const std::string& name, int width, int height) {
  Scene scene = load_scene(name, scene_search_path({}));
  set_shadows(scene, ShadowKind::volumes);
  ThreadPool pool{2};
  const CameraMatrices camera = camera_matrices(scene.camera, 5.0, width, height);
  std::vector<ShadowLight> lights;
  for (const Light& light : scene.lights) lights.push_back(shadow_light(light));
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  Image picture = make_image(Format::rgba16f, width, height);
  std::vector<Image> behind(1, picture);
  std::vector<std::vector<std::uint8_t>> first;
  for (const VolumeCount count : {VolumeCount::z_fail, VolumeCount::z_pass}) {
    prepared.shadows->volume_count = count;
    draw_layers(prepared, camera, 5.0, picture, behind, pool);
    const SceneShadows& shadows = *prepared.shadows;
    if (first.empty()) first = shadows.masks;
    for (std::size_t layer = 0; layer < 2; ++layer) {
      CAPTURE(layer);
      const ShadowErrors errors =
          shadow_errors(shadows.facets, lights, shadows.seen[layer], shadows.masks[layer],
                        {multiply(camera.eye_to_clip, camera.world_to_eye), width, height, {}},
                        camera.eye, true, pool);
      CHECK(errors.in_shadow > errors.seen / 100);
      CHECK(errors.in_shadow < errors.seen);
      CHECK(errors.wrong == 0);
      CHECK(errors.near_edge <= 1);
      std::size_t differing = 0;
      for (std::size_t i = 0; i < first[layer].size(); ++i) {
        differing += first[layer][i] != shadows.masks[layer][i] ? 1 : 0;
      }
      CHECK(differing <= errors.near_edge);
    }
  }
}

}  // namespace

TEST_CASE("cube-room's volumes are right") { check_scene("cube-room", 160, 120); }

TEST_CASE("figures' volumes are right") { check_scene("figures", 160, 120); }

TEST_CASE("sphere-world's volumes are right" * doctest::test_suite("long")) {
  check_scene("sphere-world", 200, 150);
}

TEST_CASE("volumes give the same bits on every vector unit and number of threads" *
          doctest::test_suite("threads")) {
  Scene scene = load_scene("cube-room", scene_search_path({}));
  set_shadows(scene, ShadowKind::volumes);
  const CameraMatrices camera = camera_matrices(scene.camera, 5.0, 150, 97);
  const auto mask_by = [&](ThreadPool& pool) {
    PreparedScene prepared = prepare_scene(scene, {}, pool);
    Image picture = make_image(Format::rgba16f, 150, 97);
    draw_scene(prepared, camera, 5.0, picture, pool);
    return prepared.shadows->masks[0];
  };
  ThreadPool scalar{1, Isa::scalar};
  const std::vector<std::uint8_t> expected = mask_by(scalar);
  for (const Isa isa : {available_isas()[1], widest_isa()}) {
    ThreadPool pool{3, isa};
    CHECK(mask_by(pool) == expected);
  }
}
