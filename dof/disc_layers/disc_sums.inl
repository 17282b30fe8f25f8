// Sums over the discs of disc_ladder.h in tiles, and the way from large pixels to small ones: what
// the kernels of disc-layers and of object-identification share. Needs disc_levels.h and lanes.

// Lanes from `from` on, of `a` and `b` by turns.
template <std::size_t from, std::size_t... lane>
SOFTFOCUS_INLINE Floats by_turns(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (from + lane / 2 + (lane & 1) * kLanes)...);
}

// Lanes 0, 2, 4, ... or 1, 3, 5, ... of two vectors.
template <std::size_t first, std::size_t... lane>
SOFTFOCUS_INLINE Floats every_other(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (2 * lane + first)...);
}

static_assert(kDiscTileWidth == 4 * kDiscColumn && 2 * kDiscMargin == kDiscColumn &&
              kDiscColumn % kLanes == 0);

// Sums of a disc's columns; columns[dx] is for the columns dx pixels from the middle. `at`
// points into the middle row.
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

// Adds the columns of discs.
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

// Discs' sums of a channel in `width` parts of kDiscColumn pixels; all begin at the first part's
// first pixel, `rows` reach + 1 rows above the tile. Vectors are worked on together, so that spans
// are fetched once for all of them. A row's columns are summed one row ahead: values just stored
// are slow to load at another alignment.
template <int width>
SOFTFOCUS_INLINE void sum_discs_of(const LadderSpan* spans, int reach, int height,
                                   const float* rows, float (*columns)[kDiscApron][kDiscTileRow],
                                   float* to) {
  using Around = std::make_index_sequence<width + 1>;
  using Inside = std::make_index_sequence<width>;
  for (int y = 0; y <= height; ++y) {
    if (y < height) {
      const float* row = rows + (y + reach + 1) * kDiscTileRow;
      for (int x = 0; x < (width + 1) * kDiscColumn; x += (width + 1) * kLanes) {
        sum_columns(row + x, spans, reach, columns[y % 2][0] + x, Around{});
      }
    }
    if (y == 0) continue;
    for (int x = 0; x < width * kDiscColumn; x += width * kLanes) {
      add_columns(columns[1 - y % 2][0] + kDiscMargin + x, reach, to + (y - 1) * kDiscTileWidth + x,
                  Inside{});
    }
  }
}

// Likewise from part `column` of the tile on.
SOFTFOCUS_INLINE void sum_discs(const LadderSpan* spans, int reach, int height, int column,
                                int width, const float (*rows)[kDiscTileRow],
                                float (*columns)[kDiscApron][kDiscTileRow],
                                float (*to)[kDiscTileWidth]) {
  const float* from = rows[0] + column * kDiscColumn;
  float* sums = to[0] + column * kDiscColumn;
  switch (width) {
    case 1: return sum_discs_of<1>(spans, reach, height, from, columns, sums);
    case 2: return sum_discs_of<2>(spans, reach, height, from, columns, sums);
    case 3: return sum_discs_of<3>(spans, reach, height, from, columns, sums);
    default: return sum_discs_of<4>(spans, reach, height, from, columns, sums);
  }
}

// Lanes from `from` on, of `a` and then `b`.
template <std::size_t from, std::size_t... lane>
SOFTFOCUS_INLINE Floats lanes_from(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (from + lane)...);
}

struct TwoVectors {
  Floats first, second;
};
// A vector of pixels as two of half the size.
SOFTFOCUS_INLINE TwoVectors enlarge_vector(const float* inside, const float* other) {
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  const Floats own = 0.75f * (0.75f * load(inside) + 0.25f * load(other));
  const Floats left = 0.75f * load(inside - 1) + 0.25f * load(other - 1);
  const Floats right = 0.75f * load(inside + 1) + 0.25f * load(other + 1);
  const Floats even = own + 0.25f * left, odd = own + 0.25f * right;
  return {by_turns<0>(even, odd, Lanes{}), by_turns<kLanes / 2>(even, odd, Lanes{})};
}

/// Enlarges to a row of `count` pixels, an even number, from rows of pixels of twice the size:
/// three quarters of the row `inside` which it lies, a quarter of the `other`; along x likewise.
SOFTFOCUS_INLINE void enlarge_row(const float* inside, const float* other, int count, float* to) {
  for (int x = 0; x < count / 2; x += kLanes) {
    const TwoVectors large = enlarge_vector(inside + x, other + x);
    store(to + 2 * x, large.first);
    store(to + 2 * x + kLanes, large.second);
  }
}

/// Adds a layer behind what is seen of nearer ones, in a part of the tile. `sums` are sums over its
/// discs, from the part's first row on: colours and shares; `seen_sums` those of the shares of the
/// layer and of all that it hides.
SOFTFOCUS_INLINE void add_layer(const float (*sums)[kDiscTileHeight][kDiscTileWidth],
                                const float (*seen_sums)[kDiscTileWidth], const DiscPart& part,
                                DiscTile& tile) {
  const int begin = part.column * kDiscColumn, end = begin + part.columns * kDiscColumn;
  for (int y = 0; y < part.rows; ++y) {
    for (int x = begin; x < end; x += kLanes) {
      const Floats seen = load(seen_sums[y] + x);
      float* through = tile.channel[kDiscTransmitted][part.row + y] + x;
      const Floats transmitted = load(through);
      const Mask any = seen > 0.0f;
      const Floats scale = select(any, transmitted / select(any, seen, splat(1.0f)), splat(0.0f));
      for (int i = 0; i < 3; ++i) {
        float* to = tile.channel[i][part.row + y] + x;
        store(to, load(to) + load(sums[i][y] + x) * scale);
      }
      store(through, larger(transmitted - load(sums[kDiscWeight][y] + x) * scale, splat(0.0f)));
    }
  }
}

/// Adds a row of colour and transmittance behind a row of the tile.
SOFTFOCUS_INLINE void add_row_behind(const float (*from)[kDiscTileRow], int width, int y,
                                     DiscTile& tile) {
  for (int x = 0; x < width; x += kLanes) {
    const Floats open = load(tile.channel[kDiscTransmitted][y] + x);
    for (int i = 0; i < 3; ++i) {
      float* to = tile.channel[i][y] + x;
      store(to, load(to) + open * load(from[i] + x));
    }
    store(tile.channel[kDiscTransmitted][y] + x, open * load(from[kDiscTransmitted] + x));
  }
}
