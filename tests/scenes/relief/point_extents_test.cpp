#include "scenes/relief/point_extents.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <limits>

#include "raster/numbers/vector_math.h"
#include "tests/support/relief_pictures.h"

using namespace softfocus;
using namespace softfocus::test;

TEST_CASE("points reach as far along a direction as the farthest of them all") {
  Random random{5};
  const auto point = [&](double size) {
    return glm::dvec3{random.between(-size, size), random.between(-size, size),
                      random.between(-size, size)};
  };
  for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 63, 64, 65, 1000}) {
    std::vector<glm::dvec3> points;
    points.reserve(count);
    glm::dvec3 walker{0.0};
    for (std::size_t i = 0; i < count; ++i) {
      walker += point(0.1);
      points.push_back(walker);
    }
    const std::vector<PointChunk> chunks = chunks_of(points);
    for (int i = 0; i < 50; ++i) {
      const glm::dvec3 direction = point(1.0);
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const glm::dvec3& each : points) {
        low = std::min(low, dot(each, direction));
        high = std::max(high, dot(each, direction));
      }
      const PointReach reach = reach_along(points, chunks, direction);
      CHECK(reach.low == low);
      CHECK(reach.high == high);
    }
  }
}
