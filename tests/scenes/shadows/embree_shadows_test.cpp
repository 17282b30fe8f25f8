// Embree's rays as a second truth.

#include "scenes/shadows/embree_shadows.h"

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "scenes/draw/shadowed_layers.h"
#include "scenes/load/load_scene.h"
#include "tests/support/shadow_facets.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

EmbreeDifferences differences(const std::string& name, int width, int height) {
  ThreadPool pool{2};
  Scene scene = load_scene(name, scene_search_path({}));
  set_shadows(scene, ShadowKind::projected);
  const CameraMatrices camera = camera_matrices(scene.camera, 5.0, width, height);
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  Image picture = make_image(Format::rgba16f, width, height);
  draw_scene(prepared, camera, 5.0, picture, pool);
  const SceneShadows& shadows = *prepared.shadows;
  std::vector<ShadowLight> lights;
  for (const Light& light : scene.lights) lights.push_back(shadow_light(light));
  return embree_differences(shadows.facets, lights, shadows.seen[0],
                            {multiply(camera.eye_to_clip, camera.world_to_eye), width, height, {}},
                            camera.eye, pool);
}

}  // namespace

TEST_CASE("Embree's rays, in binary32, answer as ours but within 1/16 pixel of an edge") {
  if (!embree_shadows_missing().empty()) return skip("embree", "no Embree");
  const EmbreeDifferences found = differences("figures", 160, 120);
  CHECK(found.seen > 5000);
  CHECK(found.differ[0] + found.differ[1] + found.differ[2] < found.seen / 500);
  CHECK(found.differ[3] == 0);
  CHECK(found.differ[4] == 0);
}

TEST_CASE("Embree sees a square's shadow, and lets light through a one-sided back") {
  if (!embree_shadows_missing().empty()) return skip("embree", "no Embree");
  for (const bool faces_up : {true, false}) {
    std::vector<Facet> made;
    test::add_floor(made, 10.0);
    glm::dvec3 b{1, 1, 1}, d{-1, 1, -1};
    if (!faces_up) std::swap(b, d);
    test::add_quad(made, {-1, 1, 1}, b, {1, 1, -1}, d, false);
    const Facets facets = make_facets(std::move(made));
    const EmbreeShadows embree{facets};
    const ShadowLight above{{0, 1, 0}, 0.0}, lamp{{0, 0.5, 0}, 1.0};
    CHECK(embree.is_dark(0, false, {0.5, 0, 0.5}, above) == faces_up);
    CHECK_FALSE(embree.is_dark(0, false, {1.5, 0, 0.5}, above));
    CHECK_FALSE(embree.is_dark(0, false, {0.5, 0, 0.5}, lamp));
    CHECK(embree.is_dark(0, true, {0.5, 0, 0.5}, above));
  }
}
