#pragma once
// Polygons to triangles.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace softfocus {

/// Triangles over the corners (indices into them), wound as the polygon is: always
/// corners - 2 of them. A quadrilateral is cut along the shorter diagonal that lies
/// inside it; a polygon of more corners loses one ear after the other (Meisters 1975),
/// seen along the axis in which it is largest. They cover what the even-odd rule counts as
/// inside, of outlines that touch themselves too: with doubled corners, spikes, and holes
/// joined by bridges, whichever way they run. One that crosses itself, or has no area, is
/// cut anyhow. Time grows with the square of the corners. Needs 3 corners or more.
std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(std::span<const glm::dvec3> corners);

}  // namespace softfocus
