// Projected triangles: known areas, receivers, and three schedules with the same bits.

#include "scenes/shadows/projected_shadows.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "tests/support/random.h"
#include "tests/support/shadow_facets.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

double area_of(const ProjectedTriangle& triangle) {
  const auto corner = [&](std::size_t i) { return glm::dvec3{triangle[i]} / triangle[i].w; };
  const glm::dvec3 across = cross(corner(1) - corner(0), corner(2) - corner(0));
  return std::sqrt(dot(across, across)) / 2.0;
}

double area_on(const ProjectedShadows& shadows, std::size_t receiver) {
  double area = 0.0;
  for (std::size_t i = shadows.begins[receiver]; i < shadows.begins[receiver + 1]; ++i) {
    area += area_of(shadows.triangles[i]);
  }
  return area;
}

bool same(const ProjectedShadows& a, const ProjectedShadows& b) {
  return a.lit == b.lit && a.begins == b.begins && a.triangles.size() == b.triangles.size() &&
         (a.triangles.empty() || std::memcmp(a.triangles.data(), b.triangles.data(),
                                             a.triangles.size() * sizeof a.triangles[0]) == 0);
}

const std::vector<ShadowLight> kLights{{normalize(glm::dvec3{0.3, 1, 0.2}), 0.0},
                                       {{0.2, 0.1, -0.3}, 1.0},
                                       {{3, 1, 2}, 1.0},
                                       {{0, -1, 0}, 0.0}};

}  // namespace

TEST_CASE("the shadow of a square has the area of similar triangles") {
  std::vector<Facet> corners;
  add_floor(corners, 9);
  add_quad(corners, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1});
  const Facets facets = make_facets(std::move(corners));
  const ProjectedShadows of_point = project_in_sequence(facets, {{0.5, 4, 0.25}, 1.0});
  CHECK(std::fabs(area_on(of_point, 0) - 4.0 * (16.0 / 9.0)) < 1e-12);
  const ProjectedShadows of_sun =
      project_in_sequence(facets, {normalize(glm::dvec3{1, 1, 1}), 0.0});
  CHECK(std::fabs(area_on(of_sun, 0) - 4.0) < 1e-12);
}

TEST_CASE("of a caster through the floor the part above casts") {
  std::vector<Facet> corners;
  add_floor(corners, 9);
  // Upright, 2 wide at the top and a point at the bottom; at the floor it is 1 wide.
  add_triangle(corners, {-1, 1, 0}, {0, -1, 0}, {1, 1, 0});
  const Facets facets = make_facets(std::move(corners));
  const ProjectedShadows shadows =
      project_in_sequence(facets, {normalize(glm::dvec3{0, 1, 1}), 0.0});
  // Cut at epsilon over the floor: a strip of its width is missing.
  CHECK(shadows.begins[1] == 2);
  CHECK(std::fabs(area_on(shadows, 0) - 1.5) < 2.0 * facets.epsilon_m);
}

TEST_CASE("what rises above a point light casts to infinity, not through the light") {
  std::vector<Facet> corners;
  add_floor(corners, 9);
  add_triangle(corners, {1, 0.5, -1}, {1, 0.5, 1}, {1, 3, 0});
  const Facets facets = make_facets(std::move(corners));
  const ProjectedShadows shadows = project_in_sequence(facets, {{0, 1, 0}, 1.0});
  REQUIRE(shadows.begins[1] > 0);
  for (std::size_t i = 0; i < shadows.begins[1]; ++i) {
    for (const glm::dvec4& corner : shadows.triangles[i]) {
      CHECK(corner.w >= 0.0);
      CHECK(corner.x > 0.0);
    }
  }
}

TEST_CASE("coplanar neighbours are one receiver") {
  std::vector<Facet> corners;
  for (int i = 0; i < 4; ++i) {
    add_quad(corners, {i, 0, 1}, {i + 1, 0, 1}, {i + 1, 0, 0}, {i, 0, 0});
  }
  add_quad(corners, {4, 0, 1}, {4, 1, 1}, {4, 1, 0}, {4, 0, 0});  // a wall at its end
  const Facets facets = make_facets(std::move(corners));
  REQUIRE(facets.receivers.size() == 2);
  for (std::size_t i = 0; i < 8; ++i) CHECK(facets.receiver_of[i] == 0);
}

