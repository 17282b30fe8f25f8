#include "tools/chart/front.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tools/cli/timing.h"

namespace softfocus {
namespace {

bool beats(const TwoCosts& a, const TwoCosts& b) {
  return a.time <= b.time && a.error <= b.error && (a.time < b.time || a.error < b.error);
}

/// auto may take this many times the time of the method that it chose: it looks at the picture
/// first, and times vary from run to run.
constexpr double kChoosing = 1.1;

void settle_times(ChartPanel& panel) {
  double pinhole_ms = kNotTimed;
  for (ChartPoint& point : panel.points) {
    point.median_ms =
        point.times.frame_ms.empty() ? kNotTimed : spread_of(point.times.frame_ms).median;
    if (point.entry.method == kPinhole) pinhole_ms = point.median_ms;
  }
  for (ChartPoint& point : panel.points) point.pinhole_frames = point.median_ms / pinhole_ms;
}

void settle_front(ChartPanel& panel) {
  double ChartErrors::*const error = panel.ranked[0].value;
  std::vector<TwoCosts> costs;
  std::vector<ChartPoint*> fixed;
  for (ChartPoint& point : panel.points) {
    point.on_front = false;
    if (point.entry.max_error) continue;
    costs.push_back({point.median_ms, point.errors.*error});
    fixed.push_back(&point);
  }
  for (const std::size_t i : pareto_front(costs)) fixed[i]->on_front = true;
  for (ChartPoint& point : panel.points) {
    if (!point.entry.max_error || point.times.frame_ms.empty()) continue;
    point.on_front = std::none_of(fixed.begin(), fixed.end(), [&](const ChartPoint* other) {
      return other->errors.*error <= point.errors.*error &&
             other->median_ms * kChoosing < point.median_ms;
    });
  }
}

/// If several settings have one error, the first is taken: the smallest radius.
void settle_best_settings(ChartPanel& panel) {
  double ChartErrors::*const error = panel.ranked[0].value;
  for (ChartPoint& point : panel.points) {
    const std::string series = series_name(point.entry);
    point.best_setting = true;
    for (const ChartPoint& other : panel.points) {
      if (series_name(other.entry) != series) continue;
      const double others = other.errors.*error, own = point.errors.*error;
      if (others < own || (others == own && &other < &point)) {
        point.best_setting = false;
      }
    }
  }
}

}  // namespace

std::vector<std::size_t> pareto_front(std::span<const TwoCosts> contenders) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    const TwoCosts& own = contenders[i];
    const bool beaten = std::any_of(contenders.begin(), contenders.end(),
                                    [&](const TwoCosts& other) { return beats(other, own); });
    if (!beaten && !std::isnan(own.time) && !std::isnan(own.error)) front.push_back(i);
  }
  std::stable_sort(front.begin(), front.end(), [&](std::size_t a, std::size_t b) {
    return contenders[a].time < contenders[b].time;
  });
  return front;
}

void settle_points(ChartPanel& panel) {
  settle_times(panel);
  settle_front(panel);
  settle_best_settings(panel);
}

bool has_times(const ChartPanel& panel) {
  return std::none_of(panel.points.begin(), panel.points.end(),
                      [](const ChartPoint& point) { return point.times.frame_ms.empty(); });
}

}  // namespace softfocus
