#include "scenes/relief/make_relief.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/numbers/vector_math.h"
#include "scenes/make/shapes.h"

using namespace softfocus;

namespace {

/// A sphere of a metre's radius, beside the origin.
Scene sphere_scene() {
  Scene scene;
  scene.lights = {{LightKind::directional, {0.3f, 0.8f, 1.0f}, glm::vec3{1.0f}}};
  scene.materials.emplace_back();
  scene.meshes.push_back(make_sphere(1.0, 96, 48));
  scene.objects.push_back({});
  scene.objects[0].position = {0.5, -0.25, 0.75};
  return scene;
}

constexpr ReliefView kView{{2.5, 1.0, 4.0}, {0.0, 1.0, 0.0}};

}  // namespace

TEST_CASE("a relief's texels are points of the surface, with the surface's normals") {
  const Scene scene = sphere_scene();
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  for (const int bits : {8, 16}) {
    const ReliefTexture relief = make_relief(maker, kView, {64, 64, bits, true}, pool);
    int filled = 0;
    double most_away = 0.0, least_cosine = 1.0;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const auto at = static_cast<std::size_t>(64 * y + x);
        CHECK((relief.depths[at] == empty_depth(bits)) == (relief.colours[at] == 0));
        if (relief.colours[at] == 0) continue;
        ++filled;
        const glm::dvec3 out =
            relief_point(relief, x, y, relief.depths[at]) - scene.objects[0].position;
        most_away = std::fmax(most_away, std::fabs(std::sqrt(dot(out, out)) - 1.0));
        const auto part = [&](int shift) {
          return (static_cast<int>(relief.normals[at] >> shift & 255u) - 128) / 127.0;
        };
        const glm::dvec3 normal{part(0), part(8), part(16)};
        least_cosine = std::fmin(least_cosine, dot(normal, normalize(out)));
      }
    }
    // A disc within one texel of margin on each side; facets of 96 segments.
    CHECK(filled == doctest::Approx(62 * 62 * 0.785).epsilon(0.02));
    CHECK(most_away < (bits == 8 ? 0.012 : 0.006));
    CHECK(least_cosine > 0.99);
  }
}

TEST_CASE("a perspective relief's texels are points of the surface, evenly spaced for its eye") {
  const Scene scene = sphere_scene();
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  ReliefView view = kView;
  view.projection = ReliefProjection::perspective;
  REQUIRE(can_project(maker, view));
  const ReliefTexture relief = make_relief(maker, view, {64, 64, 16, true}, pool);
  CHECK(relief.camera.eye == view.eye);
  int filled = 0;
  double most_away = 0.0, least_cosine = 1.0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const auto at = static_cast<std::size_t>(64 * y + x);
      if (relief.colours[at] == 0) continue;
      ++filled;
      const glm::dvec3 point = relief_point(relief, x, y, relief.depths[at]);
      const glm::dvec3 out = point - scene.objects[0].position;
      most_away = std::fmax(most_away, std::fabs(std::sqrt(dot(out, out)) - 1.0));
      const auto part = [&](int shift) {
        return (static_cast<int>(relief.normals[at] >> shift & 255u) - 128) / 127.0;
      };
      const glm::dvec3 normal{part(0), part(8), part(16)};
      least_cosine = std::fmin(least_cosine, dot(normal, normalize(out)));
      // The eye sees none of the sphere's far side.
      CHECK(dot(out, view.eye - point) > -0.2);
    }
  }
  CHECK(filled == doctest::Approx(62 * 62 * 0.785).epsilon(0.02));
  CHECK(most_away < 0.006);
  CHECK(least_cosine > 0.99);
}

TEST_CASE("an eye beside part of an object has no perspective relief of it") {
  const Scene scene = sphere_scene();
  ThreadPool pool(1);
  const ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const auto is_seen_whole = [&](glm::dvec3 eye) {
    return can_project(maker, {eye, {0.0, 1.0, 0.0}, ReliefProjection::perspective});
  };
  CHECK(is_seen_whole({0.5, -0.25, 2.75}));
  CHECK(!is_seen_whole({0.5, -0.25, 1.5}));
  CHECK(!is_seen_whole({0.5, -0.25, 1.76}));  // too near: 1 cm before it
}

TEST_CASE("a relief holds its object from border to border, and its axes are at right angles") {
  const Scene scene = sphere_scene();
  ThreadPool pool(1);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefTexture relief = make_relief(maker, kView, {40, 72, 8, false}, pool);
  const ReliefExtent extent = *relief_extent(relief);
  CHECK(extent.x_begin <= 2);
  CHECK(extent.x_end >= 38);
  CHECK(extent.y_begin <= 2);
  CHECK(extent.y_end >= 70);
  CHECK(extent.least_code <= 1);
  const ReliefCamera& camera = relief.camera;
  CHECK(dot(camera.a, camera.b) == doctest::Approx(0.0));
  CHECK(dot(camera.a, camera.f) == doctest::Approx(0.0));
  CHECK(dot(camera.f, camera.f) == doctest::Approx(1.0));
  CHECK(dot(camera.f, maker.middle - kView.eye) > 0.0);
}

TEST_CASE("a relief has the same bits for any number of threads and vector unit") {
  const Scene scene = sphere_scene();
  ThreadPool plain(1, Isa::scalar);
  ReliefMaker maker = prepare_relief(scene, 0.0, plain);
  ReliefView view = kView;
  view.projection = ReliefProjection::perspective;
  const ReliefTexture right = make_relief(maker, view, {48, 48, 16, true}, plain);
  for (const Isa isa : available_isas()) {
    ThreadPool pool(3, isa);
    ReliefMaker own = prepare_relief(scene, 0.0, pool);
    const ReliefTexture relief = make_relief(own, view, {48, 48, 16, true}, pool);
    CHECK(relief.depths == right.depths);
    CHECK(relief.colours == right.colours);
    CHECK(relief.normals == right.normals);
  }
}

TEST_CASE("a relief that is drawn in parts has the bits of one that is drawn at once") {
  Scene scene;
  scene.lights = {{LightKind::directional, {0.3f, 0.8f, 1.0f}, glm::vec3{1.0f}}};
  scene.materials.emplace_back();
  scene.meshes.push_back(make_torus(0.7, 0.3, 60, 30));
  // The second lies where the first is: which one is seen depends on the order alone.
  scene.materials.emplace_back();
  scene.materials[1].diffuse = {0.1f, 0.9f, 0.2f};
  scene.objects.push_back({});
  scene.objects.push_back({});
  scene.objects[1].material = 1;
  const ReliefView view{{1.0, 2.0, 3.0}, {0.0, 1.0, 0.0}};
  const ReliefForm form{40, 30, 16, true};
  for (const Isa isa : {Isa::scalar, widest_isa()}) {
    ThreadPool pool(2, isa);
    ReliefMaker maker = prepare_relief(scene, 0.0, pool);
    const ReliefTexture whole = make_relief(maker, view, form, pool);
    for (const int parts : {2, 3, 50}) {
      ReliefTexture relief =
          begin_relief(maker, relief_camera(maker, view, form.width, form.height), form);
      for (int part = 0; part < parts; ++part) {
        draw_relief_part(maker, relief, form, view.eye, part, parts, pool);
      }
      read_relief(maker, form, view.eye, relief, pool);
      CHECK(relief.depths == whole.depths);
      CHECK(relief.colours == whole.colours);
      CHECK(relief.normals == whole.normals);
    }
  }
}
