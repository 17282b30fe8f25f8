// scatter-aperture: where all depths are equal it is the convolution with the aperture.

#include "dof/scatter/aperture_scatter.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kHeightsOfPixel = 2048;

/// The ends of a row at a height `y`, down, of a circle of `radius`, by the aperture's half-planes.
struct Chord {
  double left = -1e9, right = 1e9;
};
Chord chord(const Aperture& aperture, bool upside_down, double radius, double y) {
  const double stretch = static_cast<double>(aperture.stretch);
  const double across = radius * std::fmin(1.0, 1.0 / stretch);
  const double up = -y / (radius * std::fmin(1.0, stretch)) * (upside_down ? -1.0 : 1.0);
  Chord of_unit;
  if (aperture.blades == 0) {
    const double half = std::fabs(up) < 1.0 ? std::sqrt(1.0 - up * up) : -1.0;
    of_unit = {-half, half};
  }
  for (int i = 0; i < aperture.blades; ++i) {
    // Between two corners, the first of them up: x cos + up sin <= cos(pi / blades).
    const double angle = kPi * (0.5 + static_cast<double>(aperture.turn_degrees) / 180.0 +
                                (2.0 * i + 1.0) / aperture.blades);
    const double c = std::cos(angle), room = std::cos(kPi / aperture.blades) - up * std::sin(angle);
    if (std::fabs(c) < 1e-12) {
      if (room < 0.0) return {1.0, -1.0};
    } else if (c > 0.0) {
      of_unit.right = std::fmin(of_unit.right, room / c);
    } else {
      of_unit.left = std::fmax(of_unit.left, room / c);
    }
  }
  if (upside_down) of_unit = {-of_unit.right, -of_unit.left};
  return {across * of_unit.left, across * of_unit.right};
}

/// The covers of the pixels (2 reach + 1)^2 around.
std::vector<double> covers_of(const Aperture& aperture, bool upside_down, double radius,
                              int reach) {
  const int side = 2 * reach + 1;
  std::vector<double> covers(static_cast<std::size_t>(side * side));
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int i = 0; i < kHeightsOfPixel; ++i) {
      const Chord at = chord(aperture, upside_down, radius, dy - 0.5 + (i + 0.5) / kHeightsOfPixel);
      for (int dx = -reach; dx <= reach; ++dx) {
        covers[static_cast<std::size_t>((dy + reach) * side + dx + reach)] +=
            std::fmax(0.0, std::fmin(at.right, dx + 0.5) - std::fmax(at.left, dx - 0.5)) /
            kHeightsOfPixel;
      }
    }
  }
  return covers;
}

/// The largest difference from the sum that the definition asks for, of a picture whose circles all
/// have one signed radius, beyond what the halves of the result round away.
double error_of(const Aperture& aperture, float radius) {
  constexpr int kSide = 40;
  Image scene = random_scene_image(kSide, kSide, 7);
  // About 0, where halves are fine.
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      store_texel(scene, x, y, load_texel(scene, x, y) - glm::vec4{0.5f, 0.5f, 0.5f, 0.0f}, {});
    }
  }
  // r = 64 (z - 2) / z, of a depth that halves have: so the radius is near the one asked for.
  set_depth(scene, [&](int, int) { return 128.0f / (64.0f - radius); });
  const DofSettings settings{.coc = {64.0f, 2.0f}, .max_coc_px = 64.0f, .aperture = aperture};
  const double used = static_cast<double>(coc_radius_px(settings.coc, load_texel(scene, 0, 0).w));
  Image result = make_image(scene.format, kSide, kSide);
  ThreadPool pool(2);
  scatter_aperture({scene, settings, {}}, result, pool);

  const int reach = static_cast<int>(std::ceil(std::fabs(used) + 0.5));
  const std::vector<double> covers = covers_of(aperture, used < 0.0, std::fabs(used), reach);
  double largest = 0.0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      double sum = 0.0, weight = 0.0;
      for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          const int from_x = x - dx, from_y = y - dy;
          if (from_x < 0 || from_y < 0 || from_x >= kSide || from_y >= kSide) continue;
          const double cover =
              covers[static_cast<std::size_t>((dy + reach) * (2 * reach + 1) + dx + reach)];
          sum += cover * static_cast<double>(load_texel(scene, from_x, from_y).x);
          weight += cover;
        }
      }
      const double expected = sum / weight;
      const double error = std::fabs(static_cast<double>(load_texel(result, x, y).x) - expected);
      largest = std::max(largest, error - std::fabs(expected) * 0x1p-11);
    }
  }
  return largest;
}

}  // namespace

