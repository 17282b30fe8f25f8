#include "dof/measure/ssim.h"

#include <cassert>

#include "dof/measure/separable.h"

namespace softfocus {
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
