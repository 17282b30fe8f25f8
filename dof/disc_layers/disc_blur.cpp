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

void add_disc_sums(const DiscScratch& in, const DiscPart& part, DiscTile& tile, Isa isa) {
  SOFTFOCUS_KERNEL(isa, add_disc_sums)(in, part, tile);
}

void gain_of_disc(const DiscScratch& in, const DiscTile& tile, float area, float most, int width,
                  int height, float (*gain)[kDiscTileWidth], Isa isa) {
  SOFTFOCUS_KERNEL(isa, gain_of_disc)(in, tile, area, most, width, height, gain);
}

void enlarge_disc_row(const float* inside, const float* other, int count, float* to, Isa isa) {
  SOFTFOCUS_KERNEL(isa, enlarge_disc_row)(inside, other, count, to);
}

void enlarge_disc_tile(const DiscPlanes& seen, int rows, int x, int y, int height, bool behind,
                       DiscTile& tile, Isa isa) {
  SOFTFOCUS_KERNEL(isa, enlarge_disc_tile)(seen, rows, x, y, height, behind, tile);
}

void store_disc_tile(const DiscTile& tile, const LitTile* lit, const std::uint16_t* scene,
                     std::ptrdiff_t scene_row, int width, int height, HalfRounding rounding,
                     std::uint16_t* to, std::ptrdiff_t row, Isa isa) {
  SOFTFOCUS_KERNEL(isa, store_disc_tile)
  (tile, lit, scene, scene_row, width, height, rounding, to, row);
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

/// How much belongs to a rung or to larger ones.
SOFTFOCUS_INLINE Floats share_from(RungStep step, Floats square) {
  return saturate((square - step.begin) * step.slope);
}

#include "dof/disc_layers/disc_sums.inl"

// Whether anything may be hidden in a row.
SOFTFOCUS_INLINE bool has_hidden(const DiscBlur& in, int y) {
  return in.hidden != nullptr &&
         in.hidden[y].channel[kDiscSquare] != in.rows[y].channel[kDiscSquare];
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

template <HalfRounding rounding>
SOFTFOCUS_INLINE void store_tile(const DiscTile& tile, const LitTile* lit,
                                 const std::uint16_t* scene, std::ptrdiff_t scene_row, int width,
                                 int height, std::uint16_t* to, std::ptrdiff_t row) {
  constexpr int kAhead = 4;  // rows
  for (int y = 0; y < height; ++y, scene += scene_row, to += row) {
    if (y + kAhead < height) {
      const std::uint16_t* ahead = scene + kAhead * scene_row;
      for (int x = 0; x < width; x += kTexelsOfLine) __builtin_prefetch(ahead + 4 * x);
    }
    const bool aligned = reinterpret_cast<std::uintptr_t>(to) % sizeof(Bits) == 0;
    for (int x = 0; x < width; x += kLanes) {
      const Floats scale = 1.0f / (1.0f - load(tile.channel[kDiscTransmitted][y] + x));
      Floats colour[3];
      for (int i = 0; i < 3; ++i) {
        colour[i] = load(tile.channel[i][y] + x) * scale;
        if (lit != nullptr) colour[i] += load(lit->light[i][y] + x);
      }
      const HalfTexels texels{float_to_half<rounding>(clamp_to_half(colour[0])),
                              float_to_half<rounding>(clamp_to_half(colour[1])),
                              float_to_half<rounding>(clamp_to_half(colour[2])),
                              stored_depth(load_repeating(scene, x, width).a, rounding)};
      if (x + kLanes <= width) {
        const TexelWords words = interleave(texels);
        aligned ? stream_texel_words(to + 4 * x, words) : store_texel_words(to + 4 * x, words);
      } else {
        std::uint16_t last[4 * kLanes];
        store_half_texels(last, texels);
        std::memcpy(to + 4 * x, last, 4 * sizeof *last * static_cast<std::size_t>(width - x));
      }
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
    const DiscRow& from = in.rows[y];
    for (int x = begin; x < end; x += kLanes) {
      const Floats signed_square = load(from.channel[kDiscSquare] - kDiscMargin + x);
      const Floats weight = load(from.channel[kDiscWeight] - kDiscMargin + x);
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
        const Floats behind = load(in.hidden[y].channel[kDiscSquare] - kDiscMargin + x);
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
  scratch.seen_sums = equal ? kDiscWeight : kDiscChannels - 1;
  const int channels = ones || equal ? kDiscChannels - 1 : kDiscChannels;
  for (int i = 0; i < channels; ++i) {
    const float(*from)[kDiscTileRow] = scratch.seen;
    if (i < kDiscChannels - 1) {
      multiply_shares(in, i, hidden, scratch);
      from = scratch.product;
    }
    sum_discs(in.spans, in.reach, in.part.rows, in.part.column, in.part.columns, from,
              scratch.columns, scratch.sums[i]);
  }
  if (!ones) return;
  for (int y = 0; y < in.part.rows; ++y) {
    for (int x = 0; x < kDiscTileWidth; x += kLanes) {
      store(scratch.sums[kDiscChannels - 1][y] + x, splat(in.area));
    }
  }
}

/// Adds a rung behind what is seen of nearer ones.
void add_disc_sums(const DiscScratch& in, const DiscPart& part, DiscTile& tile) {
  add_layer(in.sums, in.sums[in.seen_sums], part, tile);
}

/// T area / max(sum of `seen`, T area / most), 0 where T is.
void gain_of_disc(const DiscScratch& in, const DiscTile& tile, float area, float most, int width,
                  int height, float (*gain)[kDiscTileWidth]) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; x += kLanes) {
      const Floats open = load(tile.channel[kDiscTransmitted][y] + x) * area;
      const Mask any = open > 0.0f;
      const Floats whole = larger(load(in.sums[in.seen_sums][y] + x), open * (1.0f / most));
      store(gain[y] + x, select(any, open / select(any, whole, splat(1.0f)), splat(0.0f)));
    }
  }
}

/// Enlarges to a row of `count` pixels, an even number, from rows of pixels of twice the size:
/// three quarters of the row `inside` which it lies, a quarter of the `other`; along x likewise.
void enlarge_disc_row(const float* inside, const float* other, int count, float* to) {
  enlarge_row(inside, other, count, to);
}

namespace {

// Vectors of large pixels that reach into a tile, from kDiscMargin before it on.
inline constexpr int kLargeVectors = (kDiscTileWidth / 2 + 2 * kDiscMargin) / kLanes;

// enlarge_vector() of a tile's row from aligned vectors, each made once.
SOFTFOCUS_INLINE void enlarge_tile_row(const float* inside, const float* other,
                                       TwoVectors (&to)[kDiscTileWidth / 2 / kLanes]) {
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  constexpr std::size_t kFirst = kDiscMargin % kLanes, kSkipped = kDiscMargin / kLanes;
  constexpr std::size_t kLeft = (kFirst + kLanes - 1) % kLanes;
  Floats large[kLargeVectors];
  for (std::size_t i = 0; i < kLargeVectors; ++i) {
    large[i] = 0.75f * load(inside + i * kLanes) + 0.25f * load(other + i * kLanes);
  }
  for (std::size_t i = 0; i < kDiscTileWidth / 2 / kLanes; ++i) {
    const Floats* at = large + i + kSkipped;
    const Floats* before = kFirst == 0 ? at - 1 : at;
    const Floats own = 0.75f * lanes_from<kFirst>(at[0], at[1], Lanes{});
    const Floats left = lanes_from<kLeft>(before[0], before[1], Lanes{});
    const Floats right = lanes_from<kFirst + 1>(at[0], at[1], Lanes{});
    const Floats even = own + 0.25f * left, odd = own + 0.25f * right;
    to[i] = {by_turns<0>(even, odd, Lanes{}), by_turns<kLanes / 2>(even, odd, Lanes{})};
  }
}

}  // namespace

/// Enlarges what is seen of the next level to the tile at (x, y).
void enlarge_disc_tile(const DiscPlanes& seen, int rows, int x, int y, int height, bool behind,
                       DiscTile& tile) {
  for (int row = 0; row < height; ++row) {
    const int inside = (y + row) / 2;
    const int other = (y + row) % 2 == 0 ? (inside > 0 ? inside - 1 : 0)
                                         : (inside + 1 < rows ? inside + 1 : rows - 1);
    for (int i = 0; i <= kDiscTransmitted; ++i) {
      // Rows of a tile are too far apart for the CPU to foresee.
      constexpr int kAhead = 3;
      const float* ahead = plane_row(seen, i, inside + kAhead < rows ? inside + kAhead : inside);
      for (int at = 0; row % 2 == 0 && at < kLargeVectors * kLanes; at += 2 * kTexelsOfLine) {
        __builtin_prefetch(ahead + x / 2 + at);
      }
      TwoVectors large[kDiscTileWidth / 2 / kLanes];
      enlarge_tile_row(plane_row(seen, i, inside) + x / 2, plane_row(seen, i, other) + x / 2,
                       large);
      float* to = tile.channel[i][row];
      const float* open = tile.channel[kDiscTransmitted][row];
      for (const TwoVectors& part : large) {
        TwoVectors sum = part;
        if (behind) sum = {load(open) * sum.first, load(open + kLanes) * sum.second};
        if (behind && i < kDiscTransmitted) {
          sum = {load(to) + sum.first, load(to + kLanes) + sum.second};
        }
        store(to, sum.first);
        store(to + kLanes, sum.second);
        to += 2 * kLanes;
        open += 2 * kLanes;
      }
    }
  }
}

/// Divides by the opacity reached, and stores the tile with the scene's depth. Rows are
/// `scene_row` and `row` halves apart.
void store_disc_tile(const DiscTile& tile, const LitTile* lit, const std::uint16_t* scene,
                     std::ptrdiff_t scene_row, int width, int height, HalfRounding rounding,
                     std::uint16_t* to, std::ptrdiff_t row) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even:
      store_tile<nearest_even>(tile, lit, scene, scene_row, width, height, to, row);
      break;
    case toward_zero:
      store_tile<toward_zero>(tile, lit, scene, scene_row, width, height, to, row);
      break;
    case swiftshader:
      store_tile<swiftshader>(tile, lit, scene, scene_row, width, height, to, row);
      break;
  }
  finish_streaming();
}

#endif
