// What scatter.cpp does along rows.

namespace {

using FourFloats [[gnu::vector_size(16)]] = float;
using FourDoubles [[gnu::vector_size(32)]] = double;
using FourSums [[gnu::vector_size(32)]] = std::uint64_t;

// Below 2^51 a number plus this has its whole part, rounded, in its low bits.
inline constexpr double kRoundingPlace = 0x1.8p52;

SOFTFOCUS_INLINE void add_sums(std::uint64_t* at, const FourSums& change) {
  FourSums sums;
  std::memcpy(&sums, at, sizeof sums);
  sums += change;
  std::memcpy(at, &sums, sizeof sums);
}

}  // namespace

/// Adds the spans of `count` pixels, all `dy` rows away, to rows of differences. `spans` are
/// the discs' at that |dy|; `differences` points at the first pixel's place in slab 0.
void scatter_row(const float* light, const std::uint16_t* disc, const std::uint8_t* slab, int count,
                 const DiscSpan* spans, std::uint64_t* differences, std::ptrdiff_t slab_stride) {
  for (int x = 0; x < count; ++x) {
    const DiscSpan span = spans[disc[x]];
    if (span.whole < -1) continue;
    FourFloats values;
    std::memcpy(&values, light + 4 * x, sizeof values);
    const FourDoubles exact = __builtin_convertvector(values, FourDoubles);
    const FourDoubles none = {};
    const FourSums zero = (FourSums)(none + kRoundingPlace);
    const FourSums all = (FourSums)(exact + kRoundingPlace) - zero;
    const FourSums end = (FourSums)(exact * (0.125 * span.eighths) + kRoundingPlace) - zero;
    std::uint64_t* at = differences + slab[x] * slab_stride + 4 * x;
    std::uint64_t* left = at - 4 * (span.whole + 1);
    std::uint64_t* right = at + 4 * (span.whole + 1);
    add_sums(left, end);
    add_sums(left + 4, all - end);
    add_sums(right, end - all);
    add_sums(right + 4, -end);
  }
}
