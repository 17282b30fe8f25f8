#include "scenes/make/teapot.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "tests/support/mesh_checks.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

// In Newell's own units, where the teapot is 3.15 high.
Mesh newell_size(int divisions) { return make_teapot(3.15, divisions); }

glm::dvec3 largest(const Mesh& mesh) {
  glm::dvec3 high{-1e9};
  for (const glm::vec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) high[axis] = std::max(high[axis], double{p[axis]});
  }
  return high;
}

glm::dvec3 smallest(const Mesh& mesh) {
  glm::dvec3 low{1e9};
  for (const glm::vec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) low[axis] = std::min(low[axis], double{p[axis]});
  }
  return low;
}

bool has_point(const Mesh& mesh, glm::dvec3 point) {
  return std::any_of(mesh.positions.begin(), mesh.positions.end(),
                     [&](const glm::vec3& p) { return length(glm::dvec3{p} - point) < 1e-6; });
}

}  // namespace

TEST_CASE("the teapot has Newell's extents") {
  const Mesh mesh = newell_size(32);
  CHECK(smallest(mesh).y == 0.0);
  CHECK(largest(mesh).y == doctest::Approx(3.15));
  CHECK(smallest(mesh).x == doctest::Approx(-3.0).epsilon(0.01));   // the handle
  CHECK(largest(mesh).x == doctest::Approx(3.434).epsilon(0.005));  // the spout's lip
  CHECK(largest(mesh).z == doctest::Approx(2.0).epsilon(0.005));    // the body
  CHECK(smallest(mesh).z == -largest(mesh).z);
}

TEST_CASE("the corners of the patches are where Newell's table has them") {
  const Mesh mesh = newell_size(2);
  // Published as (x, y, z) with z up: here (x, z, -y).
  CHECK(has_point(mesh, {1.4, 2.4, 0.0}));     // 103: the rim's inside
  CHECK(has_point(mesh, {1.5, 2.4, 0.0}));     // 13: the body's upper edge
  CHECK(has_point(mesh, {0.0, 0.9, 2.0}));     // 28: the body's middle
  CHECK(has_point(mesh, {1.5, 0.15, 0.0}));    // 38: the foot
  CHECK(has_point(mesh, {-1.6, 2.025, 0.0}));  // 42: where the handle begins
  CHECK(has_point(mesh, {-3.0, 1.8, 0.0}));    // 57: the handle's outermost
  CHECK(has_point(mesh, {-1.9, 0.6, 0.0}));    // 68: where it ends
  CHECK(has_point(mesh, {1.7, 1.425, 0.0}));   // 69: where the spout begins
  CHECK(has_point(mesh, {3.3, 2.4, 0.0}));     // 84: the spout's neck
  CHECK(has_point(mesh, {3.2, 2.4, 0.0}));     // 96: the lip's inside
  CHECK(has_point(mesh, {0.2, 2.7, 0.0}));     // 1: the knob's waist
  CHECK(has_point(mesh, {1.3, 2.4, 0.0}));     // 115: the lid's edge
}

