#pragma once
// Weighted sums of rows of RGBA16F, what filter kernels and pyramids are made of. A row is four
// floats a pixel, as its halves lie in memory.

#include <cstdint>
#include <span>

#include "raster/lanes/isa.h"
#include "raster/numbers/half.h"

namespace softfocus {

/// sum_rows() works in groups of so many values: rows are to be readable and sums writable up to
/// a whole group.
inline constexpr int kValuesAtOnce = 4 * kMostLanes;

/// Needs an isa with vectors, as all below. `count` pixels from column `first` on; beyond the row
/// its outermost pixels repeat.
void decode_row(std::span<const std::uint16_t> from, int first, int count, float* to, Isa isa);

/// Rows, and in each of them `taps` pixels side by side.
struct WeighedRows {
  const float* const* rows;  ///< each from the first result's first tap on
  int count;
  int taps;
  const float* weights;  ///< row by row
};

/// sums[i] = the sum of weight * rows[j][i + 4 tap], beginning with 0, row by row, for `values`
/// values: each product and sum rounded to binary32.
void sum_rows(const WeighedRows& rows, int values, float* sums, Isa isa);

/// Stores `values` sums as halves; every fourth, the alpha, comes from `alphas` unless that is
/// null.
void store_row(const float* sums, const float* alphas, int values, HalfRounding rounding,
               std::uint16_t* to, Isa isa);

}  // namespace softfocus
