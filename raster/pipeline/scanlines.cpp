#include "raster/pipeline/scanlines.h"

#include <algorithm>
#include <cmath>

namespace softfocus {
namespace {

// The rows whose centres lie between an edge's ends, and where the edge crosses the first.
// Counted from the centre of pixel (0, 0), the first centre at or below y is ceil(y).
struct Edge {
  int first_row;
  int rows;
  EdgeWalk walk;
};

Edge make_edge(const WindowVertex& upper, const WindowVertex& lower) {
  const float dx = lower.x - upper.x;
  const float dy = lower.y - upper.y;
  const float y = upper.y - 0.5f;
  const float first_row = std::ceil(y);
  const float per_row = dy != 0.0f ? dx / dy : 0.0f;
  return {static_cast<int>(first_row),
          static_cast<int>(std::ceil((lower.y - 0.5f) - first_row)),
          {(upper.x + 0.5f) + (first_row - y) * per_row, per_row}};
}

// The long edge beside the lower half. softpipe rounds here.
EdgeWalk walk_on(const EdgeWalk& walk, int rows) {
  return {walk.x + static_cast<float>(rows) * walk.per_row, walk.per_row};
}

// Clamped before the conversion, which must not see a walk that overflows.
int pixel_at(const EdgeWalk& walk, int row, int least, int greatest) {
  const float x = walk.x + static_cast<float>(row) * walk.per_row;
  if (!(x > static_cast<float>(least))) return least;
  return x < static_cast<float>(greatest) ? static_cast<int>(x) : greatest;
}

// A walk is monotonic, rounding included: the extremes are in the first and last row.
void extend_bounds(Rectangle& bounds, const HalfTriangle& half) {
  constexpr int kFar = 1 << 21;
  if (half.y_begin >= half.y_end) return;
  for (const int row : {0, half.y_end - half.y_begin - 1}) {
    bounds.x_begin = std::min(bounds.x_begin, pixel_at(half.left, row, -kFar, kFar));
    bounds.x_end = std::max(bounds.x_end, pixel_at(half.right, row, -kFar, kFar));
  }
  bounds.y_begin = std::min(bounds.y_begin, half.y_begin);
  bounds.y_end = std::max(bounds.y_end, half.y_end);
}

}  // namespace

std::array<std::size_t, 3> from_top_to_bottom(const std::array<WindowVertex, 3>& vertices) {
  const float y0 = vertices[0].y;
  const float y1 = vertices[1].y;
  const float y2 = vertices[2].y;
  if (y0 <= y1) {
    if (y1 <= y2) return {0, 1, 2};
    if (y2 <= y0) return {2, 0, 1};
    return {0, 2, 1};
  }
  if (y0 <= y2) return {1, 0, 2};
  if (y2 <= y1) return {2, 1, 0};
  return {1, 2, 0};
}

std::optional<Scanlines> make_scanlines(const std::array<WindowVertex, 3>& vertices) {
  const auto order = from_top_to_bottom(vertices);
  const WindowVertex& top = vertices[order[0]];
  const WindowVertex& middle = vertices[order[1]];
  const WindowVertex& bottom = vertices[order[2]];
  const float area =
      (bottom.x - top.x) * (middle.y - top.y) - (middle.x - top.x) * (bottom.y - top.y);
  if (!std::isfinite(1.0f / area)) return std::nullopt;

  const Edge upper = make_edge(top, middle);
  const Edge lower = make_edge(middle, bottom);
  const Edge whole = make_edge(top, bottom);
  const EdgeWalk whole_lower = walk_on(whole.walk, upper.rows);
  Scanlines scanlines{};
  if (area < 0.0f) {  // the long edge is on the left
    const int middle_row = whole.first_row + upper.rows;
    scanlines.halves = {HalfTriangle{whole.first_row, middle_row, whole.walk, upper.walk},
                        {middle_row, middle_row + lower.rows, whole_lower, lower.walk}};
  } else {
    scanlines.halves = {
        HalfTriangle{upper.first_row, upper.first_row + upper.rows, upper.walk, whole.walk},
        {lower.first_row, lower.first_row + lower.rows, lower.walk, whole_lower}};
  }

  // Not the sign of `area`, which other products give.
  scanlines.clockwise = !(unsnapped_area(vertices) < 0.0f);
  scanlines.bounds = {1 << 21, 1 << 21, -(1 << 21), -(1 << 21)};
  for (const HalfTriangle& half : scanlines.halves) extend_bounds(scanlines.bounds, half);
  return scanlines;
}

Span covered_span(const Scanlines& scanlines, int y, int x_begin, int x_end) {
  for (const HalfTriangle& half : scanlines.halves) {
    if (y < half.y_begin || y >= half.y_end) continue;
    const int row = y - half.y_begin;
    return {pixel_at(half.left, row, x_begin, x_end), pixel_at(half.right, row, x_begin, x_end)};
  }
  return {x_begin, x_begin};
}

}  // namespace softfocus
