#include "scenes/make/polygon.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/vec2.hpp>
#include <numeric>
#include <optional>
#include <tuple>

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

// The corners of a polygon that are left: a ring of indices into `flat`.
struct Ring {
  std::vector<glm::dvec2> flat;
  std::vector<std::uint32_t> before, after;
  std::vector<std::uint32_t> changed;  // when the corner was cut off, or its neighbours were
  std::uint32_t now;
  std::size_t count;
  /// Why a corner was no ear: a corner in the way, or itself, and when. Until one of the two
  /// changes it still is none.
  struct Obstacle {
    std::uint32_t corner, seen;
  };
  std::array<std::vector<Obstacle>, 2> obstacles;  // by what a cut must avoid
};

// Even-odd: whether a place lies inside a loop, or nothing if it lies on its edge.
std::optional<bool> is_inside(const std::vector<glm::dvec2>& flat,
                              std::span<const std::uint32_t> loop, glm::dvec2 p) {
  bool inside = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    glm::dvec2 low = flat[loop[i]];
    glm::dvec2 high = flat[loop[(i + 1) % loop.size()]];
    if (low.y > high.y) std::swap(low, high);
    const double side = turn(low, high, p);
    const bool within = std::min(low.x, high.x) <= p.x && p.x <= std::max(low.x, high.x);
    if (side == 0.0 && low.y <= p.y && p.y <= high.y && within) return std::nullopt;
    if (low.y <= p.y && p.y < high.y && side > 0.0) inside = !inside;
  }
  return inside;
}

bool is_nested(const std::vector<glm::dvec2>& flat, std::span<const std::uint32_t> inner,
               std::span<const std::uint32_t> outer) {
  for (const std::uint32_t corner : inner) {
    if (const auto inside = is_inside(flat, outer, flat[corner])) return *inside;
  }
  return false;
}

double twice_area(const std::vector<glm::dvec2>& flat, std::span<const std::uint32_t> loop) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    sum += turn(flat[loop[0]], flat[loop[i]], flat[loop[i + 1]]);
  }
  return sum;
}

// The corners in an order in which holes run against what they are holes of, and what is not a hole
// counter-clockwise. Where an outline comes back to a place it has made a loop; if that lies within
// the rest, or the rest within it, the inner one is a hole, however it runs.
std::vector<std::uint32_t> with_holes_turned(const std::vector<glm::dvec2>& flat) {
  std::vector<std::uint32_t> order(flat.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<std::uint32_t> by_place = order;
  std::sort(by_place.begin(), by_place.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(flat[a].x, flat[a].y, a) < std::tie(flat[b].x, flat[b].y, b);
  });
  for (std::size_t i = 0; i + 1 < by_place.size(); ++i) {
    if (flat[by_place[i]] != flat[by_place[i + 1]]) continue;
    const auto one = std::find(order.begin(), order.end(), by_place[i]);
    const auto other = std::find(order.begin(), order.end(), by_place[i + 1]);
    const auto first = std::min(one, other);
    const auto back = std::max(one, other);
    const std::vector<std::uint32_t> loop(first, back);
    std::vector<std::uint32_t> rest(back, order.end());
    rest.insert(rest.end(), order.begin(), first);
    if (twice_area(flat, loop) * twice_area(flat, rest) <= 0.0) continue;
    if (is_nested(flat, loop, rest) || is_nested(flat, rest, loop)) std::reverse(first + 1, back);
  }
  if (twice_area(flat, order) < 0.0) std::reverse(order.begin(), order.end());
  return order;
}

Ring make_ring(std::vector<glm::dvec2> flat) {
  const auto count = static_cast<std::uint32_t>(flat.size());
  const std::vector<std::uint32_t> order = with_holes_turned(flat);
  Ring ring{std::move(flat),
            std::vector(count, 0u),
            std::vector(count, 0u),
            std::vector(count, 1u),
            1,
            count,
            {}};
  for (std::uint32_t i = 0; i < count; ++i) {
    ring.after[order[i]] = order[(i + 1) % count];
    ring.before[order[(i + 1) % count]] = order[i];
  }
  for (auto& obstacles : ring.obstacles) obstacles.resize(count, {0, 0});
  return ring;
}

double turn_at(const Ring& ring, std::uint32_t corner) {
  return turn(ring.flat[ring.before[corner]], ring.flat[corner], ring.flat[ring.after[corner]]);
}

// Whether a corner lies on its neighbour, or both its edges go the same way: it has no area, and
// no other polygon's edge can end at it between its neighbours.
bool is_spike(const Ring& ring, std::uint32_t corner) {
  const glm::dvec2 in = ring.flat[corner] - ring.flat[ring.before[corner]];
  const glm::dvec2 out = ring.flat[ring.after[corner]] - ring.flat[corner];
  return turn_at(ring, corner) == 0.0 && in.x * out.x + in.y * out.y <= 0.0;
}

// What a cut must avoid. An outline that touches itself, as one around a hole does, has cuts that
// touch it: a corner then is in the way only if an edge goes from it into the triangle.
enum class Touching : std::uint8_t { at_corners, anywhere };

