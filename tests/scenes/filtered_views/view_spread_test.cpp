#include "scenes/filtered_views/view_spread.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

#include "raster/images/image.h"
#include "raster/images/texel.h"

using namespace softfocus;

namespace {

constexpr PixelCoc kCoc{12.0f, 2.0f};

Image plane_picture(int size, float depth, glm::vec3 colour) {
  Image picture = make_image(Format::rgba16f, size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      store_texel<Format::rgba16f>(picture, x, y, glm::vec4{colour, depth}, Profile{});
    }
  }
  return picture;
}

ColourPlanes spread(const Image& picture, const LensCells& cells, int cell) {
  const ViewSpread of_lens = make_view_spread(kCoc, cells);
  return spread_view_oracle(picture, of_lens, ray_steps(of_lens, points_of(cells, cell)),
                            cells.per_cell);
}

}  // namespace

TEST_CASE("view spread: levels go from near to far, and hold what has no depth") {
  const ViewSpread of_lens = make_view_spread(kCoc, lens_cells({}, 8, 8));
  CHECK(spread_level(of_lens, 0.0f) == -kMostSpreadLevel);
  CHECK(spread_level(of_lens, 1.5f) < 0);
  CHECK(spread_level(of_lens, 2.0f) == 0);
  CHECK(spread_level(of_lens, 4.0f) > spread_level(of_lens, 2.5f));
  CHECK(spread_level(of_lens, std::numeric_limits<float>::quiet_NaN()) == kMostSpreadLevel);
}

TEST_CASE("view spread: what is in focus stays as it is") {
  Image picture = plane_picture(24, 2.0f, {0.25f, 0.5f, 1.0f});
  store_texel<Format::rgba16f>(picture, 7, 9, {4.0f, 3.0f, 2.0f, 2.01f}, Profile{});
  const ColourPlanes planes = spread(picture, lens_cells({}, 4, 16), 2);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      const glm::vec4 texel = load_texel<Format::rgba16f>(picture, x, y);
      for (int c = 0; c < 3; ++c) {
        CHECK(planes[static_cast<std::size_t>((c * 24 + y) * 24 + x)] == texel[c]);
      }
    }
  }
}

// A bright dot of one depth among black pixels of the same depth.
TEST_CASE("view spread: a dot becomes the cell's points, upside down before the focus") {
  const LensCells cells = lens_cells({}, 4, 16);
  const int size = 41, middle = 20;
  for (const float depth : {8.0f, 1.0f}) {
    Image picture = plane_picture(size, depth, glm::vec3{0.0f});
    store_texel<Format::rgba16f>(picture, middle, middle, {1.0f, 1.0f, 1.0f, depth}, Profile{});
    const ColourPlanes planes = spread(picture, cells, 1);
    const double radius_px = coc_radius_px(kCoc, depth);
    double sum = 0.0, off = 0.0;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const double light = planes[static_cast<std::size_t>(y * size + x)];
        sum += light;
        if (light == 0.0) continue;
        double nearest = 1e9;
        for (const glm::dvec2 point : points_of(cells, 1)) {
          nearest = std::min(nearest, std::hypot(x - middle - point.x * radius_px,
                                                 y - middle + point.y * radius_px));
        }
        off = std::max(off, nearest);
      }
    }
    CHECK(sum == doctest::Approx(1.0));
    CHECK(off < 1.3);  // half a level and half a pixel
  }
}

TEST_CASE("view spread: what is near and out of focus lets through what lies beside it") {
  // A near black strip, 3 pixels wide, before something white in focus.
  const int size = 40;
  Image picture = plane_picture(size, 2.0f, glm::vec3{1.0f});
  for (int y = 0; y < size; ++y) {
    for (int x = 19; x < 22; ++x) {
      store_texel<Format::rgba16f>(picture, x, y, {0.0f, 0.0f, 0.0f, 0.8f}, Profile{});
    }
  }
  const ColourPlanes planes = spread(picture, lens_cells({}, 1, 16), 0);
  double dark = 0.0, darkest = 0.0;
  for (int x = 0; x < size; ++x) {
    const double shadow = 1.0 - planes[static_cast<std::size_t>(20 * size + x)];
    dark += shadow;
    darkest = std::max(darkest, shadow);
  }
  CHECK(dark == doctest::Approx(3.0).epsilon(0.02));
  CHECK(darkest < 0.35);
}

TEST_CASE("view spread: rays of views that look from all over the pixel keep a circle's place") {
  const LensCells cells = lens_cells({}, 8, 32, true);
  const ViewSpread of_lens = make_view_spread(kCoc, cells);
  for (const int level : {-40, -12, 12, 40}) {
    CAPTURE(level);
    const double radius_px = of_lens.radius_px[static_cast<std::size_t>(std::abs(level))];
    glm::dvec2 mean{0.0};
    double mean_square = 0.0;
    for (int cell = 0; cell < 8; ++cell) {
      const glm::dvec2 at = cells.in_pixel[static_cast<std::size_t>(cell)];
      const glm::dvec2 view = cells.views[static_cast<std::size_t>(cell)] * radius_px;
      const auto steps = ray_steps(of_lens, points_of(cells, cell), at);
      for (int ray = 0; ray < cells.per_cell; ++ray) {
        const PixelStep step =
            steps[static_cast<std::size_t>(ray * kSpreadLevels + level + kMostSpreadLevel)];
        const double sign = level < 0 ? -1.0 : 1.0;
        const glm::dvec2 from =
            glm::dvec2{step.x, step.y} + at + sign * glm::dvec2{-view.x, view.y};
        mean += from / 256.0;
        mean_square += (from.x * from.x + from.y * from.y) / 256.0;
      }
    }
    CHECK(std::hypot(mean.x, mean.y) < 0.06);
    // The circle's and the pixel's.
    CHECK(mean_square == doctest::Approx(0.5 * radius_px * radius_px + 1.0 / 6.0).epsilon(0.02));
  }
}

TEST_CASE("view spread: what is in focus stays as it is, wherever in the pixel the view looks") {
  const LensCells cells = lens_cells({}, 4, 32, true);
  const ViewSpread of_lens = make_view_spread(kCoc, cells);
  for (int cell = 0; cell < 4; ++cell) {
    const auto steps =
        ray_steps(of_lens, points_of(cells, cell), cells.in_pixel[static_cast<std::size_t>(cell)]);
    for (int ray = 0; ray < cells.per_cell; ++ray) {
      const PixelStep step =
          steps[static_cast<std::size_t>(ray * kSpreadLevels + kMostSpreadLevel)];
      CHECK(step.x == 0);
      CHECK(step.y == 0);
    }
  }
}

TEST_CASE("view spread: no ray moves where the longest step would be below the least") {
  const LensCells cells = lens_cells({}, 32, 16);
  const ViewSpread of_lens = make_view_spread(kCoc, cells);
  double longest = 0.0;
  for (const glm::dvec2 point : cells.points) {
    longest = std::max({longest, std::fabs(point.x), std::fabs(point.y)});
  }
  const auto steps = ray_steps(of_lens, points_of(cells, 3));
  bool some_move = false;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const int level = static_cast<int>(i % kSpreadLevels) - kMostSpreadLevel;
    const double radius_px = of_lens.radius_px[static_cast<std::size_t>(std::abs(level))];
    const bool moves = steps[i].x != 0 || steps[i].y != 0;
    some_move = some_move || moves;
    if (longest * radius_px < least_step_px(cells)) CHECK(!moves);
  }
  CHECK(some_move);
}
