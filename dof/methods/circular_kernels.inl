// Both passes of circular_separable.cpp.

namespace {

struct Complexes {
  Floats re, im;
};
SOFTFOCUS_INLINE Complexes product(Complexes a, Complexes b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

SOFTFOCUS_INLINE float largest_lane(Floats v) {
  float lanes[kLanes];
  store(lanes, v);
  float largest = 0.0f;
  for (int i = 0; i < kLanes; ++i) largest = lanes[i] > largest ? lanes[i] : largest;
  return largest;
}

SOFTFOCUS_INLINE Floats share_of(Floats radius_px, Floats twice_inverse) {
  return smaller(absolute(radius_px) * twice_inverse, splat(1.0f));
}

/// Gathers `values` planes, the same for every component in the first pass, a component's
/// own in the second.
template <bool across, int components>
SOFTFOCUS_INLINE void gather_circular(const CircularRow& row) {
  constexpr int kValues = across ? 3 : 6;  // of one component
  constexpr int kRadius = across ? 3 : 6 * components;
  for (int x = 0; x < row.count; x += kLanes) {
    const float* own = row.taps[0] + x;
    const Floats signed_radius = load(own + kRadius * row.plane);
    const Floats radius = absolute(signed_radius);
    const Mask blurred = radius > 0.5f;
    const Floats cut = radius * kCircularCut[components - 1] + 0.5f;
    const Floats twice_inverse = 2.0f / larger(radius, splat(0.5f));
    const int limit = static_cast<int>(largest_lane(select(blurred, cut, splat(0.0f))));
    const int reach = limit < row.reach ? limit : row.reach;
    const Ints entry = truncate(radius * 16.0f + 0.5f);
    Floats top[3] = {}, bottom = splat(0.0f);
    for (int c = 0; c < components; ++c) {
      const std::ptrdiff_t first = across ? 0 : 6 * c * row.plane;
      const Complexes one{gather(row.components[c].real, entry, blurred),
                          gather(row.components[c].imaginary, entry, blurred)};
      const Complexes step = product(one, one);
      Complexes k = one, next = product(step, one), sum{splat(1.0f), splat(0.0f)};
      Floats here[kValues], values[6] = {};
      for (int i = 0; i < kValues; ++i) here[i] = load(own + first + i * row.plane);
      // Real ones of the first pass are values 0, 2 and 4.
      for (int i = 0; i < kValues; ++i) values[across ? 2 * i : i] = here[i];
      for (int d = 1; d <= reach; ++d) {
        const Floats weight =
            larger(smaller(cut - static_cast<float>(d), splat(1.0f)), splat(0.0f));
        const Complexes weighed{k.re * weight, k.im * weight};
        const float* before = row.taps[-d] + x;
        const float* after = row.taps[d] + x;
        const Floats share_before = share_of(load(before + kRadius * row.plane), twice_inverse);
        const Floats share_after = share_of(load(after + kRadius * row.plane), twice_inverse);
        Floats both[kValues];
        for (int i = 0; i < kValues; ++i) {
          const Floats p = load(before + first + i * row.plane);
          const Floats q = load(after + first + i * row.plane);
          both[i] =
              (here[i] + share_before * (p - here[i])) + (here[i] + share_after * (q - here[i]));
        }
        for (int i = 0; i < 3; ++i) {
          if constexpr (across) {
            values[2 * i] = values[2 * i] + weighed.re * both[i];
            values[2 * i + 1] = values[2 * i + 1] + weighed.im * both[i];
          } else {
            const Complexes more = product(weighed, {both[2 * i], both[2 * i + 1]});
            values[2 * i] = values[2 * i] + more.re;
            values[2 * i + 1] = values[2 * i + 1] + more.im;
          }
        }
        sum.re = sum.re + (weighed.re + weighed.re);
        sum.im = sum.im + (weighed.im + weighed.im);
        k = product(k, next);
        next = product(next, step);
      }
      if constexpr (across) {
        const Floats inverse = 1.0f / (sum.re * sum.re + sum.im * sum.im);
        const Complexes scale{sum.re * inverse, -(sum.im * inverse)};
        for (int i = 0; i < 3; ++i) {
          const Complexes mean = product({values[2 * i], values[2 * i + 1]}, scale);
          float* to = row.result + (6 * c + 2 * i) * row.result_plane + x;
          store(to, select(blurred, mean.re, here[i]));
          store(to + row.result_plane, select(blurred, mean.im, splat(0.0f)));
        }
      } else {
        const Complexes factor = product(
            {splat(row.components[c].real_factor), splat(-row.components[c].imaginary_factor)},
            sum);
        for (int i = 0; i < 3; ++i) {
          top[i] = top[i] + product(factor, {values[2 * i], values[2 * i + 1]}).re;
        }
        bottom = bottom + product(factor, sum).re;
      }
    }
    if constexpr (across) {
      store(row.result + 6 * components * row.result_plane + x, signed_radius);
    } else {
      for (int i = 0; i < 3; ++i) {
        store(row.result + i * row.result_plane + x,
              select(blurred, top[i] / bottom, load(own + 2 * i * row.plane)));
      }
    }
  }
}

}  // namespace

void circular_across(const CircularRow& row, int components) {
  components == 1 ? gather_circular<true, 1>(row) : gather_circular<true, 2>(row);
}
void circular_down(const CircularRow& row, int components) {
  components == 1 ? gather_circular<false, 1>(row) : gather_circular<false, 2>(row);
}
