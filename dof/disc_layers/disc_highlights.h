#pragma once
// Highlights of disc-layers (disc_layers.h): small lights far brighter than what lies around
// them. Their light is taken out of the picture before it goes down the levels, and drawn as
// discs of the pixels' own radii at full resolution.
//
// l is the largest of a pixel's red, green and blue; m is the mean of l around it, from blocks
// as large as its circle (16, 32, ... pixels), with linear steps between blocks. The part of
// the pixel's light that is taken out is
//
//   f = min(2 (1 - 8 m / l), 1 - m / l) min(r^2 - 1, 1),  0 if that is negative.
//
// So at most an eighth of the pixels of a neighbourhood are highlights, and what is left of one
// is as bright as its neighbourhood.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dof/disc_layers/disc_ladder.h"
#include "dof/dof.h"
#include "raster/images/image.h"

namespace softfocus {

/// A highlight's share in a rung.
struct LitPart {
  int x, y;
  std::uint32_t disc;
  double units[4];  ///< light of a pixel that is wholly covered: red, green, blue and 0
};

/// A rung that has highlights.
struct LitRung {
  std::size_t level, number;             ///< of the ladder
  int side;                              ///< 0 before the focus, 1 behind it
  int reach = 0;                         ///< of its largest disc, in rows
  std::vector<LitPart> parts;            ///< row by row
  std::vector<std::size_t> parts_above;  ///< of a row: the number of parts above it; and of all
  std::vector<std::uint8_t> blocks;      ///< of its level, kDiscBlock wide: whether any is in it
  int block_columns = 0, block_rows = 0;
};

/// Light is counted in units of 2^-34, as in scatter.h: sums are exact, in any order.
inline constexpr double kLightUnit = 0x1p-34;

/// A disc of a radius, by the exact cover of each pixel, and the same in all four quarters.
struct ExactDisc {
  /// The row at |dy|: pixels up to |dx| = whole are covered wholly, up to `outer` in part.
  struct Row {
    int whole, outer;   ///< whole is -1 if there are none
    std::size_t cover;  ///< in `covers`: of |dx| = whole + 1, ..., outer
  };
  std::vector<Row> rows;  ///< |dy| = 0, 1, ...
  std::vector<double> covers;
  double area = 0.0;  ///< the sum over all pixels
};

struct DiscHighlights {
  Image rest;  ///< the picture without highlights; 0 pixels wide if there are none
  std::vector<ExactDisc> discs;
  std::vector<LitRung> rungs;  ///< before the focus the largest first, then those behind it
};
DiscHighlights find_highlights(const DofInput& input, const std::vector<LevelRungs>& ladder,
                               ThreadPool& pool);

}  // namespace softfocus