TEST_CASE("a two-sided facet and a one-sided one beside it in its plane are two receivers") {
  std::vector<Facet> corners;
  add_triangle(corners, {0, 0, 1}, {1, 0, 1}, {1, 0, 0});
  add_triangle(corners, {0, 0, 1}, {1, 0, 0}, {0, 0, 0});
  corners[1].two_sided = false;
  CHECK(make_facets(corners).receivers.size() == 2);
  corners[0].two_sided = false;
  CHECK(make_facets(corners).receivers.size() == 1);
}

TEST_CASE("a light is on a receiver's back if it has one, and in its plane on neither side") {
  std::vector<Facet> corners;
  add_floor(corners, 9);
  Receiver floor = make_facets(corners).receivers[0];
  const double epsilon = make_facets(corners).epsilon_m;
  const auto side_of = [&](double height) {
    return lit_side(floor, {{1, height, 2}, 1.0}, epsilon);
  };
  CHECK(side_of(2.0 * epsilon) == LitSide::front);
  CHECK(side_of(0.5 * epsilon) == LitSide::none);
  CHECK(side_of(-2.0 * epsilon) == LitSide::back);
  floor.two_sided = false;
  CHECK(side_of(-2.0 * epsilon) == LitSide::none);
  CHECK(lit_side(floor, {{1, 1e-14, 0}, 0.0}, epsilon) == LitSide::none);
}

TEST_CASE("two walls of a corner that both face the light cast nothing on each other") {
  std::vector<Facet> corners;
  add_quad(corners, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0, 0, 0});
  add_quad(corners, {0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1});
  const Facets facets = make_facets(std::move(corners));
  CHECK(project_in_sequence(facets, {{0.7, 0.8, 0.5}, 1.0}).triangles.empty());
  // A light behind the wall: its shadow lies on the floor.
  CHECK_FALSE(project_in_sequence(facets, {{-0.7, 0.8, 0.5}, 1.0}).triangles.empty());
}

TEST_CASE("walls of a corner cast nothing on each other, turned and rounded to binary32") {
  test::Random random{4};
  const auto direction = [&] {
    const double x = random.between(-1.0, 1.0), y = random.between(-1.0, 1.0);
    return normalize(glm::dvec3{x, y, random.between(-1.0, 1.0)});
  };
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 at = direction() * 3.0, right = direction();
    const glm::dvec3 up = normalize(cross(right, direction())), ahead = cross(up, right);
    const auto corner = [&](double x, double y, double z) {
      return glm::dvec3{glm::vec3{at + right * x + up * y + ahead * -z}};
    };
    std::vector<Facet> corners;
    add_quad(corners, corner(0, 0, 1), corner(1, 0, 1), corner(1, 0, 0), corner(0, 0, 0));
    add_quad(corners, corner(0, 0, 0), corner(0, 1, 0), corner(0, 1, 1), corner(0, 0, 1));
    const Facets facets = make_facets(std::move(corners));
    CHECK(project_in_sequence(facets, {corner(0.7, 0.8, 0.5), 1.0}).triangles.empty());
    const glm::dvec3 towards = normalize(right * 0.7 + up * 0.8 + ahead * 0.2);
    CHECK(project_in_sequence(facets, {towards, 0.0}).triangles.empty());
  }
}

namespace {

WantedReceiver whole(const Facets& facets, std::uint32_t receiver) {
  const Receiver& of = facets.receivers[receiver];
  WantedReceiver wanted{receiver, {}, of.corners};
  std::copy_n(of.outline.begin(), of.corners, wanted.outline.begin());
  return wanted;
}

}  // namespace

TEST_CASE("all schedules give the same bits") {
  for (std::uint32_t seed = 1; seed < 5; ++seed) {
    const Facets facets = facet_soup(seed, 300, 0.3);
    for (const ShadowLight& light : kLights) {
      CAPTURE(seed);
      const ProjectedShadows in_sequence = project_in_sequence(facets, light);
      CHECK(in_sequence.triangles.size() > 100);
      for (const int threads : {1, 3}) {
        ThreadPool pool{threads};
        CHECK(same(in_sequence, project_in_parallel(facets, light, pool)));
        CHECK(same(in_sequence, project_by_grid(facets, light, pool)));
      }
    }
  }
}