TEST_CASE("the middles of the handle's and spout's patches are where Newell's table has them") {
  // The patches as published, z up, y <= 0; the middle of a bicubic patch is the mean
  // of its 4 x 4 points with weights 1, 3, 3, 1 along each side.
  const double patches[4][4][4][3] = {
      {{{-1.6, 0, 2.025}, {-1.6, -0.3, 2.025}, {-1.5, -0.3, 2.25}, {-1.5, 0, 2.25}},
       {{-2.3, 0, 2.025}, {-2.3, -0.3, 2.025}, {-2.5, -0.3, 2.25}, {-2.5, 0, 2.25}},
       {{-2.7, 0, 2.025}, {-2.7, -0.3, 2.025}, {-3, -0.3, 2.25}, {-3, 0, 2.25}},
       {{-2.7, 0, 1.8}, {-2.7, -0.3, 1.8}, {-3, -0.3, 1.8}, {-3, 0, 1.8}}},
      {{{-2.7, 0, 1.8}, {-2.7, -0.3, 1.8}, {-3, -0.3, 1.8}, {-3, 0, 1.8}},
       {{-2.7, 0, 1.575}, {-2.7, -0.3, 1.575}, {-3, -0.3, 1.35}, {-3, 0, 1.35}},
       {{-2.5, 0, 1.125}, {-2.5, -0.3, 1.125}, {-2.65, -0.3, 0.9375}, {-2.65, 0, 0.9375}},
       {{-2, 0, 0.9}, {-2, -0.3, 0.9}, {-1.9, -0.3, 0.6}, {-1.9, 0, 0.6}}},
      {{{1.7, 0, 1.425}, {1.7, -0.66, 1.425}, {1.7, -0.66, 0.6}, {1.7, 0, 0.6}},
       {{2.6, 0, 1.425}, {2.6, -0.66, 1.425}, {3.1, -0.66, 0.825}, {3.1, 0, 0.825}},
       {{2.3, 0, 2.1}, {2.3, -0.25, 2.1}, {2.4, -0.25, 2.025}, {2.4, 0, 2.025}},
       {{2.7, 0, 2.4}, {2.7, -0.25, 2.4}, {3.3, -0.25, 2.4}, {3.3, 0, 2.4}}},
      {{{2.7, 0, 2.4}, {2.7, -0.25, 2.4}, {3.3, -0.25, 2.4}, {3.3, 0, 2.4}},
       {{2.8, 0, 2.475}, {2.8, -0.25, 2.475}, {3.525, -0.25, 2.49375}, {3.525, 0, 2.49375}},
       {{2.9, 0, 2.475}, {2.9, -0.15, 2.475}, {3.45, -0.15, 2.5125}, {3.45, 0, 2.5125}},
       {{2.8, 0, 2.4}, {2.8, -0.15, 2.4}, {3.2, -0.15, 2.4}, {3.2, 0, 2.4}}}};
  constexpr double kWeights[4] = {0.125, 0.375, 0.375, 0.125};
  const Mesh mesh = newell_size(2);
  for (const auto& patch : patches) {
    glm::dvec3 middle{0.0};
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const auto& p = patch[i][j];
        middle += glm::dvec3{p[0], p[2], -p[1]} * (kWeights[i] * kWeights[j]);
      }
    }
    CHECK(has_point(mesh, middle));
    CHECK(has_point(mesh, {middle.x, middle.y, -middle.z}));
  }
}

TEST_CASE("the rim rises from 2.4 to at most 2.53 and falls back") {
  const Mesh mesh = newell_size(24);
  double highest = 0.0;
  for (const glm::vec3& p : mesh.positions) {
    const double radius = std::sqrt(double{p.x} * p.x + double{p.z} * p.z);
    if (p.x < 0.0f && std::fabs(radius - 1.4) < 0.06) highest = std::max(highest, double{p.y});
  }
  CHECK(highest > 2.48);
  CHECK(highest < 2.53125);
}

TEST_CASE("the teapot is its own mirror image in z") {
  const Mesh mesh = newell_size(6);
  std::set<std::tuple<float, float, float>> points;
  for (const glm::vec3& p : mesh.positions) points.emplace(p.x, p.y, p.z);
  for (const auto& point : points) {
    const auto mirrored = std::any_of(points.begin(), points.end(), [&](const auto& other) {
      return std::fabs(std::get<0>(other) - std::get<0>(point)) < 1e-5f &&
             std::fabs(std::get<1>(other) - std::get<1>(point)) < 1e-5f &&
             std::fabs(std::get<2>(other) + std::get<2>(point)) < 1e-5f;
    });
    CHECK(mirrored);
  }
}

TEST_CASE("the teapot's patches meet to the bit: only its six ends are open") {
  // Rim, lid, two ends of the handle, two of the spout.
  for (const int divisions : {2, 3, 7, 10}) {
    CAPTURE(divisions);
    const Welded welded = weld(newell_size(divisions));
    CHECK(welded.crowded_edges == 0);
    CHECK(boundary_loops(welded) == 6);
    // Rim and lid go round in 4 quarters, handle and spout in 2 halves.
    CHECK(welded.open_edges.size() == static_cast<std::size_t>((4 + 4 + 2 * 4) * divisions));
  }
}

