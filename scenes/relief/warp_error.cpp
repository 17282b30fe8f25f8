#include "scenes/relief/warp_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
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
                                 int columns, int rows) {
  assert(columns >= 1 && columns <= kMostRegions && rows >= 1 && rows <= kMostRegions);
  CriticalRegions cut{extent, columns, rows, {}};
  cut.regions.resize(static_cast<std::size_t>(columns * rows));
  const int width = extent.x_end - extent.x_begin, height = extent.y_end - extent.y_begin;
  for_each_pair(relief, [&](const CriticalPoint& pair) {
    const int column = (pair.u1 - extent.x_begin) * columns / width;
    const int row = (pair.v1 - extent.y_begin) * rows / height;
    std::optional<CriticalRegion>& region =
        cut.regions[static_cast<std::size_t>(row * columns + column)];
    const int least = std::min(pair.code1, pair.code2), most = std::max(pair.code1, pair.code2);
    if (!region) region = CriticalRegion{pair, least, most};
    region->least_code = std::min(region->least_code, least);
    region->most_code = std::max(region->most_code, most);
    if (std::abs(pair.code1 - pair.code2) > std::abs(region->point.code1 - region->point.code2)) {
      region->point = pair;
    }
  });
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
  // |k1 - k3 u|, or the same of v.
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
