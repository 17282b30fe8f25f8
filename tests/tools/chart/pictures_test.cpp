// Whose pictures the page shows.

#include "tools/chart/measure.h"

#include <doctest/doctest.h>

#include "tests/support/chart_points.h"

using namespace softfocus;

namespace {

std::vector<ChartPanel> panels_of(std::size_t scenes, std::size_t points_more) {
  std::vector<ChartPanel> panels;
  for (std::size_t i = 0; i < scenes; ++i) {
    ChartPanel panel = test::chart_panel(std::to_string(i));
    for (std::size_t k = 0; k < points_more; ++k) {
      panel.points.push_back(test::chart_point("one-pass", k % 4, {50}, 0.3));
    }
    settle_points(panel);
    panels.push_back(panel);
  }
  return panels;
}

}  // namespace

TEST_CASE("chart pictures: of few points all have some") {
  CHECK(pictured_points(panels_of(2, 0)).size() == 8);
  CHECK(expected_pictures(2, 4, 3) == 8);
}

TEST_CASE("chart pictures: of many points the best setting of each method") {
  auto panels = panels_of(4, 60);
  panels[1].points[2].errors.flip = 0.05;
  settle_points(panels[1]);
  const auto chosen = pictured_points(panels);
  // pinhole, two-pass, accumulation and one-pass on each.
  CHECK(chosen.size() == 4 * 4);
  CHECK(chosen[1].point == 1);
  CHECK(chosen[4 + 1].panel == 1);
  CHECK(chosen[4 + 1].point == 2);
  CHECK(expected_pictures(4, 64, 4) == 16);
}

TEST_CASE("chart pictures: of many scenes each method's worst") {
  auto panels = panels_of(kMostPanels + 1, 0);
  panels[3].points[1].errors.flip = 0.7;
  panels[3].points[2].errors.flip = 0.9;
  settle_points(panels[3]);
  const auto chosen = pictured_points(panels);
  REQUIRE(chosen.size() == 3);
  CHECK(chosen[0].panel == 0);
  CHECK(chosen[2].panel == 3);
  CHECK(chosen[2].point == 1);
  CHECK(expected_pictures(kMostPanels + 1, 4, 3) == 3);
}
