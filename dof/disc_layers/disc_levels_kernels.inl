// Rows of disc_levels.cpp.

namespace {

#include "dof/disc_layers/disc_share.inl"
#include "dof/repeating_texels.inl"
#include "dof/weights.inl"

SOFTFOCUS_INLINE Floats finite_colour(Bits half) {
  const Floats value = clamp_to_half(half_to_float(half));
  return select(value == value, value, splat(0.0f));
}

// Lanes 0, 2, 4, ... or 1, 3, 5, ... of two vectors.
template <std::size_t first, std::size_t... lane>
SOFTFOCUS_INLINE Floats every_other(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (2 * lane + first)...);
}
SOFTFOCUS_INLINE Floats add_pairs(Floats a, Floats b) {
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  return every_other<0>(a, b, Lanes{}) + every_other<1>(a, b, Lanes{});
}

}  // namespace

/// Signed squares of the radii of `count` pixels of a row from `x` on; the picture's edges
/// repeat outwards.
void split_disc_squares(const DofSettings& settings, const std::uint16_t* from, int x, int width,
                        int count, float* to) {
  for (int i = 0; i < count; i += kLanes) {
    const Floats depth_m = half_to_float(load_repeating(from, x + i, width).a);
    const Floats radius =
        settings.coc.radius_at_infinity_px * (depth_m - settings.coc.focus_m) / depth_m;
    const Floats magnitude = smaller(absolute(radius), splat(settings.max_coc_px));
    const Floats square = magnitude * magnitude;
    store(to + i, select(radius < 0.0f, -square, square));
  }
}

/// Of the same their colours, `channel` floats apart.
void split_disc_colours(const std::uint16_t* from, int x, int width, int count, float* to,
                        std::ptrdiff_t channel) {
  for (int i = 0; i < count; i += kLanes) {
    const HalfTexels texels = load_repeating(from, x + i, width);
    store(to + i, finite_colour(texels.r));
    store(to + channel + i, finite_colour(texels.g));
    store(to + 2 * channel + i, finite_colour(texels.b));
  }
}

void halve_disc_rows(const DiscHalving& in) {
  for (int x = 0; x < in.count; x += kLanes) {
    Floats sums[kDiscChannels][2];
    for (int half = 0; half < 2; ++half) {
      const int at = 2 * x + half * kLanes;
      for (int i = 0; i < kDiscChannels; ++i) sums[i][half] = splat(0.0f);
      for (const DiscRow& row : in.rows) {
        const Floats square = in.sign * load(row.channel[kDiscSquare] + at);
        const Floats share = share_from(in.beyond, square);
        const Floats weight = load(row.channel[kDiscWeight] + at) * share;
        for (int i = 0; i < 3; ++i) sums[i][half] += load(row.channel[i] + at) * share;
        sums[kDiscWeight][half] += weight;
        sums[kDiscSquare][half] += weight * larger(square, splat(in.least_square));
      }
    }
    for (int i = 0; i < 4; ++i) {
      store(in.to + i * in.plane + x, 0.25f * add_pairs(sums[i][0], sums[i][1]));
    }
    const Floats weight = add_pairs(sums[kDiscWeight][0], sums[kDiscWeight][1]);
    const Floats square = add_pairs(sums[kDiscSquare][0], sums[kDiscSquare][1]);
    store(in.to + kDiscSquare * in.plane + x, select(weight > 0.0f, square / weight, splat(0.0f)));
  }
}

/// Which rungs there are in a row, a bit each: `near` of negative squares, `far` of others,
/// pixel by pixel added to what was there. Bit 0 is for rung `first_rung` and smaller ones.
/// Returns those of the row, together.
MarkedRungs mark_rungs(const float* square, const float* weight, int count, int first_rung,
                       std::uint32_t* near, std::uint32_t* far) {
  // A float's upper bits count half octaves from 2^-127: 254 is 1 to 3/2, 255 to 2. There the
  // first rung after the focus is.
  const Ints offset = splat(253 + first_rung);
  Bits all_near = splat(0u), all_far = splat(0u);
  for (int x = 0; x < count; x += kLanes) {
    const Floats value = load(square + x);
    const Bits magnitude = as_bits(absolute(value));
    const Ints rung = smaller(larger((Ints)(magnitude >> 22) - offset, splat(0)), splat(30));
    const Bits own = select((magnitude & 0x3FFFFFu) == 0u, splat(1u), splat(3u)) << (Bits)rung;
    const Bits bits = select(load(weight + x) > 0.0f, own, splat(0u));
    const Bits near_bits = select(value < 0.0f, bits, splat(0u));
    const Bits far_bits = select(value < 0.0f, splat(0u), bits);
    store(near + x, load(near + x) | near_bits);
    store(far + x, load(far + x) | far_bits);
    all_near |= near_bits;
    all_far |= far_bits;
  }
  MarkedRungs marked{};
  for (int i = 0; i < kLanes; ++i) {
    marked.near |= all_near[i];
    marked.far |= all_far[i];
  }
  return marked;
}
