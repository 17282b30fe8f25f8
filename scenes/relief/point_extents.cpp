#include "scenes/relief/point_extents.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raster/numbers/vector_math.h"

namespace softfocus {
namespace {

/// Of all that is added: a product and a sum of three are wrong by a few 2^-53 of it.
constexpr double kReachRounding = 1e-14;

}  // namespace

std::vector<PointChunk> chunks_of(std::span<const glm::dvec3> points) {
  std::vector<PointChunk> chunks;
  chunks.reserve((points.size() + kChunkPoints - 1) / kChunkPoints);
  for (std::size_t first = 0; first < points.size(); first += kChunkPoints) {
    glm::dvec3 low = points[first], high = low;
    for (std::size_t i = first; i < std::min(first + kChunkPoints, points.size()); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], points[i][axis]);
        high[axis] = std::max(high[axis], points[i][axis]);
      }
    }
    chunks.push_back({(low + high) * 0.5, (high - low) * 0.5});
  }
  return chunks;
}

PointReach reach_along(std::span<const glm::dvec3> points, std::span<const PointChunk> chunks,
                       glm::dvec3 direction) {
  constexpr double kNowhere = std::numeric_limits<double>::infinity();
  PointReach reach{kNowhere, -kNowhere};
  const glm::dvec3 sizes{std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z)};
  for (std::size_t number = 0; number < chunks.size(); ++number) {
    const PointChunk& chunk = chunks[number];
    const glm::dvec3 far{std::fabs(chunk.middle.x), std::fabs(chunk.middle.y),
                         std::fabs(chunk.middle.z)};
    const double middle = dot(chunk.middle, direction), half = dot(chunk.half, sizes);
    const double more = half + kReachRounding * (dot(far, sizes) + half);
    if (middle + more < reach.high && middle - more > reach.low) continue;
    const std::size_t first = number * kChunkPoints;
    for (std::size_t i = first; i < std::min(first + kChunkPoints, points.size()); ++i) {
      const double along = dot(points[i], direction);
      reach.low = std::min(reach.low, along);
      reach.high = std::max(reach.high, along);
    }
  }
  return reach;
}

}  // namespace softfocus
