#pragma once
// Levels pixel by pixel: what the oracles of methods with a stack of levels (level_stack.h) share.

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "dof/level_stack.h"

namespace softfocus {

template <std::size_t channels>
struct Grid {
  using Pixel = std::array<float, channels>;
  int width = 0, height = 0;
  std::vector<Pixel> pixels;

  Grid() = default;
  Grid(int across, int down)
      : width(across), height(down), pixels(static_cast<std::size_t>(across * down)) {}
  // The edges repeat outwards.
  const Pixel& at(int x, int y) const {
    const int inside = std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1);
    return pixels[static_cast<std::size_t>(inside)];
  }
  Pixel& at(int x, int y) { return pixels[static_cast<std::size_t>(y * width + x)]; }
  Grid half() const { return Grid((width + 1) / 2, (height + 1) / 2); }
};
/// The channels of LevelRow, and what is seen.
using SideGrid = Grid<kLevelChannels>;
using SeenGrid = Grid<kSeenChannels>;

template <class Set>
void for_each_pixel(int width, int height, const Set& set) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) set(x, y);
  }
}

/// A pixel of the level before `from`.
template <std::size_t channels>
std::array<float, channels> enlarged(const Grid<channels>& from, int x, int y) {
  const int other_x = x / 2 + (x % 2 == 0 ? -1 : 1), other_y = y / 2 + (y % 2 == 0 ? -1 : 1);
  std::array<float, channels> pixel;
  for (std::size_t i = 0; i < channels; ++i) {
    const auto column = [&](int at) {
      return 0.75f * from.at(at, y / 2)[i] + 0.25f * from.at(at, other_y)[i];
    };
    pixel[i] = 0.75f * column(x / 2) + 0.25f * column(other_x);
  }
  return pixel;
}

/// The next level: of what belongs beyond `from`. Squares count times `sign`, and as `least_square`
/// at least.
inline SideGrid next_level(const SideGrid& from, float sign, RungStep beyond, float least_square) {
  SideGrid result = from.half();
  for_each_pixel(result.width, result.height, [&](int x, int y) {
    SideGrid::Pixel sums[2]{};
    for (int column = 0; column < 2; ++column) {
      for (int row = 0; row < 2; ++row) {
        const SideGrid::Pixel& pixel = from.at(2 * x + column, 2 * y + row);
        const float square = sign * pixel[kLevelSquare];
        const float share = share_from(beyond, square), weight = pixel[kLevelWeight] * share;
        for (std::size_t i = 0; i < 3; ++i) sums[column][i] += pixel[i] * share;
        sums[column][kLevelWeight] += weight;
        sums[column][kLevelSquare] += weight * std::max(square, least_square);
      }
    }
    SideGrid::Pixel& to = result.at(x, y);
    for (std::size_t i = 0; i < 4; ++i) to[i] = 0.25f * (sums[0][i] + sums[1][i]);
    const float weight = sums[0][kLevelWeight] + sums[1][kLevelWeight];
    const float square = sums[0][kLevelSquare] + sums[1][kLevelSquare];
    to[kLevelSquare] = weight > 0.0f ? square / weight : 0.0f;
  });
  return result;
}

/// Adds what larger levels show behind what is seen.
inline void add_behind(SeenGrid::Pixel& seen, const SeenGrid::Pixel& behind) {
  const float open = seen[kTransmitted];
  for (std::size_t i = 0; i < 3; ++i) seen[i] += open * behind[i];
  seen[kTransmitted] = open * behind[kTransmitted];
}

}  // namespace softfocus
