#include "scenes/surface_splatting/surface_splatting.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/load/load_scene.h"
#include "scenes/surface_splatting/surface_splats.h"
#include "tests/support/lens_view_scenes.h"
#include "tests/support/random.h"

using namespace softfocus;
using test::Drawn;
using test::sample_scene;
using test::square_scene;

namespace {

constexpr const char* kName = "surface-splatting";

Drawn splatted(const Scene& scene, int width, int height, ThreadPool& pool,
               const ThinLens& lens = test::kTestLens) {
  return sample_scene(scene, kName, {}, width, height, pool, lens);
}

std::vector<Splat> random_splats(int count, int width, int height) {
  test::Random random{7};
  std::vector<Splat> splats;
  for (int i = 0; i < count; ++i) {
    const float radius = 12.0f * random.unit() * random.unit();
    const auto cell = static_cast<float>(splat_cell_px(radius));
    splats.push_back({static_cast<float>(width + 20) * random.unit() - 10.0f,
                      static_cast<float>(height + 20) * random.unit() - 10.0f,
                      0.1f + random.unit(),
                      radius,
                      cell * cell,
                      static_cast<std::uint32_t>(3.0f * random.unit()),
                      {random.unit(), random.unit(), 4.0f * random.unit()}});
  }
  return splats;
}

// Every splat at one pixel, in the order of the header.
glm::vec3 composited(std::span<const Splat> splats, glm::vec3 background, int x, int y) {
  std::vector<std::size_t> order(splats.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return splats[a].inverse_depth > splats[b].inverse_depth;
  });
  double rests[] = {1.0, 1.0, 1.0}, open = 1.0;
  glm::dvec3 sum{0.0};
  for (const std::size_t i : order) {
    const Splat& splat = splats[i];
    const Footprint footprint = footprint_of(splat);
    const double dx = x + 0.5 - static_cast<double>(splat.x_px);
    const double dy = y + 0.5 - static_cast<double>(splat.y_px);
    const double reach = static_cast<double>(footprint.reach_px);
    double weight = 0.0;
    if (footprint.inverse_2v == 0.0f) {
      weight = static_cast<int>(std::floor(splat.x_px)) == x &&
                       static_cast<int>(std::floor(splat.y_px)) == y
                   ? 1.0
                   : 0.0;
    } else if (std::fabs(dx) <= reach && std::fabs(dy) <= reach) {
      weight = static_cast<double>(footprint.opacity) *
               std::exp(-(dx * dx + dy * dy) * static_cast<double>(footprint.inverse_2v));
    }
    double& rest = rests[splat.surface];
    const double taken = std::min(weight, rest);
    if (!(taken > 0.0)) continue;
    const double share = open * (taken / rest);
    sum += glm::dvec3{splat.colour} * share;
    open -= share;
    rest -= taken;
  }
  return open < 1.0 - 0x1p-10 ? glm::vec3{sum / (1.0 - open)} : background;
}

}  // namespace

TEST_CASE("surface-splatting: exp is right to 3e-6") {
  for (int i = 0; i <= 450; ++i) {
    const float t = 0.01f * static_cast<float>(i);
    CHECK(falling_exponential(t) ==
          doctest::Approx(std::exp(-static_cast<double>(t))).epsilon(3e-6));
  }
}

TEST_CASE("surface-splatting: the tiles' picture is the composition of all splats at each pixel") {
  const int width = 53, height = 41;
  const std::vector<Splat> splats = random_splats(900, width, height);
  const glm::vec3 background{0.25f, 0.5f, 0.0f};
  const Image depth = make_image(Format::rgba16f, width, height);
  ThreadPool scalar{1, Isa::scalar};
  const Image expected = draw_splats(splats, 3, background, depth, Profile{}, scalar);
  double worst = 0.0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const glm::vec3 oracle = composited(splats, background, x, y);
      const glm::vec4 got = load_texel(expected, x, y);
      for (int c = 0; c < 3; ++c) {
        worst = std::max(worst, static_cast<double>(std::fabs(got[c] - oracle[c])));
      }
    }
  }
  CHECK(worst < 0.003);  // a half is off by 2^-9 at 4
  for (const Isa isa : available_isas()) {
    for (const int threads : {1, 3}) {
      ThreadPool pool{threads, isa};
      CHECK(equal(draw_splats(splats, 3, background, depth, Profile{}, pool), expected));
    }
  }
}

TEST_CASE("surface-splatting: what lies in the plane of focus is as the pinhole has it") {
  ThreadPool pool{2};
  const Scene scene = square_scene(test::kTestLens.focus_m, 0.8);
  const Drawn drawn = splatted(scene, 65, 65, pool);
  CHECK(equal(drawn.sampled.picture, drawn.pinhole));
}

TEST_CASE("surface-splatting: holes in the plane of focus are as the pinhole has them") {
  ThreadPool pool{2};
  const Scene scene = test::lattice_scene(test::kTestLens.focus_m, 0.8);
  const Drawn drawn = splatted(scene, 65, 65, pool);
  CHECK(equal(drawn.sampled.picture, drawn.pinhole));
  CHECK(load_texel(drawn.pinhole, 26, 26).x == 1.0f);
  CHECK(load_texel(drawn.pinhole, 26, 36).x == 0.0f);
}

