// The place at which light ends on curves of few facets.

#include "scenes/shadows/terminators.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/make/shapes.h"
#include "scenes/shadows/shadow_truth.h"
#include "tests/support/shadow_facets.h"
#include "tests/support/shadow_scene.h"

using namespace softfocus;

namespace {

// A sphere of few facets, lit from the side.
Scene sphere_scene(Terminator rule) {
  Scene scene;
  scene.camera.position = {0, 0.5, 3};
  scene.camera.target = {0, 0, 0};
  Light light;
  light.position_or_direction = {-1.0f, 0.6f, 0.2f};
  light.shadows = ShadowKind::projected;
  light.terminator = rule;
  scene.lights = {light};
  scene.materials = {Material{}};
  scene.meshes = {make_sphere(0.7, 14, 7)};
  scene.objects = {Object{}};
  return scene;
}

Image drawn(const Scene& scene, ThreadPool& pool) {
  return draw_scene(scene, camera_matrices(scene.camera, 0.0, 120, 90), 0.0, 120, 90, {}, pool);
}

Image unshadowed(Scene scene, ThreadPool& pool) {
  set_shadows(scene, ShadowKind::none);
  return drawn(scene, pool);
}

CurvedSurfaces with_normal(glm::vec3 normal, std::vector<std::uint32_t> objects) {
  CurvedSurfaces surfaces{{}, std::move(objects)};
  surfaces.normals.resize(surfaces.object_of.size(), {normal, normal, normal});
  return surfaces;
}

// A facet in the plane z = 0 with one normal for all corners, and a light at an angle.
double kept(glm::vec3 normal, glm::dvec3 light, bool from_back = false) {
  std::vector<Facet> made;
  test::add_triangle(made, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Facets facets = make_facets(std::move(made));
  const CurvedSurfaces surfaces = with_normal(normal, {0});
  return kept_by_fade(facets, surfaces, 0, from_back, {0.2, 0.3, 0.0}, {normalize(light), 0.0});
}

}  // namespace

TEST_CASE("normals: a sphere's light ends where its normals turn away, on facets of either side") {
  ThreadPool pool{2};
  Scene scene = sphere_scene(Terminator::normals);
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  Image picture = make_image(Format::rgba16f, 120, 90);
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, 120, 90);
  draw_scene(prepared, camera, 0.0, picture, pool);
  const Image all = unshadowed(scene, pool);
  const Facets& facets = prepared.shadows->facets;
  const CurvedSurfaces surfaces = curved_surfaces(scene, 0.0);
  const ShadowLight light = shadow_light(scene.lights[0]);
  int on_away = 0, beyond = 0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      const SeenFacet seen = prepared.shadows->seen[0][static_cast<std::size_t>(120 * y + x)];
      if (!shows_facet(seen)) continue;
      const std::uint32_t facet = facet_of(seen);
      const glm::dvec3 point =
          seen_point(facets.planes[facet], multiply(camera.eye_to_clip, camera.world_to_eye),
                     camera.eye, {x + 0.5, y + 0.5}, 120, 90);
      const double kept =
          kept_by_normals(facets.facets[facet], facets.planes[facet],
                          corner_cosines(facets, surfaces, facet, false, light), point);
      const float dark = 0.2f * 0.2f;  // ambient alone
      const float lit = load_texel<Format::rgba16f>(all, x, y).x - dark;
      const float here = load_texel<Format::rgba16f>(picture, x, y).x - dark;
      REQUIRE(std::fabs(here - lit * static_cast<float>(kept)) < 3e-3f);
      on_away += height_over(facets.planes[facet], light) < 0.0 && here > 0.01f ? 1 : 0;
      beyond += lit > 0.01f && kept == 0.0 ? 1 : 0;
    }
  }
  CHECK(on_away > 20);
  CHECK(beyond > 20);
}

