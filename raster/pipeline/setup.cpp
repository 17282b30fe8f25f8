#include "raster/pipeline/setup.h"

#include <algorithm>
#include <cmath>

#include "raster/numbers/fixed_point.h"
#include "raster/numbers/lerp.h"

namespace softfocus {
namespace {

// The guard band keeps positions far inside this; what lies beyond is no number.
constexpr float kLargestPosition = 0x1p20f;

int floor_to_pixel(std::int64_t snapped) { return static_cast<int>(snapped >> kSubpixelBits); }
int ceil_to_pixel(std::int64_t snapped) {
  return static_cast<int>((snapped + kSubpixelOne - 1) >> kSubpixelBits);
}

}  // namespace

WindowVertex to_window(const glm::vec4& position, int width, int height, const Profile& profile) {
  const float inverse_w = 1.0f / position.w;
  const float half_width = static_cast<float>(width) * 0.5f;
  const float half_height = static_cast<float>(height) * 0.5f;
  return {multiply_add(position.x * inverse_w, half_width, half_width, profile.viewport),
          multiply_add(position.y * inverse_w, half_height, half_height, profile.viewport),
          multiply_add(position.z * inverse_w, 0.5f, 0.5f, profile.viewport), inverse_w};
}

std::optional<TriangleSetup> set_up_triangle(const std::array<WindowVertex, 3>& vertices, Cull cull,
                                             FrontFace front_face, const Rectangle& clip) {
  std::array<std::int64_t, 3> x{};
  std::array<std::int64_t, 3> y{};
  for (std::size_t i = 0; i < 3; ++i) {
    const WindowVertex& v = vertices[i];
    if (!(std::fabs(v.x) < kLargestPosition) || !(std::fabs(v.y) < kLargestPosition) ||
        !std::isfinite(v.depth) || !std::isfinite(v.inverse_w)) {
      return std::nullopt;
    }
    x[i] = snap_to_subpixel(v.x);
    y[i] = snap_to_subpixel(v.y);
  }

  const std::int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
  if (area == 0) return std::nullopt;
  // y points down, so a positive area runs clockwise as seen.
  const bool clockwise = area > 0;
  const bool front = clockwise == (front_face == FrontFace::clockwise);
  if ((cull == Cull::back && !front) || (cull == Cull::front && front)) return std::nullopt;

  TriangleSetup setup{};
  setup.vertices = vertices;
  setup.front_facing = front;
  setup.area = clockwise ? area : -area;

  const auto [x_min, x_max] = std::minmax({x[0], x[1], x[2]});
  const auto [y_min, y_max] = std::minmax({y[0], y[1], y[2]});
  setup.bounds = {std::max(clip.x_begin, ceil_to_pixel(x_min)),
                  std::max(clip.y_begin, ceil_to_pixel(y_min)),
                  std::min(clip.x_end, floor_to_pixel(x_max) + 1),
                  std::min(clip.y_end, floor_to_pixel(y_max) + 1)};
  if (setup.bounds.x_begin >= setup.bounds.x_end || setup.bounds.y_begin >= setup.bounds.y_end) {
    return std::nullopt;
  }

  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t from = (i + 1) % 3;
    const std::size_t to = (i + 2) % 3;
    std::int64_t dx = x[to] - x[from];
    std::int64_t dy = y[to] - y[from];
    if (!clockwise) {
      dx = -dx;
      dy = -dy;
    }
    EdgeFunction& edge = setup.edges[i];
    edge.per_x = -dy * kSubpixelOne;
    edge.per_y = dx * kSubpixelOne;
    edge.at_origin = dy * x[from] - dx * y[from];
    // Clockwise on a screen whose y points down, a left edge runs up and an upper
    // one runs right.
    edge.owns_centres = dy < 0 || (dy == 0 && dx > 0);
  }
  return setup;
}

}  // namespace softfocus
