#pragma once
// The picture of disc_layers.h at each level: pixels of 1, 2, 4, ... across.

#include <cstdint>
#include <vector>

#include "dof/disc_ladder.h"
#include "dof/disc_tile.h"
#include "dof/picture_planes.h"

namespace softfocus {

/// Blocks of pixels that know which rungs are in them.
inline constexpr int kDiscBlock = 16;

/// What a level has of one side of the focus. Level 0 has both sides in one.
struct DiscPicture {
  Planes planes;  ///< red, green, blue times weight; weight; square. Level 0 has no weight
  std::vector<std::uint32_t> near, far;  ///< of blocks: rungs of the level, a bit each
};

struct DiscLevel {
  int width, height;
  int block_columns, block_rows;
  DiscPicture sides[2];     ///< before the focus, behind it; of level 0 the first is both
  Planes seen[2];           ///< what is seen of this level and larger ones: colour, transmittance
  std::vector<float> ones;  ///< weights of level 0

  bool whole() const { return !ones.empty(); }
};

/// The row of one side at pixel x, which may lie kDiscMargin outside; rows outside repeat.
DiscRows disc_rows(const DiscLevel& level, int side, int x, int y);

/// Levels for the rungs of a ladder, without what is seen of them.
std::vector<DiscLevel> make_disc_levels(const DofInput& input,
                                        const std::vector<LevelRungs>& ladder, ThreadPool& pool);

/// The rungs of one side whose pixels may reach into a rectangle of a level from at most
/// kDiscMargin pixels away.
std::uint32_t rungs_near(const DiscLevel& level, int side, int x, int y, int width, int height);

}  // namespace softfocus
