#pragma once
// The truth of bloom: the bright light convolved with one kernel.

#include <vector>

#include "raster/effects/bloom.h"

namespace softfocus {

/// Weights of (2 reach + 1)^2 pixels, row by row, that sum to 1.
struct BloomKernel {
  int reach = 0;
  std::vector<double> weights;

  double at(int x, int y) const {
    const auto side = static_cast<std::size_t>(2 * reach + 1);
    return weights[static_cast<std::size_t>(y + reach) * side +
                   static_cast<std::size_t>(x + reach)];
  }
};

/// The sum of the kernels of a pyramid's levels. The way down to level i and back is no
/// convolution: it depends on where in a level's pixel the light is. Its mean over all these places
/// is one,
///
///   K_i(d) = 4^-i sum_u g_i(d + u) h_i(u)
///
/// with the way down h_i and the way up g_i from and to pixels of level 0 (pyramid.h). Level i < n
/// counts (1 - spread) spread^(i - 1), level n spread^(n - 1): bloom.h.
BloomKernel bloom_kernel(int levels, double spread);

/// bloom() with its pyramid replaced by the kernel, in binary64 up to the last rounding. At the
/// edges the bright light repeats. `settings.is_steady` is false.
Image bloom_truth(const BloomSettings& settings, const Image& picture, ThreadPool& pool);

}  // namespace softfocus
