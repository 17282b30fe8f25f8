#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/ray_distribution/sheet.h"

#include <algorithm>
#include <cmath>

#define SOFTFOCUS_KERNELS "dof/ray_distribution/sheet.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// Row `y` of the sheet: a row of the picture, its border repeated, and nothing around it.
void fill_row(const Planes& planes, int y, Sheet& sheet) {
  const int width = planes.width, before = sheet.before;
  const bool outside = y < 0 || y >= planes.height + 2 * before;
  for (int c = 0; c < 4; ++c) {
    float* to = plane_row(sheet.pixels, c, y + 1);
    float* end = to + sheet.pixels.stride;
    const float nothing = c == 3 ? kNothingBehind : 0.0f;
    if (outside) {
      std::fill(to, end, nothing);
      continue;
    }
    const float* from = plane_row(planes, c, std::clamp(y - before, 0, planes.height - 1));
    to = std::fill_n(to, kMostLanes, nothing);
    to = std::fill_n(to, before, from[0]);
    to = std::copy_n(from, width, to);
    to = std::fill_n(to, before, from[width - 1]);
    std::fill(to, end, nothing);
  }
}

// The scalar form of measure_row().
void measure_row_scalar(const float* radius, std::ptrdiff_t stride, int tiles, float* least,
                        float* most, char* whole) {
  for (int x = 0; x < tiles * kReachTile; ++x) {
    const int tile = x / kReachTile;
    const float own = radius[x];
    if (own == kNothingBehind) {
      whole[tile] = 0;
      continue;
    }
    float& low = least[tile * kReachTile];
    float& high = most[tile * kReachTile];
    low = std::min(low, own);
    high = std::max(high, own);
    for (const float other :
         {radius[x - 1], radius[x + 1], radius[x - stride], radius[x + stride]}) {
      if (!(std::fabs(other - own) <= kSurfaceStep)) continue;
      low = std::min(low, other);
      high = std::max(high, other);
    }
  }
}

void measure_tiles(Sheet& sheet, int tile_y, Isa isa) {
  const int first = tile_y * sheet.tiles_across;
  float* least = &sheet.row_least[static_cast<std::size_t>(first * kReachTile)];
  float* most = &sheet.row_most[static_cast<std::size_t>(first * kReachTile)];
  char* whole = &sheet.whole[static_cast<std::size_t>(first)];
  for (int y = 0; y < kReachTile; ++y) {
    const float* radius = sheet.row(3, tile_y * kReachTile + y);
    if (isa == Isa::scalar) {
      measure_row_scalar(radius, sheet.pixels.stride, sheet.tiles_across, least + y, most + y,
                         whole);
    } else {
      SOFTFOCUS_KERNEL(isa, measure_row)
      (radius, sheet.pixels.stride, sheet.tiles_across, least + y, most + y, whole);
    }
  }
  for (int x = 0; x < sheet.tiles_across; ++x) {
    const auto tile = static_cast<std::size_t>(first + x);
    sheet.least[tile] = *std::min_element(least + x * kReachTile, least + (x + 1) * kReachTile);
    sheet.most[tile] = *std::max_element(most + x * kReachTile, most + (x + 1) * kReachTile);
  }
}

int tiles_for(int pixels) { return (pixels + kReachTile - 1) / kReachTile; }

}  // namespace

Sheet make_sheet(const Planes& planes, int before, ThreadPool& pool) {
  Sheet sheet;
  sheet.before = before;
  sheet.tiles_across = tiles_for(planes.width + 2 * before);
  sheet.tiles_down = tiles_for(planes.height + 2 * before);
  sheet.pixels = make_planes(4, sheet.tiles_across * kReachTile + 2 * kMostLanes,
                             sheet.tiles_down * kReachTile + 2, pool);
  const auto tiles = static_cast<std::size_t>(sheet.tiles_across * sheet.tiles_down);
  sheet.row_least.assign(tiles * kReachTile, kNothingBehind);
  sheet.row_most.assign(tiles * kReachTile, -kNothingBehind);
  sheet.least.resize(tiles);
  sheet.most.resize(tiles);
  sheet.whole.assign(tiles, 1);
  pool.for_each(sheet.tiles_down, [&](int tile_y) {
    const int first = tile_y * kReachTile;
    for (int y = first; y < first + kReachTile; ++y) fill_row(planes, y, sheet);
    if (tile_y == 0) fill_row(planes, -1, sheet);
    if (tile_y == sheet.tiles_down - 1) fill_row(planes, first + kReachTile, sheet);
  });
  pool.for_each(sheet.tiles_down, [&](int tile_y) { measure_tiles(sheet, tile_y, pool.isa()); });
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    if (sheet.least[tile] > sheet.most[tile]) continue;
    const float farthest = std::max(std::fabs(sheet.least[tile]), std::fabs(sheet.most[tile]));
    sheet.reach = std::max(sheet.reach, static_cast<int>(farthest) + 1);
  }
  return sheet;
}

}  // namespace softfocus

#else  // kernels

namespace {

template <int step, std::size_t... lane>
SOFTFOCUS_INLINE Floats exchange(Floats v, std::index_sequence<lane...>) {
  return __builtin_shufflevector(v, v, (lane ^ step)...);
}
template <int step>
SOFTFOCUS_INLINE Floats exchange(Floats v) {
  return exchange<step>(v, std::make_index_sequence<kLanes>{});
}
SOFTFOCUS_INLINE float smallest_lane(Floats v) {
  if constexpr (kLanes > 8) v = smaller(v, exchange<kLanes / 2>(v));
  if constexpr (kLanes > 4) v = smaller(v, exchange<4>(v));
  v = smaller(v, exchange<2>(v));
  return smaller(v, exchange<1>(v))[0];
}

struct Range {
  Floats least, most;
};
SOFTFOCUS_INLINE void widen(Range& range, Floats own, const float* neighbour) {
  const Floats radius = load(neighbour);
  const Floats other = select(absolute(radius - own) <= kSurfaceStep, radius, own);
  range.least = smaller(range.least, other);
  range.most = larger(range.most, other);
}

}  // namespace

/// The ranges of one row of pixels in each tile, kReachTile floats apart, and whether it is
/// whole.
void measure_row(const float* radius, std::ptrdiff_t stride, int tiles, float* least, float* most,
                 char* whole) {
  for (int tile = 0; tile < tiles; ++tile) {
    Range row{splat(kNothingBehind), splat(-kNothingBehind)};
    Mask empty{};
    for (int i = 0; i < kReachTile; i += kLanes) {
      const float* at = radius + tile * kReachTile + i;
      const Floats own = load(at);
      Range range{own, own};
      widen(range, own, at - 1);
      widen(range, own, at + 1);
      widen(range, own, at - stride);
      widen(range, own, at + stride);
      const Mask nothing = own >= kNothingBehind;
      empty |= nothing;
      row.least = smaller(row.least, range.least);
      row.most = larger(row.most, select(nothing, splat(-kNothingBehind), range.most));
    }
    least[tile * kReachTile] = smallest_lane(row.least);
    most[tile * kReachTile] = -smallest_lane(-row.most);
    if (any(empty)) whole[tile] = 0;
  }
}

#endif