TEST_CASE("scatter-aperture: where depth is constant it is the disc, within 1e-4, of any radius") {
  for (const float radius : {0.3f, 0.6f, 0.9f, 1.4f, 2.7f, 5.3f, -3.3f, 8.9f, -13.1f, 23.7f}) {
    CAPTURE(radius);
    CHECK(error_of({}, radius) < 1e-4);
  }
}

TEST_CASE("scatter-aperture: blades, their turn and a stretch likewise") {
  for (const Aperture& aperture :
       {Aperture{3, 0.0f, 1.0f}, Aperture{5, 13.0f, 1.0f}, Aperture{6, -20.0f, 1.5f},
        Aperture{0, 0.0f, 2.0f}, Aperture{0, 0.0f, 0.5f}, Aperture{7, 90.0f, 0.7f},
        Aperture{4, 45.0f, 1.0f}, Aperture{16, 1.0f, 1.0f}}) {
    for (const float radius : {4.6f, -7.8f, 15.2f}) {
      CAPTURE(aperture.blades);
      CAPTURE(aperture.stretch);
      CAPTURE(radius);
      CHECK(error_of(aperture, radius) < 1e-4);
    }
  }
}

TEST_CASE("scatter-aperture: a triangle points up behind the focus, and down before it") {
  ThreadPool pool(1);
  const DofSettings settings{.coc = {16.0f, 2.0f}, .max_coc_px = 16.0f, .aperture = {.blades = 3}};
  for (const float depth_m : {4.0f, 4.0f / 3.0f}) {  // radii of 8 and -8
    Image scene = make_image(Format::rgba16f, 41, 41);
    set_depth(scene, [&](int, int) { return depth_m; });
    store_texel(scene, 20, 20, {1000.0f, 1000.0f, 1000.0f, depth_m}, {});
    Image result = make_image(scene.format, 41, 41);
    scatter_aperture({scene, settings, {}}, result, pool);
    const auto light_in = [&](int from, int to) {
      double light = 0.0;
      for (int y = from; y <= to; ++y) {
        for (int x = 0; x < 41; ++x) light += static_cast<double>(load_texel(result, x, y).x);
      }
      return light;
    };
    // The centre of the circle lies at a third of the height.
    const double above = light_in(0, 15), below = light_in(25, 40);
    CHECK((depth_m > 2.0f) == (below < above));
    CHECK((depth_m > 2.0f) == (light_in(25, 40) == 0.0));
  }
}

TEST_CASE("scatter-aperture: the same bits on every vector unit, by any number of threads") {
  const Image scene = random_scene_image(71, 53, 8);
  const DofSettings settings{.coc = {12.0f, 2.0f},
                             .max_coc_px = 9.5f,
                             .aperture = {.blades = 5, .turn_degrees = 10.0f, .stretch = 1.3f}};
  ThreadPool one(1, Isa::scalar);
  Image expected = make_image(scene.format, scene.width, scene.height);
  scatter_aperture({scene, settings, {}}, expected, one);
  for (const Isa isa : available_isas()) {
    ThreadPool pool(3, isa);
    Image actual = random_scene_image(scene.width, scene.height, 99);
    scatter_aperture({scene, settings, {}}, actual, pool);
    CAPTURE(std::string{isa_name(isa)});
    CHECK(equal(actual, expected));
  }
}

TEST_CASE("an aperture of 2 blades, of an infinite turn or stretch is none") {
  CHECK(aperture_error({}) == nullptr);
  CHECK(aperture_error({.blades = 64, .turn_degrees = -360.0f, .stretch = 16.0f}) == nullptr);
  CHECK(aperture_error({.blades = 2}) != nullptr);
  CHECK(aperture_error({.blades = 65}) != nullptr);
  CHECK(aperture_error({.turn_degrees = 1e30f * 1e30f}) != nullptr);
  CHECK(aperture_error({.stretch = 0.0f}) != nullptr);
}
