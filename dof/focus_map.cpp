#ifndef SOFTFOCUS_ISA

#include "dof/focus_map.h"

#include <algorithm>
#include <cstdint>

#include "dof/weights.h"
#include "raster/images/texel.h"
#include "raster/numbers/half.h"

#define SOFTFOCUS_KERNELS "dof/focus_map.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// On either side of the focus plane the radius grows with the distance from it, so the nearest
// or the farthest depth has the largest one. The radius has three roundings, at that depth and
// at a depth between: together at most 2^-21 of it.
constexpr float kFocusMapRounding = 1.0f + 0x1p-20f;

// A bound for depths from `least` to `most`, halves compared as integers. Those past infinity
// are NaN or negative. Zero and infinity are blurred to the largest.
float radius_bound(const DofSettings& settings, std::uint32_t least, std::uint32_t most) {
  if (most > kHalfInfinity) return settings.max_coc_px;
  const auto radius = [&](std::uint32_t depth) {
    return filter_radius(settings, half_to_float(static_cast<std::uint16_t>(depth)));
  };
  return std::min(std::max(radius(least), radius(most)) * kFocusMapRounding, settings.max_coc_px);
}

// The ranges that widen_depths() widens, empty at first.
struct DepthRanges {
  std::size_t lanes;
  std::vector<std::uint32_t> values;

  DepthRanges(Isa isa, int cells)
      : lanes(static_cast<std::size_t>(SOFTFOCUS_KERNEL(isa, kLanes))),
        values(2 * lanes * static_cast<std::size_t>(cells), 0) {
    for (std::size_t i = 0; i < values.size(); i += 2 * lanes) {
      std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(i), lanes, 0xFFFFu);
    }
  }
};

void map_band(const DofInput& input, Isa isa, int band, float* bounds, int cells) {
  const ConstImageView& scene = input.scene;
  DepthRanges ranges(isa, cells);
  const int end = std::min((band + 1) * kCellHeight, scene.height);
  for (int y = band * kCellHeight; y < end; ++y) {
    SOFTFOCUS_KERNEL(isa, widen_depths)
    (row<std::uint16_t>(scene, y).data(), scene.width, ranges.values.data());
  }
  const std::uint32_t* values = ranges.values.data();
  for (int i = 0; i < cells; ++i, values += 2 * ranges.lanes) {
    bounds[i] = radius_bound(input.settings, *std::min_element(values, values + ranges.lanes),
                             *std::max_element(values + ranges.lanes, values + 2 * ranges.lanes));
  }
}

void pass_band(const DofInput& input, const ImageView& result, Isa isa, int band,
               const float* bounds, int cells) {
  const int end = std::min((band + 1) * kCellHeight, result.height);
  for (int y = band * kCellHeight; y < end; ++y) {
    const std::uint16_t* from = row<std::uint16_t>(input.scene, y).data();
    std::uint16_t* to = row<std::uint16_t>(result, y).data();
    for (int i = 0; i < cells; ++i) {
      const int first = i;
      while (i < cells && bounds[i] <= 1.0f) ++i;
      if (i == first) continue;
      const int x = first * kCellWidth;
      const int count = std::min(i * kCellWidth, result.width) - x;
      SOFTFOCUS_KERNEL(isa, pass_pixels)
      (from + 4 * x, to + 4 * x, count, input.profile.half_store, write_past_caches(result));
    }
  }
}

}  // namespace

bool write_past_caches(const ConstImageView& result) {
  constexpr std::size_t kCached = std::size_t{16} << 20;
  // Such stores write whole cache lines.
  const bool aligned =
      reinterpret_cast<std::uintptr_t>(result.texels) % 64 == 0 && result.stride_bytes % 64 == 0;
  const std::size_t row_bytes =
      static_cast<std::size_t>(result.width) * bytes_per_texel(result.format);
  return aligned && row_bytes * static_cast<std::size_t>(result.height) > kCached;
}