TEST_CASE("normals: what is kept is the clamped cosine of the mean over the mean of the clamped") {
  std::vector<Facet> made;
  test::add_triangle(made, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Facets facets = make_facets(std::move(made));
  const auto kept = [&](std::array<double, 3> cosines, glm::dvec3 point) {
    return kept_by_normals(facets.facets[0], facets.planes[0], cosines, point);
  };
  CHECK(kept({0.5, 0.2, 0.1}, {0.3, 0.3, 0}) == doctest::Approx(1.0));
  CHECK(kept({0.6, -0.2, -0.2}, {0.25, 0.25, 0}) == doctest::Approx(0.2 / 0.3));
  CHECK(kept({0.6, -0.2, -0.2}, {0.5, 0.4, 0}) == 0.0);
  CHECK(kept({-0.1, -0.2, 0.0}, {0.3, 0.3, 0}) == 1.0);  // no light to keep
}

TEST_CASE("normals: another object's shadow lies on facets that turn away, too") {
  ThreadPool pool{2};
  Scene scene = sphere_scene(Terminator::normals);
  scene.meshes.push_back(make_plane(8, 8, 1, 1));
  Object plate;
  plate.mesh = 1;
  plate.position = {-2, 1.2, 0.4};
  plate.rotation_degrees = {0, 0, 59};
  scene.objects.push_back(plate);
  scene.materials[0].two_sided = true;
  Scene without = scene;
  without.lights.clear();
  CHECK_FALSE(equal(unshadowed(scene, pool), drawn(without, pool)));
  CHECK(equal(drawn(scene, pool), drawn(without, pool)));
}

TEST_CASE(
    "normals: on no facet that turns away does a ray from its middle meet the sphere itself") {
  const Scene scene = sphere_scene(Terminator::normals);
  const Facets facets = scene_facets(scene, 0.0);
  const CurvedSurfaces surfaces = curved_surfaces(scene, 0.0);
  const ShadowLight light = shadow_light(scene.lights[0]);
  std::vector<std::uint32_t> all(facets.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  int away = 0;
  for (std::uint32_t facet = 0; facet < facets.facets.size(); ++facet) {
    const std::array<double, 3> cosines = corner_cosines(facets, surfaces, facet, false, light);
    if (height_over(facets.planes[facet], light) > 0.0) continue;
    if (std::max({cosines[0], cosines[1], cosines[2]}) <= 0.0) continue;
    ++away;
    const auto& [a, b, c] = facets.facets[facet].corners;
    CHECK_FALSE(
        in_shadow_but_for_own_curve(facets, surfaces, facet, (a + b + c) / 3.0, light, all));
  }
  CHECK(away > 5);
}

TEST_CASE("normals: what is far away on the own object still casts its shadow") {
  // Two facets of one object: the lower turns away by its plane, not by its normals.
  std::vector<Facet> made;
  test::add_triangle(made, {0, 0, 0}, {0, 0, 1}, {1, 0.1, 0});
  test::add_triangle(made, {-9, 5, -9}, {0, 5, 9}, {9, 5, -9});
  const Facets facets = make_facets(std::move(made));
  const glm::vec3 up{0.0f, 1.0f, 0.0f};
  const std::vector<std::uint32_t> all{0, 1};
  const auto dark = [&](double height, std::uint32_t other) {
    const CurvedSurfaces surfaces = with_normal(up, {0, other});
    return in_shadow_but_for_own_curve(facets, surfaces, 0, {0.2, 5.0 - height, 0.2},
                                       {{0, 1, 0}, 0.0}, all);
  };
  CHECK(dark(4.0, 0));
  CHECK_FALSE(dark(2.0, 0));
  CHECK(dark(2.0, 1));
}

TEST_CASE("fade: all is kept where plane and normals agree, and G's cubic where they do not") {
  CHECK(kept({0, 0, 1}, {0.5, 0.1, 1}) == doctest::Approx(1.0));
  CHECK(kept({0, 0, 1}, {0.5, 0.1, -1}, true) == doctest::Approx(1.0));
  // Plane and light: sin 10 degrees. The normal leans to the light by 30 degrees.
  const double s = 0.17364817766693033, c = 0.98480775301220802;
  const float lean = 0.5f, up = 0.8660254f;
  const double g = s / ((0.5 * c + 0.8660254 * s) * 0.8660254);
  CHECK(kept({lean, 0, up}, {c, 0, s}) == doctest::Approx(-g * g * g + g * g + g).epsilon(1e-6));
  CHECK(kept({lean, 0, up}, {1, 0, 1e-9}) < 1e-8);
  CHECK(kept({-lean, 0, up}, {c, 0, s}) == 1.0);  // the normal turns away: no light to keep
}

TEST_CASE("fade: takes from the facets that the light grazes, and nowhere adds light") {
  ThreadPool pool{2};
  const Image hard = drawn(sphere_scene(Terminator::facets), pool);
  const Image faded = drawn(sphere_scene(Terminator::fade), pool);
  int darker = 0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      const float before = load_texel<Format::rgba16f>(hard, x, y).x;
      const float after = load_texel<Format::rgba16f>(faded, x, y).x;
      REQUIRE(after <= before);
      darker += after < before ? 1 : 0;
    }
  }
  CHECK(darker > 50);
}

TEST_CASE("flat surfaces keep their bits by every rule") {
  ThreadPool pool{2};
  Scene scene = test::shadow_scene(ShadowKind::projected);
  scene.objects.pop_back();  // the ball
  const Image expected = drawn(scene, pool);
  for (const Terminator rule : {Terminator::normals, Terminator::fade}) {
    for (Light& light : scene.lights) light.terminator = rule;
    CHECK(equal(drawn(scene, pool), expected));
  }
}

TEST_CASE("terminators have the same bits on every vector unit and number of threads") {
  for (const Terminator rule : {Terminator::normals, Terminator::fade}) {
    ThreadPool scalar{1, Isa::scalar};
    const Image expected = drawn(sphere_scene(rule), scalar);
    for (const Isa isa : {available_isas()[1], widest_isa()}) {
      ThreadPool pool{3, isa};
      CHECK(equal(drawn(sphere_scene(rule), pool), expected));
    }
  }
}

TEST_CASE("fade: a map's kernel and the fade are taken one after the other") {
  ThreadPool pool{2};
  Scene scene = sphere_scene(Terminator::fade);
  scene.lights[0].shadows = ShadowKind::map;
  scene.lights[0].map = {.size = 128, .kernel = 3};
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  Image picture = make_image(Format::rgba16f, 120, 90);
  draw_scene(prepared, camera_matrices(scene.camera, 0.0, 120, 90), 0.0, picture, pool);
  scene.lights[0].terminator = Terminator::facets;
  PreparedScene kernel = prepare_scene(scene, {}, pool);
  draw_scene(kernel, camera_matrices(scene.camera, 0.0, 120, 90), 0.0, picture, pool);
  const auto& both = prepared.shadows->shares[0][0];
  const auto& alone = kernel.shadows->shares[0][0];
  int more = 0;
  for (std::size_t i = 0; i < both.size(); ++i) {
    REQUIRE(both[i] >= std::lround(alone[i] * 255.0 / 9.0));
    more += both[i] > std::lround(alone[i] * 255.0 / 9.0) ? 1 : 0;
  }
  CHECK(more > 50);
}
