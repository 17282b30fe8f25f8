#include "scenes/filtered_views/view_spread.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <glm/vec3.hpp>
#include <limits>

#include "raster/images/texel.h"

namespace softfocus {
namespace {

constexpr double kLevelsPerPx = 1.5;  // in focus

// Of round'(), for levels whose rays stay where they are.
constexpr double kNoStep = -kMostSpreadStep;

double axis_of(glm::dvec2 point, int axis) { return axis == 0 ? -point.x : point.y; }

double rounded(double v, double t) {
  const double whole = std::fmax(std::floor(std::fabs(v) + t), 0.0);
  return v < 0.0 ? -whole : whole;
}

// Of a pixel's places along an axis.
constexpr double kPixelMeanSquare = 1.0 / 12.0;

// The t with which the points keep their mean square along the axis, and the pixel its own.
double rounding_of(const LensCells& cells, int axis, double radius_px) {
  std::vector<double> view, step;
  double wanted = 0.0;
  bool jitter = false;
  for (std::size_t i = 0; i < cells.points.size(); ++i) {
    const std::size_t cell = i / static_cast<std::size_t>(cells.per_cell);
    const double in_pixel = cells.in_pixel[cell][axis];
    const double at_view = axis_of(cells.views[cell], axis) * radius_px;
    const double beside = axis_of(cells.points[i], axis) * radius_px;
    wanted += (at_view + beside) * (at_view + beside);
    view.push_back(at_view + in_pixel);
    step.push_back(beside - in_pixel);
    jitter = jitter || in_pixel != 0.0;
  }
  if (jitter) wanted += kPixelMeanSquare * static_cast<double>(cells.points.size());
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  constexpr int kTries = 32;
  for (int i = 0; i <= kTries; ++i) {
    const double t = static_cast<double>(i) / kTries;
    double found = 0.0;
    for (std::size_t k = 0; k < view.size(); ++k) {
      const double at = view[k] + rounded(step[k], t);
      found += at * at;
    }
    const double off = std::fabs(found - wanted);
    if (off < least) {
      least = off;
      best = t;
    }
  }
  return best;
}

}  // namespace

ViewSpread make_view_spread(const PixelCoc& coc, const LensCells& cells) {
  double longest = 0.0;
  for (const glm::dvec2 point : cells.points) {
    longest = std::max({longest, std::fabs(point.x), std::fabs(point.y)});
  }
  ViewSpread spread{coc, static_cast<float>(kLevelsPerPx), 0.0f, {}, {}};
  // The last level's radius is that of the longest step, less what rounding may add.
  constexpr double kLast = kMostSpreadLevel;
  const double last_px = (kMostSpreadStep - 1) / std::max(longest, 1e-3);
  const double bend = std::max(kLevelsPerPx / kLast - 1.0 / last_px, 0.0);
  spread.bend_per_px = static_cast<float>(bend);
  const double least_px = least_step_px(cells);
  for (int level = 0; level <= kMostSpreadLevel; ++level) {
    const double radius_px = std::min(level / (kLevelsPerPx - bend * level), last_px);
    spread.radius_px.push_back(radius_px);
    for (int axis = 0; axis < 2; ++axis) {
      spread.rounding[static_cast<std::size_t>(axis)].push_back(
          longest * radius_px < least_px ? kNoStep : rounding_of(cells, axis, radius_px));
    }
  }
  return spread;
}

int spread_level(const ViewSpread& spread, float depth_m) {
  constexpr float kLast = kMostSpreadLevel;
  // r and 1 + b |r|, both times the depth.
  const float radius = spread.coc.radius_at_infinity_px * (depth_m - spread.coc.focus_m);
  float level = spread.levels_per_px * radius / (depth_m + spread.bend_per_px * std::fabs(radius));
  level = level < kLast ? level : kLast;
  level = level > -kLast ? level : -kLast;
  return static_cast<int>(std::floor(level + 0.5f));
}

std::vector<PixelStep> ray_steps(const ViewSpread& spread, std::span<const glm::dvec2> points,
                                 glm::dvec2 in_pixel) {
  std::vector<PixelStep> steps;
  for (const glm::dvec2 point : points) {
    for (int level = -kMostSpreadLevel; level <= kMostSpreadLevel; ++level) {
      const auto number = static_cast<std::size_t>(std::abs(level));
      const double radius_px = level < 0 ? -spread.radius_px[number] : spread.radius_px[number];
      const auto along = [&](int axis) {
        const double t = spread.rounding[static_cast<std::size_t>(axis)][number];
        return static_cast<int>(rounded(axis_of(point, axis) * radius_px - in_pixel[axis], t));
      };
      steps.push_back({along(0), along(1)});
    }
  }
  return steps;
}

ColourPlanes spread_view_oracle(const ConstImageView& view, const ViewSpread& spread,
                                std::span<const PixelStep> steps, int rays) {
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  assert(steps.size() == static_cast<std::size_t>(rays * kSpreadLevels));
  std::vector<int> levels;
  levels.reserve(pixels);
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      levels.push_back(spread_level(spread, load_texel<Format::rgba16f>(view, x, y).w));
    }
  }
  struct Place {
    int x, y;
  };
  const auto moved = [&](Place p, int ray, int level) {
    const PixelStep step =
        steps[static_cast<std::size_t>(ray * kSpreadLevels + level + kMostSpreadLevel)];
    return Place{std::clamp(p.x + step.x, 0, view.width - 1),
                 std::clamp(p.y + step.y, 0, view.height - 1)};
  };
  const auto level_at = [&](Place p) {
    return levels[static_cast<std::size_t>(p.y * view.width + p.x)];
  };
  const auto seen = [&](Place p, int ray) {
    for (int level = -kMostSpreadLevel; level <= kMostSpreadLevel; ++level) {
      const Place q = moved(p, ray, level);
      if (level_at(q) == level) return q;
    }
    const Place q = moved(p, ray, level_at(p));
    return level_at(q) > level_at(p) ? q : p;
  };
  ColourPlanes planes(3 * pixels);
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      glm::vec3 sum{0.0f};
      for (int ray = 0; ray < rays; ++ray) {
        const Place q = seen({x, y}, ray);
        const glm::vec3 colour{load_texel<Format::rgba16f>(view, q.x, q.y)};
        sum = ray == 0 ? colour : sum + colour;
      }
      const std::size_t at = static_cast<std::size_t>(y * view.width + x);
      for (int c = 0; c < 3; ++c) {
        planes[static_cast<std::size_t>(c) * pixels + at] = sum[c] / static_cast<float>(rays);
      }
    }
  }
  return planes;
}

}  // namespace softfocus
