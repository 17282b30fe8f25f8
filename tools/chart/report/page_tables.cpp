#include "tools/chart/report/page_tables.h"

#include <algorithm>
#include <cmath>

#include "tools/bench/timing.h"
#include "tools/chart/report/point_links.h"
#include "tools/cli/option_values.h"
#include "tools/report/html.h"

namespace softfocus {
namespace {

constexpr int kFlipPlaces = kPictureErrors[0].places, kRatioPlaces = 2;

std::string ms_cell(double ms) { return number_cell(ms, ms_text(ms)); }

bool is_of_shadows(const ChartPanel& panel) {
  return panel.ranked[0].value == kShadowErrors[0].value;
}

bool is_of_turns(const ChartPanel& panel) { return panel.ranked[1].value == kTurnErrors[1].value; }

std::string error_cells(const ChartPanel& panel, const ChartErrors& errors) {
  std::string cells = is_of_shadows(panel) ? number_cell(errors.wrong_pixels, 0) : "";
  if (is_of_turns(panel)) {
    cells += number_cell(errors.outline_px, kTurnErrors[1].places) +
             number_cell(errors.renewals, 0) + number_cell(errors.megabytes, 2);
  }
  cells += number_cell(errors.psnr_db, 2) + number_cell(errors.ssim, 4) +
           number_cell(errors.flip, kFlipPlaces);
  for (const double flip : errors.flip_by_region) cells += number_cell(flip, kFlipPlaces);
  cells += number_cell(errors.hdr_flip, kFlipPlaces);
  for (const double flip : errors.hdr_flip_by_region) cells += number_cell(flip, kFlipPlaces);
  return cells;
}

std::string point_row(const ChartPanel& panel, const ChartPoint& point) {
  const std::vector<double>& filter_ms = point.times.filter_ms;
  const auto rounds = static_cast<double>(point.times.frame_ms.size());
  return std::string{point.on_front ? "<tr class=\"best\">" : "<tr>"} +
         word_cell(html_text(panel.scene)) + word_cell(method_link(panel, point)) +
         word_cell(html_text(settings_text(point.entry))) + ms_cell(point.median_ms) +
         number_cell(point.pinhole_frames, kRatioPlaces) +
         ms_cell(filter_ms.empty() ? kNotTimed : spread_of(filter_ms).median) +
         error_cells(panel, point.errors) + number_cell(rounds, 0) + "</tr>\n";
}

std::string floor_row(const ChartPanel& panel) {
  const std::string none = number_cell(kNotTimed, "");
  return "<tr>" + word_cell(html_text(panel.scene)) + word_cell("noise of the truth") +
         word_cell("half its " + std::to_string(panel.truth_samples) + " samples against half") +
         none + none + none + error_cells(panel, panel.noise_floor) + none + "</tr>\n";
}

const ChartPanel& panel_of(const std::vector<ChartPanel>& panels, const std::string& scene) {
  return *std::find_if(panels.begin(), panels.end(),
                       [&](const ChartPanel& panel) { return panel.scene == scene; });
}

std::string over_cells(const OverScenes& of, int places) {
  return number_cell(of.median, places) + number_cell(of.p90, places) +
         number_cell(of.worst, places);
}

}  // namespace

std::string points_table(const std::vector<ChartPanel>& panels) {
  std::string rows;
  for (const ChartPanel& panel : panels) {
    for (const ChartPoint& point : panel.points) rows += point_row(panel, point);
    rows += floor_row(panel);
  }
  std::vector<Column> columns{{"scene", true}, {"method", true},   {"settings", true},
                              {"frame, ms"},   {"pinhole frames"}, {"filter, ms"}};
  if (is_of_shadows(panels.front())) columns.push_back({"wrong pixels"});
  if (is_of_turns(panels.front())) {
    for (const char* name : {"outline, px", "renewals", "MB"}) columns.push_back({name});
  }
  for (const char* name : {"PSNR, dB", "SSIM", "FLIP", "silhouette", "near", "focus", "far",
                           "HDR-FLIP", "silhouette", "near", "focus", "far", "rounds"}) {
    columns.push_back({name});
  }
  return table_of("results", table_head(columns), rows);
}

std::string best_table(const std::vector<ChartPanel>& panels,
                       const std::vector<BestForBudget>& best) {
  std::string rows;
  for (const BestForBudget& of : best) {
    const RankedError& ranked = of.ranked;
    const ChartPanel& panel = panel_of(panels, of.scene);
    if (of.rank == 0) {
      rows += "<tr>" + word_cell(html_text(of.scene)) +
              (std::isfinite(of.budget) ? number_cell(of.budget, short_number(of.budget))
                                        : "<td data-n=\"1e9\">any</td>");
    }
    rows += word_cell(method_link(panel, *of.point)) +
            word_cell(html_text(settings_text(of.point->entry))) +
            number_cell(of.point->errors.*ranked.value, ranked.places) +
            number_cell(of.point->pinhole_frames, kRatioPlaces);
    if (of.rank + 1 == panel.ranked.size()) rows += "</tr>\n";
  }
  std::vector<Column> columns{{"scene", true}, {"budget, pinhole frames"}};
  for (const RankedError& ranked : panels.front().ranked) {
    const std::string title{ranked.title};
    for (const Column& column : {Column{"least " + title, true}, Column{"settings", true},
                                 Column{title}, Column{"pinhole frames"}}) {
      columns.push_back(column);
    }
  }
  return table_of("best", table_head(columns), rows);
}

std::string summary_table(const std::vector<SummaryRow>& summary) {
  std::string rows;
  for (const SummaryRow& row : summary) {
    rows +=
        std::string{row.settings == kBestSetting ? "<tr class=\"best\">" : "<tr>"} +
        word_cell(html_text(row.method)) + word_cell(html_text(row.settings)) +
        number_cell(row.scenes, 0) + number_cell(row.pinhole_frames.median, kRatioPlaces) +
        over_cells(row.ratios[0], kRatioPlaces) + word_cell(html_text(row.ratios[0].worst_scene)) +
        over_cells(row.errors[0], row.ranked[0].places) +
        word_cell(html_text(row.errors[0].worst_scene)) + over_cells(row.ratios[1], kRatioPlaces) +
        over_cells(row.errors[1], row.ranked[1].places) + "</tr>\n";
  }
  const RankedErrors& ranked = summary.front().ranked;
  const std::string first{ranked[0].title}, second{ranked[1].title};
  return table_of("summary",
                  table_head({{"method", true},
                              {"settings", true},
                              {"scenes"},
                              {"pinhole frames"},
                              {first + " ratio: median"},
                              {"90 %"},
                              {"worst"},
                              {"on", true},
                              {first + ": median"},
                              {"90 %"},
                              {"worst"},
                              {"on", true},
                              {second + " ratio: median"},
                              {"90 %"},
                              {"worst"},
                              {second + ": median"},
                              {"90 %"},
                              {"worst"}}),
                  rows);
}

}  // namespace softfocus
