// The gather and the median of ring_bucket.cpp.

namespace {

SOFTFOCUS_INLINE Floats saturate(Floats v) { return larger(smaller(v, splat(1.0f)), splat(0.0f)); }

struct Bucket {
  Floats weight, r, g, b, radius;
};
SOFTFOCUS_INLINE Bucket empty_bucket() {
  const Floats none = splat(0.0f);
  return {none, none, none, none, none};
}

/// The mean of a bucket's quantity; 0 of an empty one.
SOFTFOCUS_INLINE Floats mean(Floats sum, Floats weight) {
  return sum / larger(weight, splat(1e-20f));
}

template <bool near_field>
SOFTFOCUS_INLINE void gather_fields(const BucketRow& row) {
  for (int x = 0; x < row.count; x += kLanes) {
    // What lies behind a near pixel must be guessed from what does not reach it.
    Floats guess = splat(0.0f);
    if constexpr (near_field) guess = load(row.rows[0] + 5 * row.plane + x) * 1e-3f;
    Bucket previous = empty_bucket(), near = empty_bucket();
    const BucketTap* tap = row.taps;
    for (int ring = row.rings; ring >= 0; --ring) {
      const int count = ring > 0 ? 8 * ring : 1;
      const Floats border = splat((static_cast<float>(ring) + 0.5f) * row.spacing_px);
      Bucket current = empty_bucket();
      Floats hits = splat(0.0f);
      for (int i = 0; i < count; ++i, ++tap) {
        const float* from = row.rows[tap->dy] + tap->dx + x;
        const Floats r = load(from), g = load(from + row.plane), b = load(from + 2 * row.plane);
        const Floats size = load(from + 3 * row.plane);
        const Floats reached = saturate(size - splat(tap->distance_px - 0.5f));
        const Floats light = smaller(load(from + 4 * row.plane) * row.inverse_density, splat(1.0f));
        Floats far_reached = reached, far_weight = reached * light;
        if constexpr (near_field) {
          const Floats share = load(from + 5 * row.plane);
          const Floats near_weight = far_weight * share;
          near.weight = near.weight + near_weight;
          near.r = near.r + r * near_weight;
          near.g = near.g + g * near_weight;
          near.b = near.b + b * near_weight;
          far_weight = (far_weight + guess * light) * (1.0f - share);
          far_reached = reached * (1.0f - share);
        }
        const Mask outer = size > border;
        const Floats to_previous = select(outer, far_weight, splat(0.0f));
        const Floats to_current = far_weight - to_previous;
        previous.weight = previous.weight + to_previous;
        previous.r = previous.r + r * to_previous;
        previous.g = previous.g + g * to_previous;
        previous.b = previous.b + b * to_previous;
        previous.radius = previous.radius + size * to_previous;
        current.weight = current.weight + to_current;
        current.r = current.r + r * to_current;
        current.g = current.g + g * to_current;
        current.b = current.b + b * to_current;
        current.radius = current.radius + size * to_current;
        hits = hits + select(outer, splat(0.0f), far_reached);
      }
      const Floats occlusion =
          saturate(mean(previous.radius, previous.weight) - mean(current.radius, current.weight));
      const Floats opacity = hits / static_cast<float>(count);
      const Floats kept = 1.0f - opacity * occlusion;
      previous = {previous.weight * kept + current.weight, previous.r * kept + current.r,
                  previous.g * kept + current.g, previous.b * kept + current.b,
                  previous.radius * kept + current.radius};
    }
    const Mask any_far = previous.weight > 0.0f;
    const Mask any_near = near.weight > 0.0f;
    float* to = row.result + x;
    const float* own = row.rows[0] + x;
    store(to, select(any_far, mean(previous.r, previous.weight), load(own)));
    store(to + row.result_plane,
          select(any_far, mean(previous.g, previous.weight), load(own + row.plane)));
    store(to + 2 * row.result_plane,
          select(any_far, mean(previous.b, previous.weight), load(own + 2 * row.plane)));
    store(to + 3 * row.result_plane, select(any_near, mean(near.r, near.weight), load(own)));
    store(to + 4 * row.result_plane,
          select(any_near, mean(near.g, near.weight), load(own + row.plane)));
    store(to + 5 * row.result_plane,
          select(any_near, mean(near.b, near.weight), load(own + 2 * row.plane)));
    store(to + 6 * row.result_plane, saturate(near.weight * row.gain));
  }
}

}  // namespace

void gather_rings(const BucketRow& row) {
  row.near_field ? gather_fields<true>(row) : gather_fields<false>(row);
}

namespace {

SOFTFOCUS_INLINE void sort(Floats& a, Floats& b) {
  const Floats least = smaller(a, b);
  b = larger(a, b);
  a = least;
}
SOFTFOCUS_INLINE void sort(Floats& a, Floats& b, Floats& c) {
  sort(b, c);
  sort(a, b);
  sort(b, c);
}
SOFTFOCUS_INLINE Floats middle(Floats a, Floats b, Floats c) {
  sort(a, b, c);
  return b;
}

}  // namespace

/// Medians of 3x3 about `count` pixels of the middle one of three rows.
void median_row(const float* above, const float* here, const float* below, int count, float* to) {
  for (int x = 0; x < count; x += kLanes) {
    Floats least[3], mid[3], most[3];
    for (int i = 0; i < 3; ++i) {
      least[i] = load(above + x + i - 1);
      mid[i] = load(here + x + i - 1);
      most[i] = load(below + x + i - 1);
      sort(least[i], mid[i], most[i]);
    }
    // Of the columns' least the largest, of the middle ones the middle, of the largest the
    // least: the median of these is that of all nine.
    store(to + x,
          middle(larger(larger(least[0], least[1]), least[2]), middle(mid[0], mid[1], mid[2]),
                 smaller(smaller(most[0], most[1]), most[2])));
  }
}
