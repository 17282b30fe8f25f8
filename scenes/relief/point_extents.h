#pragma once
// How far many points reach along a direction. Chunks of points have boxes, and a chunk is passed
// over if its box cannot reach farther than the farthest point so far. Vertices of a mesh lie near
// their neighbours in the list, so few chunks are looked into.

#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace softfocus {

struct PointChunk {
  glm::dvec3 middle, half;  ///< of the box along the axes that holds its points
};
inline constexpr std::size_t kChunkPoints = 64;

/// One for each kChunkPoints points in their order; the last may have fewer.
std::vector<PointChunk> chunks_of(std::span<const glm::dvec3> points);

struct PointReach {
  double low, high;
};

/// The least and the largest dot(point, direction), the same numbers as by a loop over all points.
/// `chunks` are the points' chunks_of(). Without points low is +infinity and high -infinity.
PointReach reach_along(std::span<const glm::dvec3> points, std::span<const PointChunk> chunks,
                       glm::dvec3 direction);

}  // namespace softfocus
