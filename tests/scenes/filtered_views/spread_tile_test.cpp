#include "scenes/filtered_views/spread_tile.h"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/random_bits.h"

using namespace softfocus;

namespace {

constexpr Profile kProfile{};

// A floor that runs through the focus, before it things of all sizes and depths, and a few pixels
// without a finite depth.
Image scattered_picture(int width, int height, std::uint32_t seed) {
  Image picture = make_image(Format::rgba16f, width, height);
  const auto put = [&](int x, int y, float depth, std::uint32_t colour) {
    const float red = static_cast<float>(colour % 97) / 31.0f;
    const float green = static_cast<float>(colour % 89) / 88.0f;
    store_texel<Format::rgba16f>(picture, x, y, {red, green, red * green, depth}, kProfile);
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      put(x, y, 1.5f + 9.0f * static_cast<float>(height - y) / static_cast<float>(height),
          hash_of_place(x / 3, y / 3) + seed);
    }
  }
  for (int thing = 0; thing < 30; ++thing) {
    const std::uint32_t bits = hash_of_place(thing, static_cast<int>(seed));
    const int left = static_cast<int>(bits % static_cast<std::uint32_t>(width));
    const int top = static_cast<int>(bits / 7 % static_cast<std::uint32_t>(height));
    const int side = 1 + static_cast<int>(bits / 77 % 25);
    const float depth = 0.4f + static_cast<float>(bits / 3 % 64) * 0.1f;
    for (int y = top; y < std::min(top + side, height); ++y) {
      for (int x = left; x < std::min(left + side, width); ++x) put(x, y, depth, bits + 11u);
    }
  }
  put(width / 2, height / 2, std::numeric_limits<float>::infinity(), 5);
  put(width / 3, height / 2, std::numeric_limits<float>::quiet_NaN(), 6);
  return picture;
}

ViewTiles in_tiles(const Image& picture, const ViewSpread& spread, Isa isa) {
  ViewTiles view = make_view_tiles(picture.width, picture.height);
  for (int tile = 0; tile < view.tiles_x * view.tiles_y; ++tile) {
    const int left = tile % view.tiles_x * kSpreadTile, top = tile / view.tiles_x * kSpreadTile;
    const int width = std::min(kSpreadTile, picture.width - left);
    std::uint16_t* to = texels_of_tile(view, tile);
    for (int y = top; y < std::min(top + kSpreadTile, picture.height); ++y, to += 4 * width) {
      std::memcpy(to, row<std::uint16_t>(picture, y).data() + 4 * left,
                  8 * static_cast<std::size_t>(width));
    }
    set_levels(view, spread, tile, isa);
  }
  return view;
}

// As spread_view_oracle() gives them.
ColourPlanes spread_in_tiles(const Image& picture, const ViewSpread& spread,
                             const SpreadSteps& steps, Isa isa) {
  const ViewTiles view = in_tiles(picture, spread, isa);
  const auto pixels =
      static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  ColourPlanes planes(3 * pixels);
  SpreadMemory memory = make_spread_memory();
  for (int tile = 0; tile < view.tiles_x * view.tiles_y; ++tile) {
    spread_tile(view, steps, tile, true, memory, isa);
    const int left = tile % view.tiles_x * kSpreadTile, top = tile / view.tiles_x * kSpreadTile;
    for (int y = top; y < std::min(top + kSpreadTile, picture.height); ++y) {
      for (int x = left; x < std::min(left + kSpreadTile, picture.width); ++x) {
        for (int c = 0; c < 3; ++c) {
          const int at = (c * kSpreadTile + y - top) * kSpreadTile + x - left;
          planes[static_cast<std::size_t>(c) * pixels +
                 static_cast<std::size_t>(y * picture.width + x)] =
              memory.sums[static_cast<std::size_t>(at)];
        }
      }
    }
  }
  return planes;
}

}  // namespace

TEST_CASE("spread tile: the oracle's bits, on every vector unit") {
  const LensCells cells = lens_cells({}, 8, 8);
  for (const float radius_px : {1.0f, 9.0f, 40.0f, 300.0f}) {
    const ViewSpread spread = make_view_spread({radius_px, 3.0f}, cells);
    for (const glm::ivec2 size : {glm::ivec2{150, 141}, {64, 128}, {7, 3}}) {
      const int width = size.x, height = size.y;
      const Image picture = scattered_picture(width, height, static_cast<std::uint32_t>(width));
      for (const int cell : {0, 5}) {
        const SpreadSteps steps = spread_steps(spread, points_of(cells, cell));
        const ColourPlanes expected =
            spread_view_oracle(picture, spread, ray_steps(spread, points_of(cells, cell)), 8);
        for (const Isa isa : available_isas()) {
          CAPTURE(radius_px);
          CAPTURE(width);
          CAPTURE(isa_name(isa));
          CHECK(spread_in_tiles(picture, spread, steps, isa) == expected);
        }
      }
    }
  }
}

TEST_CASE("spread tile: a second view is added to the first") {
  const LensCells cells = lens_cells({}, 4, 4);
  const ViewSpread spread = make_view_spread({12.0f, 3.0f}, cells);
  const SpreadSteps steps = spread_steps(spread, points_of(cells, 1));
  const Image picture = scattered_picture(50, 40, 3);
  for (const Isa isa : available_isas()) {
    const ViewTiles view = in_tiles(picture, spread, isa);
    SpreadMemory once = make_spread_memory(), twice = make_spread_memory();
    spread_tile(view, steps, 0, true, once, isa);
    spread_tile(view, steps, 0, true, twice, isa);
    spread_tile(view, steps, 0, false, twice, isa);
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 50; ++x) {
        const auto at = static_cast<std::size_t>(y * kSpreadTile + x);
        CHECK(twice.sums[at] == once.sums[at] + once.sums[at]);
      }
    }
  }
}
