#include "dof/ray_distribution/ray_distribution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "dof/ray_distribution/behind.h"
#include "dof/ray_distribution/patch.h"
#include "raster/numbers/exact_math.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

// How far the picture's border is repeated, at most: more would take long for small pictures.
constexpr int kMostBefore = 64;

// The means of a patch's sums, its own pixels where nothing was added.
void store_patch(const DofInput& input, const Planes& scene, Patch& patch, const ImageView& result,
                 Isa isa) {
  const int columns = std::min(kPatchColumns, scene.width - patch.x);
  const int rows = std::min(kPatchRows, scene.height - patch.y);
  for (int y = 0; y < rows; ++y) {
    float* sums = patch.sums.data() + y * kSumStride;
    const float* count = sums + 3 * kSumPlane;
    for (int c = 0; c < 3; ++c) {
      float* sum = sums + c * kSumPlane;
      const float* own = plane_row(scene, c, patch.y + y) + patch.x;
      for (int x = 0; x < columns; ++x) sum[x] = count[x] > 0.0f ? sum[x] / count[x] : own[x];
    }
    store_span(input, result, patch.x, patch.y + y, columns, sums, sums + kSumPlane,
               sums + 2 * kSumPlane, isa);
  }
}

}  // namespace

std::vector<LensPoint> distribution_points(float largest_px) {
  const int pairs = largest_px <= 1.5f    ? 16
                    : largest_px <= 6.0f  ? 32
                    : largest_px <= 32.0f ? 64
                                          : 128;
  std::vector<LensPoint> points;
  for (int i = 0; i < pairs; ++i) {
    const double turns = 0.6180339887498949 * i;
    const double degrees = 180.0 * (turns - std::floor(turns));
    const double radius = std::sqrt((i + 0.5) / pairs);
    const auto u = static_cast<float>(radius * exact_math::cos_degrees(degrees));
    const auto v = static_cast<float>(radius * exact_math::sin_degrees(degrees));
    points.push_back({u, v});
    points.push_back({-u, -v});
  }
  return points;
}

void ray_distribution(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const Planes scene = split_picture(input, pool);
  const std::vector<float> of_rows = largest_of_rows(scene, 3, pool);
  const float largest = *std::max_element(of_rows.begin(), of_rows.end());
  const int before =
      std::min((static_cast<int>(largest) + kReachTile) / kReachTile * kReachTile, kMostBefore);
  const Sheet visible = make_sheet(scene, before, pool);
  const Sheet hidden = make_sheet(guess_behind(scene, pool).pixels, before, pool);
  const std::vector<LensPoint> points = distribution_points(largest);
  const int across = (scene.width + kPatchColumns - 1) / kPatchColumns;
  const int down = (scene.height + kPatchRows - 1) / kPatchRows;
  for_each_with<Patch>(pool, across * down, [&](int task, auto& patch) {
    const Blocks blocks = begin_patch(visible, hidden, task % across * kPatchColumns,
                                      task / across * kPatchRows, patch);
    if (blocks != 0) {
      for (const LensPoint lens : points) {
        add_plane(visible, hidden, lens, blocks, patch, pool.isa());
      }
      finish_patch(visible, patch, pool.isa());
    }
    store_patch(input, scene, patch, result, pool.isa());
  });
}

}  // namespace softfocus
