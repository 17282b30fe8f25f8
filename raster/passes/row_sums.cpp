#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "raster/passes/row_sums.h"

#include <algorithm>

#define SOFTFOCUS_KERNELS "raster/passes/row_sums.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void decode_row(std::span<const std::uint16_t> from, int first, int count, float* to, Isa isa) {
  const int width = static_cast<int>(from.size() / 4);
  const int begin = std::clamp(-first, 0, count), end = std::clamp(width - first, begin, count);
  SOFTFOCUS_KERNEL(isa, decode_halves)
  (from.data() + std::ptrdiff_t{4} * (first + begin), 4 * (end - begin), to + 4 * begin);
  const auto repeat = [&](int column, int from_x, int to_x) {
    for (int x = from_x; x < to_x; ++x) {
      for (int c = 0; c < 4; ++c) {
        to[4 * x + c] = half_to_float(from[static_cast<std::size_t>(4 * column + c)]);
      }
    }
  };
  repeat(0, 0, begin);
  repeat(width - 1, end, count);
}

void sum_rows(const WeighedRows& rows, int values, float* sums, Isa isa) {
  SOFTFOCUS_KERNEL(isa, sum_vectors)(rows, values, sums);
}

void store_row(const float* sums, const float* alphas, int values, HalfRounding rounding,
               std::uint16_t* to, Isa isa) {
  const int whole = values - values % kMostLanes;
  SOFTFOCUS_KERNEL(isa, store_vectors)(sums, alphas, whole, rounding, to);
  for (int i = whole; i < values; ++i) {
    to[i] = float_to_half(i % 4 == 3 && alphas != nullptr ? alphas[i] : sums[i], rounding);
  }
}

}  // namespace softfocus

#else  // the kernels

void decode_halves(const std::uint16_t* from, int count, float* to) {
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) store(to + i, load_halves(from + i));
  for (; i < count; ++i) to[i] = ::softfocus::half_to_float(from[i]);
}

/// Several vectors of sums at once, so that additions need not wait for each other.
void sum_vectors(const WeighedRows& rows, int values, float* sums) {
  constexpr int kVectors = kValuesAtOnce / kMostLanes;
  for (int i = 0; i < values; i += kVectors * kLanes) {
    Floats sum[kVectors];
    for (Floats& one : sum) one = splat(0.0f);
    const float* weight = rows.weights;
    for (int j = 0; j < rows.count; ++j) {
      const float* from = rows.rows[j] + i;
      for (int tap = 0; tap < rows.taps; ++tap, from += 4) {
        const Floats share = splat(*weight++);
        for (int v = 0; v < kVectors; ++v) sum[v] += share * load(from + v * kLanes);
      }
    }
    for (int v = 0; v < kVectors; ++v) store(sums + i + v * kLanes, sum[v]);
  }
}

namespace {

template <HalfRounding rounding>
SOFTFOCUS_INLINE void store_rounded(const float* sums, const float* alphas, int values,
                                    std::uint16_t* to) {
  using Halves [[gnu::vector_size(2 * kLanes)]] = std::uint16_t;
  const Mask is_alpha = (lane_numbers() & 3) == 3;
  for (int i = 0; i < values; i += kLanes) {
    const Floats sum = load(sums + i);
    const Floats value = alphas != nullptr ? select(is_alpha, load(alphas + i), sum) : sum;
    const Halves halves = __builtin_convertvector(float_to_half<rounding>(value), Halves);
    std::memcpy(to + i, &halves, sizeof halves);
  }
}

}  // namespace

void store_vectors(const float* sums, const float* alphas, int values, HalfRounding rounding,
                   std::uint16_t* to) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return store_rounded<nearest_even>(sums, alphas, values, to);
    case toward_zero: return store_rounded<toward_zero>(sums, alphas, values, to);
    case swiftshader: return store_rounded<swiftshader>(sums, alphas, values, to);
  }
}

#endif
