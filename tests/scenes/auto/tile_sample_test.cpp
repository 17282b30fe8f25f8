#include "scenes/auto/tile_sample.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "dof/measure/flip.h"
#include "raster/images/texel.h"
#include "raster/pipeline/draw_call.h"

using namespace softfocus;
using doctest::Approx;

namespace {

constexpr int kTiles = 12;  // a side

// Grey everywhere, and `extra` light in the middle of some tiles, the more the farther right.
Image picture_with(float extra) {
  const int side = kTiles * kTileSize;
  Image image = make_image(Format::rgba16f, side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const int column = x / kTileSize, line = y / kTileSize;
      const bool is_inside = std::min(x % kTileSize, y % kTileSize) >= 12 &&
                             std::max(x % kTileSize, y % kTileSize) < kTileSize - 12;
      const bool is_changed = is_inside && (column + 2 * line) % 3 == 0;
      const float light =
          0.2f + (is_changed ? extra * static_cast<float>(column + 1) / kTiles : 0.0f);
      store_texel(image, x, y, {light, light, light, 1.0f}, {});
    }
  }
  return image;
}

double flip_of_all(const Image& a, const Image& b, ThreadPool& pool) {
  return mean(flip_map(a, b, clamped_tone(), pool));
}

}  // namespace

TEST_CASE("tile sample: no more tiles than wanted, all are taken, and the estimate is exact") {
  ThreadPool pool{2};
  const Image a = make_image(Format::rgba16f, 100, 70);
  Image b = a;
  clear_image(b, {0.5f, 0.5f, 0.5f, 0.0f}, Profile{});
  const TileSample sample = sample_tiles(a, b, 24, pool);
  REQUIRE(sample.tiles.size() == 4);
  for (const SampledTile& tile : sample.tiles) CHECK(tile.chance == 1.0);
  const Estimate found = flip_of_tiles(sample, a, b, pool);
  CHECK(found.mean == Approx(flip_of_all(a, b, pool)).epsilon(1e-9));
  CHECK(found.standard_error == 0.0);
}

TEST_CASE("tile sample: chances are within 1, sum up to the count, and follow the change") {
  ThreadPool pool{2};
  const TileSample sample = sample_tiles(picture_with(0.0f), picture_with(0.5f), 24, pool);
  CHECK(sample.tiles.size() >= 23);
  CHECK(sample.tiles.size() <= 25);
  int changed = 0;
  for (const SampledTile& of : sample.tiles) {
    CHECK(of.chance > 0.0);
    CHECK(of.chance <= 1.0);
    changed += (of.tile % kTiles + 2 * (of.tile / kTiles)) % 3 == 0 ? 1 : 0;
  }
  CHECK(changed >= 20);  // a third of the tiles
}

TEST_CASE("tile sample: the estimate lies within three standard errors of the whole picture's" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  const Image truth = picture_with(0.4f);
  const TileSample sample = sample_tiles(picture_with(0.0f), picture_with(0.5f), 24, pool);
  for (const float light : {0.0f, 0.2f, 0.35f}) {
    const Image test = picture_with(light);
    const double expected = flip_of_all(truth, test, pool);
    const Estimate found = flip_of_tiles(sample, truth, test, pool);
    CAPTURE(light);
    CHECK(found.standard_error > 0.0);
    CHECK(found.standard_error < 0.3 * expected);
    CHECK(std::fabs(found.mean - expected) < 3.0 * found.standard_error + 0.02 * expected);
  }
  CHECK(flip_of_tiles(sample, truth, truth, pool).mean == 0.0);
}
