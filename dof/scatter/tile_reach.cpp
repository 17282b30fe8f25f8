#include "dof/scatter/tile_reach.h"

namespace softfocus {
namespace {

// Calls visit(other) for tiles that a tile's discs can touch, its own included, until it
// returns true.
template <class Visit>
bool visit_touched(const TileReach& reach, std::size_t tile, const Visit& visit) {
  if (reach.reach_px[tile] < 0) return false;
  const int tiles = (reach.reach_px[tile] + kReachTile) / kReachTile;
  const int x = static_cast<int>(tile) % reach.width, y = static_cast<int>(tile) / reach.width;
  for (int to_y = std::max(y - tiles, 0); to_y <= std::min(y + tiles, reach.height - 1); ++to_y) {
    for (int to_x = std::max(x - tiles, 0); to_x <= std::min(x + tiles, reach.width - 1); ++to_x) {
      if (visit(static_cast<std::size_t>(to_y * reach.width + to_x))) return true;
    }
  }
  return false;
}

}  // namespace

TileMask full_mask(int width_px, int height_px) {
  TileMask mask{
      (width_px + kReachTile - 1) / kReachTile, (height_px + kReachTile - 1) / kReachTile, {}};
  mask.set.assign(static_cast<std::size_t>(mask.width * mask.height), 1);
  return mask;
}

TileMask both(const TileMask& a, const TileMask& b) {
  TileMask mask = a;
  for (std::size_t i = 0; i < mask.set.size(); ++i) mask.set[i] = a.set[i] & b.set[i];
  return mask;
}

TileMask touched(const TileReach& reach) {
  TileMask mask{reach.width, reach.height, std::vector<char>(reach.reach_px.size(), 0)};
  for (std::size_t tile = 0; tile < mask.set.size(); ++tile) {
    visit_touched(reach, tile, [&](std::size_t other) {
      mask.set[other] = 1;
      return false;
    });
  }
  return mask;
}

TileMask touching(const TileReach& reach, const TileMask& mask) {
  TileMask result{reach.width, reach.height, std::vector<char>(reach.reach_px.size(), 0)};
  for (std::size_t tile = 0; tile < mask.set.size(); ++tile) {
    const bool touches =
        visit_touched(reach, tile, [&](std::size_t other) { return mask.set[other] != 0; });
    result.set[tile] = touches ? 1 : 0;
  }
  return result;
}

}  // namespace softfocus