float largest_filter_radius(const DofInput& input, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  std::vector<float> of_row(static_cast<std::size_t>(scene.height), 0.0f);
  pool.for_each(scene.height, [&](int y) {
    float largest = 0.0f;
    const auto halves = row<std::uint16_t>(scene, y);
    for (std::size_t i = 3; i < halves.size(); i += 4) {
      largest = std::max(largest, filter_radius(input.settings, half_to_float(halves[i])));
    }
    of_row[static_cast<std::size_t>(y)] = largest;
  });
  return *std::max_element(of_row.begin(), of_row.end());
}

FocusMap pass_in_focus(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  FocusMap map;
  map.columns = (scene.width + kCellWidth - 1) / kCellWidth;
  map.rows = (scene.height + kCellHeight - 1) / kCellHeight;
  map.largest_px.resize(static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows));
  pool.for_each(map.rows, [&](int band) {
    float* bounds = &map.largest_px[static_cast<std::size_t>(band * map.columns)];
    map_band(input, pool.isa(), band, bounds, map.columns);
    pass_band(input, result, pool.isa(), band, bounds, map.columns);
  });
  return map;
}

}  // namespace softfocus

#else  // Rows of pixels, once a vector unit.

/// Widens each cell's range of depths by another row. Depths are halves, compared as integers;
/// a range is a vector of least and a vector of largest depths.
void widen_depths(const std::uint16_t* row, int width, std::uint32_t* ranges) {
  for (int x = 0; x < width; x += kCellWidth, ranges += 2 * kLanes) {
    const int end = x + kCellWidth < width ? x + kCellWidth : width;
    Bits least = load(ranges), most = load(ranges + kLanes);
    int at = x;
    for (; at + kLanes <= end; at += kLanes) {
      const Bits depth = load_half_texels(row + 4 * at).a;
      least = select(depth < least, depth, least);
      most = select(depth > most, depth, most);
    }
    for (; at < end; ++at) {
      const Bits depth = splat(std::uint32_t{row[4 * at + 3]});
      least = select(depth < least, depth, least);
      most = select(depth > most, depth, most);
    }
    store(ranges, least);
    store(ranges + kLanes, most);
  }
}

namespace {

#include "dof/weights.inl"

/// The colour of a pixel that gathers only itself: it is cut to what a half holds.
SOFTFOCUS_INLINE Bits passed_colour(Bits half) {
  const Bits cut = half - select((half & 0x7FFFu) == kHalfInfinity, splat(1u), splat(0u));
  return stored_depth(cut, HalfRounding::nearest_even);
}

SOFTFOCUS_INLINE void pass_vector(const std::uint16_t* from, std::uint16_t* to,
                                  HalfRounding rounding) {
  const HalfTexels texels = load_half_texels(from);
  store_half_texels(to, {passed_colour(texels.r), passed_colour(texels.g), passed_colour(texels.b),
                         stored_depth(texels.a, rounding)});
}

}  // namespace

/// Writes pixels that gather only themselves.
void pass_pixels(const std::uint16_t* from, std::uint16_t* to, int count, HalfRounding rounding,
                 bool past_caches) {
  int at = 0;
  for (; at + kLanes <= count; at += kLanes, from += 4 * kLanes, to += 4 * kLanes) {
    // Only infinities and NaN are changed, and they are rare.
    TexelWords words;
    std::memcpy(&words.first, from, sizeof words.first);
    std::memcpy(&words.second, from + 2 * kLanes, sizeof words.second);
    const Bits first = words.first, second = words.second;
    const Mask special = ((first & 0x7C00u) == 0x7C00u) | ((first & 0x7C000000u) == 0x7C000000u) |
                         ((second & 0x7C00u) == 0x7C00u) | ((second & 0x7C000000u) == 0x7C000000u);
    if (any(special)) {
      pass_vector(from, to, rounding);
    } else if (past_caches) {
      stream_texel_words(to, words);
    } else {
      store_texel_words(to, words);
    }
  }
  if (at < count) {
    const std::size_t bytes = 4 * sizeof *from * static_cast<std::size_t>(count - at);
    std::uint16_t last[4 * kLanes] = {}, passed[4 * kLanes];
    std::memcpy(last, from, bytes);
    pass_vector(last, passed, rounding);
    std::memcpy(to, passed, bytes);
  }
  if (past_caches) finish_streaming();
}

#endif
