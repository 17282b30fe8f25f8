#include "dof/focus_map.h"

#include <algorithm>
#include <cstdint>

#include "dof/weights.h"
#include "raster/numbers/half.h"

#define SOFTFOCUS_KERNELS "dof/focus_kernels.inl"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// With one sign, the radius grows with the distance from the focus plane, so it is
// largest at the nearest or the farthest depth. Its three roundings, here and at the
// pixel between them, make at most 2^-21 of it.
constexpr float kRounding = 1.0f + 0x1p-20f;

// Of depths from `least` to `most`, halves compared as integers: those past infinity are
// NaN or negative. Zero and infinity are blurred to the largest.
float radius_bound(const DofSettings& settings, std::uint32_t least, std::uint32_t most) {
  if (most > kHalfInfinity) return settings.max_coc_px;
  const auto radius = [&](std::uint32_t depth) {
    return filter_radius(settings, half_to_float(static_cast<std::uint16_t>(depth)));
  };
  return std::min(std::max(radius(least), radius(most)) * kRounding, settings.max_coc_px);
}

// The vectors of ranges that the kernel widens.
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
      (from + 4 * x, to + 4 * x, count, write_past_caches(result));
    }
  }
}

}  // namespace

bool write_past_caches(const ConstImageView& result) {
  constexpr std::size_t kCached = std::size_t{16} << 20;
  // Such stores take whole lines of a cache.
  const bool aligned =
      reinterpret_cast<std::uintptr_t>(result.texels) % 64 == 0 && result.stride_bytes % 64 == 0;
  const std::size_t row_bytes =
      static_cast<std::size_t>(result.width) * bytes_per_texel(result.format);
  return aligned && row_bytes * static_cast<std::size_t>(result.height) > kCached;
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
