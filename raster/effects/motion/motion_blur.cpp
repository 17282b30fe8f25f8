#include "raster/effects/motion/motion_blur.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <vector>

#include "raster/effects/motion/motion_filters.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

/// The pixel's tile, or the next one by chance near its border, so that borders do not show.
glm::vec2 neighbourhood_motion(const MotionBlurPass& pass, const MotionTiles& tiles,
                               const ConstImageView& picture, int x, int y) {
  int at_x = x, at_y = y;
  if (pass.filter == MotionFilter::two_ways) {
    // A quarter of a tile to either side.
    const int i = static_cast<int>(jitter_bits(y, x) >> 16) - 128;
    const int j = static_cast<int>(jitter_bits(y + 1, x) >> 16) - 128;
    at_x = std::clamp(x + (i * pass.radius_px >> 9), 0, picture.width - 1);
    at_y = std::clamp(y + (j * pass.radius_px >> 9), 0, picture.height - 1);
  }
  return tiles
      .v[static_cast<std::size_t>(at_y / pass.radius_px * tiles.columns + at_x / pass.radius_px)];
}

/// None where nothing near moves: the pixel stays.
std::optional<glm::vec3> blurred(const BlurInput& input, int x, int y) {
  const glm::vec2 n = neighbourhood_motion(input.pass, input.tiles, input.picture, x, y);
  const float square = n.x * n.x + n.y * n.y;
  if (!(square > kLeastMotion2)) return {};
  const float length = std::sqrt(square);
  return input.pass.filter == MotionFilter::two_ways ? blurred_two_ways(input, x, y, n, length)
                                                     : blurred_one_way(input, x, y, n, length);
}

/// Tiles in which a pixel may read a motion that counts.
std::vector<bool> moving_tiles(const MotionTiles& tiles, MotionFilter filter) {
  std::vector<bool> moves(tiles.v.size());
  const int reach = filter == MotionFilter::two_ways ? 1 : 0;
  for (int y = 0; y < tiles.rows; ++y) {
    for (int x = 0; x < tiles.columns; ++x) {
      const glm::vec2 v = tiles.v[static_cast<std::size_t>(y * tiles.columns + x)];
      if (!(v.x * v.x + v.y * v.y > kLeastMotion2)) continue;
      for (int j = std::max(y - reach, 0); j <= std::min(y + reach, tiles.rows - 1); ++j) {
        for (int i = std::max(x - reach, 0); i <= std::min(x + reach, tiles.columns - 1); ++i) {
          moves[static_cast<std::size_t>(j * tiles.columns + i)] = true;
        }
      }
    }
  }
  return moves;
}

}  // namespace

void motion_blur(const MotionBlurSettings& settings, const ConstImageView& picture,
                 const ConstImageView& velocity, const ImageView& result, const Profile& profile,
                 ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && result.format == Format::rgba16f);
  assert(velocity.format == Format::rg16f);
  if (!has_whole_strides(picture)) {
    return motion_blur(settings, copy_of(picture), velocity, result, profile, pool);
  }
  const MotionBlurPass pass = pass_of(settings);
  const int width = picture.width, size = pass.radius_px;
  // All of it is written, and zeros before would take a tenth of the time.
  const std::ptrdiff_t stride = (width + 7) / 8 * 8;
  const RowMemory<std::uint64_t> memory = make_row_memory<std::uint64_t>(
      static_cast<std::size_t>(stride * picture.height), &pool.memory());
  const ImageView spread =
      view_of(Format::rgba16f, memory.get(), width, picture.height, 8 * stride);
  motion_to_either_side(pass, velocity, spread, profile, pool);
  const MotionTiles tiles =
      longest_of_neighbours(longest_of_tiles(pass, spread, pool), pass.filter);
  const std::vector<bool> moves = moving_tiles(tiles, pass.filter);
  const ConstImageView spread_view = spread;
  const BlurInput input{pass, picture, spread_view, tiles};
  for_each_row(pool, picture.height, kPassRows, [&](int y) {
    const BlurRow job{pass, source_of(picture), source_of(spread), width, picture.height, tiles, y};
    const auto moves_at = [&](int tile) {
      return moves[static_cast<std::size_t>(y / size * tiles.columns + tile)];
    };
    for (int tile = 0; tile < tiles.columns;) {
      const int first = tile;
      const bool is_moving = moves_at(first);
      while (tile < tiles.columns && moves_at(tile) == is_moving) ++tile;
      const int end = std::min(tile * size, width);
      int x = first * size;
      if (!is_moving) {
        copy_texels(picture, result, y, x, end);
        continue;
      }
      if (pool.isa() != Isa::scalar) {
        const auto blur_row =
            pass.filter == MotionFilter::two_ways ? blur_row_two_ways : blur_row_one_way;
        x = blur_row(pool.isa(), job, x, end, row<std::uint16_t>(result, y).data(),
                     profile.half_store);
      }
      for (; x < end; ++x) {
        store_colour(picture, result, x, y, blurred(input, x, y), profile);
      }
    }
  });
}

}  // namespace softfocus
