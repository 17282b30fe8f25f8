#include "tools/chart/report.h"

#include <doctest/doctest.h>

#include "tests/support/chart_points.h"
#include "tools/files/json.h"

using namespace softfocus;

TEST_CASE("chart: a point's time is the median of its rounds") {
  const ChartPanel panel = test::chart_panel("figures");
  CHECK(panel.points[0].median_ms == 6.0);
  CHECK(panel.points[1].median_ms == 11.0);
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
  // two-pass takes 11 ms for 0.1.
  CHECK(panel_with(12.0, 0.1).points.back().on_front);
  CHECK_FALSE(panel_with(12.2, 0.1).points.back().on_front);
  CHECK(panel_with(12.2, 0.09).points.back().on_front);
  const ChartPanel better = panel_with(5.0, 0.001);
  CHECK(better.points.back().on_front);
  CHECK(better.points[1].on_front);
}

TEST_CASE("chart: JSON has an entry for each point of each scene, with every key") {
  const Json list = chart_json({test::chart_panel("figures"), test::chart_panel("other")});
  REQUIRE(list.values().size() == 8);
  CHECK(list.at(4).at("scene").text() == "other");
  CHECK(json_text(list.at(1)) ==
        R"({"scene":"figures","method":"two-pass","settings":{"max_coc_px":4.0,"profile":"ieee"},)"
        R"("median_ms":11.0,"psnr_db":30.5,"ssim":0.875,"flip":0.1,"flip_silhouette":0.5,)"
        R"("flip_near":null,"flip_focus":0.0,"flip_far":0.25,"filter_ms":2.5,"rounds":3,)"
        R"("on_front":true,"truth_samples":512,"noise_floor_flip":0.002,)"
        R"("noise_floor_psnr_db":60.0,"picture_hash":"0x0000000000000123"})");
  CHECK(json_text(list.at(3).at("settings")) == R"({"samples":64})");
  CHECK(list.at(3).at("filter_ms").is_null());
}

TEST_CASE("chart: an infinite PSNR is null") {
  ChartPanel panel = test::chart_panel("figures");
  panel.points[0].errors.psnr_db = std::numeric_limits<double>::infinity();
  CHECK(chart_json({panel}).at(0).at("psnr_db").is_null());
}

TEST_CASE("chart: CSV is names and a line for each point") {
  const std::string csv = chart_csv({test::chart_panel("a, \"b\"")});
  const std::string head =
      "scene,method,settings,median_ms,psnr_db,ssim,flip,flip_silhouette,flip_near,flip_focus,"
      "flip_far,filter_ms,rounds,on_front,truth_samples,noise_floor_flip,noise_floor_psnr_db,"
      "picture_hash\n";
  CHECK(csv.starts_with(head));
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 5);
  CHECK(
      csv.find("\"a, \"\"b\"\"\",two-pass,max_coc_px=4.0;profile=ieee,11.0,30.5,0.875,0.1,0.5,,0.0,"
               "0.25,2.5,3,true,512,0.002,60.0,0x0000000000000123\n") != csv.npos);
  CHECK(csv.find("accumulation,samples=64,700.0,30.5,0.875,0.01,0.5,,0.0,0.25,,1,true") !=
        csv.npos);
}
