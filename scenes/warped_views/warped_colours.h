#pragma once
// The colours of a warped tile, read bilinearly from where in the source exactly each pixel's
// centre comes from, and added to those of other views.

#include <span>
#include <vector>

#include "scenes/warped_views/warp.h"

namespace softfocus {

/// Parts of a pixel that are not worth reading the next texel for.
inline constexpr float kWholePx = 1.0f / 64.0f;

/// Sums of colours, with the rows of a tile.
struct WarpedColours {
  std::vector<float> red, green, blue;
};

/// Adds the tile's colours, and lists its holes.
void add_colours(const WarpSource& source, glm::vec2 shift, WarpTile& tile, WarpedColours& sums,
                 Isa isa);

/// Adds sums to totals of that size, and forgets them.
void settle_sums(std::span<float> sums, std::span<double> totals, Isa isa);

}  // namespace softfocus
