// The chart's summary of all scenes: the best for a budget, and each contender.

#include "tools/chart/report/summary.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/chart_points.h"

using namespace softfocus;

namespace {

OverScenes over(const std::vector<double>& numbers) {
  std::vector<SceneNumber> list;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    list.push_back({numbers[i], std::to_string(i)});
  }
  return over_scenes(list);
}

/// "method setting" of the best for a budget by one of the errors.
std::string best_of(const std::vector<BestForBudget>& list, double budget, std::size_t ranked) {
  for (const BestForBudget& of : list) {
    if (of.budget == budget && of.rank == ranked) return entry_id(of.point->entry);
  }
  return "";
}

const SummaryRow& row_of(const std::vector<SummaryRow>& rows, const std::string& method,
                         std::string_view settings) {
  for (const SummaryRow& row : rows) {
    if (row.method == method && row.settings == settings) return row;
  }
  throw std::runtime_error("no such row");
}

}  // namespace

TEST_CASE("over scenes: the median, what nine of ten have at most, and the worst with its scene") {
  const OverScenes ten = over({1, 10, 2, 9, 3, 8, 4, 7, 5, 6});
  CHECK(ten.median == 5.5);
  CHECK(ten.p90 == 9.0);
  CHECK(ten.worst == 10.0);
  CHECK(ten.worst_scene == "1");
  CHECK(over({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}).p90 == 10.0);
  CHECK(over({3, 1}).p90 == 3.0);
  CHECK(over({4}).median == 4.0);
  CHECK(std::isnan(over({1, kNotTimed}).median));
  CHECK(std::isnan(over({}).worst));
}

TEST_CASE("best for a budget: the least error within it, of equal ones the fastest") {
  // two-pass takes 2 and 2.25 frames of the pinhole, both 0.1; accumulation 117, 0.01.
  std::vector<ChartPanel> panels{test::chart_panel("figures")};
  panels[0].points[2].errors.hdr_flip = 0.15;
  const auto best = best_for_budgets(panels);
  CHECK(best.size() == 2 * (kBudgets.size() + 1));
  CHECK(best_of(best, 1.5, 0) == "pinhole");
  CHECK(best_of(best, 2.0, 0) == "two-pass-r8");
  CHECK(best_of(best, 50.0, 0) == "two-pass-r8");
  CHECK(best_of(best, 2.0, 1) == "two-pass-r8");
  CHECK(best_of(best, 3.0, 1) == "two-pass-r16");
  CHECK(best_of(best, kAnyTime, 0) == "accumulation-s64");
}

TEST_CASE("best for a budget: without times only that in any time") {
  std::vector<ChartPanel> panels{test::chart_panel("figures")};
  for (ChartPoint& point : panels[0].points) point.times = {};
  settle_points(panels[0]);
  const auto best = best_for_budgets(panels);
  CHECK(best.size() == 2);
  CHECK(best_of(best, kAnyTime, 0) == "accumulation-s64");
}

TEST_CASE("summary: a ratio is over the least error within the contender's own time") {
  std::vector<ChartPanel> panels{test::chart_panel("a"), test::chart_panel("b"),
                                 test::chart_panel("c")};
  // On b two-pass is worse than what is faster; that accumulation is better does not count.
  panels[1].points[1].errors.flip = 0.5;
  panels[2].points[1].errors.flip = 0.3;
  for (ChartPanel& panel : panels) settle_points(panel);
  const auto rows = summary_of(panels);
  const SummaryRow& row = row_of(rows, "two-pass", "max-coc 8");
  CHECK(row.scenes == 3);
  CHECK(row.pinhole_frames.median == 2.0);
  CHECK(row.ratios[0].median == 0.3 / 0.2);
  CHECK(row.ratios[0].worst == 0.5 / 0.2);
  CHECK(row.ratios[0].worst_scene == "b");
  CHECK(row.ratios[1].worst == 1.0);
  CHECK(row.errors[0].median == 0.3);
  CHECK(row.errors[0].worst == 0.5);
  // On b and c the other radius is the best.
  const SummaryRow& best = row_of(rows, "two-pass", kBestSetting);
  CHECK(best.errors[0].worst == 0.1);
  CHECK(best.pinhole_frames.median == 2.25);
  // A series of one setting has no line for its best.
  CHECK(rows.size() == 5);
}

TEST_CASE("summary: errors below the noise of the truth count as that noise") {
  ChartPanel panel = test::chart_panel("a");
  panel.noise_floor.flip = 0.15;
  settle_points(panel);
  const SummaryRow row = row_of(summary_of({panel}), "accumulation", "64 samples");
  CHECK(row.ratios[0].worst == 1.0);
  panel.points[3].errors.flip = 0.12;
  panel.points[1].errors.flip = 0.0;
  CHECK(row_of(summary_of({panel}), "accumulation", "64 samples").ratios[0].worst == 1.0);
}

TEST_CASE("summary: auto is one contender whatever it chose, and may lack a scene") {
  std::vector<ChartPanel> panels{test::chart_panel("a"), test::chart_panel("b"),
                                 test::chart_panel("c")};
  for (std::size_t i = 0; i < 2; ++i) {
    ChartPoint point = test::chart_point("auto", 0, {20}, 0.02);
    point.entry.chosen = i == 0 ? "pinhole" : "disc-layers, radius 16";
    panels[i].points.push_back(point);
    settle_points(panels[i]);
  }
  const SummaryRow row = row_of(summary_of(panels), "auto", "max-error 0.05");
  CHECK(row.scenes == 2);
  CHECK(row.ratios[0].worst == 1.0);
}
