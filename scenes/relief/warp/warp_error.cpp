#include "scenes/relief/warp/warp_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace softfocus {
namespace {

/// In texels, binary64.
struct WarpScales {
  PreWarp warp;
  double step_m;

  WarpedPlace at(double u, double v, int code) const {
    return exact_place(warp, u, v, code * step_m);
  }
};

WarpScales warp_scales(const ReliefTexture& relief, glm::dvec3 eye) {
  return {pre_warp(relief, eye), depth_step(relief)};
}

double distance_between(const WarpedPlace& a, const WarpedPlace& b) {
  return std::sqrt((a.u - b.u) * (a.u - b.u) + (a.v - b.v) * (a.v - b.v));
}

/// Calls `with(pair)` for each two neighbours, rows before columns at each texel.
template <class With>
void for_each_pair(const ReliefTexture& relief, const With& with) {
  const std::uint16_t empty = empty_depth(relief.depth_bits);
  const auto code_at = [&](int u, int v) {
    return relief.depths[static_cast<std::size_t>(v) * static_cast<std::size_t>(relief.width) +
                         static_cast<std::size_t>(u)];
  };
  for (int v = 0; v < relief.height; ++v) {
    for (int u = 0; u < relief.width; ++u) {
      const int code = code_at(u, v);
      if (code == empty) continue;
      if (u + 1 < relief.width && code_at(u + 1, v) != empty) {
        with(CriticalPoint{u, v, u + 1, v, code, code_at(u + 1, v)});
      }
      if (v + 1 < relief.height && code_at(u, v + 1) != empty) {
        with(CriticalPoint{u, v, u, v + 1, code, code_at(u, v + 1)});
      }
    }
  }
}

/// The first texel of a part: its share of the size, times `parts`, reaches `part`.
int part_begin(int begin, int end, int part, int parts) {
  return begin + ((end - begin) * part + parts - 1) / parts;
}

/// The pairs whose first texel is one of a row's from `begin` to before `end`.
void add_pairs(const ReliefTexture& relief, int v, int begin, int end,
               std::optional<CriticalRegion>& region) {
  const std::uint16_t empty = empty_depth(relief.depth_bits);
  const std::uint16_t* codes = relief.depths.data() + std::ptrdiff_t{v} * relief.width;
  const std::uint16_t* below = v + 1 < relief.height ? codes + relief.width : nullptr;
  int most = region ? std::abs(region->point.code1 - region->point.code2) : -1;
  int least = region ? region->least_code : empty, largest = region ? region->most_code : 0;
  const auto add = [&](int u, int u2, int v2, int code, int other) {
    least = std::min(least, std::min(code, other));
    largest = std::max(largest, std::max(code, other));
    const int step = std::abs(code - other);
    if (step <= most) return;
    most = step;
    region = CriticalRegion{{u, v, u2, v2, code, other}, least, largest};
  };
  for (int u = begin; u < end; ++u) {
    const int code = codes[u];
    if (code == empty) continue;
    if (u + 1 < relief.width && codes[u + 1] != empty) add(u, u + 1, v, code, codes[u + 1]);
    if (below != nullptr && below[u] != empty) add(u, u, v + 1, code, below[u]);
  }
  if (region) {
    region->least_code = least;
    region->most_code = largest;
  }
}

}  // namespace

std::optional<CriticalPoint> critical_point(const ReliefTexture& relief) {
  std::optional<CriticalPoint> critical;
  int most = -1;
  for_each_pair(relief, [&](const CriticalPoint& pair) {
    const int step = std::abs(pair.code1 - pair.code2);
    if (step <= most) return;
    most = step;
    critical = pair;
  });
  return critical;
}

double critical_error(const ReliefTexture& relief, const CriticalPoint& point, glm::dvec3 eye) {
  const WarpScales scales = warp_scales(relief, eye);
  return distance_between(scales.at(point.u1, point.v1, point.code1),
                          scales.at(point.u2, point.v2, point.code2));
}

