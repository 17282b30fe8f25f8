#pragma once
// Findings for the tests of what `chart` writes.

#include <limits>

#include "tools/chart/point.h"

namespace softfocus::test {

inline ChartPoint chart_point(const std::string& method, std::size_t setting,
                              std::vector<double> frame_ms, double flip) {
  ChartPoint point{.entry = chart_entries(method, 1024, false).at(setting)};
  point.picture_hash = 0x123;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  point.errors = {
      30.5, 0.875, flip, {0.5, kNone, 0, 0.25, 0.125}, 2 * flip, {0.75, kNone, 0, 0.5, 0.375}};
  point.worst = {3, 4, 16};
  point.pictures = {"AAAA", "BBBB", "CCCC", "DDDD", "EEEE"};
  if (point.entry.filter != nullptr) point.times.filter_ms.assign(frame_ms.size(), 2.5);
  point.times.frame_ms = std::move(frame_ms);
  return point;
}

/// Four points with times and pictures. two-pass at radius 8 beats two-pass at radius 16.
inline ChartPanel chart_panel(const std::string& scene) {
  ChartPanel panel;
  panel.scene = scene;
  panel.title = "A <title>";
  panel.truth_samples = 512;
  panel.noise_floor = {
      60, 0.999, 0.002, {0.003, 0.002, 0.001, 0.002}, 0.004, {0.006, 0.004, 0.002, 0.004}};
  panel.truth_picture = "FFFF";
  panel.points = {chart_point("pinhole", 0, {7, 5, 6}, 0.2),
                  chart_point("two-pass", 0, {12, 10, 30}, 0.1),
                  chart_point("two-pass", 1, {12, 13, 14, 15}, 0.1),
                  chart_point("accumulation", 3, {700}, 0.01)};
  settle_points(panel);
  return panel;
}

}  // namespace softfocus::test
