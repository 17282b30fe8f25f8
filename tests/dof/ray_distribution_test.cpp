#include "dof/ray_distribution/ray_distribution.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "dof/ray_distribution/behind.h"
#include "raster/images/texel.h"
#include "tests/support/method_checks.h"
#include "tests/support/sanitizers.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

Image filtered(const Image& scene, const DofSettings& settings, ThreadPool& pool) {
  Image result = make_image(Format::rgba16f, scene.width, scene.height);
  ray_distribution({scene, settings, {}}, result, pool);
  return result;
}

struct Size {
  int width, height;
};

// A plane of the buffer, as ray_distribution.h says it: green alone.
struct Plane {
  int width, height;
  std::vector<float> radius, green;
};

// Adds the pixels of a picture to a plane where they are nearer; its border is repeated.
void add_pixels(const Planes& pixels, LensPoint lens, int border, Plane& plane) {
  const auto at = [&](int c, int x, int y) {
    return plane_row(pixels, c,
                     std::clamp(y, 0, pixels.height - 1))[std::clamp(x, 0, pixels.width - 1)];
  };
  const auto shift = [](float radius, float axis) {
    return static_cast<int>(std::nearbyint(radius * axis));
  };
  for (int y = -border; y < pixels.height + border; ++y) {
    for (int x = -border; x < pixels.width + border; ++x) {
      const float radius = at(3, x, y);
      if (radius == kNothingBehind) continue;
      const auto cells_to = [&](int dx, int dy, float axis) {
        const float other = at(3, x + dx, y + dy);
        return std::fabs(other - radius) <= kSurfaceStep &&
               std::abs(dx + dy + shift(other, axis) - shift(radius, axis)) == 2;
      };
      const int to_x = x + shift(radius, lens.u), to_y = y + shift(radius, lens.v);
      for (int cell_y = to_y - cells_to(0, -1, lens.v); cell_y <= to_y + cells_to(0, 1, lens.v);
           ++cell_y) {
        for (int cell_x = to_x - cells_to(-1, 0, lens.u); cell_x <= to_x + cells_to(1, 0, lens.u);
             ++cell_x) {
          if (cell_x < 0 || cell_y < 0 || cell_x >= plane.width || cell_y >= plane.height) continue;
          const auto cell = static_cast<std::size_t>(cell_y * plane.width + cell_x);
          if (!(radius < plane.radius[cell])) continue;
          plane.radius[cell] = radius;
          plane.green[cell] = at(1, x, y);
        }
      }
    }
  }
}

std::vector<float> oracle(const Image& scene, const DofSettings& settings, ThreadPool& pool) {
  const Planes visible = split_picture({scene, settings, {}}, pool);
  const Planes hidden = guess_behind(visible, pool).pixels;
  const std::vector<float> rows = largest_of_rows(visible, 3, pool);
  const float largest = *std::max_element(rows.begin(), rows.end());
  const int border = std::min((static_cast<int>(largest) + 16) / 16 * 16, 64);
  const auto pixels = static_cast<std::size_t>(scene.width * scene.height);
  std::vector<float> sum(pixels, 0.0f), count(pixels, 0.0f);
  const float empty = std::numeric_limits<float>::infinity();
  for (const LensPoint lens : distribution_points(largest)) {
    Plane seen{scene.width, scene.height, std::vector<float>(pixels, empty),
               std::vector<float>(pixels)};
    Plane behind = seen;
    add_pixels(visible, lens, border, seen);
    add_pixels(hidden, lens, border, behind);
    for (std::size_t i = 0; i < pixels; ++i) {
      const Plane& plane = seen.radius[i] < empty ? seen : behind;
      if (plane.radius[i] == empty) continue;
      sum[i] += plane.green[i];
      count[i] += 1.0f;
    }
  }
  for (std::size_t i = 0; i < pixels; ++i) {
    const int x = static_cast<int>(i) % scene.width, y = static_cast<int>(i) / scene.width;
    sum[i] = count[i] > 0.0f ? sum[i] / count[i] : plane_row(visible, 1, y)[x];
  }
  return sum;
}

// Depths that make slopes, steps and single pixels.
Image rugged_picture(int width, int height) {
  Image scene = random_scene_image(width, height, 11);
  set_depth(scene, [](int x, int y) {
    if (x % 13 == 4 && y % 7 == 2) return 0.8f;
    const int step = y / 20;
    return 1.1f + 0.02f * static_cast<float>(x) + 0.9f * static_cast<float>(step);
  });
  return scene;
}

}  // namespace

