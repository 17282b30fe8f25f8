#include "tools/refocus/depth/depth_histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfocus {

DepthHistogram depth_histogram(const DepthMap& map, bool even) {
  DepthHistogram histogram;
  double least = std::numeric_limits<double>::infinity(), largest = -least;
  for (const float metres : map.metres) {
    histogram.infinite += std::isinf(metres);
    if (!std::isfinite(metres)) continue;
    least = std::min(least, static_cast<double>(metres));
    largest = std::max(largest, static_cast<double>(metres));
  }
  if (!(least <= largest)) return histogram;
  const std::size_t count = least < largest ? kDepthBins : 1;
  const auto border = [&](std::size_t i) {
    const double share = static_cast<double>(i) / static_cast<double>(count);
    if (i == 0) return least;
    if (i == count) return largest;
    return even ? least + share * (largest - least)
                : 1.0 / (1.0 / least + share * (1.0 / largest - 1.0 / least));
  };
  for (std::size_t i = 0; i < count; ++i) histogram.bins.push_back({border(i), border(i + 1), 0});
  for (const float metres : map.metres) {
    if (!std::isfinite(metres)) continue;
    const double z = static_cast<double>(metres);
    const auto bin = std::find_if(histogram.bins.begin(), histogram.bins.end() - 1,
                                  [z](const DepthBin& b) { return z < b.to; });
    ++bin->count;
  }
  return histogram;
}

}  // namespace softfocus
