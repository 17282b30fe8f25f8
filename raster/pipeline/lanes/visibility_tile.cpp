#include "raster/pipeline/lanes/visibility_tile.h"

namespace softfocus {

void forget_seen(VisibilityTile& tile) {
  tile.ids.fill(0);
  tile.triangles.clear();
  tile.runs.clear();
}

void begin_tile(VisibilityTile& tile, const Rectangle& area, const Image& depth,
                std::optional<float> clear_depth) {
  tile.area = area;
  forget_seen(tile);
  if (clear_depth) {
    tile.depth.fill(*clear_depth);
    return;
  }
  for (int y = 0; y < area.y_end - area.y_begin; ++y) {
    const float* from = row<float>(depth, area.y_begin + y).data() + area.x_begin;
    for (int x = 0; x < area.x_end - area.x_begin; ++x) tile.depth[place_of_pixel(x, y)] = from[x];
  }
}

void end_tile(const VisibilityTile& tile, Image& depth) {
  const Rectangle& area = tile.area;
  for (int y = 0; y < area.y_end - area.y_begin; ++y) {
    float* to = row<float>(depth, area.y_begin + y).data() + area.x_begin;
    for (int x = 0; x < area.x_end - area.x_begin; ++x) to[x] = tile.depth[place_of_pixel(x, y)];
  }
}

void shade_tile(const VisibilityTile& tile) {
  for (const VisibleRun& run : tile.runs) {
    run.draw->lane_steps->shade_seen(run.draw->recorded.get(), tile, run);
  }
}

}  // namespace softfocus
