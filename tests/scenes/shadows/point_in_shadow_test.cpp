// The oracle on shadows that are known.

#include "scenes/shadows/shadow_truth.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

using namespace softfocus;

namespace {

// A square of `size`, its middle at `middle`, facing up.
void add_square(std::vector<Facet>& facets, glm::dvec3 middle, double size, bool two_sided) {
  const double h = size / 2.0;
  const glm::dvec3 a = middle + glm::dvec3{-h, 0, h}, b = middle + glm::dvec3{h, 0, h};
  const glm::dvec3 c = middle + glm::dvec3{h, 0, -h}, d = middle + glm::dvec3{-h, 0, -h};
  facets.push_back({{a, b, c}, two_sided});
  facets.push_back({{a, c, d}, two_sided});
}

// A square of side 1 at height 1 over a floor of side 20.
Facets square_over_floor() {
  std::vector<Facet> facets;
  add_square(facets, {0, 0, 0}, 20, false);
  add_square(facets, {0, 1, 0}, 1, true);
  return make_facets(std::move(facets));
}

bool is_dark(const Facets& facets, std::uint32_t facet, glm::dvec3 point, const ShadowLight& light,
             bool from_back = false) {
  std::vector<std::uint32_t> all(facets.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  return point_in_shadow(facets, facet, from_back, point, light, all);
}

// Compares the floor with a square shadow, at points that are not on its edge.
void check_floor(const ShadowLight& light, glm::dvec2 middle, double size) {
  const Facets facets = square_over_floor();
  for (double x = -4.013; x < 4.0; x += 0.05) {
    for (double z = -4.007; z < 4.0; z += 0.05) {
      const double beside = std::max(std::fabs(x - middle.x), std::fabs(z - middle.y));
      if (std::fabs(beside - size / 2.0) < 1e-9) continue;
      CAPTURE(x);
      CAPTURE(z);
      REQUIRE(is_dark(facets, 0, {x, 0, z}, light) == (beside < size / 2.0));
    }
  }
}

}  // namespace

TEST_CASE("a directional light moves a square's shadow along the floor") {
  check_floor({normalize(glm::dvec3{1, 2, -0.5}), 0.0}, {-0.5, 0.25}, 1.0);
}

TEST_CASE("a point light makes a square's shadow larger, about its foot") {
  // 3 over the floor, so the shadow is 3 / (3 - 1) times as large about (0.5, -1).
  check_floor({{0.5, 3, -1}, 1.0}, {-0.25, 0.5}, 1.5);
}

TEST_CASE("a light below what it should shade casts nothing there") {
  const Facets facets = square_over_floor();
  CHECK_FALSE(is_dark(facets, 0, {0, 0, 0}, {{0, 0.5, 0}, 1.0}));
}

TEST_CASE("a side that the light is not on is dark") {
  const Facets facets = square_over_floor();
  CHECK(is_dark(facets, 2, {0.2, 1, 0.2}, {{0, 0.5, 0}, 1.0}));
  CHECK_FALSE(is_dark(facets, 2, {0.2, 1, 0.2}, {{0, 0.5, 0}, 1.0}, true));
}

TEST_CASE("a one-sided facet stops light on its front alone") {
  std::vector<Facet> corners;
  add_square(corners, {0, 0, 0}, 20, true);
  add_square(corners, {0, 1, 0}, 1, false);
  const Facets facets = make_facets(std::move(corners));
  CHECK(is_dark(facets, 0, {0, 0, 0}, {{0, 2, 0}, 1.0}));
  // From below: the light of the lower side passes the square, as a look from there would.
  std::vector<Facet> under;
  add_square(under, {0, 2, 0}, 20, true);
  add_square(under, {0, 1, 0}, 1, false);
  CHECK_FALSE(is_dark(make_facets(std::move(under)), 0, {0, 2, 0}, {{0, 0, 0}, 1.0}, true));
}

TEST_CASE("what is seen at the picture's middle is where the axis meets the plane") {
  // Looks along -z from (0, 0, 5): x and y over the depth 5 - z.
  glm::dmat4 to_clip{0.0};
  to_clip[0][0] = 1.0, to_clip[1][1] = -1.0, to_clip[2][2] = -1.0;
  to_clip[2][3] = -1.0, to_clip[3][3] = 5.0;
  const FacetPlane plane{normalize(glm::dvec3{1, 0, 1}), 0.0};
  const glm::dvec3 middle = seen_point(plane, to_clip, {0, 0, 5}, {50, 30}, 100, 60);
  CHECK(std::fabs(middle.x) < 1e-15);
  CHECK(std::fabs(middle.z) < 1e-15);
  const glm::dvec3 right = seen_point(plane, to_clip, {0, 0, 5}, {75, 30}, 100, 60);
  CHECK(std::fabs(right.x - 5.0) < 1e-14);  // x = (5 - z) / 2 and z = -x
}
