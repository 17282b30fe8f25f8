#include "dof/measure/separable.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace softfocus {
namespace {

constexpr int kStripRows = 64;

void add_weighted(std::span<double> sums, double weight, std::span<const double> values) {
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += weight * values[i];
}

}  // namespace

FilterTaps gaussian_taps(double sigma_px, int radius) {
  FilterTaps taps;
  double sum = 0.0;
  for (int x = -radius; x <= radius; ++x) {
    taps.weights.push_back(std::exp(-(x * x) / (2.0 * sigma_px * sigma_px)));
    sum += taps.weights.back();
  }
  for (double& weight : taps.weights) weight /= sum;
  return taps;
}

void for_each_strip(int height, int margin, ThreadPool& pool,
                    const std::function<void(const RowStrip&)>& body) {
  pool.for_each((height + kStripRows - 1) / kStripRows, [&](int i) {
    const int first = i * kStripRows;
    body({first, std::min(kStripRows, height - first), margin});
  });
}

PixelMap strip_map(int width, const RowStrip& strip) {
  return make_pixel_map(width + 2 * strip.margin, strip.rows + 2 * strip.margin);
}

int picture_row(const RowStrip& strip, int strip_row, int picture_height) {
  return std::clamp(strip.first_row + strip_row - strip.margin, 0, picture_height - 1);
}

std::span<double> between_margins(PixelMap& map, const RowStrip& strip, int strip_row) {
  const auto margin = static_cast<std::size_t>(strip.margin);
  const auto whole = row(map, strip_row);
  return whole.subspan(margin, whole.size() - 2 * margin);
}

void fill_margins(PixelMap& map, const RowStrip& strip) {
  for (int y = 0; y < map.height; ++y) {
    const auto inner = between_margins(map, strip, y);
    const auto whole = row(map, y);
    std::fill_n(whole.begin(), strip.margin, inner.front());
    std::fill_n(whole.end() - strip.margin, strip.margin, inner.back());
  }
}

PixelMap filtered_along(const PixelMap& map, const RowStrip& strip, const FilterTaps& taps) {
  assert(taps.radius() <= strip.margin);
  PixelMap result = make_pixel_map(map.width - 2 * strip.margin, map.height);
  const auto width = static_cast<std::size_t>(result.width);
  for (int y = 0; y < map.height; ++y) {
    auto start = static_cast<std::size_t>(strip.margin - taps.radius());
    for (const double weight : taps.weights) {
      add_weighted(row(result, y), weight, row(map, y).subspan(start, width));
      ++start;
    }
  }
  return result;
}

PixelMap filtered_down(const PixelMap& map, const RowStrip& strip, const FilterTaps& taps) {
  assert(taps.radius() <= strip.margin);
  PixelMap result = make_pixel_map(map.width, strip.rows);
  for (int y = 0; y < result.height; ++y) {
    int from = y + strip.margin - taps.radius();
    for (const double weight : taps.weights) add_weighted(row(result, y), weight, row(map, from++));
  }
  return result;
}

}  // namespace softfocus
