// Tiles of disc_layers.cpp.

namespace {

#include "dof/disc_share.inl"

// The lanes from `from` on of two vectors by turns.
template <std::size_t from, std::size_t... lane>
SOFTFOCUS_INLINE Floats by_turns(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (from + lane / 2 + (lane & 1) * kLanes)...);
}

// Sums of columns of a disc, a vector of them: at columns[dx] what is dx pixels from the
// middle. `at` is in the row of the middle.
SOFTFOCUS_INLINE void sum_columns(const float* at, const LadderSpan* spans, int reach,
                                  float* columns) {
  Floats sum = load(at);
  int dx = reach;
  for (int dy = 1;; ++dy) {
    const Floats pair = load(at - dy * kDiscTileRow) + load(at + dy * kDiscTileRow);
    while (spans[dx].whole == dy - 1) {
      store(columns + dx * kDiscTileRow, spans[dx].centre * sum + spans[dx].end * pair);
      if (--dx < 0) return;
    }
    sum += pair;
  }
}

// Discs' sums of a channel that fills the rows from `reach + 1` above the tile on.
SOFTFOCUS_INLINE void sum_discs(const DiscBlur& in, const float (*rows)[kDiscTileRow], int width,
                                float (*columns)[kDiscTileRow], float (*to)[kDiscTileWidth]) {
  for (int y = 0; y < in.height; ++y) {
    const float* row = rows[y + in.reach + 1];
    for (int x = kDiscMargin - kLanes * ((in.reach + kLanes - 1) / kLanes);
         x < kDiscMargin + width + in.reach; x += kLanes) {
      sum_columns(row + x, in.spans, in.reach, columns[0] + x);
    }
    for (int x = 0; x < width; x += kLanes) {
      const float* middle = columns[0] + kDiscMargin + x;
      Floats sum = load(middle);
      for (int dx = 1; dx <= in.reach; ++dx) {
        middle += kDiscTileRow;
        sum += load(middle - dx) + load(middle + dx);
      }
      store(to[y] + x, sum);
    }
  }
}

}  // namespace

/// Sums over the rung's discs in scratch.sums: of its colours and of its share, and of
/// what is seen where nothing nearer is.
void blur_disc_tile(const DiscBlur& in, DiscScratch& scratch) {
  const int width = (in.width + kLanes - 1) / kLanes * kLanes;
  const int rows = in.height + 2 * (in.reach + 1);
  const int margin = in.reach > 0 ? kDiscMargin : 0;
  Mask all_ones = splat(-1), all_equal = splat(-1);
  for (int y = 0; y < rows; ++y) {
    const DiscRow& from = in.rows[y];
    float* shares = scratch.share[y] + kDiscMargin;
    float* seens = scratch.seen[y] + kDiscMargin;
    for (int x = -margin; x < width + margin; x += kLanes) {
      const Floats signed_square = load(from.channel[kDiscSquare] + x);
      const Floats weight = load(from.channel[kDiscWeight] + x);
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
      store(shares + x, share);
      store(seens + x, seen);
      all_ones &= seen == 1.0f;
      all_equal &= seen == weight * share;
    }
  }
  for (int i = 0; i < 4; ++i) {
    for (int y = 0; y < rows; ++y) {
      const float* from = in.rows[y].channel[i];
      for (int x = -margin; x < width + margin; x += kLanes) {
        store(scratch.product[y] + kDiscMargin + x,
              load(from + x) * load(scratch.share[y] + kDiscMargin + x));
      }
    }
    sum_discs(in, scratch.product, width, scratch.columns, scratch.sums[i]);
  }
  if (all(all_ones)) {
    for (int y = 0; y < in.height; ++y) {
      for (int x = 0; x < width; x += kLanes) store(scratch.sums[4][y] + x, splat(in.area));
    }
  } else if (all(all_equal)) {
    std::memcpy(scratch.sums[4], scratch.sums[kDiscWeight], sizeof scratch.sums[4]);
  } else {
    sum_discs(in, scratch.seen, width, scratch.columns, scratch.sums[4]);
  }
}

/// Puts a rung behind what is seen of nearer ones.
void add_disc_sums(const DiscScratch& in, int width, int height, DiscTile& tile) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; x += kLanes) {
      const Floats seen = load(in.sums[4][y] + x);
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
/// quarters of `inside`, in which it lies, and one of `other`; across the same. `blended` has
/// room for a vector more at either end than the large pixels.
void enlarge_disc_row(const float* inside, const float* other, int count, float* blended,
                      float* to) {
  const int large = count / 2;
  for (int x = -1; x < large + 1; x += kLanes) {
    store(blended + 1 + x, 0.75f * load(inside + x) + 0.25f * load(other + x));
  }
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  for (int x = 0; x < large; x += kLanes) {
    const Floats own = 0.75f * load(blended + 1 + x);
    const Floats even = own + 0.25f * load(blended + x);
    const Floats odd = own + 0.25f * load(blended + 2 + x);
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

/// Divides by the opacity reached.
void resolve_disc_tile(int width, int height, DiscTile& tile) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; x += kLanes) {
      const Floats opacity = 1.0f - load(tile.channel[kDiscTransmitted][y] + x);
      for (int i = 0; i < 3; ++i) {
        store(tile.channel[i][y] + x, load(tile.channel[i][y] + x) / opacity);
      }
    }
  }
}
