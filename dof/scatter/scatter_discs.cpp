#include "dof/scatter/scatter_discs.h"

#include <cmath>

namespace softfocus {
namespace {

// Half the area of a disc in a row of pixels, by the midpoint rule.
double mean_half_width(double radius, int dy) {
  constexpr int kSteps = 16;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double y = dy - 0.5 + (i + 0.5) / kSteps;
    const double square = radius * radius - y * y;
    if (square > 0.0) sum += std::sqrt(square);
  }
  return sum / kSteps;
}

}  // namespace

ScatterDiscs make_discs(float largest_px, std::span<const std::uint8_t> used) {
  ScatterDiscs discs;
  discs.count = disc_of(largest_px) + 1;
  discs.reach = static_cast<int>(std::ceil(0.25 * (discs.count - 1) + 0.5)) - 1;
  if (discs.reach < 0) discs.reach = 0;
  const auto count = static_cast<std::size_t>(discs.count);
  discs.spans.assign(count * static_cast<std::size_t>(discs.reach + 1), DiscSpan{-2, 0});
  discs.reaches.assign(count, 0);
  discs.weights.assign(count, 1.0f);
  for (std::size_t disc = 0; disc < count; ++disc) {
    discs.spans[disc] = {0, 0};
    if (disc <= 2 || (!used.empty() && used[disc] == 0)) continue;
    const double radius = 0.25 * static_cast<double>(disc);
    std::int64_t eighths = 0;
    for (int dy = 0; dy <= discs.reach; ++dy) {
      const int half_width = static_cast<int>(8.0 * mean_half_width(radius, dy) + 0.5);
      if (half_width == 0) break;
      discs.spans[static_cast<std::size_t>(dy) * count + disc] = {
          static_cast<std::int16_t>((half_width + 4) / 8 - 1),
          static_cast<std::int16_t>((half_width + 4) % 8)};
      discs.reaches[disc] = dy;
      eighths += (dy == 0 ? 2 : 4) * half_width;
    }
    discs.weights[disc] = static_cast<float>(8.0 / static_cast<double>(eighths));
  }
  return discs;
}

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
