#include "dof/measure/hdr_flip.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace softfocus {
namespace {

constexpr double kShownAs = 0.85;
constexpr double kLeastMedian = 0x1p-14;

std::vector<double> luminances(const Image& image) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    const auto texels = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < texels.size(); i += 4) {
      values.push_back(
          luminance(half_light(texels[i]), half_light(texels[i + 1]), half_light(texels[i + 2])));
    }
  }
  return values;
}

/// The middle value; of an even number the mean of the two.
double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const double upper = *middle;
  return values.size() % 2 == 1 ? upper : 0.5 * (upper + *std::max_element(values.begin(), middle));
}

}  // namespace

ExposureRange exposure_range(const Image& reference) {
  assert(reference.format == Format::rgba16f);
  std::vector<double> values = luminances(reference);
  const double largest = *std::max_element(values.begin(), values.end());
  if (largest == 0.0) return {};
  const double bright = filmic_inverse(kShownAs);
  ExposureRange range;
  range.first_stops = std::log2(bright / largest);
  range.last_stops = std::log2(bright / std::max(median(values), kLeastMedian));
  // A picture darker than the least median.
  range.last_stops = std::max(range.first_stops, range.last_stops);
  range.count = std::max(2, static_cast<int>(std::ceil(range.last_stops - range.first_stops)));
  return range;
}

PixelMap hdr_flip_map(const Image& reference, const Image& test, ThreadPool& pool,
                      double pixels_per_degree) {
  const ExposureRange range = exposure_range(reference);
  const double step = (range.last_stops - range.first_stops) / std::max(range.count - 1, 1);
  PixelMap largest = make_pixel_map(reference.width, reference.height);
  for (int i = 0; i < range.count; ++i) {
    const PixelMap map = flip_map(reference, test, filmic_tone(range.first_stops + i * step), pool,
                                  pixels_per_degree);
    for (std::size_t k = 0; k < largest.values.size(); ++k) {
      largest.values[k] = std::max(largest.values[k], map.values[k]);
    }
  }
  return largest;
}

}  // namespace softfocus
