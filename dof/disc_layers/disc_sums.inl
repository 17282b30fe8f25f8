// Sums over the discs of disc_ladder.h in tiles: what the kernels of disc-layers and of
// object-identification share. Needs disc_levels.h and level_lanes.inl.

static_assert(kLevelTileWidth == 4 * kDiscColumn && 2 * kDiscMargin == kDiscColumn &&
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
      add_columns(columns[1 - y % 2][0] + kDiscMargin + x, reach,
                  to + (y - 1) * kLevelTileWidth + x, Inside{});
    }
  }
}

// Likewise from part `column` of the tile on.
SOFTFOCUS_INLINE void sum_discs(const LadderSpan* spans, int reach, int height, int column,
                                int width, const float (*rows)[kDiscTileRow],
                                float (*columns)[kDiscApron][kDiscTileRow],
                                float (*to)[kLevelTileWidth]) {
  const float* from = rows[0] + column * kDiscColumn;
  float* sums = to[0] + column * kDiscColumn;
  switch (width) {
    case 1: return sum_discs_of<1>(spans, reach, height, from, columns, sums);
    case 2: return sum_discs_of<2>(spans, reach, height, from, columns, sums);
    case 3: return sum_discs_of<3>(spans, reach, height, from, columns, sums);
    default: return sum_discs_of<4>(spans, reach, height, from, columns, sums);
  }
}

/// Adds a layer behind what is seen of nearer ones, in a part of the tile. `sums` are sums over its
/// discs, from the part's first row on: colours and shares; `seen_sums` those of the shares of the
/// layer and of all that it hides.
SOFTFOCUS_INLINE void add_layer(const float (*sums)[kLevelTileHeight][kLevelTileWidth],
                                const float (*seen_sums)[kLevelTileWidth], const DiscPart& part,
                                SeenTile& tile) {
  const int begin = part.column * kDiscColumn, end = begin + part.columns * kDiscColumn;
  for (int y = 0; y < part.rows; ++y) {
    add_layer_row(sums[0][y], sizeof *sums / sizeof(float), seen_sums[y], part.row + y, begin, end,
                  tile);
  }
}
