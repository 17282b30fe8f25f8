#include "scenes/relief/light_relief.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "raster/numbers/srgb.h"
#include "raster/numbers/vector_math.h"
#include "scenes/make/shapes.h"
#include "scenes/relief/make_relief.h"

using namespace softfocus;

namespace {

/// Two balls side by side, of materials of their own, under a light of each kind.
Scene two_balls() {
  Scene scene;
  scene.ambient_light = {0.3f, 0.2f, 0.1f};
  scene.lights = {{LightKind::directional, {0.3f, 0.8f, 1.0f}, glm::vec3{0.7f}},
                  {LightKind::point, {-2.0f, 1.0f, 2.0f}, {0.2f, 0.4f, 0.8f}}};
  scene.materials.resize(2);
  scene.materials[0].diffuse = {0.9f, 0.5f, 0.25f};
  scene.materials[0].specular = glm::vec3{0.4f};
  scene.materials[1].diffuse = {0.1f, 0.6f, 0.4f};
  scene.meshes.push_back(make_sphere(0.5, 128, 64));
  scene.objects.resize(2);
  scene.objects[0].position.x = -0.6;
  scene.objects[1].position.x = 0.6;
  scene.objects[1].material = 1;
  return scene;
}

constexpr ReliefForm kUnlitForm{60, 32, 16, true, true};
const ReliefView kBallView{{0.5, 1.0, 4.0}, {0.0, 1.0, 0.0}};

ReliefTexture unlit_relief(const Scene& scene, ThreadPool& pool,
                           ReliefProjection projection = ReliefProjection::orthographic) {
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  ReliefView view = kBallView;
  view.projection = projection;
  return make_relief(maker, view, kUnlitForm, pool);
}

int channel_of(std::uint32_t colour, int number) {
  return static_cast<int>(colour >> (8 * number) & 255u);
}

}  // namespace

TEST_CASE("an unlit relief that is lit by the scene's lights looks as one that was drawn lit") {
  Scene scene = two_balls();
  // A highlight at a ball's border: where a texel lies matters.
  scene.lights.push_back({LightKind::point, {-1.3f, 0.1f, 0.2f}, glm::vec3{0.6f}});
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  for (const NamedProjection& projection : kReliefProjections) {
    CAPTURE(projection.name);
    ReliefView view = kBallView;
    view.eye = kBallView.eye * 0.5;
    view.projection = projection.projection;
    const ReliefTexture drawn = make_relief(maker, view, {60, 32, 16, false}, pool);
    ReliefTexture lit = make_relief(maker, view, kUnlitForm, pool);
    CHECK(lit.depths == drawn.depths);
    light_relief(lit, relief_lights(scene.ambient_light, scene.lights), view.eye, pool);
    int most = 0;
    for (std::size_t i = 0; i < lit.colours.size(); ++i) {
      for (int channel = 0; channel < 4; ++channel) {
        most = std::max(most, std::abs(channel_of(lit.colours[i], channel) -
                                       channel_of(drawn.colours[i], channel)));
      }
    }
    // The normals have 8 bits, the drawn light is of the vertices.
    CHECK(most > 0);
    CHECK(most <= 6);
  }
}

TEST_CASE("an unlit relief's texels have the diffuse colour, and their material") {
  const Scene scene = two_balls();
  ThreadPool pool(1);
  const ReliefTexture relief = unlit_relief(scene, pool);
  REQUIRE(relief.materials.size() == 2);
  int seen[2] = {0, 0};
  for (std::size_t i = 0; i < relief.unlit.size(); ++i) {
    if (relief.depths[i] == empty_depth(16)) continue;
    const std::uint32_t number = relief.normals[i] >> 24;
    REQUIRE(number < 2);
    ++seen[number];
    for (int c = 0; c < 3; ++c) {
      CHECK(std::abs(channel_of(relief.unlit[i], c) -
                     linear_to_srgb8(scene.materials[number].diffuse[c])) <= 1);
    }
  }
  CHECK(seen[0] > 200);
  CHECK(seen[1] > 200);
}

TEST_CASE(
    "light goes around with its lamp: a texel that turns from it has the ambient share alone") {
  const Scene scene = two_balls();
  ThreadPool pool(2);
  ReliefTexture relief = unlit_relief(scene, pool);
  const std::vector<Light> behind{
      {LightKind::directional, glm::vec3{-kBallView.eye * 1.0}, glm::vec3{1.0f}}};
  light_relief(relief, relief_lights(scene.ambient_light, behind), kBallView.eye, pool);
  const glm::vec3 towards_light = normalize(behind[0].position_or_direction);
  int dark = 0;
  for (std::size_t i = 0; i < relief.colours.size(); ++i) {
    if (relief.depths[i] == empty_depth(16)) continue;
    const auto part = [&](int shift) {
      return static_cast<float>(static_cast<int>(relief.normals[i] >> shift & 255u) - 128);
    };
    if (dot(glm::vec3{part(0), part(8), part(16)}, towards_light) > 0.0f) continue;
    ++dark;
    const Material& material = scene.materials[relief.normals[i] >> 24];
    for (int c = 0; c < 3; ++c) {
      CHECK(std::abs(channel_of(relief.colours[i], c) -
                     linear_to_srgb8(material.ambient[c] * scene.ambient_light[c])) <= 1);
    }
  }
  CHECK(dark > 400);
}

TEST_CASE("light on a relief has the same bits for any number of threads and vector unit") {
  Scene scene = two_balls();
  ThreadPool plain(1, Isa::scalar);
  const ReliefLights lights = relief_lights(scene.ambient_light, scene.lights);
  for (const NamedProjection& projection : kReliefProjections) {
    ReliefTexture right = unlit_relief(scene, plain, projection.projection);
    const ReliefTexture unlit = right;
    for (const bool second_is_lit : {true, false}) {
      right.materials[1].lit = second_is_lit;
      light_relief(right, lights, kBallView.eye, plain);
      for (const Isa isa : available_isas()) {
        ThreadPool pool(3, isa);
        ReliefTexture relief = unlit;
        relief.materials[1].lit = second_is_lit;
        light_relief(relief, lights, kBallView.eye, pool);
        CHECK_MESSAGE(relief.colours == right.colours, isa_name(isa));
      }
    }
  }
}
