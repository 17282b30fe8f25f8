#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/ray_distribution/behind.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dof/scatter/layer_planes.h"

namespace softfocus {

// Two rows of a level of the pyramid that a row of the picture lies between.
struct GuessRows {
  const float* rows[2];  // red of columns 0; green, blue, radius follow, `plane` floats apart
  float shares[2];
  std::ptrdiff_t plane;
  // For each column of the picture the two columns of the level that it lies between, and the first
  // one's share.
  const std::int32_t *near, *far;
  const float* near_share;
};

// The radii of a tile.
struct TileRadii {
  float least = kNothingBehind, most = -kNothingBehind;
  bool torn = false;  // whether it has neighbours of different surfaces
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/ray_distribution/behind.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// A level of the pyramid, its pixels some power of two as wide as the picture's, and
// GuessRows' columns.
struct FarthestLevel {
  Planes pixels;
  std::vector<std::int32_t> near, far;
  std::vector<float> near_share;
};

// The scalar form of farthest_row().
void farthest_row_scalar(const Planes& fine, int y, int first, int end, Planes& coarse) {
  const PullPair rows = pull_pair(y, fine.height);
  const float* top = plane_row(fine, 0, rows.first);
  const float* bottom = plane_row(fine, 0, rows.second);
  for (int x = first; x < end; ++x) {
    const PullPair columns = pull_pair(x, fine.width);
    const std::array<const float*, 4> from{top + columns.first, top + columns.second,
                                           bottom + columns.first, bottom + columns.second};
    const std::ptrdiff_t radius = 3 * fine.plane;
    const float farthest = std::max(std::max(from[0][radius], from[1][radius]),
                                    std::max(from[2][radius], from[3][radius]));
    std::array<float, 4> share;
    for (std::size_t i = 0; i < 4; ++i) {
      share[i] = from[i][radius] >= farthest - kSurfaceStep ? 1.0f : 0.0f;
    }
    const float count = (share[0] + share[1]) + (share[2] + share[3]);
    for (int i = 0; i < 4; ++i) {
      const std::ptrdiff_t plane = i * fine.plane;
      const float sum = (share[0] * from[0][plane] + share[1] * from[1][plane]) +
                        (share[2] * from[2][plane] + share[3] * from[3][plane]);
      plane_row(coarse, i, y)[x] = sum / count;
    }
  }
}

// Columns of a level whose pairs lie side by side go in lanes.
void farthest_row(const Planes& fine, int y, Planes& coarse, Isa isa) {
  const PullPair rows = pull_pair(y, fine.height);
  for (int x = 0; x < coarse.width; x += kMostLanes) {
    const int end = std::min(x + kMostLanes, coarse.width);
    const int from = pull_pair(x, fine.width).first;
    const bool side_by_side = pull_pair(end - 1, fine.width).second == from + 2 * (end - x) - 1 &&
                              from + 2 * kMostLanes <= fine.stride;
    if (isa == Isa::scalar || !side_by_side) {
      farthest_row_scalar(fine, y, x, end, coarse);
    } else {
      SOFTFOCUS_KERNEL(isa, farthest_row)
      (plane_row(fine, 0, rows.first) + from, plane_row(fine, 0, rows.second) + from, fine.plane,
       plane_row(coarse, 0, y) + x, coarse.plane);
    }
  }
}

// The scalar form of measure_tile(). The rows go on up to pixel `last`.
void measure_tile_scalar(const float* radius, std::ptrdiff_t stride, int rows, bool more_rows,
                         int last, TileRadii& tile) {
  for (int y = 0; y < rows; ++y) {
    const float* here = radius + y * stride;
    const float* below = y + 1 < rows || more_rows ? here + stride : here;
    for (int x = 0; x <= std::min(last, kReachTile - 1); ++x) {
      tile.least = std::min(tile.least, here[x]);
      tile.most = std::max(tile.most, here[x]);
      tile.torn |= std::fabs(here[std::min(x + 1, last)] - here[x]) > kSurfaceStep ||
                   std::fabs(below[x] - here[x]) > kSurfaceStep;
    }
  }
}

std::vector<TileRadii> measure_tiles(const Planes& scene, ThreadPool& pool) {
  const TileMask size = full_mask(scene.width, scene.height);
  std::vector<TileRadii> tiles(size.set.size());
  pool.for_each(size.height, [&](int tile_y) {
    const int y = tile_y * kReachTile, rows = std::min(kReachTile, scene.height - y);
    const bool more_rows = tile_y + 1 < size.height;
    for (int tile_x = 0; tile_x < size.width; ++tile_x) {
      const int x = tile_x * kReachTile;
      TileRadii& tile = tiles[static_cast<std::size_t>(tile_y * size.width + tile_x)];
      const float* radius = plane_row(scene, 3, y) + x;
      // The last tile ends with the row, past which lanes would read.
      if (pool.isa() == Isa::scalar || tile_x + 1 == size.width) {
        measure_tile_scalar(radius, scene.stride, rows, more_rows, scene.width - 1 - x, tile);
      } else {
        SOFTFOCUS_KERNEL(pool.isa(), measure_tile)(radius, scene.stride, rows, more_rows, tile);
      }
    }
  });
  return tiles;
}

// A pixel can be seen past an edge if it is no farther from it than the two sides move apart.
TileMask seen_tiles(const Planes& scene, const std::vector<TileRadii>& tiles, float farthest) {
  TileMask torn = full_mask(scene.width, scene.height);
  TileReach reach{torn.width, torn.height, std::vector<int>(tiles.size(), -1)};
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    torn.set[i] = tiles[i].torn ? 1 : 0;
    const float apart = farthest - tiles[i].least;
    if (apart > kSurfaceStep) reach.reach_px[i] = static_cast<int>(apart) + 1;
  }
  return touching(reach, torn);
}

// FarthestLevel `i` above `fine`.
FarthestLevel make_level(const Planes& scene, const std::vector<FarthestLevel>& finer,
                         ThreadPool& pool) {
  const Planes& fine = finer.empty() ? scene : finer.back().pixels;
  FarthestLevel level{
      make_planes(4, (fine.width + 1) / 2, (fine.height + 1) / 2, pool), {}, {}, {}};
  pool.for_each(level.pixels.height,
                [&](int y) { farthest_row(fine, y, level.pixels, pool.isa()); });
  const auto columns = static_cast<std::size_t>(plane_stride(scene.width));
  level.near.resize(columns);
  level.far.resize(columns);
  level.near_share.resize(columns);
  for (std::size_t x = 0; x < static_cast<std::size_t>(scene.width); ++x) {
    const PushTap tap =
        push_tap(finer.empty() ? static_cast<int>(x) : finer.back().near[x], fine.width);
    level.near[x] = tap.near;
    level.far[x] = tap.far;
    level.near_share[x] = tap.near_share;
  }
  return level;
}

// The rows of all levels that row `y` of the picture lies between.
std::vector<GuessRows> guess_rows(const Planes& scene, const std::vector<FarthestLevel>& levels,
                                  int y) {
  std::vector<GuessRows> rows;
  int height = scene.height;
  for (const FarthestLevel& level : levels) {
    const PushTap down = push_tap(y, height);
    rows.push_back({{plane_row(level.pixels, 0, down.near), plane_row(level.pixels, 0, down.far)},
                    {down.near_share, 1.0f - down.near_share},
                    level.pixels.plane,
                    level.near.data(),
                    level.far.data(),
                    level.near_share.data()});
    y = down.near;
    height = level.pixels.height;
  }
  return rows;
}

// Column `x` whose radius is `own`; kNothingBehind if no level has a guess.
std::array<float, 4> guess(const std::vector<GuessRows>& levels, std::size_t x, float own) {
  for (const GuessRows& level : levels) {
    std::array<float, 4> sums{};
    float total = 0.0f;
    for (int row = 0; row < 2; ++row) {
      for (const auto& [column, share] : {std::pair{level.near[x], level.near_share[x]},
                                          std::pair{level.far[x], 1.0f - level.near_share[x]}}) {
        const float* from = level.rows[row] + column;
        if (!(from[3 * level.plane] > own + kSurfaceStep)) continue;
        const float weight = level.shares[row] * share;
        for (int c = 0; c < 4; ++c) {
          sums[static_cast<std::size_t>(c)] += weight * from[c * level.plane];
        }
        total += weight;
      }
    }
    if (!(total > 0.0f)) continue;
    for (float& sum : sums) sum /= total;
    return sums;
  }
  return {0.0f, 0.0f, 0.0f, kNothingBehind};
}

// The scalar form of guess_row().
void guess_row_scalar(const std::vector<GuessRows>& levels, const float* own, int first, int end,
                      float* to, std::ptrdiff_t plane) {
  for (int x = first; x < end; ++x) {
    const std::array<float, 4> pixel = guess(levels, static_cast<std::size_t>(x), own[x]);
    for (int c = 0; c < 4; ++c) to[c * plane + x] = pixel[static_cast<std::size_t>(c)];
  }
}

}  // namespace

