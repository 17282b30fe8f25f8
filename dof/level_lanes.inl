// What the kernels of methods with a stack of levels share. Needs level_stack.h.

#include "dof/picture_lanes.inl"

/// share_from() of level_stack.h.
SOFTFOCUS_INLINE Floats share_from(RungStep step, Floats square) {
  return saturate((square - step.begin) * step.slope);
}

/// The sums of neighbours in two vectors side by side.
SOFTFOCUS_INLINE Floats add_pairs(Floats a, Floats b) {
  const TwoVectors pairs = unzip(a, b);
  return pairs.first + pairs.second;
}

/// kLanes pixels as 2 kLanes of half the size, from the row `inside` which they lie and the
/// `other`.
SOFTFOCUS_INLINE TwoVectors enlarge(const float* inside, const float* other) {
  const Floats own = 0.75f * (0.75f * load(inside) + 0.25f * load(other));
  const Floats left = 0.75f * load(inside - 1) + 0.25f * load(other - 1);
  const Floats right = 0.75f * load(inside + 1) + 0.25f * load(other + 1);
  return zip(own + 0.25f * left, own + 0.25f * right);
}

/// Adds a layer behind what is seen of nearer ones, in pixels of a row of the tile. `sums` are the
/// layer's, `plane` floats apart: of colours and shares; `seen_sums` those of the shares of the
/// layer and of all that it hides.
SOFTFOCUS_INLINE void add_layer_row(const float* sums, std::ptrdiff_t plane, const float* seen_sums,
                                    int y, int begin, int end, SeenTile& tile) {
  for (int x = begin; x < end; x += kLanes) {
    const Floats seen = load(seen_sums + x);
    float* through = tile.channel[kTransmitted][y] + x;
    const Floats transmitted = load(through);
    const Mask any = seen > 0.0f;
    const Floats scale = select(any, transmitted / select(any, seen, splat(1.0f)), splat(0.0f));
    for (int i = 0; i < 3; ++i) {
      float* to = tile.channel[i][y] + x;
      store(to, load(to) + load(sums + i * plane + x) * scale);
    }
    store(through, larger(transmitted - load(sums + 3 * plane + x) * scale, splat(0.0f)));
  }
}

/// kLanes pixels of the next level, from two rows of this one at `x`: of what belongs beyond the
/// level. Squares count times `sign`, and as `least_square` at least.
struct Halved {
  Floats channel[kLevelChannels];
};
SOFTFOCUS_INLINE Halved halve_rows(const LevelRow (&rows)[2], int x, float sign, RungStep beyond,
                                   float least_square) {
  Floats sums[kLevelChannels][2];
  for (int half = 0; half < 2; ++half) {
    const int at = x + half * kLanes;
    for (int i = 0; i < kLevelChannels; ++i) sums[i][half] = splat(0.0f);
    for (const LevelRow& row : rows) {
      const Floats square = sign * load(row.channel[kLevelSquare] + at);
      const Floats share = share_from(beyond, square);
      const float* weights = row.channel[kLevelWeight];
      const Floats weight = weights == nullptr ? share : load(weights + at) * share;
      for (int i = 0; i < 3; ++i) sums[i][half] += load(row.channel[i] + at) * share;
      sums[kLevelWeight][half] += weight;
      sums[kLevelSquare][half] += weight * larger(square, splat(least_square));
    }
  }
  Halved result;
  for (int i = 0; i < 3; ++i) result.channel[i] = 0.25f * add_pairs(sums[i][0], sums[i][1]);
  const Floats weight = add_pairs(sums[kLevelWeight][0], sums[kLevelWeight][1]);
  const Floats square = add_pairs(sums[kLevelSquare][0], sums[kLevelSquare][1]);
  result.channel[kLevelWeight] = 0.25f * weight;
  result.channel[kLevelSquare] = select(weight > 0.0f, square / weight, splat(0.0f));
  return result;
}
