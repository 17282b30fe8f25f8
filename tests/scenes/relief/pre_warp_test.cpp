#include "scenes/relief/warp/pre_warp.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/numbers/vector_math.h"
#include "tests/support/relief_pictures.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

/// Axes at right angles, turned and of different lengths.
ReliefTexture turned_relief(Random& random, int bits) {
  ReliefTexture relief = empty_relief(40, 30, bits, 0.5);
  const auto any = [&] { return random.between(-1.0, 1.0); };
  const glm::dvec3 f = normalize(glm::dvec3{any(), any(), any() + 2.0});
  const glm::dvec3 a = normalize(cross(f, glm::dvec3{any(), 3.0, any()}));
  relief.camera = {{any(), any(), any()}, a * 0.013, cross(f, a) * 0.021, f, 0.5};
  return relief;
}

/// An eye's distance from the plane, 1.5 times the depth and more.
ReliefTexture in_perspective(const ReliefTexture& relief, Random& random) {
  const glm::dvec3 on_plane =
      relief_point(relief, random.between(-60.0, 90.0), random.between(-60.0, 90.0), 0.0);
  return seen_from_eye(relief, on_plane - relief.camera.f * random.between(0.75, 3.0));
}

glm::dvec3 eye_before(const ReliefTexture& relief, Random& random) {
  const glm::dvec3 middle = relief_point(relief, 20.0, 15.0, 0.0);
  const glm::dvec3 aside =
      relief.camera.a * random.between(-60.0, 60.0) + relief.camera.b * random.between(-60.0, 60.0);
  return middle + aside - relief.camera.f * random.between(0.3, 3.0);
}

}  // namespace

TEST_CASE("the pre-warp's equation is the point's projection onto the plane") {
  Random random{7};
  for (int i = 0; i < 200; ++i) {
    const ReliefTexture turned = turned_relief(random, 8);
    const ReliefTexture relief = i % 2 == 0 ? turned : in_perspective(turned, random);
    const glm::dvec3 eye = eye_before(relief, random);
    const double u = random.between(0.0, 39.0), v = random.between(0.0, 29.0);
    const double depth = random.between(0.0, 0.5);
    const WarpedPlace moved = pre_warp_oracle(relief, eye, u, v, depth);
    const WarpedPlace seen = projected_place(relief, eye, u, v, depth);
    CHECK(moved.u == doctest::Approx(seen.u).epsilon(1e-9));
    CHECK(moved.v == doctest::Approx(seen.v).epsilon(1e-9));
    const WarpedPlace exact = exact_place(pre_warp(relief, eye), u, v, depth);
    CHECK(exact.u == doctest::Approx(seen.u).epsilon(1e-9));
    CHECK(exact.v == doctest::Approx(seen.v).epsilon(1e-9));
  }
}

TEST_CASE("a perspective texel's point lies on the eye's ray, its depth n z / (n + z)") {
  Random random{12};
  for (int i = 0; i < 50; ++i) {
    const ReliefTexture relief = in_perspective(turned_relief(random, 8), random);
    const ReliefCamera& camera = relief.camera;
    const double u = random.between(0.0, 39.0), v = random.between(0.0, 29.0);
    const double d = random.between(0.0, 0.5), n = source_distance(camera);
    const glm::dvec3 point = point_at_depth(camera, u, v, d);
    const glm::dvec3 ray = normalize(point_at_depth(camera, u, v, 0.0) - *camera.eye);
    const glm::dvec3 away = cross(point - *camera.eye, ray);
    CHECK(dot(away, away) < 1e-20);
    const double z = dot(point - camera.origin, camera.f);
    CHECK(n * z / (n + z) == doctest::Approx(d).epsilon(1e-9));
  }
}

TEST_CASE("texels move on lines through the epipole: towards it, or away if the eye is farther") {
  Random random{13};
  int outwards = 0;
  for (int i = 0; i < 50; ++i) {
    const ReliefTexture relief = in_perspective(turned_relief(random, 8), random);
    const glm::dvec3 eye = eye_before(relief, random);
    const PreWarp warp = pre_warp(relief, eye);
    outwards += warp.outwards ? 1 : 0;
    CHECK(warp.outwards == (source_distance(relief.camera) < warp.height_m));
    const WarpedPlace moved = pre_warp_oracle(relief, eye, 7.0, 9.0, 0.3);
    const double u = 7.0 - warp.epipole_u, v = 9.0 - warp.epipole_v;
    const double scale = (moved.u - warp.epipole_u) / u;
    CHECK((moved.v - warp.epipole_v) / v == doctest::Approx(scale).epsilon(1e-6));
    CHECK((scale > 1.0) == warp.outwards);
    CHECK(scale > 0.0);
  }
  CHECK(outwards > 5);
  CHECK(outwards < 45);
}

TEST_CASE("a look into the table, two additions and two products give the equation's place") {
  Random random{8};
  for (const int bits : {8, 16}) {
    const ReliefTexture turned = turned_relief(random, bits);
    const ReliefTexture relief = bits == 8 ? turned : in_perspective(turned, random);
    const glm::dvec3 eye = eye_before(relief, random);
    const PreWarp warp = pre_warp(relief, eye);
    const std::vector<WarpedDepth> table = warp_table(warp, bits);
    const std::vector<FixedDepth> fixed = fixed_warp_table(warp, bits);
    REQUIRE(table.size() == static_cast<std::size_t>(last_depth(bits)) + 1);
    for (std::size_t code = 0; code < table.size(); code += bits == 8 ? 1 : 255) {
      const WarpedPlace exact =
          pre_warp_oracle(relief, eye, 31, 7, static_cast<double>(code) * depth_step(relief));
      CHECK(std::fabs((31.0f + table[code].shift_u) * table[code].scale - exact.u) < 1e-3);
      CHECK(std::fabs((7.0f + table[code].shift_v) * table[code].scale - exact.v) < 1e-3);
      // Half a unit of the shift, of the scale and of the place.
      const double u = fixed_place(31 * 256, fixed[code].shift_u, fixed[code].scale) / 256.0;
      CHECK(std::fabs(u - exact.u) < 1.0 / 128.0);
    }
  }
}

TEST_CASE("a row's places have the table's bits on every vector unit") {
  Random random{9};
  const ReliefTexture relief = rough_relief(77, 9, 16, 3);
  const PreWarp warp = pre_warp(relief, {0.4, -0.2, 1.5});
  const std::vector<WarpedDepth> table = warp_table(warp, 16);
  std::vector<std::uint16_t> codes;
  codes.reserve(77);
  for (int i = 0; i < 77; ++i) codes.push_back(static_cast<std::uint16_t>(random.whole(0, 65534)));
  for (const Isa isa : available_isas()) {
    std::vector<float> u(77), v(77);
    warp_row(warp, codes.data(), 77, 5, u.data(), v.data(), isa);
    bool all_equal = true;
    for (std::size_t i = 0; i < 77; ++i) {
      const WarpedDepth& depth = table[codes[i]];
      all_equal &= u[i] == (static_cast<float>(i) + depth.shift_u) * depth.scale &&
                   v[i] == (5.0f + depth.shift_v) * depth.scale;
    }
    CHECK_MESSAGE(all_equal, isa_name(isa));
  }
}
