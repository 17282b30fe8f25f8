#pragma once
// The pyramids of mipmap.h: what lies before the focus, what lies behind it or in it, and the
// picture without what lies before the focus, its holes filled.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "dof/dof.h"
#include "dof/mipmap/mip_ladder.h"

namespace softfocus {

/// Largest size of a tile in pixels.
inline constexpr int kMipTileWidth = 64;
inline constexpr int kMipTileHeight = 32;
/// Pixels by which a row goes on at either end, repeating the last.
inline constexpr int kMipMargin = 16;
/// A tile's row with its margins.
inline constexpr int kMipTileRow = kMipTileWidth + 2 * kMipMargin;
/// A block of 16x8 pixels knows which rungs are in it.
inline constexpr int kMipBlockWidth = 16, kMipBlockHeight = 8;

/// Channels of a pixel of a side: red, green and blue times weight; weight, the share of the
/// pixel that belongs to the level or to those above; the mean square of its radius.
inline constexpr int kMipWeight = 3, kMipSquare = 4, kMipChannels = 5;
/// Channels of a filled pixel: red, green, blue, square.
inline constexpr int kFilledSquare = 3, kFilledChannels = 4;
/// Channels of a picture with holes: those times weight, and weight.
inline constexpr int kHoledWeight = 4, kHoledChannels = 5;
/// What is seen of a pixel: red, green, blue and the transmittance.
inline constexpr int kMipTransmitted = 3, kSeenChannels = 4;

/// Planes of a level, with a margin at either end of a row.
struct MipPlanes {
  std::ptrdiff_t stride = 0, plane = 0;
  float* values = nullptr;  ///< in MipPyramid::memory
};
/// Pixel 0 of a row.
inline float* plane_row(const MipPlanes& planes, int plane, int y) {
  return planes.values + plane * planes.plane + y * planes.stride + kMipMargin;
}

/// A pixel with holes counts as whole from a weight of 1 / kFillGain on; below, the next level
/// fills the rest.
inline constexpr float kFillGain = 4.0f;

enum class MipSide { near, far };

struct MipLevel {
  int width = 0, height = 0;
  int block_columns = 0, block_rows = 0;
  // Arrays of two: before the focus, and behind it. Level 0 has marks alone.
  std::vector<std::uint8_t> marks[2];  ///< of a block: a bit for each rung, one for those beyond
  MipPlanes sides[2];
  MipPlanes seen[2];
  MipPlanes filled;
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
void read_mip_row(const DofInput& input, const MipPyramid& pyramid, MipStep near, int x, int y,
                  int count, bool fill, MipPictureRow& to, Isa isa);

}  // namespace softfocus
