// add_row_scalar() in vectors.

namespace {

using Doubles [[gnu::vector_size(8 * SOFTFOCUS_LANES)]] = double;

}  // namespace

/// Of whole vectors: returns how many halves they are.
int add_row(const std::uint16_t* const* rows, int row_count, int halves, double* totals) {
  int done = 0;
  for (; done + kLanes <= halves; done += kLanes) {
    Floats sum = load_halves(rows[0] + done);
    for (int i = 1; i < row_count; ++i) sum += load_halves(rows[i] + done);
    Doubles total;
    std::memcpy(&total, totals + done, sizeof total);
    total += __builtin_convertvector(sum, Doubles);
    std::memcpy(totals + done, &total, sizeof total);
  }
  return done;
}

namespace {

using HalfLanes [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = std::uint16_t;

template <HalfRounding rounding>
int store_means_rounded(const double* totals, int samples, const std::uint16_t* depth, int halves,
                        std::uint16_t* to) {
  const Mask alpha = (lane_numbers() & 3) == 3;
  int done = 0;
  for (; done + kLanes <= halves; done += kLanes) {
    Doubles total;
    std::memcpy(&total, totals + done, sizeof total);
    total /= static_cast<double>(samples);
    const Bits mean = float_to_half<rounding>(__builtin_convertvector(total, Floats));
    HalfLanes texels;
    std::memcpy(&texels, depth + done, sizeof texels);
    texels = __builtin_convertvector(select(alpha, __builtin_convertvector(texels, Bits), mean),
                                     HalfLanes);
    std::memcpy(to + done, &texels, sizeof texels);
  }
  return done;
}

}  // namespace

/// store_mean() of whole vectors: returns how many halves they are.
int store_means(const double* totals, int samples, HalfRounding rounding,
                const std::uint16_t* depth, int halves, std::uint16_t* to) {
  return rounding == HalfRounding::nearest_even
             ? store_means_rounded<HalfRounding::nearest_even>(totals, samples, depth, halves, to)
             : store_means_rounded<HalfRounding::toward_zero>(totals, samples, depth, halves, to);
}
