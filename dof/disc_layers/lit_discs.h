#pragma once
// The highlights of disc-layers (disc_highlights.h) as discs of light, drawn in tiles.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dof/disc_layers/disc_blur.h"
#include "dof/disc_layers/disc_highlights.h"
#include "dof/disc_layers/disc_levels.h"
#include "dof/dof.h"
#include "raster/images/image.h"

namespace softfocus {

/// Whether a rung's discs may reach into a rectangle of a level, which is the rung's or a finer.
bool lit_near(const LitRung& rung, std::size_t level, int x, int y, int width, int height);

/// How much of a rung's highlights is seen, at its own level and every finer one but level 0. A
/// plane has the shape of the level's `seen`, and means something only where lit_near().
struct LitGains {
  std::vector<std::vector<LevelPlanes>> planes;  ///< of a lit rung: of level 1, 2, ...
  RowMemory<float> memory;
};
LitGains make_gains(const DiscHighlights& highlights, const std::vector<DiscLevel>& levels,
                    MemoryShelf& shelf);

/// The largest gain: a highlight never gains light. Behind the focus a larger level does not know
/// yet what the finer ones leave open.
inline float most_gain(std::size_t level, int side) {
  return level > 0 && side == 1 ? 256.0f : 1.0f;
}

/// Where a rung's discs are summed.
struct LitSums {
  std::uint64_t differences[kLevelTileHeight][kLevelTileWidth + 1][4];
};

/// Adds a rung's discs to the tile at (x, y), times `gain`.
void add_highlights(const DiscHighlights& highlights, const LitRung& rung, int x, int y, int width,
                    int height, const float (*gain)[kLevelTileWidth], LitSums& sums, LitTile& tile,
                    Isa isa);

/// The oracle of add_highlights(): the light of a rung at a pixel.
void light_at(const DiscHighlights& highlights, const LitRung& rung, int x, int y, float* light);

}  // namespace softfocus
