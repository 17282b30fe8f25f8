#pragma once
// The picture of disc_layers.h at each level, in pixels 1, 2, 4, ... across.

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

/// Planes of a level. A row has a margin at either end, and then room for a whole tile.
struct DiscPlanes {
  std::ptrdiff_t stride, plane;
  float* values;  ///< in DiscLevels::memory
};
inline float* plane_row(const DiscPlanes& planes, int plane, int y) {
  return planes.values + plane * planes.plane + y * planes.stride;
}

struct DiscLevel {
  int width, height;
  int block_columns, block_rows;
  /// Arrays of two: before the focus, and behind it.
  std::vector<std::uint32_t> rungs[2];  ///< of a block: a bit for each of the level's rungs
  /// The channels of DiscRow. Level 0 has none: it is the picture itself.
  DiscPlanes sides[2];
  std::vector<std::uint8_t> filled[2];  ///< of a row: whether `sides` has it; if not, it is `zeros`
  std::vector<float> zeros;
  /// What is seen of this level and of larger ones: colour and transmittance.
  DiscPlanes seen[2];
};

/// A row of one side, from pixel x on. x may lie kDiscMargin outside; rows outside repeat the
/// picture's first and last. Needs a level other than 0.
DiscRow disc_row(const DiscLevel& level, int side, int x, int y);

/// Their memory is one piece, so that the allocator keeps it from frame to frame.
struct DiscLevels {
  std::vector<DiscLevel> levels;
  std::unique_ptr<float[]> memory;
};
/// Levels for the rungs of a ladder. `seen` is left to be filled.
DiscLevels make_disc_levels(const DofInput& input, const std::vector<LevelRungs>& ladder,
                            ThreadPool& pool);

/// `count` pixels of a row of the picture from `x` on as level 0: red, green, blue and signed
/// square, `channel` floats apart. The picture's edges repeat outwards.
void split_disc_row(const DofInput& input, int x, int y, int count, float* to,
                    std::ptrdiff_t channel, Isa isa);

/// The rungs of one side whose pixels may reach into a rectangle of a level.
std::uint32_t rungs_near(const DiscLevel& level, int side, int x, int y, int width, int height);

}  // namespace softfocus
