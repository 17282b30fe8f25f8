#include "scenes/traced_relief/traced_relief.h"

#include <doctest/doctest.h>

#include "scenes/make/shapes.h"
#include "scenes/relief/light_relief.h"
#include "tests/support/relief_pictures.h"
#include "tests/support/skip.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

Scene ring_scene() {
  Scene scene;
  scene.lights = {{LightKind::directional, {0.3f, 0.8f, 1.0f}, glm::vec3{1.0f}}};
  scene.materials.emplace_back();
  scene.meshes.push_back(make_torus(0.7, 0.3, 48, 24));
  scene.objects.push_back({});
  return scene;
}

}  // namespace

TEST_CASE("a traced relief differs from a drawn one at outlines and steps alone") {
  if (!traced_relief_missing().empty()) return skip("embree", traced_relief_missing());
  const Scene scene = ring_scene();
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  for (const ReliefProjection projection :
       {ReliefProjection::orthographic, ReliefProjection::perspective}) {
    const ReliefView view{{1.5, 2.0, 3.5}, {0.0, 1.0, 0.0}, projection};
    const ReliefForm form{80, 64, 8, true};
    const ReliefTexture drawn = make_relief(maker, view, form, pool);
    const ReliefTexture traced = trace_relief(maker, view, form, pool);
    const ReliefDifferences found = relief_differences(drawn, traced);
    CHECK(found.shown > 2000);
    CHECK(found.by_one < found.shown / 200);
    CHECK(found.by_one_inside == 0);
    CHECK(found.code < found.shown / 20);
    CHECK(found.codes_off_step == 0);
    CHECK(found.colour_off_step < found.shown / 200);
    int wrong_normals = 0;
    for (std::size_t i = 0; i < drawn.normals.size(); ++i) {
      if (drawn.colours[i] == 0 || traced.colours[i] == 0) continue;
      for (int shift = 0; shift < 24; shift += 8) {
        const int apart = static_cast<int>(drawn.normals[i] >> shift & 255u) -
                          static_cast<int>(traced.normals[i] >> shift & 255u);
        wrong_normals += apart > 2 || apart < -2 ? 1 : 0;
      }
    }
    CHECK(wrong_normals < found.shown / 50);
  }
}

TEST_CASE("a traced relief that is lit later looks as a drawn one that is") {
  if (!traced_relief_missing().empty()) return skip("embree", traced_relief_missing());
  Scene scene = ring_scene();
  scene.materials[0].specular = {0.5f, 0.4f, 0.3f};
  scene.materials.emplace_back();
  scene.materials[1].diffuse = {0.2f, 0.6f, 0.9f};
  scene.objects.push_back({});
  scene.objects[1].material = 1;
  scene.objects[1].position = {0.0, 1.0, 0.0};
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefView view{{1.5, 2.0, 3.5}, {0.0, 1.0, 0.0}, ReliefProjection::orthographic};
  const ReliefForm form{80, 64, 8, true, true};
  ReliefTexture drawn = make_relief(maker, view, form, pool);
  ReliefTexture traced = trace_relief(maker, view, form, pool);
  CHECK(traced.materials.size() == 2);
  CHECK(relief_differences(drawn, traced).colour_off_step == 0);
  const std::vector<Light> lights{{LightKind::directional, {-1.0f, 0.5f, 0.2f}, glm::vec3{0.9f}}};
  for (ReliefTexture* relief : {&drawn, &traced}) {
    light_relief(*relief, relief_lights(scene.ambient_light, lights), view.eye, pool);
  }
  const ReliefDifferences found = relief_differences(drawn, traced);
  CHECK(found.shown > 2000);
  CHECK(found.colour_off_step < found.shown / 50);
  CHECK(traced.colours != traced.unlit);
}

TEST_CASE("a traced relief has the same bits for any number of threads") {
  if (!traced_relief_missing().empty()) return skip("embree", traced_relief_missing());
  const Scene scene = ring_scene();
  ThreadPool one(1), three(3);
  const ReliefMaker maker = prepare_relief(scene, 0.0, one);
  const ReliefView view{{1.5, 2.0, 3.5}};
  const ReliefTexture right = trace_relief(maker, view, {40, 32, 16, false}, one);
  const ReliefTexture own = trace_relief(maker, view, {40, 32, 16, false}, three);
  CHECK(own.depths == right.depths);
  CHECK(own.colours == right.colours);
}

TEST_CASE("texels that differ are counted by why: outlines, steps of depth, neither") {
  ReliefTexture one = empty_relief(12, 3, 8, 0.3);
  for (std::uint16_t& code : one.depths) code = 100;
  one.colours.assign(one.colours.size(), 0xFF404040u);
  one.depths[texel_at(one, 0, 1)] = 255;
  one.colours[texel_at(one, 0, 1)] = 0;
  ReliefTexture other = one;
  const auto hole = [&](int x) {
    other.depths[texel_at(one, x, 1)] = 255;
    other.colours[texel_at(one, x, 1)] = 0;
  };
  hole(1);                                   // beside the hole
  other.depths[texel_at(one, 4, 1)] = 101;   // a code
  other.depths[texel_at(one, 6, 1)] = 103;   // codes, on a plain
  other.depths[texel_at(one, 10, 1)] = 140;  // a step
  other.colours[texel_at(one, 4, 0)] = 0xFF404042u;
  const ReliefDifferences found = relief_differences(one, other);
  CHECK(found.shown == 35);
  CHECK(found.by_one == 1);
  CHECK(found.by_one_inside == 0);
  CHECK(found.code == 1);
  CHECK(found.codes == 2);
  CHECK(found.codes_off_step == 1);
  CHECK(found.colour == 1);
  CHECK(found.colour_off_step == 1);
  hole(8);
  CHECK(relief_differences(one, other).by_one_inside == 1);
}
