#pragma once
// The viewport transform: from clip coordinates to the window.

#include <array>
#include <glm/vec4.hpp>

#include "raster/numbers/lerp.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// A vertex in the window.
struct WindowVertex {
  float x;      ///< pixels, unsnapped; pixel 0 spans 0 to 1
  float y;      ///< pixels, downwards
  float depth;  ///< 0 (near) to 1 (far)
  float inverse_w;
};

/// In this order: r = 1 / w; ndc = (x r, y r, z r); x_window = ndc.x * (width/2) + width/2,
/// likewise y; depth = ndc.z * 0.5 + 0.5. If fused, a product and its sum are rounded once. w = 0
/// gives infinities and NaN.
inline WindowVertex to_window(const glm::vec4& position, int width, int height,
                              Contraction contraction) {
  const float inverse_w = 1.0f / position.w;
  const float half_width = static_cast<float>(width) * 0.5f;
  const float half_height = static_cast<float>(height) * 0.5f;
  return {multiply_add(position.x * inverse_w, half_width, half_width, contraction),
          multiply_add(position.y * inverse_w, half_height, half_height, contraction),
          multiply_add(position.z * inverse_w, 0.5f, 0.5f, contraction), inverse_w};
}

/// Twice the area in square pixels, positive if the vertices run clockwise as seen. The order of
/// operations is that of Mesa's drivers. A sliver's sign can differ from that of its snapped area.
inline float unsnapped_area(const std::array<WindowVertex, 3>& v) {
  return (v[0].x - v[2].x) * (v[1].y - v[2].y) - (v[0].y - v[2].y) * (v[1].x - v[2].x);
}

}  // namespace softfocus
