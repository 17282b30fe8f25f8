#pragma once
// The picture of disc_layers.h at each level, in pixels 1, 2, 4, ... across.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dof/disc_layers/disc_hidden.h"
#include "dof/disc_layers/disc_ladder.h"
#include "dof/dof.h"
#include "dof/level_stack.h"
#include "raster/images/image.h"

namespace softfocus {

/// Pixels by which a level's rows go on at either end, repeating the last.
inline constexpr int kDiscMargin = 8;
/// Rows above and below a tile that any disc reaches, and one more.
inline constexpr int kDiscApron = 8;
/// A tile with all that discs reach around it.
inline constexpr int kDiscTileRow = kLevelTileWidth + 2 * kDiscMargin;
inline constexpr int kDiscTileRows = kLevelTileHeight + 2 * kDiscApron;

/// A part of a tile.
inline constexpr int kDiscColumn = 16;
struct DiscPart {
  int row, rows;
  int column, columns;  ///< kDiscColumn pixels wide
};
inline constexpr DiscPart kWholeTile{0, kLevelTileHeight, 0, kLevelTileWidth / kDiscColumn};

struct DiscLevel {
  int width, height;
  int block_columns, block_rows;
  /// Arrays of two: before the focus, and behind it.
  std::vector<std::uint32_t> rungs[2];  ///< of a block: a bit for each of the level's rungs
  /// The channels of LevelRow. Level 0 has none: it is the picture itself.
  LevelPlanes sides[2];
  std::vector<std::uint8_t> filled[2];  ///< of a row: whether `sides` has it; if not, it is `zeros`
  std::vector<float> zeros;
  /// What is seen of this level and of larger ones: colour and transmittance.
  LevelPlanes seen[2];
};

/// A row of one side, from pixel x on. x may lie kDiscMargin outside; rows outside repeat the
/// picture's first and last. Needs a level other than 0.
LevelRow disc_row(const DiscLevel& level, int side, int x, int y);

struct DiscLevels {
  std::vector<DiscLevel> levels;
  RowMemory<float> memory;
};
/// Levels for the rungs of a ladder. Behind the focus they show what near things hide. `seen` is
/// left to be filled.
DiscLevels make_disc_levels(const DofInput& input, const HiddenPicture& hidden,
                            const std::vector<LevelRungs>& ladder, ThreadPool& pool);

/// `count` pixels of a row of the picture from `x` on as level 0: red, green, blue and signed
/// square, `channel` floats apart. The picture's edges repeat outwards.
void split_disc_row(const DofInput& input, int x, int y, int count, float* to,
                    std::ptrdiff_t channel, Isa isa);

/// Asks for a part of a row of RGBA16F, which will be needed soon: rows of a tile are too far apart
/// for the CPU to foresee.
inline void fetch_texels(const ConstImageView& picture, int x, int y, int count) {
  const std::byte* row = picture.texels + y * picture.stride_bytes;
  const int end = x + count < picture.width ? x + count : picture.width;
  for (int at = x > 0 ? x : 0; at < end; at += kTexelsOfLine) {
    __builtin_prefetch(row + bytes_per_texel(Format::rgba16f) * static_cast<std::size_t>(at));
  }
}

/// Something hidden counts as no nearer than the largest rung of level 0.
inline constexpr float kLeastHidden = -48.0f;

/// A picture's copy.
Image copy_of(const ConstImageView& picture, ThreadPool& pool);

/// The rungs of one side whose pixels may reach into a rectangle of a level.
std::uint32_t rungs_near(const DiscLevel& level, int side, int x, int y, int width, int height);

/// Those that may reach into a tile, by rows and by columns of blocks.
struct DiscRungBlocks {
  int row, rows;  ///< the first, and how many
  int column, columns;
  std::uint32_t of_row[kLevelTileHeight / kDiscBlock + 2];
  std::uint32_t of_column[kLevelTileWidth / kDiscBlock + 2];
};
DiscRungBlocks rung_blocks_near(const DiscLevel& level, int side, int x, int y, int width,
                                int height);

}  // namespace softfocus
