#include "tools/chart/report/summary.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/support/chart_points.h"
#include "tools/report/report.h"

using namespace softfocus;

TEST_CASE("chart: JSON has an entry for each point of each scene, with every key") {
  const Json list = chart_json({test::chart_panel("figures"), test::chart_panel("other")});
  REQUIRE(list.values().size() == 8);
  CHECK(list.at(4).at("scene").text() == "other");
  CHECK(json_text(list.at(1)) ==
        R"({"scene":"figures","method":"two-pass","settings":{"max_coc_px":8.0,"profile":"ieee"},)"
        R"("median_ms":12.0,"pinhole_frames":2.0,"psnr_db":30.5,"ssim":0.875,)"
        R"("flip":0.1,"flip_silhouette":0.5,"flip_near":null,"flip_focus":0.0,"flip_far":0.25,)"
        R"("flip_edge":0.125,)"
        R"("hdr_flip":0.2,"hdr_flip_silhouette":0.75,"hdr_flip_near":null,"hdr_flip_focus":0.0,)"
        R"("hdr_flip_far":0.5,"hdr_flip_edge":0.375,"filter_ms":2.5,"rounds":3,"on_front":true,)"
        R"("best_setting":true,)"
        R"("truth_samples":512,"noise_floor_flip":0.002,"noise_floor_hdr_flip":0.004,)"
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
  const std::string csv = csv_of(chart_json({test::chart_panel("a, \"b\"")}));
  const std::string head =
      "scene,method,settings,median_ms,pinhole_frames,psnr_db,ssim,flip,flip_silhouette,flip_near,"
      "flip_focus,flip_far,flip_edge,hdr_flip,hdr_flip_silhouette,hdr_flip_near,hdr_flip_focus,"
      "hdr_flip_far,hdr_flip_edge,filter_ms,rounds,on_front,best_setting,truth_samples,"
      "noise_floor_flip,noise_floor_hdr_flip,"
      "noise_floor_psnr_db,picture_hash\n";
  CHECK(csv.starts_with(head));
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 5);
  CHECK(
      csv.find("\"a, \"\"b\"\"\",two-pass,max_coc_px=8.0;profile=ieee,12.0,2.0,30.5,0.875,0.1,0.5,"
               ",0.0,0.25,0.125,0.2,0.75,,0.0,0.5,0.375,2.5,3,true,true,512,0.002,0.004,60.0,"
               "0x0000000000000123\n") != csv.npos);
  CHECK(csv.find(",,1,true,true,512") != csv.npos);
}

TEST_CASE("chart: without times whatever needs them is null") {
  ChartPanel panel = test::chart_panel("figures");
  for (ChartPoint& point : panel.points) point.times = {};
  settle_points(panel);
  const Json point = chart_json({panel}).at(1);
  for (const char* name : {"median_ms", "pinhole_frames", "filter_ms", "on_front"}) {
    CAPTURE(name);
    CHECK(point.at(name).is_null());
  }
  CHECK(point.at("rounds").integer() == 0);
  CHECK(point.at("best_setting").boolean());
  const Json summary = summary_json(summary_of({panel}));
  CHECK(summary.at(1).at("flip_ratio_median").is_null());
  CHECK(summary.at(1).at("flip_median").number() == 0.1);
}

TEST_CASE("chart: the best for a budget, and the summary, as CSV") {
  const std::vector<ChartPanel> panels{test::chart_panel("figures")};
  const std::string best = csv_of(best_json(best_for_budgets(panels)));
  CHECK(
      best.starts_with("scene,budget,measure,method,settings,error,pinhole_frames,median_ms\n"
                       "figures,1.25,flip,pinhole,profile=ieee,0.2,1.0,6.0\n"
                       "figures,1.25,hdr_flip,pinhole,profile=ieee,0.4,1.0,6.0\n"));
  CHECK(
      best.ends_with("figures,,flip,accumulation,samples=64,0.01,116.66666666666667,700.0\n"
                     "figures,,hdr_flip,accumulation,samples=64,0.02,116.66666666666667,700.0\n"));
  const std::string summary = csv_of(summary_json(summary_of(panels)));
  CHECK(summary.starts_with(
      "method,settings,scenes,pinhole_frames_median,pinhole_frames_worst,flip_ratio_median,"
      "flip_ratio_p90,flip_ratio_worst,flip_ratio_worst_scene,flip_median,flip_p90,flip_worst,"
      "flip_worst_scene,hdr_flip_ratio_median,hdr_flip_ratio_p90,hdr_flip_ratio_worst,"
      "hdr_flip_ratio_worst_scene,hdr_flip_median,hdr_flip_p90,hdr_flip_worst,"
      "hdr_flip_worst_scene\n"
      "pinhole,,1,1.0,1.0,1.0,1.0,1.0,figures,0.2,0.2,0.2,figures,1.0,1.0,1.0,figures,0.4,0.4,0.4,"
      "figures\n"));
}
