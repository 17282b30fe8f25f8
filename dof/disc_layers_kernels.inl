// Tiles of disc_layers.cpp.

namespace {

#include "dof/disc_share.inl"

// The lanes from `from` on of two vectors by turns.
template <std::size_t from, std::size_t... lane>
SOFTFOCUS_INLINE Floats by_turns(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (from + lane / 2 + (lane & 1) * kLanes)...);
}

// One vector of a channel of a tile's sums, the row `from` being spread over the rows that
// its disc reaches: `first` to `last` of -reach to reach.
SOFTFOCUS_INLINE void spread_row(const float* from, const LadderSpan* spans, int reach, int first,
                                 int last, float* middle) {
  Floats sum = load(from);
  int whole = 0;
  for (int dy = reach; dy >= 0; --dy) {
    const LadderSpan span = spans[dy];
    while (whole < span.whole) {
      ++whole;
      sum += load(from - whole) + load(from + whole);
    }
    const Floats row =
        span.centre * sum + span.end * (load(from - whole - 1) + load(from + whole + 1));
    if (-dy >= first && -dy <= last) {
      float* to = middle - dy * kDiscTileWidth;
      store(to, load(to) + row);
    }
    if (dy > 0 && dy >= first && dy <= last) {
      float* to = middle + dy * kDiscTileWidth;
      store(to, load(to) + row);
    }
  }
}

}  // namespace

void blur_disc_tile(const DiscBlur& in, DiscSums& out) {
  constexpr int kRow = kDiscTileWidth + 2 * kDiscMargin;
  float row[5][kRow];
  const int end = (in.width + kLanes - 1) / kLanes * kLanes;
  for (int i = 0; i < 5; ++i) {
    for (int y = 0; y < in.height; ++y) {
      for (int x = 0; x < end; x += kLanes) store(&out.sums[i][y][x], splat(0.0f));
    }
  }
  for (int y = -in.reach; y < in.height + in.reach; ++y) {
    const DiscRows& from = in.rows[y + in.reach];
    for (int i = 0; i < end + 2 * kDiscMargin; i += kLanes) {
      const int x = i - kDiscMargin;
      const Floats signed_square = load(from.square + x);
      const Floats square = in.sign * signed_square;
      const Floats weight = load(from.weight + x);
      Floats share, seen;
      if (in.side == DiscSide::focus) {
        share = 1.0f - share_from(in.end, absolute(signed_square));
        seen = 1.0f - share_from(in.end, -signed_square);
      } else {
        const Floats begun = share_from(in.begin, square), ended = share_from(in.end, square);
        share = begun - ended;
        seen = in.side == DiscSide::near ? 1.0f - weight * ended : weight * begun;
      }
      for (int c = 0; c < 3; ++c) {
        store(&row[c][i], load(from.colour + c * in.plane + x) * share);
      }
      store(&row[3][i], weight * share);
      store(&row[4][i], seen);
    }
    const int first = y < in.reach ? -y : -in.reach;
    const int last = in.height - 1 - y < in.reach ? in.height - 1 - y : in.reach;
    for (int i = 0; i < 5; ++i) {
      for (int x = 0; x < end; x += kLanes) {
        spread_row(&row[i][kDiscMargin + x], in.spans, in.reach, first, last,
                   &out.sums[i][0][0] + y * kDiscTileWidth + x);
      }
    }
  }
}

void add_disc_sums(const DiscSums& in, int width, int height, DiscTile& tile) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; x += kLanes) {
      const Floats seen = load(&in.sums[4][y][x]);
      const Floats transmitted = load(&tile.transmitted[y][x]);
      const Floats scale =
          select(seen > 0.0f, transmitted / select(seen > 0.0f, seen, splat(1.0f)), splat(0.0f));
      store(&tile.red[y][x], load(&tile.red[y][x]) + load(&in.sums[0][y][x]) * scale);
      store(&tile.green[y][x], load(&tile.green[y][x]) + load(&in.sums[1][y][x]) * scale);
      store(&tile.blue[y][x], load(&tile.blue[y][x]) + load(&in.sums[2][y][x]) * scale);
      store(&tile.transmitted[y][x],
            larger(transmitted - load(&in.sums[3][y][x]) * scale, splat(0.0f)));
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

/// Puts a row behind what is seen of another.
void add_behind(const float* red, const float* green, const float* blue, const float* transmitted,
                int width, int y, DiscTile& tile) {
  for (int x = 0; x < width; x += kLanes) {
    const Floats open = load(&tile.transmitted[y][x]);
    store(&tile.red[y][x], load(&tile.red[y][x]) + open * load(red + x));
    store(&tile.green[y][x], load(&tile.green[y][x]) + open * load(green + x));
    store(&tile.blue[y][x], load(&tile.blue[y][x]) + open * load(blue + x));
    store(&tile.transmitted[y][x], open * load(transmitted + x));
  }
}

/// Divides by the opacity reached.
void resolve_disc_tile(int width, int height, DiscTile& tile) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; x += kLanes) {
      const Floats opacity = 1.0f - load(&tile.transmitted[y][x]);
      store(&tile.red[y][x], load(&tile.red[y][x]) / opacity);
      store(&tile.green[y][x], load(&tile.green[y][x]) / opacity);
      store(&tile.blue[y][x], load(&tile.blue[y][x]) / opacity);
    }
  }
}
