#include "scenes/surface_splatting/hidden_points.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "dof/dof.h"
#include "raster/images/texel.h"

namespace softfocus {
namespace {

// Alpha's halves are off by up to 2^-11 of themselves.
constexpr double kBehind = 1.0 + 0x1p-10;

// 3 standard deviations of a circle's Gaussian, in radii.
constexpr double kReachOfRadius = 1.55;

}  // namespace

Farthest farthest_of(const Image& pinhole) {
  Farthest farthest;
  Farthest::Level first{pinhole.width, pinhole.height, {}};
  for (int y = 0; y < pinhole.height; ++y) {
    for (int x = 0; x < pinhole.width; ++x) {
      first.depth_m.push_back(load_texel<Format::rgba16f>(pinhole, x, y).w);
    }
  }
  farthest.levels.push_back(std::move(first));
  while (farthest.levels.back().width > 1 || farthest.levels.back().height > 1) {
    const Farthest::Level& from = farthest.levels.back();
    Farthest::Level next{(from.width + 1) / 2, (from.height + 1) / 2, {}};
    for (int y = 0; y < next.height; ++y) {
      for (int x = 0; x < next.width; ++x) {
        float most = 0.0f;
        for (int i = 0; i < 4; ++i) {
          const int from_x = std::min(2 * x + i % 2, from.width - 1);
          const int from_y = std::min(2 * y + i / 2, from.height - 1);
          most =
              std::max(most, from.depth_m[static_cast<std::size_t>(from_y * from.width + from_x)]);
        }
        next.depth_m.push_back(most);
      }
    }
    farthest.levels.push_back(std::move(next));
  }
  return farthest;
}

bool is_hidden(const Farthest& farthest, double radius_per_inverse, double x, double y,
               double inverse_depth, int step) {
  const int width = farthest.levels[0].width, height = farthest.levels[0].height;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  if (column < 0 || row < 0 || column >= width || row >= height) return false;
  const auto is_behind = [&](float depth_m) {
    return inverse_depth * static_cast<double>(depth_m) * kBehind < 1.0;
  };
  const float seen_m = farthest.at(0, column, row);
  if (!is_behind(seen_m)) return false;
  const double apart =
      std::fabs(radius_per_inverse * (1.0 / static_cast<double>(seen_m) - inverse_depth));
  if (!(apart < static_cast<double>(kLargestMaxCoc))) return false;
  // A point of a wider lattice lies between pixels.
  const int reach = std::max(static_cast<int>(kReachOfRadius * apart + 0.5), step > 1 ? 1 : 0);
  const auto level = static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(2 * reach)));
  if (level >= farthest.levels.size()) return false;
  const int right = std::min(column + reach, width - 1) >> level;
  const int bottom = std::min(row + reach, height - 1) >> level;
  for (int at_y = std::max(row - reach, 0) >> level; at_y <= bottom; ++at_y) {
    for (int at_x = std::max(column - reach, 0) >> level; at_x <= right; ++at_x) {
      if (!is_behind(farthest.at(level, at_x, at_y))) return false;
    }
  }
  return true;
}

}  // namespace softfocus
