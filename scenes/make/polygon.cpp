#include "scenes/make/polygon.h"

#include <cassert>
#include <cmath>
#include <glm/vec2.hpp>

#include "raster/numbers/vector_math.h"

namespace softfocus {
namespace {

double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The polygon in the plane of its two larger extents, counter-clockwise. From the first
// corner, so that a polygon far from the origin loses nothing.
std::vector<glm::dvec2> flattened(std::span<const glm::dvec3> corners) {
  glm::dvec3 normal{0.0};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 next = corners[(i + 1) % corners.size()] - corners[0];
    normal += cross(corners[i] - corners[0], next);
  }
  const glm::dvec3 size{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
  const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
  const int right = (axis + 1) % 3;
  const int up = (axis + 2) % 3;
  const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;
  std::vector<glm::dvec2> flat;
  for (const glm::dvec3& corner : corners) {
    const glm::dvec3 p = corner - corners[0];
    flat.emplace_back(p[right] * sign, p[up]);
  }
  return flat;
}

bool inside(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
}

// Whether the corner at `place` of those left can be cut off.
bool is_ear(const std::vector<glm::dvec2>& flat, const std::vector<std::uint32_t>& left,
            std::size_t place) {
  const std::size_t count = left.size();
  const std::uint32_t before = left[(place + count - 1) % count];
  const std::uint32_t after = left[(place + 1) % count];
  const glm::dvec2 a = flat[before];
  const glm::dvec2 b = flat[left[place]];
  const glm::dvec2 c = flat[after];
  if (!(turn(a, b, c) > 0.0)) return false;
  for (const std::uint32_t other : left) {
    if (other == before || other == left[place] || other == after) continue;
    const glm::dvec2 p = flat[other];
    // A polygon with a hole runs through the cut twice, over equal corners.
    if (p != a && p != b && p != c && inside(p, a, b, c)) return false;
  }
  return true;
}

double squared_distance(glm::dvec3 a, glm::dvec3 b) { return dot(a - b, a - b); }

// Whether a quadrilateral is cut from corner 1 to 3 rather than from 0 to 2.
bool cut_from_second(std::span<const glm::dvec3> corners, const std::vector<glm::dvec2>& flat) {
  // The diagonal 0-2 lies inside where both its triangles turn the right way.
  const bool first_inside =
      turn(flat[0], flat[1], flat[2]) > 0.0 && turn(flat[0], flat[2], flat[3]) > 0.0;
  const bool second_inside =
      turn(flat[1], flat[2], flat[3]) > 0.0 && turn(flat[1], flat[3], flat[0]) > 0.0;
  if (first_inside != second_inside) return second_inside;
  return squared_distance(corners[1], corners[3]) < squared_distance(corners[0], corners[2]);
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(std::span<const glm::dvec3> corners) {
  assert(corners.size() >= 3);
  if (corners.size() == 3) return {{0, 1, 2}};
  const std::vector<glm::dvec2> flat = flattened(corners);
  if (corners.size() == 4) {
    if (cut_from_second(corners, flat)) return {{0, 1, 3}, {1, 2, 3}};
    return {{0, 1, 2}, {0, 2, 3}};
  }

  std::vector<std::uint32_t> left(corners.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<std::uint32_t>(i);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::size_t place = 1;
  while (left.size() > 3) {
    std::size_t tried = 0;
    while (tried < left.size() && !is_ear(flat, left, place % left.size())) {
      ++place;
      ++tried;
    }
    place %= left.size();
    const std::size_t count = left.size();
    triangles.push_back(
        {left[(place + count - 1) % count], left[place], left[(place + 1) % count]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(place));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace softfocus
