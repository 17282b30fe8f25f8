#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "scenes/warped_views/warp_source.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/images/texel.h"

namespace softfocus {

// Red, green, blue and radii of a row, at its first pixel.
struct SourceRow {
  std::array<float*, 4> planes;
};

// A row and its neighbours above and below, with borders.
struct SharpenedRow {
  SourceRow above, own, below;
  int count;
  const float* amounts;  // none: colours stay as they are
  int last_amount;
  float most_shift;
  SourceRow to;
};

constexpr std::size_t kRadiusPlane = 3;
constexpr float kMostSourceColour = 65504.0f;

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/warped_views/warp_source.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

float radius_at(const PixelCoc& coc, float depth_m) {
  const float radius = coc_radius_px(coc, depth_m);
  if (!(radius > -kMostWarpRadiusPx)) return -kMostWarpRadiusPx;
  if (!(std::fabs(radius) >= kLeastWarpRadiusPx)) return kLeastWarpRadiusPx;
  return radius_of(std::min(radius, kMostWarpRadiusPx));
}

float cut_colour(float colour) {
  const float cut = colour < kMostSourceColour ? colour : kMostSourceColour;
  return cut > -kMostSourceColour ? cut : -kMostSourceColour;
}

void sharpen_row_scalar(const SharpenedRow& row) {
  const float *const above = row.above.planes[kRadiusPlane],
                     *const own = row.own.planes[kRadiusPlane],
                     *const below = row.below.planes[kRadiusPlane];
  for (int x = 0; x < row.count; ++x) {
    const float radius = own[x];
    const auto is_same = [&](float other) {
      return std::fabs(other - radius) * row.most_shift <= kSameSurfacePx;
    };
    bool smooth = true;
    for (int next = x - 1; next <= x + 1; ++next) {
      smooth = smooth && is_same(above[next]) && is_same(own[next]) && is_same(below[next]);
    }
    row.to.planes[kRadiusPlane][x] = noted_radius(radius, smooth ? kSmoothNote : 0);
    for (std::size_t plane = 0; plane < kRadiusPlane; ++plane) {
      const float* const colours = row.own.planes[plane];
      float& to = row.to.planes[plane][x];
      to = colours[x];
      if (row.amounts == nullptr) continue;
      const auto difference_to = [&](float other, float other_radius) {
        return is_same(other_radius) ? std::clamp(colours[x] - other, -1.0f, 1.0f) : 0.0f;
      };
      float sum = difference_to(colours[x - 1], own[x - 1]);
      sum += difference_to(colours[x + 1], own[x + 1]);
      sum += difference_to(row.above.planes[plane][x], above[x]);
      sum += difference_to(row.below.planes[plane][x], below[x]);
      const int step = std::min(static_cast<int>(std::fabs(radius) * kAmountsAPx), row.last_amount);
      to = cut_colour(colours[x] + row.amounts[step] * sum);
    }
  }
}

void repeat_border(const SourceRow& row, int width) {
  for (float* const pixels : row.planes) {
    std::fill(pixels - kSourceBorder, pixels, pixels[0]);
    std::fill(pixels + width, pixels + width + kSourceBorder, pixels[width - 1]);
  }
}

void read_row(const Image& picture, const PixelCoc& coc, int y, const SourceRow& to, Isa isa) {
  const std::uint16_t* const texels = row<std::uint16_t>(picture, y).data();
  int x = 0;
  if (isa != Isa::scalar) {
    x = SOFTFOCUS_KERNEL(isa, read_source)(coc, texels, picture.width, to);
  }
  for (; x < picture.width; ++x) {
    for (std::size_t plane = 0; plane < kRadiusPlane; ++plane) {
      to.planes[plane][x] = half_to_float(texels[4 * x + static_cast<int>(plane)]);
    }
    to.planes[kRadiusPlane][x] = radius_at(coc, half_to_float(texels[4 * x + 3]));
  }
  repeat_border(to, picture.width);
}

SourceRow row_of(WarpSource& source, int y) {
  const std::size_t first = plane_at(source, 0, y);
  return {{source.red.data() + first, source.green.data() + first, source.blue.data() + first,
           source.radii.data() + first}};
}

// Widens the range of each column by a row. ranges[0] is the column left of the first pixel.
void widen_ranges(std::vector<RadiusRange>& ranges, const float* radii) {
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const float radius = radii[static_cast<std::ptrdiff_t>(i) - 1];
    ranges[i] = {std::min(ranges[i].low, radius), std::max(ranges[i].high, radius)};
  }
}

