#include "scenes/filtered_views/lens_cells.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/lens_views/few_pixel_offsets.h"
#include "scenes/lens_views/lens_points.h"

using namespace softfocus;

namespace {

std::vector<glm::dvec2> all_points(const LensCells& cells) {
  std::vector<glm::dvec2> points;
  for (std::size_t i = 0; i < cells.points.size(); ++i) {
    points.push_back(cells.views[i / static_cast<std::size_t>(cells.per_cell)] + cells.points[i]);
  }
  return points;
}

double mean_square(const std::vector<glm::dvec2>& points) {
  double sum = 0.0;
  for (const glm::dvec2 p : points) sum += p.x * p.x + p.y * p.y;
  return sum / static_cast<double>(points.size());
}

}  // namespace

TEST_CASE("cells of the lens: each point of the set is in one of them") {
  for (const int blades : {0, 5}) {
    for (const int views : {1, 2, 3, 6, 8, 16, 33, 64}) {
      CAPTURE(blades);
      CAPTURE(views);
      const int per_cell = points_of_cell(views);
      const LensCells cells = lens_cells({blades}, views, per_cell);
      REQUIRE(cells.views.size() == static_cast<std::size_t>(views));
      REQUIRE(points_of(cells, views - 1).size() == static_cast<std::size_t>(per_cell));
      std::vector<glm::dvec2> expected = few_lens_points({blades}, views * per_cell);
      std::vector<glm::dvec2> found = all_points(cells);
      const auto before = [](glm::dvec2 a, glm::dvec2 b) {
        return a.x < b.x || (a.x == b.x && a.y < b.y);
      };
      std::sort(expected.begin(), expected.end(), before);
      std::sort(found.begin(), found.end(), before);
      REQUIRE(found.size() == expected.size());
      double farthest = 0.0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        farthest =
            std::max(farthest, std::hypot(found[i].x - expected[i].x, found[i].y - expected[i].y));
      }
      CHECK(farthest < 1e-12);
    }
  }
}

TEST_CASE("cells of the lens: what is out of focus keeps its place and its size") {
  for (const int views : {4, 8, 16, 32}) {
    CAPTURE(views);
    const LensCells cells = lens_cells({}, views, points_of_cell(views));
    CHECK(cells.views == few_lens_points({}, views));
    const std::vector<glm::dvec2> points = all_points(cells);
    glm::dvec2 mean{0.0};
    for (const glm::dvec2 point : points) mean += point;
    CHECK(std::hypot(mean.x, mean.y) < 1e-9);
    CHECK(mean_square(points) == doctest::Approx(0.5).epsilon(0.01));
  }
}

TEST_CASE("cells of the lens: a cell's points lie about its view") {
  for (const int views : {4, 8, 16, 32}) {
    CAPTURE(views);
    const LensCells cells = lens_cells({}, views, points_of_cell(views));
    // Discs of a cell's area have 1 / (2 n).
    CHECK(mean_square(cells.points) < 0.6 / views);
    CHECK(mean_square(cells.points) > 0.4 / views);
    for (const glm::dvec2 point : cells.points) {
      CHECK(std::hypot(point.x, point.y) < 1.6 / std::sqrt(views));
    }
  }
}

TEST_CASE("cells of the lens: views look from the pixel's centre, or from offsets made for them") {
  for (const int views : {4, 200}) {
    const LensCells still = lens_cells({}, views, points_of_cell(views));
    CHECK(still.in_pixel == std::vector<glm::dvec2>(still.views.size(), glm::dvec2{0.0}));
    const LensCells jittered = lens_cells({}, views, points_of_cell(views), true);
    CHECK(jittered.views == still.views);
    CHECK(jittered.points == still.points);
    CHECK(jittered.in_pixel == view_offsets(true, still.views));
  }
}

TEST_CASE("cells of the lens: the more views, the longer the steps that are left alone") {
  const auto least_px = [](int views, bool jitter) {
    return least_step_px(lens_cells({}, views, points_of_cell(views), jitter));
  };
  CHECK(least_px(8, false) == doctest::Approx(0.460).epsilon(0.01));
  CHECK(least_px(16, false) == doctest::Approx(1.3));
  CHECK(least_px(32, false) == doctest::Approx(1.5));
  CHECK(least_px(8, true) == doctest::Approx(0.460).epsilon(0.01));
  CHECK(least_px(32, true) == doctest::Approx(0.65));
}

TEST_CASE("cells of the lens: many views are points, those of accumulation") {
  CHECK(points_of_cell(1) == kMostCellPoints);
  CHECK(points_of_cell(8) == kMostCellPoints);
  CHECK(points_of_cell(9) == kMostCellPoints / 2);
  CHECK(points_of_cell(32) == kMostCellPoints / 2);
  CHECK(points_of_cell(33) == 1);
  const LensCells cells = lens_cells({}, 200, 1);
  CHECK(cells.views == lens_points_for({}, 200));
  CHECK(cells.points == std::vector<glm::dvec2>(200, glm::dvec2{0.0}));
}