TEST_CASE("the teapot has 64 n^2 - 8 n triangles, none without area") {
  for (const int n : {2, 5, 12}) {
    const Mesh mesh = newell_size(n);
    CHECK(mesh.indices.size() == static_cast<std::size_t>(3 * (64 * n * n - 8 * n)));
    CHECK(smallest_area(mesh) > 1e-7);
  }
}

TEST_CASE("the teapot's normals have unit length and face outwards") {
  const Mesh mesh = newell_size(16);
  CHECK(normal_length_error(mesh) < 2e-7);
  // A triangle spans a wide turn at the knob's top.
  CHECK(normal_agreement(mesh) > 0.5);
  CHECK(volume(mesh) > 0.0);
}

TEST_CASE("at the knob's top and the foot's middle the normal is the axis") {
  const Mesh mesh = newell_size(8);
  int tops = 0;
  int bottoms = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (mesh.positions[i].x != 0.0f || mesh.positions[i].z != 0.0f) continue;
    if (mesh.positions[i].y == 3.15f) {
      ++tops;
      CHECK(mesh.normals[i].y == doctest::Approx(1.0));
    } else if (mesh.positions[i].y == 0.0f) {
      ++bottoms;
      CHECK(mesh.normals[i].y == doctest::Approx(-1.0));
    }
  }
  CHECK(tops == 4 * 8);
  CHECK(bottoms == 4 * 8);
}

TEST_CASE("the teapot's body holds what the profile of its curves encloses") {
  // Pappus, over Newell's profile from the table, once for rim, body and foot as they
  // are turned: the almost-circles enclose a little more than circles.
  const double pieces[3][4][2] = {{{1.5, 2.4}, {1.75, 1.875}, {2.0, 1.35}, {2.0, 0.9}},
                                  {{2.0, 0.9}, {2.0, 0.45}, {1.5, 0.225}, {1.5, 0.15}},
                                  {{1.5, 0.15}, {1.5, 0.075}, {1.425, 0.0}, {0.0, 0.0}}};
  double expected = 0.0;
  double before_r = 1.5;
  double before_y = 2.4;
  for (const auto& p : pieces) {
    for (int i = 1; i <= 2000; ++i) {
      const double t = i / 2000.0;
      const double s = 1.0 - t;
      const auto at = [&](int k) {
        return s * s * s * p[0][k] + 3 * s * s * t * p[1][k] + 3 * s * t * t * p[2][k] +
               t * t * t * p[3][k];
      };
      const double mean_r = (at(0) + before_r) / 2.0;
      expected += 3.14159265358979 * mean_r * mean_r * (before_y - at(1));
      before_r = at(0);
      before_y = at(1);
    }
  }
  // The mesh's volume below y = 2.4 inside the body: cone over each triangle of the
  // revolved part, closed by a disc at 2.4 which adds nothing seen from (0, 2.4, 0).
  const int n = 24;
  const Mesh mesh = newell_size(n);
  // Patches come in the order lid (8), rim (4), body (8), foot (4), handle, spout.
  const std::size_t lid_and_rim = 4u * (2 * n * n - n) + 4u * 2 * n * n + 4u * 2 * n * n;
  const std::size_t body = 8u * 2 * n * n + 4u * (2 * n * n - n);
  const auto triangles = triangles_of(mesh);
  double held = 0.0;
  for (std::size_t i = lid_and_rim; i < lid_and_rim + body; ++i) {
    const glm::dvec3 top{0.0, 2.4, 0.0};
    const auto& t = triangles[i];
    held += dot(t[0] - top, cross(t[1] - top, t[2] - top)) / 6.0;
  }
  CHECK(held == doctest::Approx(expected).epsilon(0.012));
}

TEST_CASE("a teapot is as high as it is asked to be") {
  CHECK(largest(make_teapot(0.2, 6)).y == doctest::Approx(0.2));
}