CriticalRegions critical_regions(const ReliefTexture& relief, const ReliefExtent& extent,
                                 int columns, int rows, ThreadPool* pool) {
  assert(columns >= 1 && columns <= kMostRegions && rows >= 1 && rows <= kMostRegions);
  CriticalRegions cut{extent, columns, rows, {}};
  cut.regions.resize(static_cast<std::size_t>(columns * rows));
  const auto cut_row = [&](int row) {
    const int v_end = part_begin(extent.y_begin, extent.y_end, row + 1, rows);
    for (int v = part_begin(extent.y_begin, extent.y_end, row, rows); v < v_end; ++v) {
      for (int column = 0; column < columns; ++column) {
        add_pairs(relief, v, part_begin(extent.x_begin, extent.x_end, column, columns),
                  part_begin(extent.x_begin, extent.x_end, column + 1, columns),
                  cut.regions[static_cast<std::size_t>(row * columns + column)]);
      }
    }
  };
  if (pool != nullptr) {
    pool->for_each(rows, cut_row);
  } else {
    for (int row = 0; row < rows; ++row) cut_row(row);
  }
  return cut;
}

double mean_critical_error(const ReliefTexture& relief, const CriticalRegions& regions,
                           glm::dvec3 eye) {
  double sum = 0.0;
  int count = 0;
  for (const std::optional<CriticalRegion>& region : regions.regions) {
    if (!region) continue;
    sum += critical_error(relief, region->point, eye);
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

double error_bound(const ReliefTexture& relief, const CriticalRegions& regions, glm::dvec3 eye) {
  const WarpScales scales = warp_scales(relief, eye);
  const DepthShares metre = shares_of(scales.warp, 1.0);
  const auto scale_of = [&](double depth_m) { return 1.0 / (1.0 + metre.scale * depth_m); };
  const ReliefExtent& extent = regions.extent;
  // The largest |k1 - k3 u| of a part's columns; along rows, |k2 - k3 v|.
  const auto farthest = [&](int begin, int size, int i, int parts, double shift) {
    // The texels of a part begin at the first whose share of the size reaches it.
    const double first = begin + (static_cast<double>(i) * size) / parts;
    const double last = begin + (static_cast<double>(i + 1) * size) / parts;
    return std::fmax(std::fabs(shift - metre.scale * first), std::fabs(shift - metre.scale * last));
  };
  double bound = 0.0;
  for (int row = 0; row < regions.rows; ++row) {
    for (int column = 0; column < regions.columns; ++column) {
      const std::optional<CriticalRegion>& region =
          regions.regions[static_cast<std::size_t>(row * regions.columns + column)];
      if (!region) continue;
      const double step = std::abs(region->point.code1 - region->point.code2) * scales.step_m;
      const double least = region->least_code * scales.step_m;
      const double most = region->most_code * scales.step_m;
      const double scale = scale_of(metre.scale < 0.0 ? most : least);
      const double other = scale_of(metre.scale < 0.0 ? most - step : least + step);
      const double across =
          farthest(extent.x_begin, extent.x_end - extent.x_begin, column, regions.columns, metre.u);
      const double along =
          farthest(extent.y_begin, extent.y_end - extent.y_begin, row, regions.rows, metre.v);
      bound = std::fmax(bound,
                        scale + step * scale * other * std::sqrt(across * across + along * along));
    }
  }
  return bound;
}

double largest_error(const ReliefTexture& relief, glm::dvec3 eye) {
  const WarpScales scales = warp_scales(relief, eye);
  double largest = 0.0;
  for_each_pair(relief, [&](const CriticalPoint& pair) {
    largest = std::fmax(largest, distance_between(scales.at(pair.u1, pair.v1, pair.code1),
                                                  scales.at(pair.u2, pair.v2, pair.code2)));
  });
  return largest;
}

}  // namespace softfocus
