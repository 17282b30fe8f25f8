#pragma once
// A number for each pixel: a measure before it is averaged over the picture or a region.

#include <cstddef>
#include <span>
#include <vector>

namespace softfocus {

struct PixelMap {
  int width = 0;
  int height = 0;
  std::vector<double> values;  ///< row by row, the top one first
};

inline PixelMap make_pixel_map(int width, int height) {
  return {width, height,
          std::vector<double>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
}

inline std::span<double> row(PixelMap& map, int y) {
  const auto width = static_cast<std::size_t>(map.width);
  return std::span{map.values}.subspan(static_cast<std::size_t>(y) * width, width);
}
inline std::span<const double> row(const PixelMap& map, int y) {
  const auto width = static_cast<std::size_t>(map.width);
  return std::span{map.values}.subspan(static_cast<std::size_t>(y) * width, width);
}

/// The mean of all values, summed in reading order.
inline double mean(const PixelMap& map) {
  double sum = 0.0;
  for (const double value : map.values) sum += value;
  return sum / static_cast<double>(map.values.size());
}

}  // namespace softfocus
