#include "tools/chart/contenders/bloom_truth.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdlib>
#include <glm/vec3.hpp>

#include "raster/images/texel.h"
#include "raster/passes/pyramid.h"

namespace softfocus {
namespace {

// Weights of offsets from `begin` on along both axes.
struct Taps {
  int begin = 0, side = 1;
  std::vector<double> weights{1.0};

  double& at(int x, int y) {
    return weights[static_cast<std::size_t>(y - begin) * static_cast<std::size_t>(side) +
                   static_cast<std::size_t>(x - begin)];
  }
};

Taps empty_taps(int begin, int side) {
  return {begin, side,
          std::vector<double>(static_cast<std::size_t>(side) * static_cast<std::size_t>(side))};
}

// Offsets -2 to 3: of the pixel pair under the smaller picture's.
constexpr int kDownBegin = -2, kDownTaps = 6;

double down_weight(int x, int y) {
  const auto distance = [](int d) { return static_cast<std::size_t>(d > 0 ? d - 1 : -d); };
  return kDownsample128ths[distance(y)][distance(x)] / 128.0;
}

// From pixels of level 0 to those of level i, mirrored.
Taps way_down(int levels) {
  Taps down;
  for (int level = 0; level < levels; ++level) {
    const int step = 1 << level;
    Taps next = empty_taps(down.begin - step * (kDownBegin + kDownTaps - 1),
                           down.side + step * (kDownTaps - 1));
    for (int y = kDownBegin; y < kDownBegin + kDownTaps; ++y) {
      for (int x = kDownBegin; x < kDownBegin + kDownTaps; ++x) {
        const double weight = down_weight(x, y);
        for (int v = down.begin; v < down.begin + down.side; ++v) {
          for (int u = down.begin; u < down.begin + down.side; ++u) {
            next.at(u - step * x, v - step * y) += weight * down.at(u, v);
          }
        }
      }
    }
    down = std::move(next);
  }
  return down;
}

// A line of weights of offsets from `begin` on.
struct Line {
  int begin = 0;
  std::vector<double> weights{1.0};
};

// Along each axis, from a pixel of level i to those of level 0.
Line way_up(int levels) {
  // kTent16ths of the even and of the odd pixels, in turn.
  constexpr int kUpBegin = -3;
  constexpr std::array kUp{kTent16ths[0], kTent16ths[3], kTent16ths[1], kTent16ths[2],
                           kTent16ths[2], kTent16ths[1], kTent16ths[3], kTent16ths[0]};
  Line up;
  for (int level = 0; level < levels; ++level) {
    const int step = 1 << level;
    Line next{
        up.begin + step * kUpBegin,
        std::vector<double>(up.weights.size() + static_cast<std::size_t>(step) * (kUp.size() - 1))};
    for (std::size_t tap = 0; tap < kUp.size(); ++tap) {
      for (std::size_t i = 0; i < up.weights.size(); ++i) {
        next.weights[i + tap * static_cast<std::size_t>(step)] += kUp[tap] / 16.0 * up.weights[i];
      }
    }
    up = std::move(next);
  }
  return up;
}

// Both axes of the way up, one after the other: rows of `wide`, then columns of the kernel.
void add_level(int level, double share, BloomKernel& kernel) {
  const Taps down = way_down(level);
  const Line up = way_up(level);
  const auto rows = static_cast<std::size_t>(down.side), taps = up.weights.size();
  const std::size_t side = rows + taps - 1;
  // The mean over the places in a pixel of the level.
  const double factor = share / static_cast<double>(1 << (2 * level));
  std::vector<double> wide(rows * side);
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t x = 0; x < rows; ++x) {
      const double weight = factor * down.weights[y * rows + x];
      for (std::size_t i = 0; i < taps; ++i) wide[y * side + x + i] += weight * up.weights[i];
    }
  }
  const auto whole = static_cast<std::size_t>(2 * kernel.reach + 1);
  const auto begin = static_cast<std::size_t>(down.begin + up.begin + kernel.reach);
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t i = 0; i < taps; ++i) {
      double* const row = &kernel.weights[(begin + y + i) * whole + begin];
      for (std::size_t x = 0; x < side; ++x) row[x] += up.weights[i] * wide[y * side + x];
    }
  }
}

}  // namespace

BloomKernel bloom_kernel(int levels, double spread) {
  assert(levels >= 1);
  BloomKernel kernel;
  // 3 pixels down and 3 up, of each level.
  kernel.reach = 6 * ((1 << levels) - 1);
  const auto whole = static_cast<std::size_t>(2 * kernel.reach + 1);
  kernel.weights.assign(whole * whole, 0.0);
  double left = 1.0;
  for (int level = 1; level <= levels; ++level) {
    const double share = level == levels ? left : left * (1.0 - spread);
    left *= spread;
    add_level(level, share, kernel);
  }
  return kernel;
}

Image bloom_truth(const BloomSettings& settings, const Image& picture, ThreadPool& pool) {
  assert(!settings.is_steady);
  const Profile profile{};
  const BrightPass pass = bright_pass_of(settings);
  Image bright = make_image(Format::rgba16f, picture.width, picture.height);
  find_bright_light(pass, picture, bright, profile, pool);
  const BloomKernel kernel = bloom_kernel(settings.levels, static_cast<double>(settings.spread));
  const int reach = kernel.reach;
  struct Source {
    int x, y;
    glm::dvec3 light;
  };
  std::vector<Source> sources;
  for (int y = -reach; y < picture.height + reach; ++y) {
    for (int x = -reach; x < picture.width + reach; ++x) {
      const glm::vec4 texel = load_texel<Format::rgba16f>(
          bright, std::clamp(x, 0, picture.width - 1), std::clamp(y, 0, picture.height - 1));
      const glm::dvec3 light{texel.x, texel.y, texel.z};
      if (light != glm::dvec3{0.0}) sources.push_back({x, y, light});
    }
  }
  Image result = make_image(Format::rgba16f, picture.width, picture.height);
  pool.for_each(picture.height, [&](int y) {
    std::vector<glm::dvec3> scattered(static_cast<std::size_t>(picture.width), glm::dvec3{0.0});
    for (const Source& source : sources) {
      if (std::abs(source.y - y) > reach) continue;
      const int begin = std::max(source.x - reach, 0);
      const int end = std::min(source.x + reach + 1, picture.width);
      for (int x = begin; x < end; ++x) {
        scattered[static_cast<std::size_t>(x)] +=
            source.light * kernel.at(x - source.x, y - source.y);
      }
    }
    for (int x = 0; x < picture.width; ++x) {
      const glm::vec4 own = load_texel<Format::rgba16f>(picture, x, y);
      const glm::vec4 light = load_texel<Format::rgba16f>(bright, x, y);
      const glm::dvec3& wide = scattered[static_cast<std::size_t>(x)];
      glm::vec4 sum = own;
      for (int c = 0; c < 3; ++c) {
        sum[c] = static_cast<float>(static_cast<double>(own[c]) +
                                    static_cast<double>(settings.strength) *
                                        (wide[c] - static_cast<double>(light[c])));
      }
      store_texel<Format::rgba16f>(result, x, y, sum, profile);
    }
  });
  return result;
}

}  // namespace softfocus