bool is_in_the_way(const Ring& ring, std::uint32_t other, const std::array<glm::dvec2, 3>& triangle,
                   Touching allowed) {
  const glm::dvec2 p = ring.flat[other];
  bool before_enters = true;
  bool after_enters = true;
  int sides = 0;  // that p lies on
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec2 from = triangle[i];
    const glm::dvec2 to = triangle[(i + 1) % 3];
    const double side = turn(from, to, p);
    if (side < 0.0) return false;
    if (side > 0.0) continue;
    ++sides;
    before_enters = before_enters && turn(from, to, ring.flat[ring.before[other]]) > 0.0;
    after_enters = after_enters && turn(from, to, ring.flat[ring.after[other]]) > 0.0;
  }
  const bool may_touch = allowed == Touching::anywhere ? sides > 0 : sides > 1;
  return !may_touch || before_enters || after_enters;
}

// The corner that keeps another from being cut off: itself if it turns inwards.
std::optional<std::uint32_t> find_obstacle(const Ring& ring, std::uint32_t corner,
                                           Touching allowed) {
  if (!(turn_at(ring, corner) > 0.0)) return corner;
  const std::uint32_t first = ring.before[corner];
  const std::uint32_t last = ring.after[corner];
  const std::array<glm::dvec2, 3> triangle{ring.flat[first], ring.flat[corner], ring.flat[last]};
  const auto [a, b, c] = triangle;
  const glm::dvec2 low{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})};
  const glm::dvec2 high{std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})};
  for (std::uint32_t other = ring.after[last]; other != first; other = ring.after[other]) {
    const glm::dvec2 p = ring.flat[other];
    if (p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y) continue;
    if (is_in_the_way(ring, other, triangle, allowed)) return other;
  }
  return std::nullopt;
}

bool is_ear(Ring& ring, std::uint32_t corner, Touching allowed) {
  Ring::Obstacle& known = ring.obstacles[static_cast<std::size_t>(allowed)][corner];
  if (known.seen >= std::max(ring.changed[corner], ring.changed[known.corner])) return false;
  const auto found = find_obstacle(ring, corner, allowed);
  if (found) known = {*found, ring.now};
  return !found;
}

// The next corner to cut off, from `start` on: an ear; one that touches other edges; one without an
// area; `start` if the outline crosses itself.
std::uint32_t next_cut(Ring& ring, std::uint32_t start) {
  std::optional<std::uint32_t> touching;
  std::optional<std::uint32_t> straight;
  std::uint32_t corner = start;
  for (std::size_t tried = 0; tried < ring.count; ++tried, corner = ring.after[corner]) {
    if (is_ear(ring, corner, Touching::at_corners)) return corner;
    if (!touching && is_ear(ring, corner, Touching::anywhere)) touching = corner;
    if (!touching && !straight && turn_at(ring, corner) == 0.0) straight = corner;
  }
  return touching ? *touching : straight.value_or(start);
}

double squared_distance(glm::dvec3 a, glm::dvec3 b) { return dot(a - b, a - b); }

// Whether a quadrilateral is cut from corner 1 to 3 rather than from 0 to 2.
bool cut_from_second(std::span<const glm::dvec3> corners, const std::vector<glm::dvec2>& flat) {
  // The diagonal 0-2 lies inside where both its triangles turn the right way.
  const std::array first{turn(flat[0], flat[1], flat[2]), turn(flat[0], flat[2], flat[3])};
  const std::array second{turn(flat[1], flat[2], flat[3]), turn(flat[1], flat[3], flat[0])};
  const bool first_inside = first[0] > 0.0 && first[1] > 0.0;
  const bool second_inside = second[0] > 0.0 && second[1] > 0.0;
  if (first_inside != second_inside) return second_inside;
  if (!first_inside) {  // a triangle without an area on the edge of the other one
    const bool first_covers = first[0] >= 0.0 && first[1] >= 0.0;
    const bool second_covers = second[0] >= 0.0 && second[1] >= 0.0;
    if (first_covers != second_covers) return second_covers;
  }
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

  Ring ring = make_ring(flat);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint32_t corner = 1;
  const auto cut = [&] {
    const std::uint32_t first = ring.before[corner];
    const std::uint32_t last = ring.after[corner];
    triangles.push_back({first, corner, last});
    ring.after[first] = last;
    ring.before[last] = first;
    --ring.count;
    ring.changed[first] = ring.changed[corner] = ring.changed[last] = ++ring.now;
    corner = last;
  };
  // Spikes first. What is cut may leave another before it.
  std::size_t straight = 0;
  while (ring.count > 3 && straight < ring.count) {
    straight = is_spike(ring, corner) ? 0 : straight + 1;
    if (straight > 0) {
      corner = ring.after[corner];
    } else {
      cut();
      corner = ring.before[corner];
    }
  }
  corner = 1;
  while (ring.after[ring.before[corner]] != corner) ++corner;
  while (ring.count > 3) {
    corner = next_cut(ring, corner);
    cut();
    while (ring.count > 3 && (is_spike(ring, corner) || is_spike(ring, ring.before[corner]))) {
      if (!is_spike(ring, corner)) corner = ring.before[corner];
      cut();
    }
  }
  std::array<std::uint32_t, 3> last{ring.before[corner], corner, ring.after[corner]};
  std::rotate(last.begin(), std::min_element(last.begin(), last.end()), last.end());
  triangles.push_back(last);
  return triangles;
}

}  // namespace softfocus
