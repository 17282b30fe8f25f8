#include "dof/auto/cell_means.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr PixelCoc kCoc{12.0f, 2.0f};

// As the header's words say, cell by cell.
CellMean oracle(const Image& image, int column, int row) {
  const int x_end = std::min((column + 1) * kCellPx, image.width);
  const int y_end = std::min((row + 1) * kCellPx, image.height);
  CellMean mean;
  int pixels = 0;
  for (int x = column * kCellPx; x < x_end; ++x) {
    CellMean sum;
    for (int y = row * kCellPx; y < y_end; ++y) {
      const glm::vec4 texel = load_texel<Format::rgba16f>(image, x, y);
      for (int i = 0; i < 3; ++i) sum.colour[static_cast<std::size_t>(i)] += trait_light(texel[i]);
      const float radius_px = signed_trait_radius(kCoc, texel.w);
      sum.radius_px += radius_px;
      for (int i = 0; i < 3 && std::abs(radius_px) >= 0.5f; ++i) {
        mean.brightest = std::max(mean.brightest, trait_light(texel[i]));
      }
      ++pixels;
    }
    for (std::size_t i = 0; i < 3; ++i) mean.colour[i] += sum.colour[i];
    mean.radius_px += sum.radius_px;
  }
  for (float& channel : mean.colour) channel /= static_cast<float>(pixels);
  mean.radius_px /= static_cast<float>(pixels);
  return mean;
}

}  // namespace

TEST_CASE("cell means: the oracle's bits, of any size, on any threads and vector unit") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const auto& [width, height] : {std::pair{64, 16}, std::pair{75, 21}, std::pair{3, 2}}) {
    Image image = random_scene_image(width, height, 3);
    store_texel(image, 0, 0, {-1.0f, kInfinity, std::numeric_limits<float>::quiet_NaN(), 0.0f}, {});
    store_texel(image, width - 1, height - 1, {1.0f, 2.0f, 3.0f, kInfinity}, {});
    for (const Isa isa : available_isas()) {
      for (const int threads : {1, 3}) {
        ThreadPool pool{threads, isa};
        const CellMeans means = cell_means(image, kCoc, pool);
        REQUIRE(means.columns == (width + 7) / 8);
        REQUIRE(means.rows == (height + 7) / 8);
        for (int row = 0; row < means.rows; ++row) {
          for (int column = 0; column < means.columns; ++column) {
            const CellMean expected = oracle(image, column, row);
            const CellMean& found =
                means.cells[static_cast<std::size_t>(row * means.columns + column)];
            CHECK(found.colour == expected.colour);
            CHECK(found.radius_px == expected.radius_px);
            CHECK(found.brightest == expected.brightest);
          }
        }
      }
    }
  }
}

TEST_CASE("cell means: a lamp of one pixel is there with all of its light") {
  Image image = make_image(Format::rgba16f, 32, 32);
  clear_image(image, {0.0f, 0.0f, 0.0f, 4.0f}, Profile{});
  store_texel(image, 13, 21, {640.0f, 64.0f, 6.4f, 4.0f}, {});
  ThreadPool pool{1};
  const CellMeans means = cell_means(image, kCoc, pool);
  const CellMean& lamp = means.cells[2 * 4 + 1];
  CHECK(lamp.colour[0] == 10.0f);
  CHECK(lamp.colour[1] == 1.0f);
  CHECK(lamp.radius_px == 6.0f);
  CHECK(lamp.brightest == 640.0f);
}
