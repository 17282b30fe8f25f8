#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "scenes/warped_views/warp_source.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/images/texel.h"

namespace softfocus {

// A row of a plane, with borders.
struct SharpenedRow {
  const float *from, *radii;
  int stride, count;
  const float* amounts;
  int last_amount;
  float most_shift;
  float* to;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/warped_views/warp_source.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

float radius_at(const PixelCoc& coc, float depth_m) {
  const float radius = coc_radius_px(coc, depth_m);
  if (!(radius > -kMostWarpRadiusPx)) return -kMostWarpRadiusPx;
  return radius < kMostWarpRadiusPx ? radius : kMostWarpRadiusPx;
}

void sharpen_row_scalar(const SharpenedRow& row) {
  for (int x = 0; x < row.count; ++x) {
    const float own = row.from[x], radius = row.radii[x];
    const int step = std::min(static_cast<int>(std::fabs(radius) * kAmountsAPx), row.last_amount);
    float sum = 0.0f;
    for (const int next : {x - 1, x + 1, x - row.stride, x + row.stride}) {
      if (std::fabs(row.radii[next] - radius) * row.most_shift <= kSameSurfacePx) {
        sum += std::clamp(own - row.from[next], -1.0f, 1.0f);
      }
    }
    row.to[x] = own + row.amounts[step] * sum;
  }
}

}  // namespace

void set_source(WarpSource& source, const Image& picture, const PixelCoc& coc,
                const WarpSharpening& sharpening, ThreadPool& pool) {
  source.width = picture.width;
  source.height = picture.height;
  const auto stride = static_cast<std::size_t>(plane_stride(source));
  const std::size_t size = stride * static_cast<std::size_t>(source.height + 2);
  const std::array planes{&source.red, &source.green, &source.blue, &source.radii};
  for (std::vector<float>* plane : planes) plane->resize(size);
  const int across = warp_blocks(source.width), down = warp_blocks(source.height);
  source.block_radii.assign(static_cast<std::size_t>(across) * static_cast<std::size_t>(down),
                            0.0f);
  pool.for_each(down, [&](int block_y) {
    const int end = std::min((block_y + 1) * kWarpBlock, source.height);
    for (int y = block_y * kWarpBlock; y < end; ++y) {
      const std::size_t first = plane_at(source, 0, y);
      const std::uint16_t* const texels = row<std::uint16_t>(picture, y).data();
      int x = 0;
      if (pool.isa() != Isa::scalar) {
        x = SOFTFOCUS_KERNEL(pool.isa(), read_source)(
            coc, texels, source.width, source.red.data() + first, source.green.data() + first,
            source.blue.data() + first, source.radii.data() + first);
      }
      for (; x < source.width; ++x) {
        const std::size_t at = first + static_cast<std::size_t>(x);
        source.red[at] = half_to_float(texels[4 * x]);
        source.green[at] = half_to_float(texels[4 * x + 1]);
        source.blue[at] = half_to_float(texels[4 * x + 2]);
        source.radii[at] = radius_at(coc, half_to_float(texels[4 * x + 3]));
      }
      for (x = 0; x < source.width; ++x) {
        float& most =
            source.block_radii[static_cast<std::size_t>(block_y * across + x / kWarpBlock)];
        most = std::max(most, std::fabs(source.radii[first + static_cast<std::size_t>(x)]));
      }
      for (std::vector<float>* plane : planes) {
        float* const pixels = plane->data() + first;
        std::fill(pixels - kSourceBorder, pixels, pixels[0]);
        std::fill(pixels + source.width, pixels + source.width + kSourceBorder,
                  pixels[source.width - 1]);
      }
    }
  });
  for (std::vector<float>* plane : planes) {
    std::copy_n(plane->data() + stride, stride, plane->data());
    std::copy_n(plane->data() + size - 2 * stride, stride, plane->data() + size - stride);
  }
  if (sharpening.amounts.empty()) return;
  for (std::vector<float>* plane : {&source.red, &source.green, &source.blue}) {
    const std::vector<float> before = *plane;
    pool.for_each(source.height, [&](int y) {
      const std::size_t first = plane_at(source, 0, y);
      const SharpenedRow row{
          before.data() + first,     source.radii.data() + first,
          static_cast<int>(stride),  source.width,
          sharpening.amounts.data(), static_cast<int>(sharpening.amounts.size()) - 1,
          sharpening.most_shift,     plane->data() + first};
      if (pool.isa() == Isa::scalar) {
        sharpen_row_scalar(row);
      } else {
        SOFTFOCUS_KERNEL(pool.isa(), sharpen_row)(row);
      }
    });
  }
}

WarpSharpening warp_sharpening(std::span<const glm::vec2> shifts) {
  constexpr int kAmounts = 16 * 16;  // beyond 16 pixels all parts are as likely
  WarpSharpening sharpening;
  for (int step = 0; step < kAmounts; ++step) {
    const double radius = (step + 0.5) / double{kAmountsAPx};
    double variance = 0.0;
    for (const glm::vec2 shift : shifts) {
      for (const float along : {shift.x, shift.y}) {
        const double moved = std::fabs(radius * double{along});
        const double part = moved - std::floor(moved);
        variance += part * (1.0 - part);
      }
      sharpening.most_shift =
          std::max({sharpening.most_shift, std::fabs(shift.x), std::fabs(shift.y)});
    }
    sharpening.amounts.push_back(
        static_cast<float>(variance / (4.0 * static_cast<double>(shifts.size()))));
  }
  return sharpening;
}

}  // namespace softfocus

