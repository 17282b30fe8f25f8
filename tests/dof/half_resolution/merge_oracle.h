#pragma once
// The steps of dof/half_resolution in binary64 that the tests of ring-bucket and circular share.

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "dof/half_resolution/half_fields.h"
#include "raster/images/image.h"
#include "raster/images/texel.h"

namespace softfocus::test {

inline double saturated(double v) { return std::clamp(v, 0.0, 1.0); }
inline double mixed(double a, double b, double share) { return a + share * (b - a); }

/// A value of a cell; outside, that of the nearest.
inline double cell_value(const HalfFields& fields, int plane, int x, int y) {
  return static_cast<double>(plane_row(
      fields.cells, plane,
      std::clamp(y, 0, fields.cells.height - 1))[std::clamp(x, 0, fields.cells.width - 1)]);
}

/// A cell's green as a method blurs it.
struct BlurredCell {
  double far, near, opacity;
};

/// Half resolution to full, about a pixel: three quarters of its cell and a quarter of the next.
template <class Value>
double enlarged(int x, int y, const Value& value) {
  const int cx = x / 2, cy = y / 2, ox = x % 2 == 0 ? -1 : 1, oy = y % 2 == 0 ? -1 : 1;
  const auto row = [&](int at) { return mixed(value(cx, at), value(cx + ox, at), 0.25); };
  return mixed(row(cy), row(cy + oy), 0.25);
}

/// t(r).
inline double half_share_of(double r) { return saturated((r * r - 2.25) / 1.75); }

/// A pixel's green with the slight blur of merge_fields.h.
inline double softened(const DofInput& input, int x, int y) {
  const auto at = [&](int px, int py) {
    return split_texel(input, std::clamp(px, 0, input.scene.width - 1),
                       std::clamp(py, 0, input.scene.height - 1));
  };
  const auto r = static_cast<double>(at(x, y).radius_px);
  const auto own = static_cast<double>(at(x, y).g);
  const double variance = std::clamp((r * r - 0.25) / 4.0, 0.0, 0.5);
  double sum = own;
  for (int i = 0; i < 9; ++i) {
    const int dx = i % 3 - 1, dy = i / 3 - 1;
    if ((dx == 0 && dy == 0) || variance == 0.0) continue;
    const SplitTexel p = at(x + dx, y + dy);
    const auto other = static_cast<double>(p.radius_px);
    const double k =
        (dx == 0 ? 1.0 - variance : variance / 2.0) * (dy == 0 ? 1.0 - variance : variance / 2.0);
    const double share =
        std::min(other * other / (r * r), 1.0) * saturated(2.0 - std::fabs(other - r));
    sum += k * share * (static_cast<double>(p.g) - own);
  }
  return sum;
}

/// The largest difference of a result's green from merge_fields.h, of cells blurred by `blur`.
/// Needs fields without highlights.
inline double merge_error(const DofInput& input, const HalfFields& fields, const Image& result,
                          const std::function<BlurredCell(int, int)>& blur) {
  const int columns = fields.cells.width, rows = fields.cells.height;
  std::vector<BlurredCell> cells;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) cells.push_back(blur(x, y));
  }
  const auto cell = [&](int x, int y) {
    x = std::clamp(x, 0, columns - 1);
    y = std::clamp(y, 0, rows - 1);
    return cells[static_cast<std::size_t>(y * columns + x)];
  };
  double worst = 0.0;
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      const auto weight = [&](int cx, int cy) { return cell_value(fields, kFarWeight, cx, cy); };
      const double far =
          enlarged(x, y, [&](int cx, int cy) { return weight(cx, cy) * cell(cx, cy).far; }) /
          enlarged(x, y, weight);
      const double near = enlarged(x, y, [&](int cx, int cy) { return cell(cx, cy).near; });
      const double opacity = enlarged(x, y, [&](int cx, int cy) { return cell(cx, cy).opacity; });
      const SplitTexel own = split_texel(input, x, y);
      const auto r = static_cast<double>(own.radius_px);
      const double share = r < 0.0 ? saturated(-r - 2.0) : half_share_of(r);
      const double expected = near + (1.0 - opacity) * mixed(softened(input, x, y), far, share);
      const double got = static_cast<double>(load_texel(result, x, y).y);
      worst = std::max(worst, std::fabs(got - expected));
    }
  }
  return worst;
}

}  // namespace softfocus::test
