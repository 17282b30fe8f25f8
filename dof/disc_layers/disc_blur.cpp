#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/disc_layers/disc_blur.h"

#include <cstring>
#include <utility>

#define SOFTFOCUS_KERNELS "dof/disc_layers/disc_blur.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void blur_disc_tile(const DiscBlur& in, DiscScratch& scratch, Isa isa) {
  SOFTFOCUS_KERNEL(isa, blur_disc_tile)(in, scratch);
}

void add_disc_sums(const DiscScratch& in, const DiscPart& part, SeenTile& tile, Isa isa) {
  SOFTFOCUS_KERNEL(isa, add_disc_sums)(in, part, tile);
}

void gain_of_disc(const DiscScratch& in, const SeenTile& tile, float area, float most, int width,
                  int height, float (*gain)[kLevelTileWidth], Isa isa) {
  SOFTFOCUS_KERNEL(isa, gain_of_disc)(in, tile, area, most, width, height, gain);
}

void enlarge_disc_row(const float* inside, const float* other, int count, float* to, Isa isa) {
  SOFTFOCUS_KERNEL(isa, enlarge_disc_row)(inside, other, count, to);
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/level_lanes.inl"

#include "dof/disc_layers/disc_sums.inl"

// Whether anything may be hidden in a row.
SOFTFOCUS_INLINE bool has_hidden(const DiscBlur& in, int y) {
  return in.hidden != nullptr &&
         in.hidden[y].channel[kLevelSquare] != in.rows[y].channel[kLevelSquare];
}

// A channel times the rung's share, and what is hidden times its own.
SOFTFOCUS_INLINE void multiply_shares(const DiscBlur& in, int channel, bool any_hidden,
                                      DiscScratch& scratch) {
  const int rows = in.part.rows + 2 * (in.reach + 1);
  const int begin = in.part.column * kDiscColumn;
  const int end = begin + (in.part.columns + 1) * kDiscColumn;
  for (int y = 0; y < rows; ++y) {
    const float* from = in.rows[y].channel[channel] - kDiscMargin;
    if (!any_hidden || !has_hidden(in, y)) {
      for (int x = begin; x < end; x += kLanes) {
        store(scratch.product[y] + x, load(from + x) * load(scratch.share[y] + x));
      }
      continue;
    }
    const float* behind = in.hidden[y].channel[channel] - kDiscMargin;
    for (int x = begin; x < end; x += kLanes) {
      store(scratch.product[y] + x, load(from + x) * load(scratch.share[y] + x) +
                                        load(behind + x) * load(scratch.hidden[y] + x));
    }
  }
}

}  // namespace

/// Sums over the rung's discs: of its colours, of its share and of `seen`, into scratch.sums.
void blur_disc_tile(const DiscBlur& in, DiscScratch& scratch) {
  const int rows = in.part.rows + 2 * (in.reach + 1);
  const int begin = in.part.column * kDiscColumn;
  const int end = begin + (in.part.columns + 1) * kDiscColumn;
  Mask all_ones = splat(-1), all_equal = splat(-1), any_hidden = splat(0);
  for (int y = 0; y < rows; ++y) {
    const LevelRow& from = in.rows[y];
    for (int x = begin; x < end; x += kLanes) {
      const Floats signed_square = load(from.channel[kLevelSquare] - kDiscMargin + x);
      const Floats weight = load(from.channel[kLevelWeight] - kDiscMargin + x);
      Floats share, seen;
      if (in.side == DiscSide::focus) {
        share = 1.0f - share_from(in.end, absolute(signed_square));
        seen = 1.0f - share_from(in.end, -signed_square);
      } else {
        const Floats square = in.sign * signed_square;
        const Floats begun = share_from(in.begin, square), ended = share_from(in.end, square);
        share = begun - ended;
        seen = in.side == DiscSide::near ? 1.0f - weight * ended : weight * begun;
      }
      if (has_hidden(in, y)) {
        const Floats behind = load(in.hidden[y].channel[kLevelSquare] - kDiscMargin + x);
        const Floats square = -larger(behind, splat(kLeastHidden));
        const Floats hidden = share_from(in.begin, square) - share_from(in.end, square);
        const Floats counted = select(behind == signed_square, splat(0.0f), hidden);
        store(scratch.hidden[y] + x, counted);
        seen += counted;
        any_hidden |= counted != 0.0f;
      }
      store(scratch.share[y] + x, share);
      store(scratch.seen[y] + x, seen);
      all_ones &= seen == 1.0f;
      all_equal &= seen == weight * share;
    }
  }
  const bool hidden = any(any_hidden);
  const bool ones = all(all_ones), equal = !ones && !hidden && all(all_equal);
  scratch.seen_sums = equal ? kLevelWeight : kLevelChannels - 1;
  const int channels = ones || equal ? kLevelChannels - 1 : kLevelChannels;
  for (int i = 0; i < channels; ++i) {
    const float(*from)[kDiscTileRow] = scratch.seen;
    if (i < kLevelChannels - 1) {
      multiply_shares(in, i, hidden, scratch);
      from = scratch.product;
    }
    sum_discs(in.spans, in.reach, in.part.rows, in.part.column, in.part.columns, from,
              scratch.columns, scratch.sums[i]);
  }
  if (!ones) return;
  for (int y = 0; y < in.part.rows; ++y) {
    for (int x = 0; x < kLevelTileWidth; x += kLanes) {
      store(scratch.sums[kLevelChannels - 1][y] + x, splat(in.area));
    }
  }
}

/// Adds a rung behind what is seen of nearer ones.
void add_disc_sums(const DiscScratch& in, const DiscPart& part, SeenTile& tile) {
  add_layer(in.sums, in.sums[in.seen_sums], part, tile);
}

/// T area / max(sum of `seen`, T area / most), 0 where T is.
void gain_of_disc(const DiscScratch& in, const SeenTile& tile, float area, float most, int width,
                  int height, float (*gain)[kLevelTileWidth]) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; x += kLanes) {
      const Floats open = load(tile.channel[kTransmitted][y] + x) * area;
      const Mask any = open > 0.0f;
      const Floats whole = larger(load(in.sums[in.seen_sums][y] + x), open * (1.0f / most));
      store(gain[y] + x, select(any, open / select(any, whole, splat(1.0f)), splat(0.0f)));
    }
  }
}

/// Enlarges to a row of `count` pixels, an even number, from rows of pixels of twice the size:
/// three quarters of the row `inside` which it lies, a quarter of the `other`; along x likewise.
void enlarge_disc_row(const float* inside, const float* other, int count, float* to) {
  for (int x = 0; x < count / 2; x += kLanes) {
    const TwoVectors large = enlarge(inside + x, other + x);
    store(to + 2 * x, large.first);
    store(to + 2 * x + kLanes, large.second);
  }
}

#endif
