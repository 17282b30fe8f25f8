// The grid of a light's casters: it may name too many, and must name all that a ray meets.

#include "scenes/shadows/light_grid.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "tests/support/shadow_facets.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

// Before the light.
bool meets(const Facet& facet, glm::dvec3 from, const ShadowLight& light) {
  const glm::dvec3 ray = light.place - from * light.w;
  const auto& [a, b, c] = facet.corners;
  const glm::dvec3 p = cross(ray, c - a), q = cross(from - a, b - a);
  const double determinant = dot(b - a, p);
  if (determinant == 0.0) return false;
  const double s = dot(from - a, p) / determinant, t = dot(ray, q) / determinant;
  const double along = dot(c - a, q) / determinant;
  return s >= 0.0 && t >= 0.0 && s + t <= 1.0 && along > 0.0 && (light.w == 0.0 || along < 1.0);
}

// From behind a point of the facet, seen from the light.
glm::dvec3 behind(glm::dvec3 target, const ShadowLight& light) {
  return target + (target * light.w - light.place) * 0.7;
}

bool same(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

// Returns how many casters rays met. Each must be named where its ray begins.
int check_grid(const Facets& facets, const ShadowLight& light) {
  const LightGrid grid = make_light_grid(facets, light);
  std::vector<std::uint32_t> found;
  CasterSearch search;
  int met = 0;
  for (std::size_t f = 0; f < facets.facets.size(); ++f) {
    const auto& [a, b, c] = facets.facets[f].corners;
    for (const glm::dvec3& target :
         {a, b, c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5, (a + b + c) / 3.0}) {
      const glm::dvec3 from = behind(target, light);
      find_casters(grid, {&from, 1}, found);
      REQUIRE(same(find_casters(grid, {&from, 1}, search), found));
      for (std::uint32_t i = 0; i < facets.facets.size(); ++i) {
        if (!stops_light(facets.facets[i], facets.planes[i], light)) continue;
        if (!meets(facets.facets[i], from, light)) continue;
        ++met;
        REQUIRE(std::binary_search(found.begin(), found.end(), i));
      }
    }
  }
  return met;
}

}  // namespace

TEST_CASE("a light's grid names every caster that a ray to the light meets, at its corners too") {
  for (std::uint32_t seed = 1; seed < 4; ++seed) {
    CAPTURE(seed);
    const Facets facets = facet_soup(seed, 200, 0.4);
    for (const ShadowLight& light :
         {ShadowLight{normalize(glm::dvec3{0.3, 1, 0.2}), 0.0}, ShadowLight{{0, -1, 0}, 0.0},
          ShadowLight{{0.2, 0.1, -0.3}, 1.0}, ShadowLight{{3, 1, 2}, 1.0},
          ShadowLight{facets.facets[9].corners[0], 1.0}}) {
      CHECK(check_grid(facets, light) > 500);
    }
  }
}

TEST_CASE("a search of few casters and one of most name what sorting all cells names") {
  const Facets facets = facet_soup(5, 800, 0.1);
  for (const ShadowLight& light :
       {ShadowLight{normalize(glm::dvec3{0.3, 1, 0.2}), 0.0}, ShadowLight{{0.2, 0.1, -0.3}, 1.0}}) {
    const LightGrid grid = make_light_grid(facets, light);
    CasterSearch search;
    search.search = ~std::uint32_t{0} - 3;  // it comes round
    search.found_in.resize(grid.facets);
    std::size_t most = 0;
    for (const double reach : {0.01, 0.1, 0.3, 1.0, 3.0, 0.05}) {
      const std::array<glm::dvec3, 3> polygon{
          {{-reach, -0.5, reach}, {reach, -0.4, reach}, {reach, -0.6, -reach}}};
      std::vector<std::uint32_t> found;
      find_casters(grid, polygon, found);
      // A polygon that touches more than half of the cells gets all.
      const std::span<const std::uint32_t> by_search = find_casters(grid, polygon, search);
      CHECK((same(by_search, found) || (reach > 0.5 && same(by_search, grid.all))));
      most = std::max(most, found.size());
    }
    CHECK(most > facets.facets.size() / 8);
  }
}

TEST_CASE("casters that each cross all of the light's view do not fill the memory") {
  Random random{7};
  std::vector<Facet> corners;
  for (int i = 0; i < 9000; ++i) {
    const double x = random.between(-1.0, 1.0), z = random.between(-1.0, 1.0);
    add_triangle(corners, {x, 1, -1}, {x + 0.001, 1, 1}, {x, 1, 1});
    add_triangle(corners, {-1, 1.1, z}, {1, 1.1, z + 0.001}, {1, 1.1, z});
  }
  const Facets facets = make_facets(std::move(corners));
  ThreadPool pool{3};
  const LightGrid grid = make_light_grid(facets, {{0, 1, 0}, 0.0}, &pool);
  CHECK(grid.cells > 1);
  CHECK(grid.casters.size() <= 33 * facets.facets.size());
  const LightGrid by_one = make_light_grid(facets, {{0, 1, 0}, 0.0});
  CHECK(by_one.cells == grid.cells);
  CHECK(by_one.begins == grid.begins);
  CHECK(by_one.casters == grid.casters);
}

TEST_CASE("casters that meet at the borders of cells are named on both sides of them") {
  // The corners of these squares are the corners of cells.
  std::vector<Facet> corners;
  for (int x = -4; x < 4; ++x) {
    for (int z = -4; z < 4; ++z) {
      add_quad(corners, {x, 1, z + 1}, {x + 1, 1, z + 1}, {x + 1, 1, z}, {x, 1, z});
    }
  }
  const Facets facets = make_facets(std::move(corners));
  CHECK(check_grid(facets, {{0, 1, 0}, 0.0}) > 500);
  CHECK(check_grid(facets, {normalize(glm::dvec3{0.3, 1, 0.7}), 0.0}) > 500);
  // Along x, so that they stay corners of cells, but for rounding.
  for (int x_step = 0; 0.1 + 0.1 * x_step < 2.0; ++x_step) {
    const double x = 0.1 + 0.1 * x_step;
    CHECK(check_grid(facets, {normalize(glm::dvec3{x, 1, 0}), 0.0}) > 500);
  }
  CHECK(check_grid(facets, {{0, 5, 0}, 1.0}) > 500);
  CHECK(check_grid(facets, {{0.1, 1.5, 0.3}, 1.0}) > 500);
}
