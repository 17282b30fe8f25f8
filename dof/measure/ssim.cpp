#include "dof/measure/ssim.h"

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

namespace {

constexpr int kRadius = 5;
constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01;
constexpr double kC2 = 0.03 * 0.03;

PixelMap luma(const Image& image, const ToneTable& tone, const RowStrip& strip) {
  PixelMap map = strip_map(image.width, strip);
  for (int y = 0; y < map.height; ++y) {
    const auto texels = row<std::uint16_t>(image, picture_row(strip, y, image.height));
    const auto values = between_margins(map, strip, y);
    for (std::size_t x = 0; x < values.size(); ++x) {
      values[x] = luminance(toned(tone, texels[4 * x]), toned(tone, texels[4 * x + 1]),
                            toned(tone, texels[4 * x + 2]));
    }
  }
  fill_margins(map, strip);
  return map;
}

PixelMap product(const PixelMap& a, const PixelMap& b) {
  PixelMap result = make_pixel_map(a.width, a.height);
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    result.values[i] = a.values[i] * b.values[i];
  }
  return result;
}

}  // namespace

PixelMap ssim_map(const Image& a, const Image& b, const ToneTable& tone, ThreadPool& pool) {
  assert(a.format == Format::rgba16f && b.format == Format::rgba16f);
  assert(a.width == b.width && a.height == b.height);
  PixelMap map = make_pixel_map(a.width, a.height);
  const FilterTaps window = gaussian_taps(kSigma, kRadius);
  for_each_strip(a.height, kRadius, pool, [&](const RowStrip& strip) {
    const auto windowed = [&](const PixelMap& values) {
      return filtered_down(filtered_along(values, strip, window), strip, window);
    };
    const PixelMap of_a = luma(a, tone, strip);
    const PixelMap of_b = luma(b, tone, strip);
    const PixelMap mean_a = windowed(of_a);
    const PixelMap mean_b = windowed(of_b);
    const PixelMap mean_aa = windowed(product(of_a, of_a));
    const PixelMap mean_bb = windowed(product(of_b, of_b));
    const PixelMap mean_ab = windowed(product(of_a, of_b));
    for (int y = 0; y < strip.rows; ++y) {
      const auto result = row(map, strip.first_row + y);
      for (std::size_t x = 0; x < result.size(); ++x) {
        const double ma = row(mean_a, y)[x];
        const double mb = row(mean_b, y)[x];
        const double variance_a = row(mean_aa, y)[x] - ma * ma;
        const double variance_b = row(mean_bb, y)[x] - mb * mb;
        const double covariance = row(mean_ab, y)[x] - ma * mb;
        result[x] = (2.0 * (ma * mb) + kC1) * (2.0 * covariance + kC2) /
                    ((ma * ma + mb * mb + kC1) * (variance_a + variance_b + kC2));
      }
    }
  });
  return map;
}

}  // namespace softfocus
