#include "scenes/make/polygon.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/random_bits.h"
#include "raster/numbers/vector_math.h"
#include "tests/support/sanitizers.h"

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

// What the even-odd rule counts as inside, of an outline in z = 0 that may touch itself but does
// not cross itself: between the heights of two corners its edges have an order.
double even_odd_area(const Polygon& polygon) {
  std::vector<double> heights;
  for (const glm::dvec3& p : polygon) heights.push_back(p.y);
  std::ranges::sort(heights);
  double area = 0.0;
  for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
    const double low = heights[i], high = heights[i + 1], middle = (low + high) / 2.0;
    if (low == high) continue;
    std::vector<double> crossings;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const glm::dvec3 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
      if ((a.y < middle) == (b.y < middle)) continue;
      crossings.push_back(a.x + (middle - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    std::ranges::sort(crossings);
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
      area += (crossings[k + 1] - crossings[k]) * (high - low);
    }
  }
  return area;
}

bool is_even_odd_inside(const Polygon& polygon, double x, double y) {
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const glm::dvec3 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    if ((a.y < y) == (b.y < y)) continue;
    if (x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

// An outline such as exporters make: concave, with doubled and straight corners and spikes, perhaps
// with a hole that a bridge joins. The bridge may run along an edge. Coordinates are multiples of
// 2^-12: what lies on an edge lies on it exactly.
Polygon random_outline(std::uint64_t seed) {
  std::uint64_t draws = 0;
  const auto random = [&](double low, double high) {
    const auto bits = mix_bits(seed * 1'000'003 + draws++);
    return low + (high - low) * static_cast<double>(bits >> 40) / static_cast<double>(1 << 24);
  };
  const auto chance = [&](double share) { return random(0.0, 1.0) < share; };
  const auto on_grid = [](double x) { return std::round(x * 1024.0) / 1024.0; };
  const auto star = [&](double x, double y, double least, double most, int corners) {
    Polygon polygon;
    for (int i = 0; i < corners; ++i) {
      const double angle = 360.0 * (i + random(0.3, 0.7)) / corners;
      const double radius = random(least, most);
      polygon.emplace_back(on_grid(x + radius * exact_math::cos_degrees(angle)),
                           on_grid(y + radius * exact_math::sin_degrees(angle)), 0.0);
    }
    return polygon;
  };
  Polygon outline = star(0.0, 0.0, 1.0, 4.0, 8 + static_cast<int>(random(0, 12)));
  if (chance(0.5)) {
    // A hole in the half that lies to the right of the first corner's ray, whose bridge leaves the
    // corner itself or a place on its edge and comes in at the hole's corner or along its edge.
    const glm::dvec3 first = outline[0];
    const double nearer = 1.0 / 8.0;
    Polygon hole{{first.x * nearer, first.y * nearer, 0.0}};
    hole.push_back(hole[0] * 2.0);  // on the ray
    hole.push_back({hole[0].x + hole[0].y / 2.0, hole[0].y - hole[0].x / 2.0, 0.0});
    std::vector<std::size_t> way{1, 2, 0, 1};
    if (chance(0.5)) way = {0, 1, 2, 0};         // comes along the hole's edge
    if (chance(0.3)) std::ranges::reverse(way);  // a hole that runs as the outline does
    Polygon with_hole{first};
    for (const std::size_t at : way) with_hole.push_back(hole[at]);
    with_hole.insert(with_hole.end(), outline.begin(), outline.end());
    outline = with_hole;
  }
  Polygon decorated;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec3 p = outline[i], next = outline[(i + 1) % outline.size()];
    decorated.push_back(p);
    while (chance(0.2)) decorated.push_back(p);
    if (chance(0.2)) {  // on the edge, and perhaps back again
      decorated.push_back((p + next) / 2.0);
      if (chance(0.3)) decorated.push_back((p + (p + next) / 2.0) / 2.0);
    }
  }
  const auto start =
      static_cast<std::ptrdiff_t>(random(0.0, static_cast<double>(decorated.size())));
  std::rotate(decorated.begin(), decorated.begin() + start, decorated.end());
  if (chance(0.5)) std::ranges::reverse(decorated);
  return decorated;
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

TEST_CASE("outlines that touch themselves have the area of the even-odd rule") {
  int holes = 0;
  for (std::uint64_t seed = 0; seed < fewer<std::uint64_t>(5000); ++seed) {
    CAPTURE(seed);
    const Polygon outline = random_outline(seed);
    const auto triangles = triangulate_polygon(outline);
    REQUIRE(triangles.size() == outline.size() - 2);
    const double wound = area_vector(outline).z;
    double sum = 0.0;
    for (const auto& [a, b, c] : triangles) {
      const double part = cross(outline[b] - outline[a], outline[c] - outline[a]).z;
      CHECK(part * wound >= 0.0);
      sum += std::fabs(part) / 2.0;
    }
    CHECK(sum == doctest::Approx(even_odd_area(outline)).epsilon(1e-9));
    for (int i = 0; i < 20; ++i) {
      const auto place = [&](int axis) {
        return static_cast<double>(mix_bits(seed * 40 + static_cast<std::uint64_t>(2 * i + axis)) >>
                                   40) /
                   static_cast<double>(1 << 24) * 8.0 -
               4.0;
      };
      const glm::dvec3 p{place(0), place(1), 0.0};
      int covered = 0;
      for (const auto& [a, b, c] : triangles) {
        const auto side = [&](std::uint32_t from, std::uint32_t to) {
          return cross(outline[to] - outline[from], p - outline[from]).z * wound >= 0.0;
        };
        const bool has_area = cross(outline[b] - outline[a], outline[c] - outline[a]).z != 0.0;
        covered += has_area && side(a, b) && side(b, c) && side(c, a) ? 1 : 0;
      }
      CHECK(covered == (is_even_odd_inside(outline, p.x, p.y) ? 1 : 0));
      holes += covered;
    }
  }
  CHECK(holes > fewer(10000));
}

namespace {

double side_of(glm::dvec3 a, glm::dvec3 b, glm::dvec3 p) { return cross(b - a, p - a).z; }

bool cross_each_other(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
  return side_of(a, b, c) * side_of(a, b, d) < 0.0 && side_of(c, d, a) * side_of(c, d, b) < 0.0;
}

int winding_number(const Polygon& polygon, glm::dvec3 p) {
  int number = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    if ((a.y < p.y) == (b.y < p.y)) continue;
    if ((side_of(a, b, p) > 0.0) == (a.y < p.y)) number += a.y < p.y ? 1 : -1;
  }
  return number;
}

// Whether an outline on whole numbers touches itself at most: no place is wound around twice, or
// the other way.
bool is_sound(const Polygon& polygon) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (cross_each_other(polygon[i], polygon[(i + 1) % polygon.size()], polygon[k],
                           polygon[k + 1])) {
        return false;
      }
    }
  }
  std::set<int> numbers{0};
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      numbers.insert(winding_number(polygon, {x / 10.0 + 0.037, y / 10.0 + 0.0413, 0.0}));
    }
  }
  return numbers.size() == 2 && (numbers.contains(1) || numbers.contains(-1));
}

}  // namespace

TEST_CASE("outlines on a grid of 5x5 places, which touch themselves often, are covered") {
  int sound = 0;
  for (std::uint64_t seed = 0; seed < fewer<std::uint64_t>(60000); ++seed) {
    CAPTURE(seed);
    Polygon outline;
    const std::uint64_t count = 5 + seed % 5;
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::uint64_t place = mix_bits(seed * 16 + i) % 25;
      outline.emplace_back(place % 5, place / 5, 0.0);
    }
    if (!is_sound(outline)) continue;
    ++sound;
    double sum = 0.0;
    for (const auto& [a, b, c] : triangulate_polygon(outline)) {
      sum += std::fabs(side_of(outline[a], outline[b], outline[c])) / 2.0;
    }
    CHECK(sum == doctest::Approx(even_odd_area(outline)));
  }
  CHECK(sound > fewer(2000));
}

TEST_CASE("what crosses itself or has no area still gives corners - 2 triangles") {
  CHECK(
      triangulate_polygon(Polygon{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {2, 2, 0}}).size() ==
      3);
  CHECK(triangulate_polygon(Polygon(6, glm::dvec3{1.0})).size() == 4);
}