TEST_CASE("a ray distribution buffer is its oracle to the bit, on every vector unit") {
  for (const Size size : {Size{1, 1}, {3, 50}, {45, 40}, {130, 34}}) {
    const int width = size.width, height = size.height;
    for (const bool rugged : {true, false}) {
      const Image scene =
          rugged ? rugged_picture(width, height) : random_scene_image(width, height, 12);
      for (const float max_coc : {0.0f, 1.2f, 9.0f, 70.0f}) {
        if (kHasSanitizers && max_coc > 9.0f && width > 3) continue;
        const DofSettings settings{.coc = {14.0f, 2.0f}, .max_coc_px = max_coc};
        ThreadPool one(1);
        const std::vector<float> expected = oracle(scene, settings, one);
        for (const Isa isa : available_isas()) {
          ThreadPool pool(3, isa);
          const Image result = filtered(scene, settings, pool);
          Image wanted = result;
          int wrong = 0;
          for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
              glm::vec4 texel = load_texel(result, x, y);
              texel.y = expected[static_cast<std::size_t>(y * width + x)];
              store_texel(wanted, x, y, texel, {});
              wrong += load_texel(wanted, x, y).y != load_texel(result, x, y).y;
            }
          }
          INFO(std::string{isa_name(isa)}, ", ", width, "x", height, ", max_coc ", max_coc);
          CHECK(wrong == 0);
        }
      }
    }
  }
}

TEST_CASE("points of the lens come in pairs and have a disc's second moment") {
  for (const float largest : {1.0f, 4.0f, 20.0f, 100.0f}) {
    const std::vector<LensPoint> points = distribution_points(largest);
    double square = 0.0, across = 0.0;
    for (std::size_t i = 0; i < points.size(); i += 2) {
      CHECK(points[i].u == -points[i + 1].u);
      CHECK(points[i].v == -points[i + 1].v);
      square += 2.0 * (points[i].u * points[i].u + points[i].v * points[i].v);
      across += 2.0 * (points[i].u * points[i].u);
    }
    const auto count = static_cast<double>(points.size());
    CHECK(square / count == doctest::Approx(0.5).epsilon(1e-5));
    CHECK(across / count == doctest::Approx(0.25).epsilon(0.03));
  }
}

TEST_CASE("behind a wire before a post before a wall lies the post") {
  ThreadPool pool(2);
  // Radii -12 and -6 before a wall in focus.
  const Image scene = grey_depth_picture(96, 64, [](int x, int y) {
    if (y == 30) return std::pair{0.0f, 2.0f / 2.2f};
    return x >= 32 && x < 64 ? std::pair{0.5f, 2.0f / 1.6f} : std::pair{1.0f, 2.0f};
  });
  const Planes planes =
      split_picture({scene, {.coc = {10.0f, 2.0f}, .max_coc_px = 16.0f}, {}}, pool);
  const Behind behind = guess_behind(planes, pool);
  CHECK(plane_row(behind.pixels, 1, 30)[48] == 0.5f);
  CHECK(plane_row(behind.pixels, 3, 30)[48] == doctest::Approx(-6.0).epsilon(0.01));
  CHECK(plane_row(behind.pixels, 1, 30)[8] == 1.0f);
  CHECK(plane_row(behind.pixels, 3, 30)[8] == 0.0f);
  CHECK(plane_row(behind.pixels, 1, 10)[34] == 1.0f);
  // Nothing is behind the wall.
  CHECK(plane_row(behind.pixels, 3, 10)[8] == kNothingBehind);
}

TEST_CASE("a flat picture hides nothing") {
  ThreadPool pool(2);
  Image scene = random_scene_image(70, 40, 13);
  set_depth(scene, [](int x, int) { return 3.0f + 0.01f * static_cast<float>(x); });
  const Planes planes =
      split_picture({scene, {.coc = {10.0f, 2.0f}, .max_coc_px = 16.0f}, {}}, pool);
  const Behind behind = guess_behind(planes, pool);
  CHECK(std::count(behind.seen.set.begin(), behind.seen.set.end(), 0) ==
        static_cast<std::ptrdiff_t>(behind.seen.set.size()));
}

TEST_CASE("a ray distribution buffer blurs a near edge on both sides") {
  test::check_soft_near_edge([](const DofInput& input, Image& result,
                                ThreadPool& pool) { ray_distribution(input, result, pool); },
                             0.03);
}

TEST_CASE("a near slope hides what is behind it, and has no gaps") {
  ThreadPool pool(2);
  // A black wall with a white slope before it that a lens spreads, from radius -1 to -24.
  const Image scene = grey_depth_picture(96, 96, [](int, int y) {
    return y < 20 ? std::pair{0.0f, 2.0f}
                  : std::pair{1.0f, 2.0f / (2.05f + 0.015f * static_cast<float>(y - 20))};
  });
  const DofSettings settings{.coc = {20.0f, 2.0f}, .max_coc_px = 32.0f};
  const Image result = filtered(scene, settings, pool);
  for (int y = 60; y < 96; ++y) CHECK(load_texel(result, 48, y).x == 1.0f);
}

TEST_CASE("a thin near bar lets what is around it shine through a ray distribution buffer") {
  ThreadPool pool(2);
  const Image scene = grey_depth_picture(96, 64, [](int x, int) {
    return x >= 46 && x < 51 ? std::pair{0.0f, 1.0f} : std::pair{1.0f, 2.0f};
  });
  const DofSettings settings{.coc = {10.0f, 2.0f}, .max_coc_px = 16.0f};
  // 5 / (10 pi / 2) of a disc's light, by its middle.
  CHECK(load_texel(filtered(scene, settings, pool), 48, 32).x ==
        doctest::Approx(1.0 - 0.315).epsilon(0.05));
}