Behind guess_behind(const Planes& scene, ThreadPool& pool) {
  const std::vector<TileRadii> tiles = measure_tiles(scene, pool);
  float nearest = kNothingBehind, farthest = -kNothingBehind;
  for (const TileRadii& tile : tiles) {
    nearest = std::min(nearest, tile.least);
    farthest = std::max(farthest, tile.most);
  }
  Behind behind{make_planes(4, scene.width, scene.height, pool),
                seen_tiles(scene, tiles, farthest)};
  std::vector<FarthestLevel> levels;
  // A level's pixels are `size` pixels wide.
  for (int size = 1; static_cast<float>(size) < 2.0f * (farthest - nearest); size *= 2) {
    const Planes& fine = levels.empty() ? scene : levels.back().pixels;
    if (fine.width == 1 && fine.height == 1) break;
    levels.push_back(make_level(scene, levels, pool));
  }
  pool.for_each(scene.height, [&](int y) {
    const std::vector<GuessRows> rows = guess_rows(scene, levels, y);
    const float* own = plane_row(scene, 3, y);
    float* to = plane_row(behind.pixels, 0, y);
    std::fill_n(to + 3 * behind.pixels.plane, behind.pixels.stride, kNothingBehind);
    for (int x = 0; x < scene.width; x += kReachTile) {
      if (!is_set(behind.seen, x, y)) continue;
      const int end = std::min(x + kReachTile, scene.width);
      if (pool.isa() == Isa::scalar) {
        guess_row_scalar(rows, own, x, end, to, behind.pixels.plane);
      } else {
        SOFTFOCUS_KERNEL(pool.isa(), guess_row)
        (rows.data(), static_cast<int>(rows.size()), own, x, end, to, behind.pixels.plane);
      }
    }
  });
  return behind;
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

}  // namespace