#else  // kernels

namespace {

// radius_at() of what coc_radius_px() gives.
SOFTFOCUS_INLINE Floats cut_radius(Floats radius) {
  const Floats cut = select(radius < kMostWarpRadiusPx, radius, splat(kMostWarpRadiusPx));
  return select(radius > -kMostWarpRadiusPx, cut, splat(-kMostWarpRadiusPx));
}

// 0 to another surface, -1 to 1.
SOFTFOCUS_INLINE Floats difference_to(const SharpenedRow& row, int i, int next, Floats own,
                                      Floats radii) {
  const Floats difference = own - load(row.from + i + next);
  const Floats cut =
      select(difference < -1.0f, splat(-1.0f), select(difference > 1.0f, splat(1.0f), difference));
  const Floats away = absolute(load(row.radii + i + next) - radii);
  const Mask same = away * row.most_shift <= kSameSurfacePx;
  return select(same, cut, splat(0.0f));
}

}  // namespace

/// Returns how many pixels are done.
int read_source(const PixelCoc& coc, const std::uint16_t* texels, int count, float* red,
                float* green, float* blue, float* radii) {
  int done = 0;
  for (; done + kLanes <= count; done += kLanes) {
    const HalfTexels of = load_half_texels(texels + 4 * done);
    store(red + done, half_to_float(of.r));
    store(green + done, half_to_float(of.g));
    store(blue + done, half_to_float(of.b));
    const Floats depth = half_to_float(of.a);
    store(radii + done, cut_radius(coc.radius_at_infinity_px * (depth - coc.focus_m) / depth));
  }
  return done;
}

void sharpen_row(const SharpenedRow& row) {
  for (int i = 0; i < row.count; i += kLanes) {
    const Floats own = load(row.from + i), radii = load(row.radii + i);
    const Ints steps =
        smaller(truncate(absolute(radii) * kAmountsAPx), splat(std::int32_t{row.last_amount}));
    const Mask there = first_lanes(row.count - i);
    const Floats amounts = gather(row.amounts, steps, there);
    Floats sum = splat(0.0f);
    sum = sum + difference_to(row, i, -1, own, radii);
    sum = sum + difference_to(row, i, 1, own, radii);
    sum = sum + difference_to(row, i, -row.stride, own, radii);
    sum = sum + difference_to(row, i, row.stride, own, radii);
    const Floats sharpened = own + amounts * sum;
    store(row.to + i, select(there, sharpened, load(row.to + i)));
  }
}

#endif
