#include "scenes/lens_views/lens_points.h"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

using namespace softfocus;

namespace {

constexpr double kPi = 3.14159265358979323846;

glm::dvec2 centroid(const std::vector<glm::dvec2>& points) {
  glm::dvec2 sum{0.0};
  for (const glm::dvec2 point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

}  // namespace

TEST_CASE("the first point of the lens is its centre, whatever the aperture") {
  for (const int blades : {0, 3, 5, 6, 64}) {
    CHECK(lens_points({blades}, 1) == std::vector{glm::dvec2{0.0, 0.0}});
  }
}

TEST_CASE("an aligned block of 2^k points has one in each of 2^k boxes of every shape") {
  for (const std::uint32_t series : {0u, 1u, 7u}) {
    for (int k = 0; k <= 10; ++k) {
      const std::uint32_t size = 1u << k;
      for (const std::uint32_t start : {0u, size, 5 * size}) {
        for (int columns = 0; columns <= k; ++columns) {
          std::set<std::pair<int, int>> boxes;
          for (std::uint32_t i = start; i < start + size; ++i) {
            const glm::dvec2 point = square_point(i, series);
            boxes.emplace(static_cast<int>(point.x * (1 << columns)),
                          static_cast<int>(point.y * (1 << (k - columns))));
          }
          CHECK(boxes.size() == size);
        }
      }
    }
  }
}

TEST_CASE("equal areas of the disc get equal numbers of points") {
  const auto points = lens_points({0}, 4096);
  for (const double radius : {0.25, 0.5, 0.75, 0.9}) {
    int inside = 0;
    for (const glm::dvec2 p : points) inside += std::hypot(p.x, p.y) < radius ? 1 : 0;
    CHECK(inside / 4096.0 == doctest::Approx(radius * radius).epsilon(0.01));
  }
  for (const glm::dvec2 p : points) CHECK(std::hypot(p.x, p.y) <= 1.0);
  int upper_right = 0;
  for (const glm::dvec2 p : points) upper_right += p.x > 0.0 && p.y > p.x ? 1 : 0;
  CHECK(upper_right / 4096.0 == doctest::Approx(1.0 / 8.0).epsilon(0.02));
}

TEST_CASE("the points of a polygon lie in it, evenly, with a corner up") {
  for (const int blades : {3, 4, 5, 6, 9}) {
    const auto points = lens_points({blades}, 4096);
    double farthest = 0.0, highest = 0.0, squares_x = 0.0, squares_y = 0.0;
    const double sector = 2.0 * kPi / blades;
    for (const glm::dvec2 p : points) {
      // The side that a point is nearest to is the inradius away from the centre.
      const double angle = std::remainder(std::atan2(p.y, p.x) - kPi / 2.0 - sector / 2.0, sector);
      farthest = std::fmax(farthest, std::hypot(p.x, p.y) * std::cos(angle));
      highest = std::fmax(highest, p.y);
      squares_x += p.x * p.x / 4096.0;
      squares_y += p.y * p.y / 4096.0;
    }
    CHECK(farthest <= std::cos(sector / 2.0) + 1e-9);
    CHECK(farthest > 0.95 * std::cos(sector / 2.0));
    CHECK(highest > 0.9);
    // A regular polygon of radius 1 has the mean of x^2 over a triangle at its centre.
    const double variance = (2.0 + std::cos(sector)) / 12.0;
    CHECK(squares_x == doctest::Approx(variance).epsilon(0.01));
    CHECK(squares_y == doctest::Approx(variance).epsilon(0.01));
    CHECK(std::hypot(centroid(points).x, centroid(points).y) < 0.002);
  }
}

TEST_CASE("few points too lie about the centre") {
  for (const int count : {16, 64, 100, 256}) {
    const glm::dvec2 mean = centroid(lens_points({0}, count));
    CHECK(std::hypot(mean.x, mean.y) < 0.3 / std::sqrt(count));
  }
}

TEST_CASE("offsets in the pixel cover it evenly, or are all 0") {
  const auto offsets = pixel_offsets(true, 1024);
  CHECK(offsets[0] == glm::dvec2{0.0, 0.0});
  std::set<std::pair<int, int>> boxes;
  for (const glm::dvec2 offset : offsets) {
    CHECK(offset.x >= -0.5);
    CHECK(offset.x < 0.5);
    CHECK(offset.y >= -0.5);
    CHECK(offset.y < 0.5);
    boxes.emplace(static_cast<int>((offset.x + 0.5) * 32), static_cast<int>((offset.y + 0.5) * 32));
  }
  CHECK(boxes.size() == 1024);
  for (const glm::dvec2 offset : pixel_offsets(false, 100)) CHECK(offset == glm::dvec2{0.0, 0.0});
}

TEST_CASE("where a sample lies in the pixel says nothing of where on the lens") {
  const auto offsets = pixel_offsets(true, 4096);
  const auto points = lens_points({0}, 4096);
  for (int a = 0; a < 2; ++a) {
    for (int b = 0; b < 2; ++b) {
      double product = 0.0;
      for (std::size_t i = 0; i < points.size(); ++i) product += offsets[i][a] * points[i][b];
      CHECK(std::fabs(product / 4096.0) < 0.01);  // of same things it would be 0.144
    }
  }
}