/// kMostLanes pixels of a level: of each 2x2 pixels of two rows of the finer one the farthest.
void farthest_row(const float* top, const float* bottom, std::ptrdiff_t plane, float* to,
                  std::ptrdiff_t to_plane) {
  for (int x = 0; x < kMostLanes; x += kLanes) {
    const TwoVectors above = load_pairs(top + 3 * plane + 2 * x);
    const TwoVectors below = load_pairs(bottom + 3 * plane + 2 * x);
    const Floats least =
        larger(larger(above.first, above.second), larger(below.first, below.second)) - kSurfaceStep;
    const Floats one = splat(1.0f), none = splat(0.0f);
    const Floats share0 = select(above.first >= least, one, none);
    const Floats share1 = select(above.second >= least, one, none);
    const Floats share2 = select(below.first >= least, one, none);
    const Floats share3 = select(below.second >= least, one, none);
    const Floats count = (share0 + share1) + (share2 + share3);
    for (int c = 0; c < 4; ++c) {
      const TwoVectors upper = load_pairs(top + c * plane + 2 * x);
      const TwoVectors lower = load_pairs(bottom + c * plane + 2 * x);
      const Floats sum = (share0 * upper.first + share1 * upper.second) +
                         (share2 * lower.first + share3 * lower.second);
      store(to + c * to_plane + x, sum / count);
    }
  }
}

/// The radii of some rows of a tile. Needs one more pixel of each.
void measure_tile(const float* radius, std::ptrdiff_t stride, int rows, bool more_rows,
                  TileRadii& tile) {
  Floats least = splat(tile.least), most = splat(tile.most);
  Mask torn{};
  for (int y = 0; y < rows; ++y) {
    const float* here = radius + y * stride;
    const float* below = y + 1 < rows || more_rows ? here + stride : here;
    for (int x = 0; x < kReachTile; x += kLanes) {
      const Floats own = load(here + x);
      least = smaller(own, least);
      most = larger(own, most);
      torn |= (absolute(load(here + x + 1) - own) > kSurfaceStep) |
              (absolute(load(below + x) - own) > kSurfaceStep);
    }
  }
  for (int i = 0; i < kLanes; ++i) {
    if (least[i] < tile.least) tile.least = least[i];
    if (most[i] > tile.most) tile.most = most[i];
  }
  tile.torn = any(torn);
}

/// Guesses what lies behind the columns first to end - 1 of a row whose radii are `own`.
void guess_row(const GuessRows* levels, int count, const float* own, int first, int end, float* to,
               std::ptrdiff_t plane) {
  const Floats none = splat(0.0f);
  for (int x = first; x < end; x += kLanes) {
    const Floats least = load(own + x) + kSurfaceStep;
    Floats pixel[4] = {none, none, none, splat(kNothingBehind)};
    Mask open = first_lanes(end - x);
    for (int i = 0; i < count && any(open); ++i) {
      const GuessRows& level = levels[i];
      const Floats near_share = load(level.near_share + x);
      const Ints columns[2] = {load(level.near + x), load(level.far + x)};
      const Floats shares[2] = {near_share, 1.0f - near_share};
      Floats sums[4] = {none, none, none, none}, total = none;
      for (int row = 0; row < 2; ++row) {
        for (int column = 0; column < 2; ++column) {
          const float* from = level.rows[row];
          const Floats radius = gather(from + 3 * level.plane, columns[column], open);
          const Mask farther = open & (radius > least);
          if (!any(farther)) continue;
          const Floats weight = select(farther, level.shares[row] * shares[column], none);
          for (int c = 0; c < 3; ++c) {
            sums[c] += weight * gather(from + c * level.plane, columns[column], farther);
          }
          sums[3] += weight * select(farther, radius, none);
          total += weight;
        }
      }
      const Mask found = open & (total > 0.0f);
      for (int c = 0; c < 4; ++c) pixel[c] = select(found, sums[c] / total, pixel[c]);
      open &= ~found;
    }
    for (int c = 0; c < 4; ++c) store(to + c * plane + x, pixel[c]);
  }
}

#endif
