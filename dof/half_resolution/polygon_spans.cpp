#include "dof/half_resolution/polygon_spans.h"

#include <cmath>

#include "raster/numbers/exact_math.h"

namespace softfocus {
namespace {

// Half the width at a height of a polygon in a circle of radius 1; 0 outside.
double half_width_at(int corners, double height) {
  double widest = 0.0;
  for (int i = 0; i < corners; ++i) {
    const double one = 90.0 + 360.0 * i / corners, other = 90.0 + 360.0 * (i + 1) / corners;
    const double y0 = exact_math::sin_degrees(one), y1 = exact_math::sin_degrees(other);
    if ((y0 <= height) == (y1 <= height)) continue;
    const double x0 = exact_math::cos_degrees(one), x1 = exact_math::cos_degrees(other);
    widest = std::fmax(widest, std::fabs(x0 + (x1 - x0) * ((height - y0) / (y1 - y0))));
  }
  return widest;
}

// Of a row of pixels, by the midpoint rule.
double row_half_width(int corners, double radius, double row) {
  constexpr int kSteps = 16;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    sum += half_width_at(corners, (row - 0.5 + (i + 0.5) / kSteps) / radius);
  }
  return radius * sum / kSteps;
}

}  // namespace

PolygonSpans make_polygon_spans(int corners, float largest_px, std::span<const std::uint8_t> used) {
  PolygonSpans spans{make_discs(largest_px, std::span<const std::uint8_t>{}), {}};
  ScatterDiscs& above = spans.above;
  const auto count = static_cast<std::size_t>(above.count);
  above.spans.assign(above.spans.size(), DiscSpan{-2, 0});
  above.reaches.assign(count, 0);
  above.weights.assign(count, 1.0f);
  for (std::size_t i = 0; i < count; ++i) above.spans[i] = {0, 0};
  spans.below = above;
  for (std::size_t i = 3; i < count; ++i) {
    if (i >= used.size() || used[i] == 0) continue;
    const double radius = 0.25 * static_cast<double>(i);
    std::int64_t eighths = 0;
    for (const double side : {1.0, -1.0}) {
      ScatterDiscs& half = side > 0.0 ? spans.above : spans.below;
      for (int dy = 0; dy <= half.reach; ++dy) {
        const int half_width =
            static_cast<int>(8.0 * row_half_width(corners, radius, side * dy) + 0.5);
        if (half_width == 0) break;
        half.spans[static_cast<std::size_t>(dy) * count + i] = {
            static_cast<std::int16_t>((half_width + 4) / 8 - 1),
            static_cast<std::int16_t>((half_width + 4) % 8)};
        half.reaches[i] = dy;
        if (side > 0.0 || dy > 0) eighths += 2 * half_width;
      }
    }
    spans.above.weights[i] = spans.below.weights[i] =
        static_cast<float>(8.0 / static_cast<double>(eighths));
  }
  return spans;
}

}  // namespace softfocus
