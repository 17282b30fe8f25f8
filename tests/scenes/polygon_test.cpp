#include "scenes/make/shapes.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"

using namespace softfocus;

namespace {

using Polygon = std::vector<glm::dvec3>;

// Twice the area, as a vector along the polygon's normal.
glm::dvec3 area_vector(const Polygon& polygon) {
  glm::dvec3 sum{0.0};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    sum += cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
  }
  return sum;
}

double length(glm::dvec3 v) { return std::sqrt(dot(v, v)); }

// All triangles face as the polygon does, and have its area together: they cover it.
void check_covered(const Polygon& polygon) {
  const auto triangles = triangulate_polygon(polygon);
  REQUIRE(triangles.size() == polygon.size() - 2);
  const glm::dvec3 whole = area_vector(polygon);
  double sum = 0.0;
  for (const auto& [a, b, c] : triangles) {
    const glm::dvec3 part = cross(polygon[b] - polygon[a], polygon[c] - polygon[a]);
    CHECK(dot(part, whole) >= 0.0);
    sum += length(part);
  }
  CHECK(sum == doctest::Approx(length(whole)));
}

Polygon comb(double size, glm::dvec3 place) {
  Polygon polygon;
  for (const auto& [x, y] : std::initializer_list<std::pair<double, double>>{{0, 0},
                                                                             {7, 0},
                                                                             {7, 4},
                                                                             {6, 4},
                                                                             {6, 1},
                                                                             {5, 1},
                                                                             {5, 4},
                                                                             {4, 4},
                                                                             {4, 1},
                                                                             {3, 1},
                                                                             {3, 4},
                                                                             {2, 4},
                                                                             {2, 1},
                                                                             {1, 1},
                                                                             {1, 4},
                                                                             {0, 4}}) {
    polygon.push_back(place + glm::dvec3{x, y, 0.5 * x} * size);
  }
  return polygon;
}

}  // namespace

TEST_CASE("a triangle is itself") {
  const auto triangles = triangulate_polygon(Polygon{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  REQUIRE(triangles.size() == 1);
  CHECK(triangles[0] == std::array<std::uint32_t, 3>{0, 1, 2});
}

TEST_CASE("a quadrilateral is cut along its shorter diagonal") {
  const Polygon kite = {{0, 0, 0}, {2, -1, 0}, {4, 0, 0}, {2, 1, 0}};
  CHECK(triangulate_polygon(kite)[0] == std::array<std::uint32_t, 3>{0, 1, 3});
  const Polygon turned = {{2, -1, 0}, {4, 0, 0}, {2, 1, 0}, {0, 0, 0}};
  CHECK(triangulate_polygon(turned)[0] == std::array<std::uint32_t, 3>{0, 1, 2});
}

TEST_CASE("a dart is cut from its inner corner, whichever corner comes first") {
  Polygon dart = {{0, 0, 0}, {5, 1, 0}, {0, 2, 0}, {1, 1, 0}};
  for (int turn = 0; turn < 4; ++turn) {
    check_covered(dart);
    std::rotate(dart.begin(), dart.begin() + 1, dart.end());
  }
}

TEST_CASE("a polygon with many inner corners is covered, wherever it starts") {
  Polygon polygon = comb(1.0, {0, 0, 0});
  for (std::size_t turn = 0; turn < polygon.size(); ++turn) {
    check_covered(polygon);
    std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
  }
}

TEST_CASE("a polygon may be wound either way and face along any axis") {
  Polygon polygon = comb(1.0, {0, 0, 0});
  for (int axis = 0; axis < 3; ++axis) {
    for (glm::dvec3& p : polygon) p = {p.z, p.x, p.y};
    check_covered(polygon);
    Polygon reversed(polygon.rbegin(), polygon.rend());
    check_covered(reversed);
  }
}

TEST_CASE("a small polygon, or one far from the origin, loses no triangle") {
  check_covered(comb(1e-6, {0, 0, 0}));
  check_covered(comb(1.0, {1e5, -2e5, 3e5}));
}

TEST_CASE("a polygon with a hole, joined by a cut, is covered") {
  check_covered({{0, 0, 0},
                 {4, 0, 0},
                 {4, 4, 0},
                 {0, 4, 0},
                 {0, 0, 0},
                 {1, 1, 0},
                 {1, 3, 0},
                 {3, 3, 0},
                 {3, 1, 0},
                 {1, 1, 0}});
}

TEST_CASE("a round polygon of a thousand corners is covered") {
  Polygon round;
  for (int i = 0; i < 1000; ++i) {
    const double degrees = i * 0.36;
    round.emplace_back(exact_math::cos_degrees(degrees), 0.0, exact_math::sin_degrees(degrees));
  }
  check_covered(round);
}

TEST_CASE("what crosses itself or has no area still gives corners - 2 triangles") {
  CHECK(
      triangulate_polygon(Polygon{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {2, 2, 0}}).size() ==
      3);
  CHECK(triangulate_polygon(Polygon(6, glm::dvec3{1.0})).size() == 4);
}
