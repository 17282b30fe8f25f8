#include "raster/pipeline/setup.h"

#include <algorithm>
#include <cmath>

namespace softfocus {
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
                                             const Profile& profile) {
  if (!std::all_of(vertices.begin(), vertices.end(), is_drawable)) return std::nullopt;
  TriangleSetup setup{};
  setup.vertices = vertices;
  const auto take = [&](const auto& coverage) {
    if (!coverage) return false;
    setup.coverage = *coverage;
    setup.clockwise = coverage->clockwise;
    setup.bounds = intersection(coverage->bounds, clip);
    return setup.bounds.x_begin < setup.bounds.x_end && setup.bounds.y_begin < setup.bounds.y_end;
  };
  const bool covers = profile.coverage == Coverage::edge_functions
                          ? take(make_edge_functions(vertices, profile))
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

Span covered_span(const TriangleSetup& setup, int y, int x_begin, int x_end) {
  if (const auto* functions = std::get_if<EdgeFunctions>(&setup.coverage)) {
    return covered_span(*functions, y, x_begin, x_end);
  }
  return covered_span(std::get<Scanlines>(setup.coverage), y, x_begin, x_end);
}

}  // namespace softfocus
