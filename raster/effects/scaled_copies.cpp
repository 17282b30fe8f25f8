#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include "raster/effects/scaled_copies.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "raster/images/texel.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/passes/row_sums.h"
#include "raster/threads/loops.h"

namespace softfocus {

/// A channel of a copy along a row, and of the source the two rows that it lies between.
struct CopyRow {
  const float* above;
  const float* below;  ///< both with a column of nothing before them
  const std::int32_t* firsts;
  const float* shares;
  const float* fades;
  float row_share, row_fade, colour;
  int begin, end;  ///< columns in which it can be seen
  float* sums;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "raster/effects/scaled_copies.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

/// The place in the source of a column or row of a copy's pixels, along one axis.
struct CopiedPlace {
  int first;    ///< of two pixels, from -1 to the size less 1
  float share;  ///< of the second
  float fade;   ///< 0 where nothing is seen
};

CopiedPlace place_of(int pixel, float scale, float anchor, float fade, int size) {
  const float middle = static_cast<float>(pixel) + 0.5f;
  const float at = anchor + scale * (middle - anchor);
  const float edge = std::min(at, static_cast<float>(size) - at) * fade;
  const float place = at - 0.5f;
  const float whole = std::floor(place);
  const float kept = std::min(std::max(edge, 0.0f), 1.0f);
  if (!(kept > 0.0f) || whole < -1.0f || whole >= static_cast<float>(size)) return {-1, 0.0f, 0.0f};
  return {static_cast<int>(whole), place - whole, kept};
}

/// The columns of all copies' channels, one after the other, each up to whole vectors.
struct Columns {
  std::size_t stride;
  std::vector<std::int32_t> firsts;
  std::vector<float> shares, fades;
  std::vector<std::array<int, 2>> seen;  ///< the first column in which light is seen, and the end
};

Columns columns_of(const CopiesPass& pass, int width) {
  Columns columns{static_cast<std::size_t>(width + kMostLanes), {}, {}, {}, {}};
  const std::size_t length = 3 * pass.copies.size() * columns.stride;
  columns.firsts.assign(length, -1);
  columns.shares.assign(length, 0.0f);
  columns.fades.assign(length, 0.0f);
  std::size_t start = 0;
  for (const ScaledCopy& copy : pass.copies) {
    for (int channel = 0; channel < 3; ++channel, start += columns.stride) {
      std::array<int, 2> seen{width, 0};
      for (int x = 0; x < width; ++x) {
        const CopiedPlace place =
            place_of(x, copy.scale[channel], pass.anchor.x, pass.fade.x, width);
        const std::size_t at = start + static_cast<std::size_t>(x);
        columns.firsts[at] = place.first;
        columns.shares[at] = place.share;
        columns.fades[at] = place.fade;
        if (place.fade > 0.0f) seen = {std::min(seen[0], x), x + 1};
      }
      columns.seen.push_back(seen);
    }
  }
  return columns;
}

/// A channel of the source as floats, with a border of nothing.
class Channel {
 public:
  Channel(const ConstImageView& source, int channel)
      : stride_(static_cast<std::size_t>(source.width) + 2),
        values_(stride_ * (static_cast<std::size_t>(source.height) + 2)),
        is_dark_(static_cast<std::size_t>(source.height) + 2, true) {
    for (int y = 0; y < source.height; ++y) {
      const std::uint16_t* const from = row<std::uint16_t>(source, y).data() + channel;
      const std::size_t line = static_cast<std::size_t>(y) + 1;
      float* const to = &values_[line * stride_ + 1];
      std::uint16_t any = 0;
      for (int x = 0; x < source.width; ++x) any |= from[4 * x];
      if (any == 0) continue;
      is_dark_[line] = false;
      for (int x = 0; x < source.width; ++x) to[x] = half_to_float(from[4 * x]);
    }
  }

  /// From -1 on.
  const float* row_at(int y) const { return &values_[static_cast<std::size_t>(y + 1) * stride_]; }
  bool is_dark(int y) const { return is_dark_[static_cast<std::size_t>(y + 1)]; }

 private:
  std::size_t stride_;
  std::vector<float> values_;
  std::vector<bool> is_dark_;
};

bool fit(const ConstImageView& source, const ConstImageView& own, const ImageView& result) {
  return source.width == result.width && source.height == result.height &&
         own.width == result.width && own.height == result.height;
}

/// Red, green and blue of a row.
struct SumRows {
  std::vector<float> sums;
};

}  // namespace

void scaled_copies(const CopiesPass& pass, const ConstImageView& source, const ConstImageView& own,
                   const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(fit(source, own, result));
  const int width = result.width, height = result.height;
  const Columns columns = columns_of(pass, width);
  const std::array channels{Channel{source, 0}, Channel{source, 1}, Channel{source, 2}};
  const auto add_row = [&](int y, std::size_t copy, int channel, float* sums) {
    const Channel& light = channels[static_cast<std::size_t>(channel)];
    const ScaledCopy& what = pass.copies[copy];
    const CopiedPlace line = place_of(y, what.scale[channel], pass.anchor.y, pass.fade.y, height);
    if (!(line.fade > 0.0f) || (light.is_dark(line.first) && light.is_dark(line.first + 1))) return;
    const std::size_t table = 3 * copy + static_cast<std::size_t>(channel);
    const auto [begin, end] = columns.seen[table];
    const std::size_t start = table * columns.stride;
    SOFTFOCUS_KERNEL(pool.isa(), add_copy_row)
    ({light.row_at(line.first), light.row_at(line.first + 1), &columns.firsts[start],
      &columns.shares[start], &columns.fades[start], line.share, line.fade, what.colour[channel],
      begin, end, sums});
  };
  for_each_row_with<SumRows>(pool, height, kPassRows, [&](int y, auto& rows) {
    const std::size_t stride = columns.stride;
    rows.sums.resize(3 * stride);
    const std::uint16_t* const from = row<std::uint16_t>(own, y).data();
    for (int channel = 0; channel < 3; ++channel) {
      float* const sums = &rows.sums[static_cast<std::size_t>(channel) * stride];
      // A copy adds 0 where it is not seen, which makes 0 of -0.
      const float nothing = pass.copies.empty() ? -0.0f : 0.0f;
      for (int x = 0; x < width; ++x) sums[x] = half_to_float(from[4 * x + channel]) + nothing;
      for (std::size_t k = 0; k < pass.copies.size(); ++k) add_row(y, k, channel, sums);
    }
    const float* const sums = rows.sums.data();
    for (int x = 0; x < width; ++x) {
      store_texel<Format::rgba16f>(
          result, x, y,
          {sums[x], sums[stride + static_cast<std::size_t>(x)],
           sums[2 * stride + static_cast<std::size_t>(x)], half_to_float(from[4 * x + 3])},
          profile);
    }
  });
}

}  // namespace softfocus

#else  // the kernel

void add_copy_row(const CopyRow& copy) {
  const Mask all = splat(0) == 0;
  for (int x = copy.begin; x < copy.end; x += kLanes) {
    const Ints first = load(copy.firsts + x) + 1, second = first + 1;
    const Floats share = load(copy.shares + x);
    const Floats a = gather(copy.above, first, all), b = gather(copy.above, second, all);
    const Floats c = gather(copy.below, first, all), d = gather(copy.below, second, all);
    const Floats above = a + share * (b - a);
    const Floats below = c + share * (d - c);
    const Floats light = above + copy.row_share * (below - above);
    const Floats kept = load(copy.fades + x) * copy.row_fade;
    store(copy.sums + x, load(copy.sums + x) + copy.colour * kept * light);
  }
}

#endif
