#include "scenes/lens_views/lens_points.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace softfocus;

namespace {

// Points of a fine lattice that lie on the aperture.
std::vector<glm::dvec2> lattice_of(ApertureShape shape) {
  constexpr int kAcross = 200;
  constexpr double kPi = 3.14159265358979323846;
  std::vector<glm::dvec2> lattice;
  for (int y = 0; y < kAcross; ++y) {
    for (int x = 0; x < kAcross; ++x) {
      const glm::dvec2 p{(x + 0.5) / kAcross * 2.0 - 1.0, (y + 0.5) / kAcross * 2.0 - 1.0};
      double reach = std::hypot(p.x, p.y);
      if (shape.blades > 0) {
        const double sector = 2.0 * kPi / shape.blades;
        const double angle =
            std::remainder(std::atan2(p.y, p.x) - kPi / 2.0 - sector / 2.0, sector);
        reach *= std::cos(angle) / std::cos(sector / 2.0);
      }
      if (reach <= 1.0) lattice.push_back(p);
    }
  }
  return lattice;
}

// The error of a pixel on an edge out of focus, by the definition: over lines in every direction
// and place, the root of the mean square of the share of points on one side less that of the area.
double half_plane_error(const std::vector<glm::dvec2>& points, ApertureShape shape) {
  const std::vector<glm::dvec2> lattice = lattice_of(shape);
  constexpr int kDirections = 24, kPlaces = 81;
  double squares = 0.0;
  for (int d = 0; d < kDirections; ++d) {
    const double angle = (d + 0.37) * 3.14159265358979323846 / kDirections;
    const glm::dvec2 normal{std::cos(angle), std::sin(angle)};
    const auto sorted = [&](const std::vector<glm::dvec2>& of) {
      std::vector<double> along;
      along.reserve(of.size());
      for (const glm::dvec2 p : of) along.push_back(p.x * normal.x + p.y * normal.y);
      std::sort(along.begin(), along.end());
      return along;
    };
    const std::vector<double> few = sorted(points), area = sorted(lattice);
    const auto share = [](const std::vector<double>& of, double place) {
      return static_cast<double>(std::upper_bound(of.begin(), of.end(), place) - of.begin()) /
             static_cast<double>(of.size());
    };
    for (int i = 0; i < kPlaces; ++i) {
      const double place = 2.0 * (i + 0.5) / kPlaces - 1.0;
      const double error = share(few, place) - share(area, place);
      squares += error * error;
    }
  }
  return std::sqrt(squares / (kDirections * kPlaces));
}

}  // namespace

TEST_CASE("few points of the lens: their mean is exactly 0, and they lie on it, apart") {
  for (const int blades : {0, 3, 4, 5, 6, 9, 64}) {
    for (const int count : {1, 2, 3, 4, 5, 7, 8, 11, 16, 31, 64, 65, 100, 256}) {
      CAPTURE(blades);
      CAPTURE(count);
      const auto points = few_lens_points({blades}, count);
      REQUIRE(points.size() == static_cast<std::size_t>(count));
      glm::dvec2 sum{0.0};
      double nearest = 4.0, farthest = 0.0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        sum += points[i];  // exact: multiples of 2^-32
        farthest = std::max(farthest, std::hypot(points[i].x, points[i].y));
        for (std::size_t j = 0; j < i; ++j) {
          nearest =
              std::min(nearest, std::hypot(points[i].x - points[j].x, points[i].y - points[j].y));
        }
      }
      CHECK(sum == glm::dvec2{0.0});
      CHECK(farthest < 1.0);
      if (count > 1) CHECK(nearest > 0.5 / std::sqrt(count));
    }
  }
  CHECK(few_lens_points({0}, 1)[0] == glm::dvec2{0.0});
}

TEST_CASE("few points of the lens: no line parts them as unevenly as it parts the sequence" *
          doctest::test_suite("long")) {
  for (const int blades : {0, 3, 5, 6}) {
    for (const int count : {8, 12, 16, 32, 64, 128, 256}) {
      CAPTURE(blades);
      CAPTURE(count);
      const double few = half_plane_error(few_lens_points({blades}, count), {blades});
      const double sequence = half_plane_error(lens_points({blades}, count), {blades});
      CHECK(few < 0.85 * sequence);
      // Points each placed by itself have 0.35 / sqrt(n); these fall as n^-3/4.
      CHECK(few < 0.36 * std::pow(count, -0.75));
    }
  }
}

TEST_CASE("few points of the lens: blurred by them, a thing keeps its size") {
  for (const int count : {8, 16, 64, 256}) {
    double squares = 0.0;
    for (const glm::dvec2 p : few_lens_points({0}, count)) squares += p.x * p.x + p.y * p.y;
    // 1/2 of the disc's radius squared; centroids of equal cells lack about 1 / (2 n).
    CHECK(squares / count < 0.5);
    CHECK(squares / count > 0.5 - 0.35 / count);
  }
}

TEST_CASE("a picture of more views looks from the sequence") {
  CHECK(lens_points_for({0}, kMostFewLensPoints) == few_lens_points({0}, kMostFewLensPoints));
  CHECK(lens_points_for({0}, kMostFewLensPoints + 1) == lens_points({0}, kMostFewLensPoints + 1));
}
