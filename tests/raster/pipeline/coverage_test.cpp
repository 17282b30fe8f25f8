// Which pixels a triangle covers, through the whole draw call.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "raster/images/texel.h"
#include "raster/pipeline/draw.h"
#include "raster/pipeline/setup.h"
#include "tests/support/coverage_counts.h"

using namespace softfocus;
using test::count_at;
using test::count_coverage;
using test::pixels_not_covered_once;
using test::profile_named;
using test::Vertices;
using test::window_quad;
using test::window_triangles;
using test::wrong_pixels;

namespace {

// A triangle from a centre to each side of a ring of points.
Vertices fan(glm::vec2 centre, float radius, int spokes, int width, int height) {
  std::vector<glm::vec2> points;
  const auto ring = [&](int i) {
    const double angle = 2.0 * 3.14159265358979 * (i % spokes + 0.3) / spokes;
    return glm::vec2{centre.x + radius * static_cast<float>(std::cos(angle)),
                     centre.y + radius * static_cast<float>(std::sin(angle))};
  };
  for (int i = 0; i < spokes; ++i) {
    points.insert(points.end(), {centre, ring(i), ring(i + 1)});
  }
  return window_triangles(points, width, height);
}

// A grid of quadrangles, each two triangles, whose inner vertices are moved at random, with
// varying w; it covers (low, low) to (high, high) in window coordinates.
Vertices jittered_grid(int cells, float low, float high, int width, int height,
                       test::Random& random) {
  const float side = (high - low) / static_cast<float>(cells);
  std::vector<glm::vec4> points;
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const bool on_border = i == 0 || j == 0 || i == cells || j == cells;
      const float jitter = on_border ? 0.0f : 0.2f * side;
      const glm::vec2 window{
          low + side * static_cast<float>(i) + random.between(-1.0f, 1.0f) * jitter,
          low + side * static_cast<float>(j) + random.between(-1.0f, 1.0f) * jitter};
      points.push_back(test::at_window(window, width, height) * random.between(0.5f, 3.0f));
    }
  }
  Vertices vertices;
  const auto add = [&](int i, int j) {
    vertices.push_back({points[static_cast<std::size_t>(j * (cells + 1) + i)], {}});
  };
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const bool falling = random.whole(0, 1) == 0;
      // Either diagonal, and either winding.
      const std::array<std::array<int, 2>, 4> c{{{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
      const std::array<std::size_t, 6> order = falling
                                                   ? std::array<std::size_t, 6>{0, 1, 2, 0, 3, 2}
                                                   : std::array<std::size_t, 6>{1, 2, 3, 3, 1, 0};
      for (const std::size_t k : order) add(c[k][0], c[k][1]);
    }
  }
  return vertices;
}

}  // namespace

TEST_CASE("a fan of triangles covers each pixel around its centre once, wherever that lies") {
  test::Random random{71};
  int wrong = 0;
  for (const glm::vec2 centre : {glm::vec2{32.5f, 32.5f},
                                 {32.0f, 32.0f},
                                 {32.5f, 32.0f},
                                 {0.0f, 0.0f},
                                 {64.0f, 0.5f},
                                 {31.99f, 32.51f}}) {
    for (const int spokes : {3, 4, 8, 37, 200}) {
      wrong += pixels_not_covered_once(count_coverage(fan(centre, 200.0f, spokes, 64, 64), 64, 64));
    }
  }
  for (int i = 0; i < 30; ++i) {
    const glm::vec2 centre{random.between(0.0f, 64.0f), random.between(0.0f, 64.0f)};
    wrong += pixels_not_covered_once(
        count_coverage(fan(centre, 200.0f, random.whole(3, 60), 64, 64), 64, 64));
  }
  CHECK(wrong == 0);
}

TEST_CASE("a fan that reaches past the guard band covers each pixel once, in every profile") {
  test::Random random{72};
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    int wrong = 0;
    for (const float radius : {200.0f, 1'000.0f, 30'000.0f}) {
      for (int i = 0; i < 10; ++i) {
        const glm::vec2 centre{random.between(0.0f, 64.0f), random.between(0.0f, 64.0f)};
        wrong += pixels_not_covered_once(
            count_coverage(fan(centre, radius, random.whole(3, 60), 64, 64), 64, 64, profile));
      }
    }
    CHECK_MESSAGE(wrong == 0, known.name);
  }
}

