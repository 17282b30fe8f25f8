#pragma once
// The work of disc-layers (disc_layers.h) within a tile: discs' sums of a rung, laid behind what
// is seen of nearer ones.

#include <cstddef>
#include <cstdint>

#include "dof/disc_layers/disc_ladder.h"
#include "dof/disc_layers/disc_levels.h"
#include "dof/dof.h"

namespace softfocus {

enum class DiscSide { near, focus, far };

// A rung to blur in a tile.
struct DiscBlur {
  const LevelRow* rows;  // at the tile's first pixel; the first lies reach + 1 rows above the part
  DiscPart part;
  DiscSide side;
  float sign;  // of the squares of this side
  RungStep begin, end;
  const LadderSpan* spans;
  int reach;
  float area;  // the disc's sum where there is 1 everywhere
  // Of level 0: what near pixels hide, by the same rows, or nullptr. Where a square differs from
  // that of `rows`, something lies behind the pixel.
  const LevelRow* hidden = nullptr;
};

// Where a rung is blurred.
struct DiscScratch {
  alignas(kRowAlignment) float share[kDiscTileRows][kDiscTileRow];
  float seen[kDiscTileRows][kDiscTileRow];    // the share of the rung and of all that it hides
  float hidden[kDiscTileRows][kDiscTileRow];  // the share of what pixels hide
  float product[kDiscTileRows][kDiscTileRow];
  float columns[2][kDiscApron][kDiscTileRow];                     // of the last two rows
  float sums[kLevelChannels][kLevelTileHeight][kLevelTileWidth];  // discs' sums; the last of `seen`
  int seen_sums;  // which sums are those of `seen`: kLevelWeight where both are the same
};

/// Sums over the rung's discs: of its colours, of its share and of `seen`, into scratch.sums, whose
/// first row is the part's.
void blur_disc_tile(const DiscBlur& in, DiscScratch& scratch, Isa isa);

/// Adds a rung behind what is seen of nearer ones.
void add_disc_sums(const DiscScratch& in, const DiscPart& part, SeenTile& tile, Isa isa);

/// How much of a highlight's light is seen, if it belongs to the rung: the transmittance of all
/// nearer rungs over the part of the rung's disc that they leave open, at most `most`. Needs the
/// sums of blur_disc_tile() and the tile before add_disc_sums().
void gain_of_disc(const DiscScratch& in, const SeenTile& tile, float area, float most, int width,
                  int height, float (*gain)[kLevelTileWidth], Isa isa);

/// Enlarges to a row of `count` pixels, an even number, from rows of pixels of twice the size:
/// three quarters of the row `inside` which it lies, a quarter of the `other`; along x likewise.
void enlarge_disc_row(const float* inside, const float* other, int count, float* to, Isa isa);

}  // namespace softfocus
