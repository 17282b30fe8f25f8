#pragma once
// A box around places as a light sees them.

#include <algorithm>
#include <glm/vec2.hpp>
#include <limits>

namespace softfocus {

/// Empty at first.
struct PlaceBox {
  glm::dvec2 low{std::numeric_limits<double>::infinity()};
  glm::dvec2 high{-std::numeric_limits<double>::infinity()};
};

inline void add(PlaceBox& box, glm::dvec2 p) {
  box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
  box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
}

}  // namespace softfocus