TEST_CASE("a floor under thousands of casters, which threads share, has the bits of one thread") {
  constexpr int kCasters = 9000;
  const Facets soup = facet_soup(3, kCasters, 0.02);
  std::vector<Facet> corners = soup.facets;
  add_quad(corners, {-9, -2, 9}, {9, -2, 9}, {9, -2, -9}, {-9, -2, -9});
  const Facets facets = make_facets(std::move(corners));
  const std::uint32_t floor = facets.receiver_of[kCasters];
  const ShadowLight light = kLights[0];
  ThreadPool pool{3}, one{1};
  // The other receivers are thousands, too many for every caster against each.
  const std::array wanted{whole(facets, floor)};
  const ProjectedShadows by_grid = project_onto(wanted, facets, light, pool);
  std::size_t casters = 0;
  for (std::size_t i = 0; i < kCasters; ++i) {
    casters += stops_light(facets.facets[i], facets.planes[i], light) ? 1 : 0;
  }
  CHECK(casters > 4096);
  CHECK(by_grid.triangles.size() == casters);  // none is cut, all lie above it
  CHECK(same(by_grid, project_onto(wanted, facets, light, one)));
  // In the casters' order: each triangle's middle lies under its caster, as the light falls.
  std::size_t at = by_grid.begins[floor];
  for (std::size_t i = 0; i < kCasters; ++i) {
    if (!stops_light(facets.facets[i], facets.planes[i], light)) continue;
    const ProjectedTriangle& shadow = by_grid.triangles[at++];
    const glm::dvec3 corner = facets.facets[i].corners[0],
                     fallen = glm::dvec3{shadow[0]} / shadow[0].w;
    const glm::dvec3 way = cross(corner - fallen, light.place);
    REQUIRE(dot(way, way) < 1e-18);
  }
}

TEST_CASE("receivers that nobody wants get no triangles, the others what they had") {
  const Facets facets = facet_soup(2, 300, 0.3);
  const auto receivers = static_cast<std::uint32_t>(facets.receivers.size());
  ThreadPool pool{2};
  for (const ShadowLight& light : kLights) {
    const ProjectedShadows all = project_by_grid(facets, light, pool);
    CHECK(all.of_all);
    // Of few the grid has the cells that they look at alone.
    for (const std::uint32_t step : {3u, 7u, 40u}) {
      CAPTURE(step);
      std::vector<WantedReceiver> wanted;
      for (std::uint32_t r = 1; r < receivers; r += step) wanted.push_back(whole(facets, r));
      const ProjectedShadows some = project_onto(wanted, facets, light, pool);
      CHECK(!some.of_all);
      CHECK(some.lit == all.lit);
      for (std::size_t r = 0; r < receivers; ++r) {
        const std::size_t count = some.begins[r + 1] - some.begins[r];
        REQUIRE(count == (r % step == 1 ? all.begins[r + 1] - all.begins[r] : 0));
        for (std::size_t i = 0; i < count; ++i) {
          REQUIRE(some.triangles[some.begins[r] + i] == all.triangles[all.begins[r] + i]);
        }
      }
    }
  }
}

