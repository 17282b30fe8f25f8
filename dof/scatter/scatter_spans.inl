// The kernels that scatter.cpp and layers.cpp share.

using FourFloats [[gnu::vector_size(16)]] = float;
using FourDoubles [[gnu::vector_size(32)]] = double;
using FourSums [[gnu::vector_size(32)]] = std::uint64_t;

// A number below 2^51 plus this has the rounded number in its low bits.
inline constexpr double kRoundingPlace = 0x1.8p52;

SOFTFOCUS_INLINE void add_sums(std::uint64_t* at, const FourSums& change) {
  FourSums sums;
  std::memcpy(&sums, at, sizeof sums);
  sums += change;
  std::memcpy(at, &sums, sizeof sums);
}

/// Adds a span of four kinds of light to a row of differences. `at` is the place of the span's
/// middle. Needs a span that reaches the row.
SOFTFOCUS_INLINE void add_span(std::uint64_t* at, const float* light, DiscSpan span) {
  FourFloats values;
  std::memcpy(&values, light, sizeof values);
  const FourDoubles exact = __builtin_convertvector(values, FourDoubles);
  const FourDoubles none = {};
  const FourSums zero = (FourSums)(none + kRoundingPlace);
  const FourSums all = (FourSums)(exact + kRoundingPlace) - zero;
  const FourSums end = (FourSums)(exact * (0.125 * span.eighths) + kRoundingPlace) - zero;
  std::uint64_t* left = at - 4 * (span.whole + 1);
  std::uint64_t* right = at + 4 * (span.whole + 1);
  add_sums(left, end);
  add_sums(left + 4, all - end);
  add_sums(right, end - all);
  add_sums(right + 4, -end);
}
