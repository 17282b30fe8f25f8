#include "tools/chart/point.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/support/chart_points.h"

using namespace softfocus;

namespace {

using Indices = std::vector<std::size_t>;

Indices front_of(const std::vector<TwoCosts>& contenders) { return pareto_front(contenders); }

}  // namespace

TEST_CASE("front: what another beats in time and in error is not on it") {
  CHECK(front_of({{2, 0.5}, {1, 0.9}, {3, 0.6}, {4, 0.1}}) == Indices{1, 0, 3});
}

TEST_CASE("front: being as good in one and worse in the other is being beaten") {
  CHECK(front_of({{1, 0.5}, {1, 0.4}, {2, 0.4}}) == Indices{1});
}

TEST_CASE("front: equal ones are all on it, in their order") {
  CHECK(front_of({{5, 0.2}, {1, 0.5}, {1, 0.5}}) == Indices{1, 2, 0});
}

TEST_CASE("front: one alone is on it, of none there is none, NaN is never on it") {
  CHECK(front_of({{7, 7}}) == Indices{0});
  CHECK(front_of({}).empty());
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  CHECK(front_of({{kNan, 0.1}, {1, kNan}, {2, 0.2}}) == Indices{2});
}

TEST_CASE("chart: a point's time is the median of its rounds") {
  const ChartPanel panel = test::chart_panel("figures");
  CHECK(panel.points[0].median_ms == 6.0);
  CHECK(panel.points[1].median_ms == 12.0);
  CHECK(panel.points[2].median_ms == 13.5);
}

TEST_CASE("chart: the front leaves out what is slower and no nearer to the truth") {
  const ChartPanel panel = test::chart_panel("figures");
  CHECK(panel.points[0].on_front);
  CHECK(panel.points[1].on_front);
  CHECK_FALSE(panel.points[2].on_front);
  CHECK(panel.points[3].on_front);
}

TEST_CASE("chart: auto makes no front, and is on it if no fixed method as near is a tenth faster") {
  const auto panel_with = [](double ms, double flip) {
    ChartPanel panel = test::chart_panel("figures");
    panel.points.push_back(test::chart_point("auto", 0, {ms}, flip));
    settle_points(panel);
    return panel;
  };
  // two-pass takes 12 ms for 0.1.
  CHECK(panel_with(13.1, 0.1).points.back().on_front);
  CHECK_FALSE(panel_with(13.3, 0.1).points.back().on_front);
  CHECK(panel_with(13.3, 0.09).points.back().on_front);
  const ChartPanel better = panel_with(5.0, 0.001);
  CHECK(better.points.back().on_front);
  CHECK(better.points[1].on_front);
}

TEST_CASE("chart: times are also in frames of the scene's pinhole") {
  const ChartPanel panel = test::chart_panel("figures");
  CHECK(panel.points[0].pinhole_frames == 1.0);
  CHECK(panel.points[2].pinhole_frames == 13.5 / 6.0);
}

TEST_CASE("chart: a series' best setting is that with the least FLIP, of equal ones the first") {
  ChartPanel panel = test::chart_panel("figures");
  const auto best = [&] {
    settle_points(panel);
    std::vector<bool> list;
    for (const ChartPoint& point : panel.points) list.push_back(point.best_setting);
    return list;
  };
  CHECK(best() == std::vector<bool>{true, true, false, true});
  panel.points[2].errors.flip = 0.09;
  CHECK(best() == std::vector<bool>{true, false, true, true});
}

TEST_CASE("chart: without times there is no front, and the best settings are there") {
  ChartPanel panel = test::chart_panel("figures");
  CHECK(has_times(panel));
  for (ChartPoint& point : panel.points) point.times = {};
  panel.points.push_back(test::chart_point("auto", 0, {}, 0.1));
  settle_points(panel);
  CHECK_FALSE(has_times(panel));
  for (const ChartPoint& point : panel.points) {
    CHECK_FALSE(point.on_front);
    CHECK(std::isnan(point.median_ms));
    CHECK(std::isnan(point.pinhole_frames));
  }
  CHECK(panel.points[1].best_setting);
}