TEST_CASE("a part of a floor gets the shadows that touch it, and few others") {
  std::vector<Facet> corners = facet_soup(3, 400, 0.1).facets;
  add_quad(corners, {-9, -2, 9}, {9, -2, 9}, {9, -2, -9}, {-9, -2, -9});
  const Facets facets = make_facets(std::move(corners));
  WantedReceiver part = whole(facets, facets.receiver_of[400]);
  part.corners = 8;
  const auto corner = [](double eighth) {
    const double angle = 0.3 + 0.785398 * eighth;
    return glm::dvec3{0.4 * std::cos(angle), -2, 0.4 * std::sin(angle)};
  };
  const auto inside = [&](glm::dvec3 p) {
    for (std::size_t i = 0; i < 8; ++i) {
      const glm::dvec3 a = part.outline[i], b = part.outline[(i + 1) % 8];
      if ((b.x - a.x) * (p.z - a.z) - (b.z - a.z) * (p.x - a.x) < -1e-12) return false;
    }
    return true;
  };
  const auto touches = [&](const ProjectedTriangle& shadow) {
    constexpr int kSteps = 24;
    for (int i = 0; i <= kSteps; ++i) {
      for (int k = 0; i + k <= kSteps; ++k) {
        const double s = double(i) / kSteps, t = double(k) / kSteps;
        const glm::dvec4 p = shadow[0] * (1.0 - s - t) + shadow[1] * s + shadow[2] * t;
        if (p.w > 0.0 && inside(glm::dvec3{p} / p.w)) return true;
      }
    }
    return false;
  };
  // Outlines around the floor's middle: an octagon; a square whose corners are there twice, exactly
  // or but for rounding; a square with a corner in the middle of each edge.
  const auto eight = [&](std::size_t i) { return corner(static_cast<double>(i)); };
  const auto twice = [&](std::size_t i) { return corner(static_cast<double>(i - i % 2)); };
  const auto almost = [&](std::size_t i) { return twice(i) * (i % 2 == 0 ? 1.0 : 1.0 + 0x1p-52); };
  const auto between = [&](std::size_t i) { return (twice(i) + twice((i + 1) % 8)) * 0.5; };
  const std::vector<std::function<glm::dvec3(std::size_t)>> outlines{eight, twice, almost, between};
  ThreadPool pool{2};
  for (const auto& outline : outlines) {
    for (std::size_t i = 0; i < 8; ++i) part.outline[i] = outline(i);
    for (const ShadowLight& light :
         {ShadowLight{normalize(glm::dvec3{0.3, 1, 0.2}), 0.0}, ShadowLight{{0.5, 6, 1}, 1.0}}) {
      const ProjectedShadows all = project_by_grid(facets, light, pool);
      const ProjectedShadows some = project_onto({&part, 1}, facets, light, pool);
      std::size_t kept = 0, touching = 0;
      for (std::size_t i = all.begins[part.receiver]; i < all.begins[part.receiver + 1]; ++i) {
        const bool is_kept =
            kept < some.triangles.size() && some.triangles[kept] == all.triangles[i];
        kept += is_kept ? 1 : 0;
        const bool does_touch = touches(all.triangles[i]);
        touching += does_touch ? 1 : 0;
        REQUIRE((is_kept || !does_touch));
      }
      CHECK(kept == some.triangles.size());
      CHECK(touching > 10);
      CHECK(kept < touching + touching / 4 + 4);
      CHECK(all.triangles.size() > 2 * kept);
    }
  }
}

TEST_CASE("lights in awkward places give finite triangles") {
  const Facets facets = facet_soup(9, 200, 0.3);
  ThreadPool pool{1};
  const glm::dvec3 corner = facets.facets[5].corners[1];
  const glm::dvec3 in_plane = (facets.facets[3].corners[0] + facets.facets[3].corners[1]) * 0.5;
  for (const ShadowLight& light :
       {ShadowLight{corner, 1.0}, ShadowLight{in_plane, 1.0}, ShadowLight{{1e9, 0, 0}, 1.0},
        ShadowLight{{0, 0, 0}, 1.0}, ShadowLight{facets.planes[2].normal, 0.0}}) {
    const ProjectedShadows in_sequence = project_in_sequence(facets, light);
    CHECK(same(in_sequence, project_by_grid(facets, light, pool)));
    for (const ProjectedTriangle& triangle : in_sequence.triangles) {
      for (const glm::dvec4& p : triangle) {
        CHECK((std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && p.w >= 0.0));
      }
    }
  }
}

TEST_CASE("facets without area receive and cast nothing") {
  std::vector<Facet> corners;
  add_floor(corners, 9);
  add_triangle(corners, {0, 1, 0}, {1, 1, 0}, {2, 1, 0});
  add_triangle(corners, {0, 1, 0}, {0, 1, 0}, {0, 1, 0});
  const Facets facets = make_facets(std::move(corners));
  const ProjectedShadows shadows = project_in_sequence(facets, {{0, 3, 0}, 1.0});
  CHECK(shadows.triangles.empty());
  CHECK(shadows.lit[facets.receiver_of[2]] == LitSide::both);
}