RadiusRange range_of(const RadiusRange* begin, const RadiusRange* end) {
  RadiusRange range = *begin;
  for (; begin != end; ++begin) {
    range = {std::min(range.low, begin->low), std::max(range.high, begin->high)};
  }
  return range;
}

// The rows of three, in turn, that a band of a picture is read into.
struct ReadRows {
  explicit ReadRows(int width)
      : stride(width + 2 * kSourceBorder), memory(static_cast<std::size_t>(3 * 4 * stride)) {}
  int stride;
  std::vector<float> memory;

  SourceRow at(int y) {
    SourceRow rows{};
    for (int plane = 0; plane < 4; ++plane) {
      rows.planes[static_cast<std::size_t>(plane)] =
          memory.data() + ((y + 3) % 3 * 4 + plane) * stride + kSourceBorder;
    }
    return rows;
  }
};

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
  source.blocks.resize(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  pool.for_each(down, [&](int block_y) {
    const int begin = block_y * kWarpBlock, end = std::min(begin + kWarpBlock, source.height);
    ReadRows rows{source.width};
    std::vector<RadiusRange> ranges(static_cast<std::size_t>(source.width) + 1,
                                    {kMostWarpRadiusPx, -kMostWarpRadiusPx});
    const auto read = [&](int y) {
      const int there = std::clamp(y, 0, source.height - 1);
      read_row(picture, coc, there, rows.at(y), pool.isa());
      if (y < end) widen_ranges(ranges, rows.at(y).planes[kRadiusPlane]);
    };
    read(begin - 1);
    read(begin);
    for (int y = begin; y < end; ++y) {
      read(y + 1);
      const SharpenedRow row{rows.at(y - 1),
                             rows.at(y),
                             rows.at(y + 1),
                             source.width,
                             sharpening.amounts.empty() ? nullptr : sharpening.amounts.data(),
                             static_cast<int>(sharpening.amounts.size()) - 1,
                             sharpening.most_shift,
                             row_of(source, y)};
      if (pool.isa() == Isa::scalar) {
        sharpen_row_scalar(row);
      } else {
        SOFTFOCUS_KERNEL(pool.isa(), sharpen_row)(row);
      }
      repeat_border(row.to, source.width);
    }
    for (int block_x = 0; block_x < across; ++block_x) {
      const int x = block_x * kWarpBlock, x_end = std::min(x + kWarpBlock, source.width);
      source.blocks[static_cast<std::size_t>(block_y * across + block_x)] =
          range_of(ranges.data() + x, ranges.data() + x_end + 1);
    }
  });
  source.all = range_of(source.blocks.data(), source.blocks.data() + source.blocks.size());
  for (std::vector<float>* plane : planes) {
    std::copy_n(plane->data() + stride, stride, plane->data());
    std::copy_n(plane->data() + size - 2 * stride, stride, plane->data() + size - stride);
  }
}

WarpSharpening warp_sharpening(std::span<const glm::vec2> shifts) {
  constexpr int kAmounts = 16 * 16;  // beyond 16 pixels all parts are as likely
  WarpSharpening sharpening{{}, 0.0f};
  sharpening.amounts.reserve(kAmounts);
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
  const Floats cut =
      as_floats(as_bits(select(radius < kMostWarpRadiusPx, radius, splat(kMostWarpRadiusPx))) &
                ~kRadiusNotes);
  const Floats some =
      select(absolute(radius) >= kLeastWarpRadiusPx, cut, splat(kLeastWarpRadiusPx));
  return select(radius > -kMostWarpRadiusPx, some, splat(-kMostWarpRadiusPx));
}

