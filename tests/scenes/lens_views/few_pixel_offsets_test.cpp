#include "scenes/lens_views/few_pixel_offsets.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/lens_views/lens_points.h"

using namespace softfocus;

namespace {

using Points = std::vector<glm::dvec2>;

// How far an edge moves along the normal as a view sees it, `radius_px` being its circle's.
std::vector<double> moves_of(const Points& points, const Points& offsets, double radius_px,
                             glm::dvec2 normal) {
  std::vector<double> moves;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec2 moved = offsets[i] + points[i] * radius_px;
    moves.push_back(moved.x * normal.x + moved.y * normal.y);
  }
  std::sort(moves.begin(), moves.end());
  return moves;
}

double share_below(const std::vector<double>& sorted, double place) {
  return static_cast<double>(std::upper_bound(sorted.begin(), sorted.end(), place) -
                             sorted.begin()) /
         static_cast<double>(sorted.size());
}

// The error of a pixel on an edge: the root of the mean square over directions and places.
double edge_error(const Points& points, const Points& offsets, double radius_px) {
  constexpr int kMany = 4096, kDirections = 24, kPlaces = 81;
  const Points many_points = lens_points({}, kMany), many_offsets = pixel_offsets(true, kMany);
  double squares = 0.0;
  for (int d = 0; d < kDirections; ++d) {
    const double angle = (d + 0.37) * 2.0 * 3.14159265358979323846 / kDirections;
    const glm::dvec2 normal{std::cos(angle), std::sin(angle)};
    const auto few = moves_of(points, offsets, radius_px, normal);
    const auto all = moves_of(many_points, many_offsets, radius_px, normal);
    for (int i = 0; i < kPlaces; ++i) {
      const double place = all.front() + (all.back() - all.front()) * (i + 0.5) / kPlaces;
      const double error = share_below(few, place) - share_below(all, place);
      squares += error * error;
    }
  }
  return std::sqrt(squares / (kDirections * kPlaces));
}

Points first_offsets(int count) { return pixel_offsets(true, count); }

}  // namespace

TEST_CASE("few pixel offsets: their sum is exactly 0") {
  for (const int count : {1, 2, 3, 7, 8, 33, 100, 256}) {
    CAPTURE(count);
    glm::dvec2 sum{0.0};
    for (const glm::dvec2 offset : few_pixel_offsets(few_lens_points({}, count))) sum += offset;
    CHECK(sum == glm::dvec2{0.0});
  }
}

TEST_CASE("few pixel offsets: one in each of n columns and n rows of the pixel") {
  for (const int count : {2, 5, 8, 31, 64}) {
    CAPTURE(count);
    const Points offsets = few_pixel_offsets(few_lens_points({}, count));
    REQUIRE(offsets.size() == static_cast<std::size_t>(count));
    for (const int axis : {0, 1}) {
      std::vector<int> columns;
      for (const glm::dvec2 offset : offsets) {
        columns.push_back(static_cast<int>(std::floor((offset[axis] + 0.5) * count)));
      }
      std::sort(columns.begin(), columns.end());
      for (int i = 0; i < count; ++i) CHECK(columns[static_cast<std::size_t>(i)] == i);
    }
  }
}

TEST_CASE("few pixel offsets: edges in focus err less than with the sequence's first" *
          doctest::test_suite("long")) {
  for (const int count : {4, 8, 16, 32, 64}) {
    CAPTURE(count);
    const Points points = few_lens_points({}, count);
    CHECK(edge_error(points, few_pixel_offsets(points), 0.0) <
          1.03 * edge_error(points, first_offsets(count), 0.0));
  }
}

TEST_CASE("few pixel offsets: edges a little out of focus err less than with the sequence's" *
          doctest::test_suite("long")) {
  for (const int count : {4, 8, 16, 32, 64}) {
    const Points points = few_lens_points({}, count);
    const Points offsets = few_pixel_offsets(points);
    for (const double radius_px : {0.5, 1.0}) {
      CAPTURE(count);
      CAPTURE(radius_px);
      const auto error = [&](const Points& of) {
        return edge_error(points, of, radius_px) + edge_error(points, of, -radius_px);
      };
      CHECK(error(offsets) < 0.93 * error(first_offsets(count)));
    }
  }
}

TEST_CASE("view offsets: none without jitter, the sequence's where views are many") {
  const Points many = lens_points({}, 300);
  CHECK(view_offsets(true, many) == pixel_offsets(true, 300));
  CHECK(view_offsets(false, few_lens_points({}, 8)) == Points(8, glm::dvec2{0.0}));
  const Points few = few_lens_points({5}, 8);
  CHECK(view_offsets(true, few) == few_pixel_offsets(few));
}
