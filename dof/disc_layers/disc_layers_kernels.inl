// Tiles of disc_layers.cpp.

namespace {

#include "dof/disc_layers/disc_share.inl"
#include "dof/repeating_texels.inl"
#include "dof/weights.inl"

// The lanes from `from` on of two vectors by turns.
template <std::size_t from, std::size_t... lane>
SOFTFOCUS_INLINE Floats by_turns(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (from + lane / 2 + (lane & 1) * kLanes)...);
}

// Vectors that are worked on together, so that what is the same for all is fetched once:
// a row of a tile is one or several times as many, with its margins and without.
using ColumnVectors = std::make_index_sequence<5>;
using TileVectors = std::make_index_sequence<4>;
static_assert(kDiscTileRow % (5 * 16) == 0 && kDiscTileWidth % (4 * 16) == 0);

// Sums of columns of a disc: at columns[dx] what is dx pixels from the middle. `at` is in
// the row of the middle.
template <std::size_t... i>
SOFTFOCUS_INLINE void sum_columns(const float* at, const LadderSpan* spans, int reach,
                                  float* columns, std::index_sequence<i...>) {
  Floats sum[] = {load(at + i * kLanes)...};
  const float* above = at;
  const float* below = at;
  int dx = reach;
  for (int dy = 1;; ++dy) {
    above -= kDiscTileRow;
    below += kDiscTileRow;
    const Floats pair[] = {(load(above + i * kLanes) + load(below + i * kLanes))...};
    while (spans[dx].whole == dy - 1) {
      const Floats centre = splat(spans[dx].centre), end = splat(spans[dx].end);
      float* to = columns + dx * kDiscTileRow;
      ((store(to + i * kLanes, centre * sum[i] + end * pair[i])), ...);
      if (--dx < 0) return;
    }
    ((sum[i] += pair[i]), ...);
  }
}

// Discs from the sums of their columns.
template <std::size_t... i>
SOFTFOCUS_INLINE void add_columns(const float* columns, int reach, float* to,
                                  std::index_sequence<i...>) {
  Floats sum[] = {load(columns + i * kLanes)...};
  for (int dx = 1; dx <= reach; ++dx) {
    columns += kDiscTileRow;
    ((sum[i] += load(columns - dx + i * kLanes) + load(columns + dx + i * kLanes)), ...);
  }
  ((store(to + i * kLanes, sum[i])), ...);
}

// Discs' sums of a channel that fills the rows from `reach + 1` above the tile on. The next
// row's columns come first: what has just been stored is slow to load at another alignment.
SOFTFOCUS_INLINE void sum_discs(const DiscBlur& in, const float (*rows)[kDiscTileRow],
                                DiscScratch& scratch, float (*to)[kDiscTileWidth]) {
  for (int y = 0; y <= in.height; ++y) {
    if (y < in.height) {
      for (int x = 0; x < kDiscTileRow; x += 5 * kLanes) {
        sum_columns(rows[y + in.reach + 1] + x, in.spans, in.reach, scratch.columns[y % 2][0] + x,
                    ColumnVectors{});
      }
    }
    if (y == 0) continue;
    for (int x = 0; x < kDiscTileWidth; x += 4 * kLanes) {
      add_columns(scratch.columns[1 - y % 2][0] + kDiscMargin + x, in.reach, to[y - 1] + x,
                  TileVectors{});
    }
  }
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE void store_tile(const DiscTile& tile, const std::uint16_t* scene,
                                 std::size_t scene_row, int width, int height, std::uint16_t* to,
                                 std::size_t row) {
  for (int y = 0; y < height; ++y, scene += scene_row, to += row) {
    for (int x = 0; x < width; x += kLanes) {
      const Floats scale = 1.0f / (1.0f - load(tile.channel[kDiscTransmitted][y] + x));
      const HalfTexels texels{
          float_to_half<rounding>(clamp_to_half(load(tile.channel[0][y] + x) * scale)),
          float_to_half<rounding>(clamp_to_half(load(tile.channel[1][y] + x) * scale)),
          float_to_half<rounding>(clamp_to_half(load(tile.channel[2][y] + x) * scale)),
          stored_depth(load_repeating(scene, x, width).a)};
      if (x + kLanes <= width) {
        stream_texel_words(to + 4 * x, interleave(texels));
      } else {
        std::uint16_t last[4 * kLanes];
        store_half_texels(last, texels);
        std::memcpy(to + 4 * x, last, 4 * sizeof *last * static_cast<std::size_t>(width - x));
      }
    }
  }
}

}  // namespace

