#include "raster/pipeline/setup.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "raster/numbers/fixed_point.h"
#include "raster/pipeline/multisample.h"

namespace softfocus {
namespace {

// In 1/256 pixel from the centre of pixel (0, 0), as all positions here; a multiple of 2^-bits
// pixels.
std::int64_t snap(float window_coordinate, int bits, int samples) {
  const float from = samples == 1 ? 0.5f : 0.0f;
  const float steps = (window_coordinate - from) * static_cast<float>(1 << bits);
  return std::int64_t{std::lrint(steps)} * (1 << (kSubpixelBits - bits)) -
         (samples == 1 ? 0 : kSubpixelOne / 2);
}

int floor_to_pixel(std::int64_t snapped) { return static_cast<int>(snapped >> kSubpixelBits); }
int ceil_to_pixel(std::int64_t snapped) {
  return static_cast<int>((snapped + kSubpixelOne - 1) >> kSubpixelBits);
}

}  // namespace

std::optional<EdgeFunctions> make_edge_functions(const std::array<WindowVertex, 3>& vertices,
                                                 const Profile& profile, int samples,
                                                 int edge_samples) {
  assert(profile.subpixel_bits >= 4 && profile.subpixel_bits <= kSubpixelBits);
  std::array<std::int64_t, 3> x{};
  std::array<std::int64_t, 3> y{};
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = snap(vertices[i].x, profile.subpixel_bits, samples);
    y[i] = snap(vertices[i].y, profile.subpixel_bits, samples);
  }
  const std::int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
  if (area == 0) return std::nullopt;

  EdgeFunctions functions{};
  // y points down, so a positive area runs clockwise as seen.
  functions.clockwise = area > 0;
  functions.area = functions.clockwise ? area : -area;
  const auto [x_min, x_max] = std::minmax({x[0], x[1], x[2]});
  const auto [y_min, y_max] = std::minmax({y[0], y[1], y[2]});
  const int reach = std::max(sample_reach(samples), sample_reach(edge_samples));
  functions.bounds = {ceil_to_pixel(x_min - reach), ceil_to_pixel(y_min - reach),
                      floor_to_pixel(x_max + reach) + 1, floor_to_pixel(y_max + reach) + 1};

  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t from = (i + 1) % 3;
    const std::size_t to = (i + 2) % 3;
    std::int64_t dx = x[to] - x[from];
    std::int64_t dy = y[to] - y[from];
    if (!functions.clockwise) {
      dx = -dx;
      dy = -dy;
    }
    EdgeFunction& edge = functions.edges[i];
    edge.per_x = -dy * kSubpixelOne;
    edge.per_y = dx * kSubpixelOne;
    edge.at_origin = dy * x[from] - dx * y[from];
    // Clockwise on a screen whose y points down, a left edge runs up, an upper one runs
    // right and a lower one left.
    const bool level_owns = profile.fill_rule == FillRule::upper_left ? dx > 0 : dx < 0;
    edge.owns_centres = dy < 0 || (dy == 0 && level_owns);
  }
  return functions;
}

Span covered_span(const EdgeFunctions& functions, int y, int x_begin, int x_end,
                  const glm::ivec2& place) {
  const auto& edges = functions.edges;
  std::int64_t e0 = edge_at(edges[0], x_begin, y, place);
  std::int64_t e1 = edge_at(edges[1], x_begin, y, place);
  std::int64_t e2 = edge_at(edges[2], x_begin, y, place);
  const auto covered = [&] {
    return inside(edges[0], e0) && inside(edges[1], e1) && inside(edges[2], e2);
  };
  int x = x_begin;
  const auto step = [&] {
    ++x;
    e0 += edges[0].per_x;
    e1 += edges[1].per_x;
    e2 += edges[2].per_x;
  };
  while (x < x_end && !covered()) step();
  const int begin = x;
  while (x < x_end && covered()) step();
  return {begin, x};
}

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

namespace {

bool is_culled(bool front_facing, Cull cull) {
  return (cull == Cull::back && !front_facing) || (cull == Cull::front && front_facing);
}

bool is_drawable(const WindowVertex& v) {
  return std::fabs(v.x) < kLargestPosition && std::fabs(v.y) < kLargestPosition &&
         std::isfinite(v.depth) && std::isfinite(v.inverse_w) && v.inverse_w > 0.0f;
}

}  // namespace

std::optional<TriangleSetup> set_up_triangle(const std::array<WindowVertex, 3>& vertices, Cull cull,
                                             FrontFace front_face, const Rectangle& clip,
                                             const Profile& profile, int samples,
                                             int edge_samples) {
  if (!std::all_of(vertices.begin(), vertices.end(), is_drawable)) return std::nullopt;
  TriangleSetup setup{};
  setup.vertices = vertices;
  setup.samples = samples;
  const auto take = [&](const auto& coverage) {
    if (!coverage) return false;
    setup.coverage = *coverage;
    setup.clockwise = coverage->clockwise;
    setup.bounds = intersection(coverage->bounds, clip);
    return setup.bounds.x_begin < setup.bounds.x_end && setup.bounds.y_begin < setup.bounds.y_end;
  };
  const bool covers = profile.coverage == Coverage::edge_functions
                          ? take(make_edge_functions(vertices, profile, samples, edge_samples))
                          : take(make_scanlines(vertices));
  if (!covers) return std::nullopt;

  setup.front_facing = setup.clockwise == (front_face == FrontFace::clockwise);
  if (is_culled(setup.front_facing, cull)) return std::nullopt;
  return setup;
}

bool is_culled_unsnapped(const std::array<WindowVertex, 3>& vertices, Cull cull,
                         FrontFace front_face) {
  const float area = unsnapped_area(vertices);
  return is_culled(front_face == FrontFace::clockwise ? area > 0.0f : area < 0.0f, cull);
}

Span covered_span(const TriangleSetup& setup, int y, int x_begin, int x_end,
                  const glm::ivec2& place) {
  if (const auto* functions = std::get_if<EdgeFunctions>(&setup.coverage)) {
    return covered_span(*functions, y, x_begin, x_end, place);
  }
  return covered_span(std::get<Scanlines>(setup.coverage), y, x_begin, x_end);
}

}  // namespace softfocus
