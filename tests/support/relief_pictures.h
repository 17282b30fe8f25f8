#pragma once
// Relief textures with known answers.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "scenes/relief/warp/resample.h"
#include "tests/support/random.h"

namespace softfocus::test {

/// A plane that looks along -z, texels of a centimetre, `depth_m` deep; all empty.
inline ReliefTexture empty_relief(int width, int height, int depth_bits, double depth_m) {
  ReliefTexture relief;
  relief.width = width;
  relief.height = height;
  relief.depth_bits = depth_bits;
  relief.camera = {{-0.005 * (width - 1), 0.005 * (height - 1), 0.0},
                   {0.01, 0.0, 0.0},
                   {0.0, -0.01, 0.0},
                   {0.0, 0.0, -1.0},
                   depth_m};
  const auto texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  relief.depths.assign(texels, empty_depth(depth_bits));
  relief.colours.assign(texels, 0);
  return relief;
}

/// These texels under a perspective camera, whose eye is farther before the plane than the relief
/// is deep.
inline ReliefTexture seen_from_eye(ReliefTexture relief, glm::dvec3 eye) {
  relief.camera.eye = eye;
  return relief;
}

inline std::size_t texel_at(const ReliefTexture& relief, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(relief.width) +
         static_cast<std::size_t>(x);
}

/// The front half of a sphere that touches the plane, coloured by place.
inline ReliefTexture sphere_relief(int size, int depth_bits) {
  const double radius = 0.5 * size - 1.0;
  ReliefTexture relief = empty_relief(size, size, depth_bits, radius * 0.01);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double dx = x - 0.5 * (size - 1), dy = y - 0.5 * (size - 1);
      const double square = radius * radius - dx * dx - dy * dy;
      if (square < 0.0) continue;
      const double share = 1.0 - std::sqrt(square) / radius;
      relief.depths[texel_at(relief, x, y)] =
          static_cast<std::uint16_t>(std::lrint(share * last_depth(depth_bits)));
      const auto red = static_cast<std::uint32_t>(40 + 170 * x / size);
      const auto green = static_cast<std::uint32_t>(40 + 170 * y / size);
      relief.colours[texel_at(relief, x, y)] = red | green << 8 | 100u << 16 | 0xFF000000u;
    }
  }
  return relief;
}

/// Steps, slopes and holes.
inline ReliefTexture rough_relief(int width, int height, int depth_bits, std::uint64_t seed) {
  Random random{seed};
  ReliefTexture relief = empty_relief(width, height, depth_bits, 0.3);
  const auto below = [&](int end) { return random.whole(0, end - 1); };
  for (int patch = 0; patch < 24; ++patch) {
    const int x0 = below(width), y0 = below(height), w = 1 + below(width),
              h = 1 + below(height / 2);
    const int code = below(last_depth(depth_bits)), slope = below(5) - 2;
    const auto colour = static_cast<std::uint32_t>(below(1 << 24)) | 0xFF000000u;
    for (int y = y0; y < std::min(y0 + h, height); ++y) {
      for (int x = x0; x < std::min(x0 + w, width); ++x) {
        const int sloped = std::min(std::max(code + slope * (x - x0), 0), last_depth(depth_bits));
        const bool is_hole = patch % 6 == 5;
        relief.depths[texel_at(relief, x, y)] =
            is_hole ? empty_depth(depth_bits) : static_cast<std::uint16_t>(sloped);
        relief.colours[texel_at(relief, x, y)] = is_hole ? 0 : colour;
      }
    }
  }
  return relief;
}

inline std::vector<WarpRule> all_warps() {
  std::vector<WarpRule> all;
  for (const NamedResampling& choice : kResamplings) {
    for (const PlaceNumbers numbers : {PlaceNumbers::floats, PlaceNumbers::fixed}) {
      all.push_back({choice.resampling, numbers, WarpRule::kJoinAll});
    }
  }
  return all;
}

inline WarpedRelief warped(const ReliefTexture& relief, glm::dvec3 eye, const WarpRule& rule,
                           ThreadPool& pool, WarpCounts* counts = nullptr) {
  const ReliefExtent extent = *relief_extent(relief);
  WarpedRelief result;
  warp_relief(relief, extent, eye, *warped_extent(relief, extent, eye), rule, result, pool, counts);
  return result;
}

/// A texel of the plane; 0 outside.
inline std::uint32_t plane_colour(const WarpedRelief& of, int u, int v) {
  const int x = u - of.place.x_begin, y = v - of.place.y_begin;
  if (x < 0 || y < 0 || x >= of.place.width || y >= of.place.height) return 0;
  return of.colours[static_cast<std::size_t>(y) * static_cast<std::size_t>(of.place.width) +
                    static_cast<std::size_t>(x)];
}

}  // namespace softfocus::test
