#pragma once
// The pyramids of mipmap.h: what lies before the focus, what lies behind it or in it, and the
// picture without what lies before the focus, its holes filled; and the ladder of radii.
//
// Rung radii are 0, 1, sqrt(2), 2, ..., half an octave apart. Level 0, the picture itself, has
// the first kFineMipRungs, every further level kMipLevelRungs. With fewer rungs on level 0 the
// filters are smaller, but the discs too soft: mean FLIP over 16 random scenes is .0112 with 7,
// .0121 with 6, .0138 with 5.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "dof/dof.h"
#include "dof/level_stack.h"

namespace softfocus {

inline constexpr int kFineMipRungs = 7;
inline constexpr int kMipLevelRungs = 2;
/// Pixels of a level that a circular filter reaches at most.
inline constexpr int kMipReach = 6;

/// A circular filter: weights[dy][dx] for a quadrant, which sum to 1 over all four.
struct MipRung {
  float square;  ///< of the radius, in pixels of the picture
  RungStep step;
  int reach;
  float weights[kMipReach + 1][kMipReach + 1];
};

struct MipLevelRungs {
  std::vector<MipRung> rungs;
  RungStep beyond;  ///< what belongs to the levels above
};

/// All levels up to the one with a rung of at least `largest_px`.
std::vector<MipLevelRungs> make_mip_ladder(float largest_px);

/// Pixels by which a row goes on at either end, repeating the last.
inline constexpr int kMipMargin = 16;
/// A tile's row with its margins.
inline constexpr int kMipTileRow = kLevelTileWidth + 2 * kMipMargin;
/// A block of 16x8 pixels knows which rungs are in it.
inline constexpr int kMipBlockWidth = 16, kMipBlockHeight = 8;

/// Channels of a filled pixel: red, green, blue, square.
inline constexpr int kFilledSquare = 3, kFilledChannels = 4;
/// Channels of a picture with holes: those times weight, and weight.
inline constexpr int kHoledWeight = 4, kHoledChannels = 5;
/// A pixel with holes counts as whole from a weight of 1 / kFillGain on; below, the next level
/// fills the rest.
inline constexpr float kFillGain = 4.0f;

enum class MipSide { near, far };

struct MipLevel {
  int width = 0, height = 0;
  int block_columns = 0, block_rows = 0;
  // Arrays of two: before the focus, and behind it. Level 0 has marks alone.
  std::vector<std::uint8_t> marks[2];  ///< of a block: a bit for each rung, one for those beyond
  LevelPlanes sides[2];
  LevelPlanes seen[2];
  LevelPlanes filled;
};

struct MipPyramid {
  std::vector<MipLevel> levels;
  bool any_near = false;
  /// Two pieces, so that the allocator keeps them from frame to frame.
  std::unique_ptr<float[]> memory[2];
};
MipPyramid make_mip_pyramid(const DofInput& input, const std::vector<MipLevelRungs>& ladder,
                            ThreadPool& pool);

/// The rungs of one side whose pixels may reach into a rectangle of a level.
unsigned rungs_near(const MipLevel& level, MipSide side, int x, int y, int width, int height);

/// Rows of the picture as level 0 has them: red, green, blue, and the square of the radius. `near`
/// has what lies before the focus, elsewhere a square of 0; `far` what lies behind, holes filled.
struct MipPictureRow {
  float near[4][kMipTileRow];
  float far[4][kMipTileRow];
};
/// `count` pixels from x on, a multiple of kMipMargin; x is a multiple of it too. Without `fill`
/// the picture has nothing before the focus there, and `far` alone is made. `near` is the step
/// from the focus to the first rung.
void read_mip_row(const DofInput& input, const MipPyramid& pyramid, RungStep near, int x, int y,
                  int count, bool fill, MipPictureRow& to, Isa isa);

}  // namespace softfocus
