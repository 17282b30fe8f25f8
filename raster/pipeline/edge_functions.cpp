#include "raster/pipeline/edge_functions.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "raster/numbers/fixed_point.h"

namespace softfocus {
namespace {

// In 1/256 pixel from the centre of pixel (0, 0), as all positions here; a multiple of 2^-bits
// pixels.
std::int64_t snap(float window_coordinate, int bits) {
  const float steps = (window_coordinate - 0.5f) * static_cast<float>(1 << bits);
  return std::int64_t{std::lrint(steps)} * (1 << (kSubpixelBits - bits));
}

int floor_to_pixel(std::int64_t snapped) { return static_cast<int>(snapped >> kSubpixelBits); }
int ceil_to_pixel(std::int64_t snapped) {
  return static_cast<int>((snapped + kSubpixelOne - 1) >> kSubpixelBits);
}

}  // namespace

std::optional<EdgeFunctions> make_edge_functions(const std::array<WindowVertex, 3>& vertices,
                                                 const Profile& profile) {
  assert(profile.subpixel_bits >= 4 && profile.subpixel_bits <= kSubpixelBits);
  std::array<std::int64_t, 3> x{};
  std::array<std::int64_t, 3> y{};
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = snap(vertices[i].x, profile.subpixel_bits);
    y[i] = snap(vertices[i].y, profile.subpixel_bits);
  }
  const std::int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
  if (area == 0) return std::nullopt;

  EdgeFunctions functions{};
  // y points down, so a positive area runs clockwise as seen.
  functions.clockwise = area > 0;
  functions.area = functions.clockwise ? area : -area;
  const auto [x_min, x_max] = std::minmax({x[0], x[1], x[2]});
  const auto [y_min, y_max] = std::minmax({y[0], y[1], y[2]});
  functions.bounds = {ceil_to_pixel(x_min), ceil_to_pixel(y_min), floor_to_pixel(x_max) + 1,
                      floor_to_pixel(y_max) + 1};

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

Span covered_span(const EdgeFunctions& functions, int y, int x_begin, int x_end) {
  const auto& edges = functions.edges;
  std::int64_t e0 = edge_at(edges[0], x_begin, y);
  std::int64_t e1 = edge_at(edges[1], x_begin, y);
  std::int64_t e2 = edge_at(edges[2], x_begin, y);
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

}  // namespace softfocus
