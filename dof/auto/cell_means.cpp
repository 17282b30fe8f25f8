#ifndef SOFTFOCUS_ISA

#include "dof/auto/cell_means.h"

#include <algorithm>
#include <cmath>

#include "raster/images/texel.h"
#include "raster/numbers/half.h"

#define SOFTFOCUS_KERNELS "dof/auto/cell_means.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

/// Sums down the columns of pixels: planes of red, green, blue and radius; and the brightest.
struct ColumnSums {
  std::size_t width;
  std::vector<float> values = std::vector<float>(5 * width);
};

void add_pixel(const std::uint16_t* texel, const PixelCoc& coc, std::size_t x, ColumnSums& sums) {
  float largest = 0.0f;
  for (std::size_t i = 0; i < 3; ++i) {
    const float light = trait_light(half_to_float(texel[i]));
    sums.values[i * sums.width + x] += light;
    largest = std::max(largest, light);
  }
  const float radius_px = signed_trait_radius(coc, half_to_float(texel[3]));
  sums.values[3 * sums.width + x] += radius_px;
  float& brightest = sums.values[4 * sums.width + x];
  if (std::fabs(radius_px) >= 0.5f) brightest = std::max(brightest, largest);
}

void add_row(const ConstImageView& picture, int y, const PixelCoc& coc, Isa isa, ColumnSums& sums) {
  const std::uint16_t* texels = row<std::uint16_t>(picture, y).data();
  int x = 0;
  if (isa != Isa::scalar) {
    x = SOFTFOCUS_KERNEL(isa, add_to_columns)(texels, picture.width, coc, sums.values.data());
  }
  for (; x < picture.width; ++x) add_pixel(texels + 4 * x, coc, static_cast<std::size_t>(x), sums);
}

CellMean mean_of_columns(const ColumnSums& sums, std::size_t begin, std::size_t end, int rows) {
  std::array<float, 4> totals{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t x = begin; x < end; ++x) totals[i] += sums.values[i * sums.width + x];
  }
  const auto pixels = static_cast<float>(end - begin) * static_cast<float>(rows);
  float brightest = 0.0f;
  for (std::size_t x = begin; x < end; ++x) {
    brightest = std::max(brightest, sums.values[4 * sums.width + x]);
  }
  return {
      {totals[0] / pixels, totals[1] / pixels, totals[2] / pixels}, totals[3] / pixels, brightest};
}

}  // namespace

float signed_trait_radius(const PixelCoc& coc, float depth_m) {
  const float radius = coc_radius_px(coc, depth_m);
  if (!(radius < kLargestTraitRadiusPx)) return kLargestTraitRadiusPx;  // NaN, too
  return radius < -kLargestTraitRadiusPx ? -kLargestTraitRadiusPx : radius;
}

float trait_light(float value) {
  if (!(value > 0.0f)) return 0.0f;  // NaN, too
  return value < kLargestHalf ? value : kLargestHalf;
}

CellMeans cell_means(const ConstImageView& picture, const PixelCoc& coc, ThreadPool& pool) {
  CellMeans means;
  means.columns = (picture.width + kCellPx - 1) / kCellPx;
  means.rows = (picture.height + kCellPx - 1) / kCellPx;
  means.cells.resize(static_cast<std::size_t>(means.columns) *
                     static_cast<std::size_t>(means.rows));
  pool.for_each(means.rows, [&](int j) {
    ColumnSums sums{static_cast<std::size_t>(picture.width)};
    const int y_begin = j * kCellPx, y_end = std::min(y_begin + kCellPx, picture.height);
    for (int y = y_begin; y < y_end; ++y) add_row(picture, y, coc, pool.isa(), sums);
    CellMean* to = &means.cells[static_cast<std::size_t>(j * means.columns)];
    for (std::size_t x = 0; x < sums.width; x += kCellPx) {
      *to++ = mean_of_columns(sums, x, std::min(x + kCellPx, sums.width), y_end - y_begin);
    }
  });
  return means;
}

}  // namespace softfocus

#else  // the kernels, once a vector unit

SOFTFOCUS_INLINE Floats light_of(Bits half) {
  const Floats value = half_to_float(half);
  const Floats cut = select(value < 65504.0f, value, splat(65504.0f));
  return select(value > 0.0f, cut, splat(0.0f));
}

/// Adds a row's whole vectors to the sums, five planes of `width`. Returns how many pixels it
/// has added.
int add_to_columns(const std::uint16_t* row, int width, const PixelCoc& coc, float* sums) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const auto texels = load_half_texels(row + 4 * x);
    float* const to = sums + x;
    const Floats r = light_of(texels.r), g = light_of(texels.g), b = light_of(texels.b);
    store(to, load(to) + r);
    store(to + width, load(to + width) + g);
    store(to + 2 * width, load(to + 2 * width) + b);
    const Floats depth_m = half_to_float(texels.a);
    const Floats radius = coc.radius_at_infinity_px * (depth_m - coc.focus_m) / depth_m;
    const Floats most = splat(kLargestTraitRadiusPx);
    const Floats cut = select(radius < most, radius, most);
    const Floats signed_radius = select(cut < -most, -most, cut);
    store(to + 3 * width, load(to + 3 * width) + signed_radius);
    const Mask is_blurred = absolute(signed_radius) >= 0.5f;
    const Floats light = select(is_blurred, larger(larger(r, g), b), splat(0.0f));
    store(to + 4 * width, larger(load(to + 4 * width), light));
  }
  return x;
}

#endif
