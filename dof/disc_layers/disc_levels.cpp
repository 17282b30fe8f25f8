#include "dof/disc_layers/disc_levels.h"

#include <algorithm>

#include "raster/threads/loops.h"

namespace softfocus {
namespace {

// Whether a row has anything on a side. Rows below the last repeat it.
bool row_filled(const DiscLevel& level, int side, int y) {
  return level.filled[side][static_cast<std::size_t>(std::min(y, level.height - 1))] != 0;
}

// The blocks that reach into pixels of a row or column, first and last.
struct BlockRange {
  int first, last;
};
BlockRange blocks_near(int begin, int count, int blocks) {
  return {std::clamp((begin - kDiscApron) / kDiscBlock, 0, blocks - 1),
          std::clamp((begin + count - 1 + kDiscApron) / kDiscBlock, 0, blocks - 1)};
}

}  // namespace

LevelRow disc_row(const DiscLevel& level, int side, int x, int y) {
  const int inside = std::clamp(y, 0, level.height - 1);
  LevelRow row;
  if (!row_filled(level, side, inside)) {
    for (const float*& channel : row.channel) channel = level.zeros.data() + kDiscMargin + x;
    return row;
  }
  const LevelPlanes& planes = level.sides[side];
  const float* at = plane_row(planes, 0, inside) + x;
  for (int i = 0; i < kLevelChannels; ++i) row.channel[i] = at + i * planes.plane;
  return row;
}

Image copy_of(const ConstImageView& picture, ThreadPool& pool) {
  Image copy = make_image(picture.format, picture.width, picture.height);
  constexpr int kRows = 16;
  for_each_row(pool, picture.height, kRows, [&](int y) {
    const auto from = row<std::uint16_t>(picture, y);
    std::copy(from.begin(), from.end(), row<std::uint16_t>(copy, y).begin());
  });
  return copy;
}

std::uint32_t rungs_near(const DiscLevel& level, int side, int x, int y, int width, int height) {
  const BlockRange columns = blocks_near(x, width, level.block_columns);
  const BlockRange rows = blocks_near(y, height, level.block_rows);
  std::uint32_t rungs = 0;
  for (int row = rows.first; row <= rows.last; ++row) {
    const std::uint32_t* blocks =
        &level.rungs[side][static_cast<std::size_t>(row * level.block_columns)];
    for (int column = columns.first; column <= columns.last; ++column) rungs |= blocks[column];
  }
  return rungs;
}

DiscRungBlocks rung_blocks_near(const DiscLevel& level, int side, int x, int y, int width,
                                int height) {
  const BlockRange columns = blocks_near(x, width, level.block_columns);
  const BlockRange rows = blocks_near(y, height, level.block_rows);
  DiscRungBlocks near{
      rows.first, rows.last - rows.first + 1, columns.first, columns.last - columns.first + 1, {},
      {}};
  for (int i = 0; i < near.rows; ++i) {
    const std::uint32_t* blocks =
        &level.rungs[side]
                    [static_cast<std::size_t>((near.row + i) * level.block_columns + near.column)];
    for (int j = 0; j < near.columns; ++j) {
      near.of_row[i] |= blocks[j];
      near.of_column[j] |= blocks[j];
    }
  }
  return near;
}

}  // namespace softfocus