TEST_CASE(
    "surface-splatting: with a tiny aperture it is the pinhole's picture, textures included") {
  ThreadPool pool{2};
  for (const char* name : {"near-fence", "cube-room", "canopy"}) {
    const Scene scene = load_scene(name, scene_search_path({}));
    ThinLens lens = scene.lens.lens;
    lens.f_number = 100000.0;
    const Drawn drawn = splatted(scene, 128, 96, pool, lens);
    int off = 0;
    for (int y = 0; y < 96; ++y) {
      for (int x = 0; x < 128; ++x) {
        const glm::vec4 a = load_texel(drawn.pinhole, x, y);
        const glm::vec4 b = load_texel(drawn.sampled.picture, x, y);
        off += std::fabs(a.x - b.x) + std::fabs(a.y - b.y) + std::fabs(a.z - b.z) > 0.02f;
      }
    }
    INFO(name);
    CHECK(off < 128 * 96 / 100);
  }
}

TEST_CASE("surface-splatting: a point keeps its light, over the lens's second moment") {
  ThreadPool pool{2};
  constexpr int kSize = 128;
  const double tangent = std::tan(20.0 * 3.14159265358979323846 / 180.0);
  for (const double depth_m : {1.0, 8.0}) {
    for (const double point_px : {2.0, 8.0}) {
      const Scene scene = square_scene(depth_m, point_px * 2.0 * depth_m * tangent / kSize);
      const test::Moments m = test::moments(splatted(scene, kSize, kSize, pool).sampled.picture);
      const double radius = std::fabs(
          coc_radius_px(pixel_coc(test::kTestLens, 40.0, kSize, 1.0), static_cast<float>(depth_m)));
      const double point = point_px * point_px / 12.0;
      CAPTURE(depth_m);
      CAPTURE(point_px);
      CHECK(2.0 * std::sqrt(m.variance_x - point) == doctest::Approx(radius).epsilon(0.03));
      CHECK(2.0 * std::sqrt(m.variance_y - point) == doctest::Approx(radius).epsilon(0.03));
      CHECK(m.sum == doctest::Approx(point_px * point_px).epsilon(0.02));
      CHECK(std::fabs(m.x - kSize / 2.0) < 0.1);
      CHECK(std::fabs(m.y - kSize / 2.0) < 0.1);
    }
  }
}

TEST_CASE("surface-splatting: one sees through a blurred thin bar what lies behind it") {
  ThreadPool pool{2};
  constexpr int kSize = 128;
  // A white wall in focus, and before it a black bar, blurred by much more than it is wide.
  Scene scene = square_scene(2.0, 4.0);
  const double tangent = std::tan(20.0 * 3.14159265358979323846 / 180.0);
  constexpr double kBarPx = 4.0;
  Object bar = scene.objects[0];
  bar.position = {0.0, 0.0, 1.0};
  bar.scale = {kBarPx * 2.0 * tangent / kSize, 3.0, 1.0};
  bar.material = 1;
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].diffuse = glm::vec3{0.0f};
  scene.objects.push_back(bar);
  const Drawn drawn = splatted(scene, kSize, kSize, pool);
  CHECK(load_texel(drawn.pinhole, kSize / 2, kSize / 2).x == 0.0f);
  const double radius =
      std::fabs(coc_radius_px(pixel_coc(test::kTestLens, 40.0, kSize, 1.0), 1.0f));
  const double sigma = radius / 2.0;
  CHECK(radius > 2.0 * kBarPx);
  for (const int x : {64, 70, 80, 100}) {
    const double from = (x + 0.5 - 64.0 - kBarPx / 2.0) / (sigma * std::sqrt(2.0));
    const double to = (x + 0.5 - 64.0 + kBarPx / 2.0) / (sigma * std::sqrt(2.0));
    const double hidden = 0.5 * (std::erf(to) - std::erf(from));
    CAPTURE(x);
    CHECK(std::fabs(load_texel(drawn.sampled.picture, x, 64).x - (1.0 - hidden)) < 0.015);
  }
}

TEST_CASE("surface-splatting: an unbroken blurred wall lets nothing through") {
  ThreadPool pool{2};
  Scene scene = square_scene(6.0, 100.0);
  scene.background = glm::vec3{1000.0f};
  const Drawn drawn = splatted(scene, 96, 64, pool);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      CHECK(load_texel(drawn.sampled.picture, x, y).x == doctest::Approx(1.0).epsilon(0.001));
    }
  }
}

TEST_CASE("surface-splatting: the points of an unbroken surface stand for each pixel once") {
  ThreadPool pool{2};
  const Scene scene = square_scene(6.0, 100.0);
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, 96, 64);
  const Image pinhole = draw_scene(scene, camera, 0.0, 96, 64, Profile{}, pool);
  const std::vector<Splat> splats = surface_splats(
      {scene, camera, 0.0, pinhole, 2.0, aperture_radius_m(test::kTestLens, 1.0), {}, {}, {}},
      pool);
  double inside = 0.0;
  for (const Splat& splat : splats) {
    const bool in = splat.x_px > 0 && splat.x_px < 96 && splat.y_px > 0 && splat.y_px < 64;
    if (in && splat.surface == 0) inside += static_cast<double>(splat.area_px);
  }
  CHECK(inside == 96 * 64);
}

TEST_CASE("surface-splatting: the same bits for any number of threads and on every vector unit" *
          doctest::test_suite("threads")) {
  const Scene scene = load_scene("figures", scene_search_path({}));
  ThreadPool one{1};
  const Image expected = splatted(scene, 150, 70, one, scene.lens.lens).sampled.picture;
  for (const int threads : {2, 3}) {
    ThreadPool pool{threads};
    CHECK(equal(splatted(scene, 150, 70, pool, scene.lens.lens).sampled.picture, expected));
  }
  for (const Isa isa : available_isas()) {
    ThreadPool pool{1, isa};
    CHECK(equal(splatted(scene, 150, 70, pool, scene.lens.lens).sampled.picture, expected));
  }
}
