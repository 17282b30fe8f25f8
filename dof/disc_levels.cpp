#include "dof/disc_levels.h"

#include <algorithm>
#include <array>
#include <cmath>

#define SOFTFOCUS_KERNELS "dof/disc_levels_kernels.inl"
#include "raster/numbers/for_each_isa.inl"

namespace softfocus {
namespace {

DiscLevel make_level(int width, int height) {
  DiscLevel level{};
  level.width = width;
  level.height = height;
  level.block_columns = (width + kDiscBlock - 1) / kDiscBlock;
  level.block_rows = (height + kDiscBlock - 1) / kDiscBlock;
  return level;
}

int padded_width(const DiscLevel& level) { return level.width + 2 * kDiscMargin + kDiscTileWidth; }

void mark_blocks(DiscLevel& level, int first_rung, std::uint32_t all, int strip, Isa isa) {
  const std::size_t row = static_cast<std::size_t>(level.block_columns) * kDiscBlock;
  std::vector<std::uint32_t> near(row), far(row);
  for (DiscPicture& picture : level.sides) {
    if (picture.near.empty()) continue;
    const int side = static_cast<int>(&picture - level.sides);
    std::fill(near.begin(), near.end(), 0u);
    std::fill(far.begin(), far.end(), 0u);
    for (int y = strip * kDiscBlock; y < std::min((strip + 1) * kDiscBlock, level.height); ++y) {
      const DiscRows rows = disc_rows(level, side, 0, y);
      SOFTFOCUS_KERNEL(isa, mark_rungs)
      (rows.square, rows.weight, level.width, first_rung, near.data(), far.data());
    }
    for (int column = 0; column < level.block_columns; ++column) {
      std::uint32_t in_near = 0, in_far = 0;
      for (int x = 0; x < kDiscBlock; ++x) {
        in_near |= near[static_cast<std::size_t>(column * kDiscBlock + x)];
        in_far |= far[static_cast<std::size_t>(column * kDiscBlock + x)];
      }
      const auto at = static_cast<std::size_t>(strip * level.block_columns + column);
      picture.near[at] = in_near & all;
      picture.far[at] = in_far & all;
    }
  }
}

void add_marks(DiscLevel& level, DiscPicture& picture) {
  const auto blocks = static_cast<std::size_t>(level.block_columns * level.block_rows);
  picture.near.assign(blocks, 0);
  picture.far.assign(blocks, 0);
}

DiscLevel split_level(const DofInput& input, ThreadPool& pool) {
  DiscLevel level = make_level(input.scene.width, input.scene.height);
  const int padded = padded_width(level);
  level.ones.assign(static_cast<std::size_t>(padded), 1.0f);
  level.sides[0].planes = make_planes(4, padded, level.height);
  add_marks(level, level.sides[0]);
  Planes& planes = level.sides[0].planes;
  pool.for_each(level.block_rows, [&](int strip) {
    for (int y = strip * kDiscBlock; y < std::min((strip + 1) * kDiscBlock, level.height); ++y) {
      SOFTFOCUS_KERNEL(pool.isa(), split_disc_row)
      (input.settings, row<std::uint16_t>(input.scene, y).data(), level.width,
       static_cast<int>(planes.stride), plane_row(planes, 0, y), planes.plane);
    }
    mark_blocks(level, 0, (1u << kFineRungs) - 1, strip, pool.isa());
  });
  return level;
}

DiscLevel halve_level(const DiscLevel& from, const LevelRungs& of, const LevelRungs& next,
                      int first_rung, ThreadPool& pool) {
  DiscLevel level = make_level((from.width + 1) / 2, (from.height + 1) / 2);
  const int padded = padded_width(level);
  for (DiscPicture& picture : level.sides) {
    picture.planes = make_planes(5, padded, level.height);
    add_marks(level, picture);
  }
  pool.for_each(level.block_rows, [&](int strip) {
    for (int y = strip * kDiscBlock; y < std::min((strip + 1) * kDiscBlock, level.height); ++y) {
      for (int side = 0; side < 2; ++side) {
        Planes& planes = level.sides[side].planes;
        const int from_side = from.whole() ? 0 : side;
        float* to = plane_row(planes, 0, y);
        const DiscHalving halving{
            {disc_rows(from, from_side, 0, 2 * y), disc_rows(from, from_side, 0, 2 * y + 1)},
            from.sides[from_side].planes.plane,
            from.whole() && side == 0 ? -1.0f : 1.0f,
            of.beyond,
            next.rungs[0].square,
            level.width,
            to + kDiscMargin,
            planes.plane};
        SOFTFOCUS_KERNEL(pool.isa(), halve_disc_rows)(halving);
        for (int i = 0; i < 5; ++i, to += planes.plane) {
          std::fill_n(to, kDiscMargin, to[kDiscMargin]);
          std::fill(to + kDiscMargin + level.width, to + planes.stride,
                    to[kDiscMargin + level.width - 1]);
        }
      }
    }
    mark_blocks(level, first_rung, (1u << next.rungs.size()) - 1, strip, pool.isa());
  });
  return level;
}

}  // namespace

DiscRows disc_rows(const DiscLevel& level, int side, int x, int y) {
  const Planes& planes = level.sides[level.whole() ? 0 : side].planes;
  const float* colour = plane_row(planes, 0, std::clamp(y, 0, level.height - 1)) + kDiscMargin + x;
  if (level.whole()) {
    return {colour, level.ones.data() + kDiscMargin + x, colour + 3 * planes.plane};
  }
  return {colour, colour + 3 * planes.plane, colour + 4 * planes.plane};
}

std::vector<DiscLevel> make_disc_levels(const DofInput& input,
                                        const std::vector<LevelRungs>& ladder, ThreadPool& pool) {
  std::vector<DiscLevel> levels;
  levels.reserve(ladder.size());
  levels.push_back(split_level(input, pool));
  int first_rung = kFineRungs;
  for (std::size_t i = 1; i < ladder.size(); ++i) {
    levels.push_back(halve_level(levels[i - 1], ladder[i - 1], ladder[i], first_rung, pool));
    first_rung += static_cast<int>(ladder[i].rungs.size());
  }
  return levels;
}

std::uint32_t rungs_near(const DiscLevel& level, int side, int x, int y, int width, int height) {
  const DiscPicture& picture = level.sides[level.whole() ? 0 : side];
  const std::vector<std::uint32_t>& marks = level.whole() && side == 0 ? picture.near : picture.far;
  const auto block = [](int at, int count) {
    return std::clamp((at + kDiscMargin) / kDiscBlock - 1, 0, count - 1);
  };
  constexpr int kReach = 10;
  std::uint32_t rungs = 0;
  for (int row = block(y - kReach, level.block_rows);
       row <= block(y + height - 1 + kReach, level.block_rows); ++row) {
    for (int column = block(x - kReach, level.block_columns);
         column <= block(x + width - 1 + kReach, level.block_columns); ++column) {
      rungs |= marks[static_cast<std::size_t>(row * level.block_columns + column)];
    }
  }
  return rungs;
}

}  // namespace softfocus