/// Sums over the rung's discs in scratch.sums: of its colours and of its share, and of
/// what is seen where nothing nearer is.
void blur_disc_tile(const DiscBlur& in, DiscScratch& scratch) {
  const int rows = in.height + 2 * (in.reach + 1);
  Mask all_ones = splat(-1), all_equal = splat(-1);
  for (int y = 0; y < rows; ++y) {
    const DiscRow& from = in.rows[y];
    for (int x = 0; x < kDiscTileRow; x += kLanes) {
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
      store(scratch.share[y] + x, share);
      store(scratch.seen[y] + x, seen);
      all_ones &= seen == 1.0f;
      all_equal &= seen == weight * share;
    }
  }
  for (int i = 0; i < 4; ++i) {
    for (int y = 0; y < rows; ++y) {
      const float* from = in.rows[y].channel[i] - kDiscMargin;
      for (int x = 0; x < kDiscTileRow; x += kLanes) {
        store(scratch.product[y] + x, load(from + x) * load(scratch.share[y] + x));
      }
    }
    sum_discs(in, scratch.product, scratch, scratch.sums[i]);
  }
  scratch.seen_sums = kDiscChannels - 1;
  if (all(all_ones)) {
    for (int y = 0; y < in.height; ++y) {
      for (int x = 0; x < kDiscTileWidth; x += kLanes)
        store(scratch.sums[4][y] + x, splat(in.area));
    }
  } else if (all(all_equal)) {
    scratch.seen_sums = kDiscWeight;
  } else {
    sum_discs(in, scratch.seen, scratch, scratch.sums[4]);
  }
}

/// Puts a rung behind what is seen of nearer ones.
void add_disc_sums(const DiscScratch& in, int width, int height, DiscTile& tile) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; x += kLanes) {
      const Floats seen = load(in.sums[in.seen_sums][y] + x);
      float* through = tile.channel[kDiscTransmitted][y] + x;
      const Floats transmitted = load(through);
      const Mask any = seen > 0.0f;
      const Floats scale = select(any, transmitted / select(any, seen, splat(1.0f)), splat(0.0f));
      for (int i = 0; i < 3; ++i) {
        float* to = tile.channel[i][y] + x;
        store(to, load(to) + load(in.sums[i][y] + x) * scale);
      }
      store(through, larger(transmitted - load(in.sums[kDiscWeight][y] + x) * scale, splat(0.0f)));
    }
  }
}

/// A row of `count` pixels, an even number, from rows of pixels of twice the size: three
/// quarters of `inside`, in which it lies, and one of `other`; across the same.
void enlarge_disc_row(const float* inside, const float* other, int count, float* to) {
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  for (int x = 0; x < count / 2; x += kLanes) {
    const Floats own = 0.75f * (0.75f * load(inside + x) + 0.25f * load(other + x));
    const Floats left = 0.75f * load(inside + x - 1) + 0.25f * load(other + x - 1);
    const Floats right = 0.75f * load(inside + x + 1) + 0.25f * load(other + x + 1);
    const Floats even = own + 0.25f * left, odd = own + 0.25f * right;
    store(to + 2 * x, by_turns<0>(even, odd, Lanes{}));
    store(to + 2 * x + kLanes, by_turns<kLanes / 2>(even, odd, Lanes{}));
  }
}

/// Puts a row behind what is seen of another; both have colour and transmittance.
void add_behind(const float (*from)[kDiscTileRow], int width, int y, DiscTile& tile) {
  for (int x = 0; x < width; x += kLanes) {
    const Floats open = load(tile.channel[kDiscTransmitted][y] + x);
    for (int i = 0; i < 3; ++i) {
      float* to = tile.channel[i][y] + x;
      store(to, load(to) + open * load(from[i] + x));
    }
    store(tile.channel[kDiscTransmitted][y] + x, open * load(from[kDiscTransmitted] + x));
  }
}

/// Divides by the opacity reached, and puts the tile's pixels into the picture, with the
/// scene's depth. Rows are `scene_row` and `row` halves apart.
void store_disc_tile(const DiscTile& tile, const std::uint16_t* scene, std::size_t scene_row,
                     int width, int height, HalfRounding rounding, std::uint16_t* to,
                     std::size_t row) {
  if (rounding == HalfRounding::nearest_even) {
    store_tile<HalfRounding::nearest_even>(tile, scene, scene_row, width, height, to, row);
  } else {
    store_tile<HalfRounding::toward_zero>(tile, scene, scene_row, width, height, to, row);
  }
  finish_streaming();
}