TEST_CASE("a jittered grid of shared edges covers each pixel once") {
  test::Random random{73};
  int wrong = 0;
  for (int i = 0; i < 10; ++i) {
    for (const int cells : {3, 17, 60}) {
      wrong += pixels_not_covered_once(
          count_coverage(jittered_grid(cells, -9.0f, 137.0f, 128, 128, random), 128, 128));
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a jittered grid through the guard band covers each pixel once, in every profile") {
  test::Random random{74};
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    int wrong = 0;
    for (int i = 0; i < 5; ++i) {
      for (const int cells : {3, 17, 60}) {
        const float margin = 64.0f * (profile.guard_band + 2.0f);
        wrong += pixels_not_covered_once(
            count_coverage(jittered_grid(cells, 64.0f - margin, 64.0f + margin, 128, 128, random),
                           128, 128, profile));
      }
    }
    CHECK_MESSAGE(wrong == 0, known.name);
  }
}

TEST_CASE("a jittered grid of cells smaller than a pixel covers each pixel once") {
  test::Random random{75};
  CHECK(pixels_not_covered_once(
            count_coverage(jittered_grid(150, -1.0f, 33.0f, 32, 32, random), 32, 32)) == 0);
}

TEST_CASE(
    "a quad from pixel centre to pixel centre covers its upper and left rims, not the others") {
  for (const bool reversed : {false, true}) {
    std::vector<glm::vec2> points = window_quad(2.5f, 3.5f, 6.5f, 8.5f);
    if (reversed) std::reverse(points.begin(), points.end());
    const Image counts = count_coverage(window_triangles(points, 16, 16), 16, 16);
    CHECK(wrong_pixels(counts, [](int x, int y) { return x >= 2 && x < 6 && y >= 3 && y < 8; }) ==
          0);
  }
}

TEST_CASE("a quad from pixel corner to pixel corner covers the pixels within") {
  const Image counts = count_coverage(window_triangles(window_quad(2, 3, 6, 8), 16, 16), 16, 16);
  CHECK(wrong_pixels(counts, [](int x, int y) { return x >= 2 && x < 6 && y >= 3 && y < 8; }) == 0);
}

TEST_CASE("moving a quad by 1/256 pixel over pixel centres moves its rims by a pixel") {
  const float step = 1.0f / 256.0f;
  const auto covered = [&](float by) {
    return count_coverage(
        window_triangles(window_quad(2.5f + by, 3.5f + by, 6.5f + by, 8.5f + by), 16, 16), 16, 16);
  };
  CHECK(wrong_pixels(covered(step),
                     [](int x, int y) { return x >= 3 && x < 7 && y >= 4 && y < 9; }) == 0);
  CHECK(wrong_pixels(covered(-step),
                     [](int x, int y) { return x >= 2 && x < 6 && y >= 3 && y < 8; }) == 0);
}

TEST_CASE("with the lower-left rule that quad covers its lower and left rims, not the others") {
  Profile profile;
  profile.fill_rule = FillRule::lower_left;
  for (const bool reversed : {false, true}) {
    std::vector<glm::vec2> points = window_quad(2.5f, 3.5f, 6.5f, 8.5f);
    if (reversed) std::reverse(points.begin(), points.end());
    const Image counts = count_coverage(window_triangles(points, 16, 16), 16, 16, profile);
    CHECK(wrong_pixels(counts, [](int x, int y) { return x >= 2 && x < 6 && y >= 4 && y < 9; }) ==
          0);
  }
}

TEST_CASE("with 4 subpixel bits a quad moves in steps of 1/16 pixel") {
  Profile profile;
  profile.subpixel_bits = 4;
  const auto covered = [&](float by) {
    return count_coverage(
        window_triangles(window_quad(2.5f + by, 3.5f + by, 6.5f + by, 8.5f + by), 16, 16), 16, 16,
        profile);
  };
  const auto unmoved = [](int x, int y) { return x >= 2 && x < 6 && y >= 3 && y < 8; };
  const auto moved = [](int x, int y) { return x >= 3 && x < 7 && y >= 4 && y < 9; };
  CHECK(wrong_pixels(covered(1.0f / 256.0f), unmoved) == 0);
  CHECK(wrong_pixels(covered(1.0f / 32.0f), unmoved) == 0);  // halfway: to the even step
  CHECK(wrong_pixels(covered(9.0f / 256.0f), moved) == 0);
  CHECK(wrong_pixels(covered(1.0f / 16.0f), moved) == 0);
}

TEST_CASE("with any subpixel bits and fill rule shared edges cover each pixel once") {
  test::Random random{80};
  for (int bits = 4; bits <= 8; ++bits) {
    Profile profile;
    profile.subpixel_bits = bits;
    for (const FillRule rule : {FillRule::upper_left, FillRule::lower_left}) {
      profile.fill_rule = rule;
      CHECK(pixels_not_covered_once(count_coverage(jittered_grid(40, -9.0f, 73.0f, 64, 64, random),
                                                   64, 64, profile)) == 0);
      CHECK(pixels_not_covered_once(
                count_coverage(fan({32.5f, 32.5f}, 200.0f, 37, 64, 64), 64, 64, profile)) == 0);
    }
  }
}

TEST_CASE("scanlines of shared edges cover each pixel once") {
  test::Random random{81};
  int wrong = 0;
  for (int i = 0; i < 20; ++i) {
    const int cells = random.whole(3, 60);
    wrong += pixels_not_covered_once(count_coverage(
        jittered_grid(cells, 0.0f, 128.0f, 128, 128, random), 128, 128, profile_named("softpipe")));
  }
  CHECK(wrong == 0);
}

TEST_CASE("a point on a left edge belongs to the triangle") {
  const Image counts = count_coverage(
      window_triangles(std::array<glm::vec2, 3>{{{4.5f, 1.0f}, {12.0f, 8.0f}, {4.5f, 15.0f}}}, 16,
                       16),
      16, 16);
  CHECK(count_at(counts, 4, 8) == 1.0f);
}

TEST_CASE("a point on a right edge does not belong to the triangle") {
  const Image counts = count_coverage(
      window_triangles(std::array<glm::vec2, 3>{{{11.5f, 1.0f}, {4.0f, 8.0f}, {11.5f, 15.0f}}}, 16,
                       16),
      16, 16);
  CHECK(count_at(counts, 11, 8) == 0.0f);
  CHECK(count_at(counts, 10, 8) == 1.0f);
}

TEST_CASE("a point on a level upper edge belongs to the triangle, on a level lower edge not") {
  const Image upper = count_coverage(
      window_triangles(std::array<glm::vec2, 3>{{{1.0f, 4.5f}, {15.0f, 4.5f}, {8.0f, 12.0f}}}, 16,
                       16),
      16, 16);
  CHECK(count_at(upper, 8, 4) == 1.0f);
  const Image lower = count_coverage(
      window_triangles(std::array<glm::vec2, 3>{{{1.0f, 11.5f}, {15.0f, 11.5f}, {8.0f, 4.0f}}}, 16,
                       16),
      16, 16);
  CHECK(count_at(lower, 8, 11) == 0.0f);
  CHECK(count_at(lower, 8, 10) == 1.0f);
}

TEST_CASE("the four triangles of a square around a pixel's centre cover that pixel once") {
  std::vector<glm::vec2> points;
  const std::array<glm::vec2, 4> corners{
      {{2.5f, 2.5f}, {13.5f, 2.5f}, {13.5f, 13.5f}, {2.5f, 13.5f}}};
  for (std::size_t i = 0; i < 4; ++i) {
    points.insert(points.end(), {{8.5f, 8.5f}, corners[i], corners[(i + 1) % 4]});
  }
  const Image counts = count_coverage(window_triangles(points, 16, 16), 16, 16);
  CHECK(wrong_pixels(counts, [](int x, int y) { return x >= 2 && x < 13 && y >= 2 && y < 13; }) ==
        0);
}

TEST_CASE("triangles without area draw nothing") {
  const std::vector<glm::vec2> points{
      {4.5f, 4.5f}, {4.5f, 4.5f},   {4.5f, 4.5f},    // a point
      {1.0f, 1.0f}, {14.0f, 14.0f}, {1.0f, 1.0f},    // there and back
      {0.5f, 0.5f}, {7.5f, 7.5f},   {15.5f, 15.5f},  // three in line, through centres
      {2.5f, 9.5f}, {8.5f, 9.5f},   {12.5f, 9.5f}};
  const Image counts = count_coverage(window_triangles(points, 16, 16), 16, 16);
  CHECK(wrong_pixels(counts, [](int, int) { return 0; }) == 0);
}

TEST_CASE(
    "facebookresearch/DRTK issue 9: two triangles with a diagonal through centres leave no hole") {
  for (const float shift : {0.0f, 0.5f}) {
    const std::array<glm::vec2, 4> v{{{0.5f, 0.49993896484375f},
                                      {0.5f, 6.5f},
                                      {6.50006103515625f, 0.49993896484375f},
                                      {6.50006103515625f, 6.5f}}};
    for (const bool flipped : {false, true}) {
      std::vector<glm::vec2> points{v[0], v[1], v[2], v[3], v[2], v[1]};
      if (flipped) std::swap(points[4], points[5]);
      for (glm::vec2& p : points) p += shift;
      const Image counts = count_coverage(window_triangles(points, 8, 8), 8, 8);
      const int first = shift == 0.0f ? 0 : 1;
      CHECK(wrong_pixels(counts, [&](int x, int y) {
              return x >= first && x < first + 6 && y >= first && y < first + 6;
            }) == 0);
    }
  }
}

TEST_CASE("a rectangle larger than the target covers each pixel of it once, whatever its size") {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 130}, {130, 1}, {63, 65}, {64, 64}, {128, 64}, {200, 70}}) {
    const auto w = static_cast<float>(width);
    const auto h = static_cast<float>(height);
    const Image counts = count_coverage(
        window_triangles(window_quad(-0.5f * w, -0.5f * h, 1.5f * w, 1.5f * h), width, height),
        width, height);
    CHECK(pixels_not_covered_once(counts) == 0);
  }
}

TEST_CASE("one triangle over the whole target covers each pixel once") {
  const Vertices vertices{{{-1.0f, -1.0f, 0.0f, 1.0f}, {}},
                          {{3.0f, -1.0f, 0.0f, 1.0f}, {}},
                          {{-1.0f, 3.0f, 0.0f, 1.0f}, {}}};
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    CHECK_MESSAGE(pixels_not_covered_once(count_coverage(vertices, 150, 97, profile)) == 0,
                  known.name);
  }
}
