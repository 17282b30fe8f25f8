#include "scenes/relief/relief_texture.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "raster/numbers/vector_math.h"
#include "tests/support/relief_pictures.h"

using namespace softfocus;
using namespace softfocus::test;

TEST_CASE("a texel of a coarser relief lies in the middle of the four that it stands for") {
  const ReliefTexture fine = sphere_relief(40, 16);
  const ReliefTexture coarse = coarser_relief(fine);
  CHECK(coarse.width == 20);
  const glm::dvec3 apart = relief_point(coarse, 3, 5, 7) - relief_point(fine, 6.5, 10.5, 7);
  CHECK(dot(apart, apart) < 1e-24);
}

TEST_CASE("a coarser relief keeps the outline's place, and the nearest depth of each four") {
  const ReliefTexture fine = sphere_relief(41, 16);
  const ReliefTexture coarse = coarser_relief(fine);
  CHECK(coarse.width == 21);
  int filled = 0, coarse_filled = 0;
  for (const std::uint16_t code : fine.depths) filled += code != 65535 ? 1 : 0;
  for (const std::uint16_t code : coarse.depths) coarse_filled += code != 65535 ? 1 : 0;
  CHECK(4 * coarse_filled > 0.97 * filled);
  CHECK(4 * coarse_filled < 1.03 * filled);
  CHECK(coarse.depths[texel_at(coarse, 10, 10)] ==
        std::min({fine.depths[texel_at(fine, 20, 20)], fine.depths[texel_at(fine, 21, 20)],
                  fine.depths[texel_at(fine, 20, 21)], fine.depths[texel_at(fine, 21, 21)]}));
}

TEST_CASE("a coarser texel mixes no colours of surfaces that lie far apart") {
  ReliefTexture fine = empty_relief(4, 4, 8, 0.3);
  const auto set = [&](int x, int y, std::uint16_t depth, std::uint32_t grey) {
    fine.depths[texel_at(fine, x, y)] = depth;
    fine.colours[texel_at(fine, x, y)] = grey * 0x010101u | 0xFF000000u;
  };
  set(0, 0, 10, 100);
  set(1, 0, 12, 103);
  set(0, 1, 200, 7);
  set(2, 2, 30, 50);  // alone: half of four would be two
  const ReliefTexture coarse = coarser_relief(fine);
  CHECK(coarse.depths[0] == 10);
  CHECK(coarse.colours[0] == (102u * 0x010101u | 0xFF000000u));
  CHECK(coarse.depths[3] == 255);
  CHECK(coarse.colours[3] == 0);
}
