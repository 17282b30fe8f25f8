#pragma once
// The way up a stack of levels, whose pixels are 1, 2, 4, ... across: large blur is made of large
// pixels. disc_layers.h, mipmap.h and object_layers.h share it.
//
// What is seen of a level is drawn in tiles. A tile starts with what larger levels show before the
// focus. A method lays its own layers behind that, from the nearest to the farthest. What larger
// levels show behind the focus comes last. A level keeps either side of the focus by itself, so
// that the next smaller level can put its own layers between; level 0, the picture, has both in
// one tile. Enlarging gives a pixel three quarters of the larger one in which it lies and a quarter
// of the nearest beside it, along x and along y.

#include <algorithm>
#include <cstddef>

#include "dof/dof.h"
#include "raster/images/image.h"
#include "raster/threads/loops.h"

namespace softfocus {

/// Where a rung of a ladder of radii begins: sat((square - begin) slope) of a pixel belongs to the
/// rung and to larger ones.
struct RungStep {
  float begin, slope;
};
inline constexpr RungStep kAlways{-1.0f, 1.0f};
inline constexpr RungStep kNever{3e38f, 1.0f};

inline float share_from(RungStep step, float square) {
  return std::max(std::min((square - step.begin) * step.slope, 1.0f), 0.0f);
}

/// Planes of a level, in memory that has another owner. A row has room before its first pixel and
/// after its last.
struct LevelPlanes {
  std::ptrdiff_t stride = 0, plane = 0;
  int before = 0;
  float* values = nullptr;  ///< of pixel (0, 0)
};
inline float* plane_row(const LevelPlanes& planes, int plane, int y) {
  return planes.values + plane * planes.plane + y * planes.stride;
}
struct RowRoom {
  int before, after;
};
/// Enough to enlarge a whole tile that begins at the last pixel.
inline constexpr RowRoom kSeenRoom{8, 72};
/// Takes planes from `memory`, whose first `used` floats are taken already, and adds to `used`. If
/// `memory` is null, only counts.
LevelPlanes take_planes(int count, int width, int height, float* memory, std::size_t& used,
                        RowRoom room = kSeenRoom);
/// Repeats the first and last of `width` pixels outwards, in the rows of some planes.
void repeat_ends(const LevelPlanes& planes, int count, int width, int y);

/// Channels of a pixel: red, green and blue times weight; weight, the share of the pixel that
/// belongs to the level or to larger ones; the mean square of its radius. The picture itself may
/// have negative squares before the focus, and nullptr for weights of 1.
inline constexpr int kLevelWeight = 3, kLevelSquare = 4, kLevelChannels = 5;
struct LevelRow {
  const float* channel[kLevelChannels];
};

/// Pixels of RGBA16F in a line of the cache.
inline constexpr int kTexelsOfLine = 8;

/// Largest size of a tile in pixels.
inline constexpr int kLevelTileWidth = 64;
inline constexpr int kLevelTileHeight = 32;

/// What is seen of a pixel: red, green, blue and the transmittance.
inline constexpr int kTransmitted = 3, kSeenChannels = 4;
struct SeenTile {
  alignas(kRowAlignment) float channel[kSeenChannels][kLevelTileHeight][kLevelTileWidth];
};

/// A tile of a level, or pixels around one.
struct LevelRectangle {
  int x, y, width, height;
};
/// The pixels of the next level that enlarging reads.
inline LevelRectangle in_next_level(const LevelRectangle& at) {
  return {at.x / 2 - 1, at.y / 2 - 1, at.width / 2 + 2, at.height / 2 + 2};
}
/// Pixels around a tile: only if they show anything does the level before read the tile. Its tiles
/// read half their size and two pixels more.
inline LevelRectangle around_tile(const LevelRectangle& at) {
  constexpr int kAcross = kLevelTileWidth / 2 + 2, kDown = kLevelTileHeight / 2 + 2;
  return {at.x - kAcross, at.y - kDown, at.width + 2 * kAcross, at.height + 2 * kDown};
}

/// Enlarges what is seen of the next level, in `rows` rows, to a tile: as the tile, or behind what
/// is seen of it.
void enlarge_seen(const LevelPlanes& seen, int rows, const LevelRectangle& at, bool behind,
                  SeenTile& tile, Isa isa);
/// Light to add to a tile.
struct LitTile {
  alignas(kRowAlignment) float light[3][kLevelTileHeight][kLevelTileWidth];
};
/// Divides a tile of level 0 by the opacity reached, adds light if there is any, and stores the
/// tile with the scene's depth.
void store_tile(const DofInput& input, const ImageView& result, const LevelRectangle& at,
                const SeenTile& tile, const LitTile* lit, Isa isa);
/// Keeps a row of a tile in a plane, which repeats its ends outwards by a pixel.
void keep_row(const LevelPlanes& planes, int width, int plane, const LevelRectangle& at, int row,
              const float* from);

/// Whether a level or a larger one shows anything of a side in a rectangle.
///
/// This and what follows needs of a Frame: `levels`, each with width, height and `seen` before the
/// focus (side 0) and behind it (side 1); `isa`; any_near(level, side, rectangle), whether layers
/// of the level may reach there; and any_wanted(level, side, rectangle), any_seen() or more.
template <class Frame>
bool any_seen(const Frame& frame, std::size_t level, int side, LevelRectangle at) {
  for (; level < frame.levels.size(); ++level, at = in_next_level(at)) {
    if (frame.any_near(level, side, at)) return true;
  }
  return false;
}

/// Starts a tile: with what larger levels show before the focus, or with nothing.
template <class Frame>
void start_tile(const Frame& frame, std::size_t level, int side, const LevelRectangle& at,
                SeenTile& tile) {
  if (side == 0 && any_seen(frame, level + 1, 0, in_next_level(at))) {
    const auto& next = frame.levels[level + 1];
    return enlarge_seen(next.seen[0], next.height, at, false, tile, frame.isa);
  }
  const int count = at.height * kLevelTileWidth;
  for (int i = 0; i < 3; ++i) std::fill_n(tile.channel[i][0], count, 0.0f);
  std::fill_n(tile.channel[kTransmitted][0], count, 1.0f);
}

/// Ends a tile: with what larger levels show behind the focus.
template <class Frame>
void add_larger_behind(const Frame& frame, std::size_t level, const LevelRectangle& at,
                       SeenTile& tile) {
  if (!any_seen(frame, level + 1, 1, in_next_level(at))) return;
  const auto& next = frame.levels[level + 1];
  enlarge_seen(next.seen[1], next.height, at, true, tile, frame.isa);
}

/// Calls body(at, work) for each tile of a level. A Workspace serves one tile after the other.
template <class Workspace, class Level, class Body>
void for_each_tile(const Level& level, ThreadPool& pool, const Body& body) {
  const int columns = (level.width + kLevelTileWidth - 1) / kLevelTileWidth;
  const int rows = (level.height + kLevelTileHeight - 1) / kLevelTileHeight;
  for_each_with<Workspace>(pool, columns * rows, [&](int task, auto& work) {
    const int x = task % columns * kLevelTileWidth, y = task / columns * kLevelTileHeight;
    body(LevelRectangle{x, y, std::min(kLevelTileWidth, level.width - x),
                        std::min(kLevelTileHeight, level.height - y)},
         work);
  });
}

/// Draws what is seen of all levels but the picture, the largest first. blur(level, side, at, work)
/// lays a side's layers behind what is seen in work.tile.
template <class Workspace, class Frame, class Blur>
void see_levels(const Frame& frame, ThreadPool& pool, const Blur& blur) {
  for (std::size_t i = frame.levels.size(); i-- > 1;) {
    const auto& level = frame.levels[i];
    for_each_tile<Workspace>(level, pool, [&](const LevelRectangle& at, Workspace& work) {
      for (int side = 0; side < 2; ++side) {
        if (!frame.any_wanted(i, side, around_tile(at))) continue;
        start_tile(frame, i, side, at, work.tile);
        blur(i, side, at, work);
        if (side == 1) add_larger_behind(frame, i, at, work.tile);
        for (int y = 0; y < at.height; ++y) {
          for (int c = 0; c < kSeenChannels; ++c) {
            keep_row(level.seen[side], level.width, c, at, y, work.tile.channel[c][y]);
          }
        }
      }
    });
  }
}

}  // namespace softfocus
