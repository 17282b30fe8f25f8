#include "dof/mipmap/mip_levels.h"

#include <algorithm>
#include <cmath>

namespace softfocus {
namespace {

// The square up to which a circle counts as none.
constexpr double kSharpSquare = 0.25;

double square_of(int rung) { return rung == 0 ? 0.0 : std::ldexp(1.0, rung - 1); }

struct Quadrant {
  double weights[kMipReach + 1][kMipReach + 1];
  double variance;  // along an axis
};

// A disc with an edge one pixel soft.
Quadrant circular_filter(double radius) {
  Quadrant filter{};
  double sum = 0.0, moment = 0.0;
  for (int y = 0; y <= kMipReach; ++y) {
    for (int x = 0; x <= kMipReach; ++x) {
      const double distance = std::sqrt(static_cast<double>(x * x + y * y));
      const double weight = std::clamp(radius + 0.5 - distance, 0.0, 1.0);
      const double count = (x > 0 ? 2.0 : 1.0) * (y > 0 ? 2.0 : 1.0);
      filter.weights[y][x] = weight;
      sum += count * weight;
      moment += count * weight * 0.5 * (x * x + y * y);
    }
  }
  for (auto& row : filter.weights) {
    for (double& weight : row) weight /= sum;
  }
  filter.variance = moment / sum;
  return filter;
}

Quadrant filter_of_variance(double wanted) {
  if (wanted <= 0.0) return circular_filter(0.5);
  double low = 0.5, high = kMipReach + 0.5;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (circular_filter(middle).variance < wanted ? low : high) = middle;
  }
  return circular_filter(0.5 * (low + high));
}

// A disc's second moment along an axis is a quarter of its radius squared. In square pixels of
// a level, (1 - 4^-level) / 3 of it come with the size of the pixels: a twelfth by averaging
// 2x2 pixels level by level, a quarter by enlarging with weights of 3/4 and 1/4.
void set_filter(MipRung& rung, double square, int level) {
  const double pixel = std::ldexp(1.0, -2 * level);
  const Quadrant filter = filter_of_variance(0.25 * square * pixel - (1.0 - pixel) / 3.0);
  for (int y = 0; y <= kMipReach; ++y) {
    for (int x = 0; x <= kMipReach; ++x) {
      rung.weights[y][x] = static_cast<float>(filter.weights[y][x]);
      if (rung.weights[y][x] > 0.0f) rung.reach = std::max(x, y);
    }
  }
}

RungStep step_to(int rung) {
  const double begin = rung == 1 ? kSharpSquare : square_of(rung - 1);
  return {static_cast<float>(begin), static_cast<float>(1.0 / (square_of(rung) - begin))};
}

}  // namespace

std::vector<MipLevelRungs> make_mip_ladder(float largest_px) {
  std::vector<MipLevelRungs> levels;
  const double largest = static_cast<double>(largest_px) * static_cast<double>(largest_px);
  int rung = 0;
  do {
    const int level = static_cast<int>(levels.size());
    MipLevelRungs& rungs = levels.emplace_back();
    const int end = kFineMipRungs + kMipLevelRungs * level;
    for (int first = rung; rung < end; ++rung) {
      MipRung& made = rungs.rungs.emplace_back();
      made.square = static_cast<float>(square_of(rung));
      made.step = rung == first ? kAlways : step_to(rung);
      set_filter(made, square_of(rung), level);
    }
    rungs.beyond = step_to(rung);
  } while (square_of(rung - 1) < largest);
  levels.back().beyond = kNever;
  return levels;
}

}  // namespace softfocus
