// Sums of rows, and the blend, of post_process.cpp.

/// Of `taps` rows the weighted sum.
void weigh_rows(const float* const* rows, const float* weights, int taps, int count, float* to) {
  for (int x = 0; x < count; x += kLanes) {
    Floats sum = load(rows[0] + x) * weights[0];
    for (int i = 1; i < taps; ++i) sum = sum + load(rows[i] + x) * weights[i];
    store(to + x, sum);
  }
}

namespace {

SOFTFOCUS_INLINE Floats saturate(Floats v) { return larger(smaller(v, splat(1.0f)), splat(0.0f)); }

SOFTFOCUS_INLINE Floats mix(Floats a, Floats b, Floats share) { return a + share * (b - a); }

/// Four pixels of which the first is given, as the bilinear tap in their middle.
SOFTFOCUS_INLINE Floats square_sum(const float* upper, const float* lower) {
  return (load(upper) + load(upper + 1)) + (load(lower) + load(lower + 1));
}

}  // namespace

void blend_row(const PostProcessRow& row) {
  for (int x = 0; x < row.count; x += kLanes) {
    const Floats near = load(row.blurred + 3 * row.blurred_plane + x);
    const Floats radius = larger(load(row.radius + x), near);
    const Floats square = larger(radius, splat(0.0f)) * larger(radius, splat(0.0f));
    Floats shares[4];
    for (int i = 1; i < 4; ++i) {
      shares[i] = saturate((square - row.squares[i - 1]) * row.inverses[i]);
    }
    for (int c = 0; c < 3; ++c) {
      const float* at[5];
      for (int i = 0; i < 5; ++i) at[i] = row.sharp[i] + c * row.sharp_plane + x;
      const Floats own = load(at[2]);
      const Floats taps = (square_sum(at[0], at[1]) + square_sum(at[1] - 2, at[2] - 2)) +
                          (square_sum(at[3] - 1, at[4] - 1) + square_sum(at[2] + 1, at[3] + 1));
      const Floats small = (own + taps) * (1.0f / 17.0f);
      const Floats medium = load(row.blurred + c * row.blurred_plane + x);
      const Floats large = load(row.blurred + (4 + c) * row.blurred_plane + x);
      store(row.result + c * row.result_plane + x,
            mix(mix(mix(own, small, shares[1]), medium, shares[2]), large, shares[3]));
    }
  }
}
