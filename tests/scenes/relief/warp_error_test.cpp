#include "scenes/relief/warp/warp_error.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

#include "tests/support/relief_pictures.h"

using namespace softfocus;
using namespace softfocus::test;

TEST_CASE("the critical point is the pair of neighbours with the largest step of depth") {
  ReliefTexture relief = empty_relief(9, 7, 8, 0.3);
  for (std::uint16_t& code : relief.depths) code = 100;
  relief.depths[texel_at(relief, 5, 3)] = 255;  // empty texels are no neighbours
  relief.depths[texel_at(relief, 2, 4)] = 140;
  relief.depths[texel_at(relief, 2, 5)] = 90;
  const CriticalPoint point = *critical_point(relief);
  CHECK(point.u1 == 2);
  CHECK(point.v1 == 4);
  CHECK(point.u2 == 2);
  CHECK(point.v2 == 5);
  CHECK(point.code1 - point.code2 == 50);
  CHECK(!critical_point(empty_relief(3, 3, 8, 0.1)));
}

TEST_CASE("no pair of neighbours comes farther apart than the bound") {
  Random random{11};
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    ReliefTexture relief = rough_relief(40, 30, seed % 2 == 0 ? 8 : 16, seed);
    if (seed % 4 < 2) relief.camera.eye = glm::dvec3{0.3, -0.1, 1.2};
    const glm::dvec3 eye{random.between(-2.0, 2.0), random.between(-2.0, 2.0),
                         random.between(0.1, 3.0)};
    const CriticalPoint point = *critical_point(relief);
    const double largest = largest_error(relief, eye);
    CHECK(critical_error(relief, point, eye) <= largest);
    double before = HUGE_VAL;
    for (const int parts : {1, 2, 8}) {
      const CriticalRegions regions =
          critical_regions(relief, *relief_extent(relief), parts, parts);
      const double bound = error_bound(relief, regions, eye);
      CHECK(largest <= bound * (1.0 + 1e-12));
      CHECK(bound <= before * 1.05);
      before = bound;
    }
  }
}

TEST_CASE("one region's mean is the critical point's error") {
  const ReliefTexture relief = rough_relief(40, 30, 8, 6);
  const glm::dvec3 eye{0.5, 0.1, 1.0};
  const CriticalRegions one = critical_regions(relief, *relief_extent(relief), 1, 1);
  CHECK(mean_critical_error(relief, one, eye) ==
        critical_error(relief, *critical_point(relief), eye));
}

TEST_CASE("a pair counts in the region of its first texel") {
  ReliefTexture relief = empty_relief(8, 8, 8, 0.3);
  for (std::uint16_t& code : relief.depths) code = 100;
  relief.depths[texel_at(relief, 3, 5)] = 120;  // towards (4, 5), across the border of regions
  relief.depths[texel_at(relief, 4, 5)] = 90;
  const CriticalRegions cut = critical_regions(relief, *relief_extent(relief), 2, 2);
  REQUIRE(cut.regions[2]);
  CHECK(cut.regions[2]->point.u1 == 3);
  CHECK(cut.regions[2]->point.v1 == 5);
  CHECK(cut.regions[2]->least_code == 90);
  CHECK(cut.regions[0]->point.code1 == cut.regions[0]->point.code2);
}

TEST_CASE(
    "regions have the pairs that a walk over all pairs gives them, in any number of threads") {
  ThreadPool pool(3);
  for (const int parts : {1, 3, 7, 64}) {
    const ReliefTexture relief = rough_relief(37, 29, 8, static_cast<std::uint64_t>(parts));
    const ReliefExtent extent = *relief_extent(relief);
    std::vector<std::optional<CriticalRegion>> right(static_cast<std::size_t>(parts * parts));
    const auto add = [&](int u, int v, int u2, int v2) {
      if (u2 == relief.width || v2 == relief.height) return;
      const int code = relief.depths[texel_at(relief, u, v)];
      const int other = relief.depths[texel_at(relief, u2, v2)];
      if (code == 255 || other == 255) return;
      const int column = (u - extent.x_begin) * parts / (extent.x_end - extent.x_begin);
      const int row = (v - extent.y_begin) * parts / (extent.y_end - extent.y_begin);
      std::optional<CriticalRegion>& region = right[static_cast<std::size_t>(row * parts + column)];
      const CriticalPoint pair{u, v, u2, v2, code, other};
      if (!region) region = CriticalRegion{pair, code, code};
      region->least_code = std::min(region->least_code, std::min(code, other));
      region->most_code = std::max(region->most_code, std::max(code, other));
      if (std::abs(code - other) > std::abs(region->point.code1 - region->point.code2)) {
        region->point = pair;
      }
    };
    for (int v = 0; v < relief.height; ++v) {
      for (int u = 0; u < relief.width; ++u) {
        add(u, v, u + 1, v);
        add(u, v, u, v + 1);
      }
    }
    for (ThreadPool* threads : {static_cast<ThreadPool*>(nullptr), &pool}) {
      const CriticalRegions cut = critical_regions(relief, extent, parts, parts, threads);
      for (std::size_t i = 0; i < right.size(); ++i) {
        REQUIRE(cut.regions[i].has_value() == right[i].has_value());
        if (!right[i]) continue;
        CHECK(cut.regions[i]->least_code == right[i]->least_code);
        CHECK(cut.regions[i]->most_code == right[i]->most_code);
        CHECK(cut.regions[i]->point.u1 == right[i]->point.u1);
        CHECK(cut.regions[i]->point.v1 == right[i]->point.v1);
        CHECK(cut.regions[i]->point.v2 == right[i]->point.v2);
      }
    }
  }
}

TEST_CASE("from straight before a pair, a step of depth pulls nothing apart") {
  const ReliefTexture relief = rough_relief(40, 30, 8, 2);
  const glm::dvec3 far{0.0, 0.0, 1e7};
  CHECK(largest_error(relief, far) == doctest::Approx(1.0).epsilon(1e-4));
}