SOFTFOCUS_INLINE Floats cut_colours(Floats colour) {
  const Floats cut = select(colour < kMostSourceColour, colour, splat(kMostSourceColour));
  return select(cut > -kMostSourceColour, cut, splat(-kMostSourceColour));
}

SOFTFOCUS_INLINE Mask is_same(const float* radii, Floats own, float most_shift) {
  return absolute(load(radii) - own) * most_shift <= kSameSurfacePx;
}

// 0 to another surface, -1 to 1.
SOFTFOCUS_INLINE Floats difference_to(const float* others, Floats own, Mask same) {
  const Floats difference = own - load(others);
  const Floats cut =
      select(difference < -1.0f, splat(-1.0f), select(difference > 1.0f, splat(1.0f), difference));
  return select(same, cut, splat(0.0f));
}

}  // namespace

/// Returns how many pixels are done.
int read_source(const PixelCoc& coc, const std::uint16_t* texels, int count, const SourceRow& to) {
  int done = 0;
  for (; done + kLanes <= count; done += kLanes) {
    const HalfTexels of = load_half_texels(texels + 4 * done);
    store(to.planes[0] + done, half_to_float(of.r));
    store(to.planes[1] + done, half_to_float(of.g));
    store(to.planes[2] + done, half_to_float(of.b));
    const Floats depth = half_to_float(of.a);
    store(to.planes[kRadiusPlane] + done,
          cut_radius(coc.radius_at_infinity_px * (depth - coc.focus_m) / depth));
  }
  return done;
}

/// Writes up to kLanes - 1 pixels past the last one.
void sharpen_row(const SharpenedRow& row) {
  const float *const above = row.above.planes[kRadiusPlane],
                     *const own = row.own.planes[kRadiusPlane],
                     *const below = row.below.planes[kRadiusPlane];
  for (int i = 0; i < row.count; i += kLanes) {
    const Floats radii = load(own + i);
    const Mask left = is_same(own + i - 1, radii, row.most_shift),
               right = is_same(own + i + 1, radii, row.most_shift),
               up = is_same(above + i, radii, row.most_shift),
               down = is_same(below + i, radii, row.most_shift);
    const Mask smooth = left & right & up & down & is_same(above + i - 1, radii, row.most_shift) &
                        is_same(above + i + 1, radii, row.most_shift) &
                        is_same(below + i - 1, radii, row.most_shift) &
                        is_same(below + i + 1, radii, row.most_shift);
    store(row.to.planes[kRadiusPlane] + i,
          as_floats(as_bits(radii) | (as_bits(smooth) & kSmoothNote)));
    if (row.amounts == nullptr) {
      for (std::size_t plane = 0; plane < kRadiusPlane; ++plane) {
        store(row.to.planes[plane] + i, load(row.own.planes[plane] + i));
      }
      continue;
    }
    const Ints steps =
        smaller(truncate(absolute(radii) * kAmountsAPx), splat(std::int32_t{row.last_amount}));
    const Floats amounts = gather(row.amounts, steps, first_lanes(row.count - i));
    for (std::size_t plane = 0; plane < kRadiusPlane; ++plane) {
      const float* const colours = row.own.planes[plane] + i;
      const Floats colour = load(colours);
      Floats sum = difference_to(colours - 1, colour, left);
      sum = sum + difference_to(colours + 1, colour, right);
      sum = sum + difference_to(row.above.planes[plane] + i, colour, up);
      sum = sum + difference_to(row.below.planes[plane] + i, colour, down);
      store(row.to.planes[plane] + i, cut_colours(colour + amounts * sum));
    }
  }
}

#endif
