#include "scenes/relief/warp_error.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace softfocus {
namespace {

/// In texels, binary64.
struct WarpScales {
  PreWarp warp;
  double step_m;

  WarpedPlace at(double u, double v, int code) const {
    const double scale = warp.height_m / (warp.height_m + code * step_m);
    return {warp.epipole_u + (u - warp.epipole_u) * scale,
            warp.epipole_v + (v - warp.epipole_v) * scale};
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

double error_bound(const ReliefTexture& relief, const ReliefExtent& extent,
                   const CriticalPoint& point, glm::dvec3 eye) {
  const WarpScales scales = warp_scales(relief, eye);
  const double h = scales.warp.height_m;
  const double step = std::abs(point.code1 - point.code2) * scales.step_m;
  const double least = extent.least_code * scales.step_m;
  const double across = std::fmax(std::fabs(extent.x_begin - scales.warp.epipole_u),
                                  std::fabs(extent.x_end - 1 - scales.warp.epipole_u));
  const double along = std::fmax(std::fabs(extent.y_begin - scales.warp.epipole_v),
                                 std::fabs(extent.y_end - 1 - scales.warp.epipole_v));
  const double scale_step = h * step / ((h + least) * (h + least + step));
  return 1.0 + scale_step * std::sqrt(across * across + along * along);
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
