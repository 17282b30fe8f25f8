#pragma once
// The picture of disc_layers.h at each level: pixels of 1, 2, 4, ... across.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "dof/disc_layers/disc_ladder.h"
#include "dof/disc_layers/disc_tile.h"
#include "dof/dof.h"

namespace softfocus {

/// Blocks of pixels that know which rungs are in them.
inline constexpr int kDiscBlock = 8;

/// Planes of a level, each row with a margin at either end and room for whole tiles.
struct DiscPlanes {
  std::ptrdiff_t stride, plane;
  float* values;  ///< of the levels' memory
};
inline float* plane_row(const DiscPlanes& planes, int plane, int y) {
  return planes.values + plane * planes.plane + y * planes.stride;
}

struct DiscLevel {
  int width, height;
  int block_columns, block_rows;
  std::vector<std::uint32_t> rungs[2];  ///< of blocks: the level's, a bit each, on either side
  /// The channels of DiscRow, before and behind the focus. Level 0 has none: it is the
  /// picture itself.
  DiscPlanes sides[2];
  std::vector<std::uint8_t> filled[2];  ///< of rows: others are not in `sides`, they are `zeros`
  std::vector<float> zeros;
  /// What is seen of this level and of larger ones, colour and transmittance.
  DiscPlanes seen[2];
};

/// The row of one side at pixel x, which may lie kDiscMargin outside; rows outside repeat.
/// Not of level 0.
DiscRow disc_row(const DiscLevel& level, int side, int x, int y);

/// Levels for the rungs of a ladder; what is seen of them is left to be filled. One piece of
/// memory, so that it is not given back to the system after each frame.
struct DiscLevels {
  std::vector<DiscLevel> levels;
  std::unique_ptr<float[]> memory;
};
DiscLevels make_disc_levels(const DofInput& input, const std::vector<LevelRungs>& ladder,
                            ThreadPool& pool);

/// `count` pixels of a row of the picture from `x` on, as rows of level 0: colours and
/// signed squares, `channel` floats apart. Its edges repeat outwards.
void split_disc_row(const DofInput& input, int x, int y, int count, float* to,
                    std::ptrdiff_t channel, Isa isa);

/// The rungs of one side whose pixels may reach into a rectangle of a level.
std::uint32_t rungs_near(const DiscLevel& level, int side, int x, int y, int width, int height);

}  // namespace softfocus
