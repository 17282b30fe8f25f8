#include "dof/weights.h"

#include <algorithm>
#include <vector>

#include "raster/images/texel.h"

namespace softfocus {

float largest_filter_radius(const DofInput& input, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  std::vector<float> of_row(static_cast<std::size_t>(scene.height), 0.0f);
  pool.for_each(scene.height, [&](int y) {
    float largest = 0.0f;
    const auto halves = row<std::uint16_t>(scene, y);
    for (std::size_t i = 3; i < halves.size(); i += 4) {
      largest = std::max(largest, filter_radius(input.settings, half_to_float(halves[i])));
    }
    of_row[static_cast<std::size_t>(y)] = largest;
  });
  return *std::max_element(of_row.begin(), of_row.end());
}

}  // namespace softfocus
