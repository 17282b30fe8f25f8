#pragma once
// How many pixels lie how deep.

#include <cstddef>
#include <vector>

#include "tools/refocus/depth/depth_map.h"

namespace softfocus {

struct DepthBin {
  double from = 0.0;
  double to = 0.0;
  std::size_t count = 0;
};

struct DepthHistogram {
  std::vector<DepthBin> bins{};  ///< none if nothing has a finite depth
  std::size_t infinite = 0;
};

inline constexpr std::size_t kDepthBins = 12;

/// Bins of equal steps of 1/z, as circles of confusion grow, or, if `even`, of z, which may then be
/// below 0. Missing depths are not counted.
DepthHistogram depth_histogram(const DepthMap& map, bool even);

}  // namespace softfocus
