#pragma once
// The picture of disc_layers.h at each level: pixels of 1, 2, 4, ... across.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "dof/disc_layers/disc_ladder.h"
#include "dof/dof.h"

namespace softfocus {

/// Largest size of a tile in pixels.
inline constexpr int kDiscTileWidth = 64;
inline constexpr int kDiscTileHeight = 32;
/// Pixels by which a level's rows go on at either end, repeating the last.
inline constexpr int kDiscMargin = 8;
/// Rows above and below a tile that any disc reaches, and one more.
inline constexpr int kDiscApron = 8;
/// A block of 8x8 pixels knows which rungs are in it.
inline constexpr int kDiscBlock = 8;

/// Channels of a pixel: red, green and blue times weight; weight, the share of the pixel that
/// is there; the square of its radius. In level 0 the squares of radii before the focus are
/// negative, in other levels all are positive.
inline constexpr int kDiscWeight = 3, kDiscSquare = 4, kDiscChannels = 5;
struct DiscRow {
  const float* channel[kDiscChannels];
};

/// What is seen of a pixel: red, green, blue and the transmittance.
inline constexpr int kDiscTransmitted = 3;

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
