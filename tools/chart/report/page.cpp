#include "tools/chart/report/page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "tools/chart/measure.h"
#include "tools/chart/point.h"
#include "tools/cli/option_values.h"
#include "tools/cli/timing.h"
#include "tools/report/report.h"

namespace softfocus {
namespace {

constexpr int kFlipPlaces = kPictureErrors[0].places, kRatioPlaces = 2;

/// The point's place in the page.
std::string place_of(const ChartPanel& panel, const ChartPoint& point) {
  return panel.scene + "-" + entry_id(point.entry);
}

/// "two-pass, max-coc 16".
std::string full_name(const ChartPoint& point) {
  const std::string settings = settings_text(point.entry);
  return point.entry.method + (settings.empty() ? "" : ", " + settings);
}

std::string fixed(double value, int places) {
  std::string text(64, '\0');
  text.resize(
      static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.*f", places, value)));
  return text;
}

std::string error_text(const RankedError& error, double value) {
  return std::string{error.title} + " " + fixed(value, error.places);
}

// --- plots ---

/// On a logarithmic axis.
double shown_error(const ChartErrors& errors, const RankedError& error) {
  return std::max(errors.*error.value, error.least_shown);
}

/// The corners of the stair: until a point is reached, the one before it is the nearest to the
/// truth. auto makes no front.
Json front_series(const ChartPanel& panel, const RankedError& error,
                  std::vector<const ChartPoint*>& on_front) {
  std::vector<TwoCosts> costs;
  std::vector<const ChartPoint*> fixed_ones;
  double slowest_ms = 0.0;
  for (const ChartPoint& point : panel.points) {
    slowest_ms = std::max(slowest_ms, point.median_ms);
    if (point.entry.max_error) continue;
    costs.push_back({point.median_ms, shown_error(point.errors, error)});
    fixed_ones.push_back(&point);
  }
  Json corners = Json::array();
  for (const std::size_t i : pareto_front(costs)) {
    corners.push_back({{"x", costs[i].time}, {"y", costs[i].error}});
    on_front.push_back(fixed_ones[i]);
  }
  if (!on_front.empty()) {
    corners.push_back({{"x", slowest_ms}, {"y", corners.values().back().at("y")}});
  }
  return report_series("best for its time", "stair", std::move(corners));
}

/// Points by their series, in the order of its first: each method is a line along its settings;
/// auto's points are rings around those of what it chose.
class SeriesOfMethods {
 public:
  void add(const std::string& series, Json point) {
    const auto found =
        std::find_if(all_.begin(), all_.end(), [&](const auto& of) { return of.first == series; });
    Json& points = found != all_.end() ? found->second : all_.emplace_back(series, Json{}).second;
    points.push_back(std::move(point));
  }
  void append_to(std::vector<Json>& list) {
    for (auto& [series, points] : all_) {
      list.push_back(report_series(series, series == "auto" ? "ring" : "line", std::move(points)));
    }
  }

 private:
  std::vector<std::pair<std::string, Json>> all_;
};

Json panel_plot(const ChartPanel& panel, const RankedError& error) {
  std::vector<const ChartPoint*> on_front;
  std::vector<Json> all{front_series(panel, error, on_front)};
  if (!std::isnan(panel.noise_floor.*error.value)) {
    Json level = Json::object();
    level["y"] = shown_error(panel.noise_floor, error);
    all.push_back(report_series("noise of the truth", "level", json_list({level})));
  }
  SeriesOfMethods methods;
  for (const ChartPoint& point : panel.points) {
    Json json{{"x", point.median_ms},
              {"y", shown_error(point.errors, error)},
              {"text", full_name(point)}};
    if (std::find(on_front.begin(), on_front.end(), &point) != on_front.end()) {
      json["label"] = full_name(point);
    }
    if (!point.pictures.empty()) json["to"] = place_of(panel, point);
    methods.add(series_name(point.entry), std::move(json));
  }
  methods.append_to(all);
  const std::string title{error.title};
  return {{"title", panel.scene},
          {"about", "Time of a frame against " + title + " on " + panel.scene +
                        "; the table of all numbers has them"},
          {"x",
           {{"title", "whole frame, milliseconds: further left is faster"},
            {"short", "ms"},
            {"log", true}}},
          {"y",
           {{"title", (error.places > 0 ? "mean " + title + " against the truth"
                                        : title + " against the truth (0.5 is none)") +
                          ": lower is better"},
            {"short", title},
            {"log", true}}},
          {"series", json_list(all)}};
}

Json plots_json(const std::string& name, const std::vector<Json>& panels) {
  return {{"name", name}, {"panels", json_list(panels)}};
}

Json panels_part(const ChartPage& page, const RankedError& error, std::string name, bool is_first) {
  std::vector<Json> plots;
  for (const ChartPanel& panel : page.panels) plots.push_back(panel_plot(panel, error));
  std::replace(name.begin(), name.end(), '_', '-');
  Json part{{"id", name},
            {"title", "Time against " + std::string{error.title}},
            {"plots", plots_json(name, plots)}};
  if (is_first) {
    part["text"] = json_list(
        {"Down and left is better. The stair joins what is best for its time: nothing is both "
         "faster and nearer to the truth. The broken line is the noise of the truth itself: below "
         "it no difference means anything. Rings are auto, which chooses from the others. Point "
         "at a name or a mark for more."});
  }
  return part;
}

/// A panel of ratios over times.
struct RatioPanel {
  std::size_t ranked;  ///< of a row's errors
  double OverScenes::*number;
  const char* name;
};

Json ratio_plot(const RatioPanel& panel, const std::vector<SummaryRow>& summary) {
  SeriesOfMethods methods;
  for (const SummaryRow& row : summary) {
    if (row.settings == kBestSetting) continue;
    methods.add(row.method,
                {{"x", row.pinhole_frames.median},
                 {"y", row.ratios[panel.ranked].*panel.number},
                 {"text", row.method + (row.settings.empty() ? "" : ", " + row.settings)}});
  }
  std::vector<Json> all;
  methods.append_to(all);
  return {{"title", std::string{panel.name} + " over the scenes: " +
                        std::string{summary.front().ranked[panel.ranked].title}},
          {"x",
           {{"title", "median time, in frames of the pinhole: further left is faster"},
            {"short", "pinhole frames"},
            {"log", true}}},
          {"y",
           {{"title", "times the least error in its time: 1 is best"},
            {"short", "ratio"},
            {"log", true}}},
          {"series", json_list(all)}};
}

/// Each series at its best setting, or its only one; the least median of the first error first.
std::vector<SummaryRow> best_rows(const std::vector<SummaryRow>& summary) {
  std::vector<SummaryRow> rows;
  for (const SummaryRow& row : summary) {
    const auto settings =
        std::count_if(summary.begin(), summary.end(),
                      [&](const SummaryRow& other) { return other.method == row.method; });
    if (row.settings == kBestSetting || settings == 1) rows.push_back(row);
  }
  std::stable_sort(rows.begin(), rows.end(), [](const SummaryRow& a, const SummaryRow& b) {
    return a.errors[0].median < b.errors[0].median;
  });
  return rows;
}

/// A row for each method, from its median to its worst.
Json error_plot(std::size_t ranked, const std::vector<SummaryRow>& rows) {
  const RankedError& error = rows.front().ranked[ranked];
  Json names = Json::array(), spans = Json::array(), medians = Json::array(),
       nine_tenths = Json::array(), worst = Json::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const OverScenes& of = rows[i].errors[ranked];
    const auto shown = [&](double value) { return std::max(value, error.least_shown); };
    const auto add = [&](Json& points, double value, const std::string& name) {
      points.push_back({{"x", shown(value)}, {"y", i}, {"text", name}});
    };
    names.push_back(rows[i].method);
    spans.push_back({{"x", shown(of.median)}, {"to_x", shown(of.worst)}, {"y", i}});
    add(medians, of.median, "median");
    add(nine_tenths, of.p90, "90th percentile");
    add(worst, of.worst, "worst: " + of.worst_scene);
  }
  const std::string title{error.title};
  return {{"title", title + " of each method at its best setting"},
          {"x",
           {{"title", "mean error against the truth: further left is better"},
            {"short", title},
            {"log", true}}},
          {"y", {{"short", "method"}, {"names", std::move(names)}}},
          {"series", json_list({report_series("", "span", std::move(spans)),
                                report_series("median", "dots", std::move(medians)),
                                report_series("90th percentile", "dots", std::move(nine_tenths)),
                                report_series("worst scene", "dots", std::move(worst))})}};
}

Json summary_plots(const std::vector<SummaryRow>& summary) {
  if (!has_times(summary)) {
    const std::vector<SummaryRow> rows = best_rows(summary);
    Json plots = plots_json("summary", {error_plot(0, rows), error_plot(1, rows)});
    plots["height"] = 22 * rows.size() + 90;
    return plots;
  }
  return plots_json("summary", {ratio_plot({0, &OverScenes::median, "Median"}, summary),
                                ratio_plot({0, &OverScenes::worst, "Worst"}, summary),
                                ratio_plot({1, &OverScenes::median, "Median"}, summary),
                                ratio_plot({1, &OverScenes::worst, "Worst"}, summary)});
}

// --- tables ---

using Cells = std::vector<Json>;

struct Column {
  std::string name;
  Json places{};  ///< null: words
  std::string group{};
};

Json table_json(const std::vector<Column>& columns, const std::vector<Json>& rows) {
  Json list = Json::array();
  for (const Column& of : columns) {
    Json column{{"name", of.name}};
    column[of.places.is_null() ? "word" : "places"] = of.places.is_null() ? Json{true} : of.places;
    if (!of.group.empty()) column["group"] = of.group;
    list.push_back(std::move(column));
  }
  return {{"columns", std::move(list)}, {"rows", json_list(rows)}};
}

Json row_json(const Cells& cells, bool is_best) {
  Json row{{"cells", json_list(cells)}};
  if (is_best) row["best"] = true;
  return row;
}

/// The method's name, leading to the point's pictures if it has some.
Json method_cell(const ChartPanel& panel, const ChartPoint& point) {
  if (point.pictures.empty()) return point.entry.method;
  return {{"value", point.entry.method}, {"to", place_of(panel, point)}};
}

/// Those of the subject.
std::vector<ChartMeasure> columns_of(const ChartPanel& panel) {
  std::vector<ChartMeasure> all;
  for (const ChartMeasure& measure : chart_measures()) {
    const bool is_there = !std::isnan(measure.value(panel.points.front().errors));
    if (!measure.is_own || is_there) all.push_back(measure);
  }
  return all;
}

Json points_table(const std::vector<ChartPanel>& panels) {
  std::vector<Json> rows;
  const std::vector<ChartMeasure> measures = columns_of(panels.front());
  const auto add_row = [&](Cells cells, const ChartErrors& errors, Json rounds, bool is_best) {
    for (const ChartMeasure& measure : measures) {
      cells.push_back(number_or_null(measure.value(errors)));
    }
    cells.push_back(std::move(rounds));
    rows.push_back(row_json(cells, is_best));
  };
  for (const ChartPanel& panel : panels) {
    for (const ChartPoint& point : panel.points) {
      const std::vector<double>& filter_ms = point.times.filter_ms;
      add_row({panel.scene, method_cell(panel, point), settings_text(point.entry),
               number_or_null(point.median_ms), number_or_null(point.pinhole_frames),
               filter_ms.empty() ? Json{} : Json{spread_of(filter_ms).median}},
              point.errors, point.times.frame_ms.size(), point.on_front);
    }
    add_row({panel.scene,
             "noise of the truth",
             "half its " + std::to_string(panel.truth_samples) + " samples against half",
             {},
             {},
             {}},
            panel.noise_floor, {}, false);
  }
  std::vector<Column> columns{{"scene"},
                              {"method"},
                              {"settings"},
                              {"frame, ms", "ms"},
                              {"pinhole frames", kRatioPlaces},
                              {"filter, ms", "ms"}};
  for (const ChartMeasure& of : measures) columns.push_back({of.title, of.places, of.group});
  columns.push_back({"rounds", 0});
  return table_json(columns, rows);
}

Json best_table(const ChartPage& page) {
  std::vector<Json> rows;
  Cells cells;
  for (const BestForBudget& of : page.best) {
    const auto panel = std::find_if(page.panels.begin(), page.panels.end(),
                                    [&](const ChartPanel& one) { return one.scene == of.scene; });
    if (of.rank == 0) {
      const bool has_end = std::isfinite(of.budget);
      cells = {of.scene,
               {{"value", has_end ? of.budget : 1e9},
                {"text", has_end ? short_number(of.budget) : "any"}}};
    }
    cells.insert(cells.end(), {method_cell(*panel, *of.point), settings_text(of.point->entry),
                               number_or_null(of.point->errors.*of.ranked.value),
                               number_or_null(of.point->pinhole_frames)});
    if (of.rank + 1 == panel->ranked.size()) rows.push_back(row_json(cells, false));
  }
  std::vector<Column> columns{{"scene"}, {"budget, pinhole frames", 2}};
  for (const RankedError& ranked : page.panels.front().ranked) {
    const std::string title{ranked.title}, group = "least " + title;
    columns.insert(columns.end(), {{"method", {}, group},
                                   {"settings", {}, group},
                                   {title, ranked.places, group},
                                   {"pinhole frames", kRatioPlaces, group}});
  }
  return table_json(columns, rows);
}

Json summary_table(const std::vector<SummaryRow>& summary) {
  std::vector<Json> rows;
  for (const SummaryRow& row : summary) {
    Cells cells{row.method, row.settings, row.scenes, number_or_null(row.pinhole_frames.median)};
    for (std::size_t i = 0; i < row.ranked.size(); ++i) {
      for (const OverScenes* of : {&row.ratios[i], &row.errors[i]}) {
        cells.insert(cells.end(), {number_or_null(of->median), number_or_null(of->p90),
                                   number_or_null(of->worst), of->worst_scene});
      }
    }
    rows.push_back(row_json(cells, row.settings == kBestSetting));
  }
  std::vector<Column> columns{
      {"method"}, {"settings"}, {"scenes", 0}, {"pinhole frames", kRatioPlaces}};
  for (const RankedError& ranked : summary.front().ranked) {
    const std::string title{ranked.title};
    for (const auto& [group, places] :
         {std::pair{title + " ratio", kRatioPlaces}, std::pair{title, ranked.places}}) {
      for (const char* name : {"median", "90 %", "worst"}) columns.push_back({name, places, group});
      columns.push_back({"on", {}, group});
    }
  }
  return table_json(columns, rows);
}

// --- pictures ---

Json point_card(const ChartPanel& panel, const ChartPoint& point, Json& pictures) {
  const std::string name = full_name(point) + " on " + panel.scene, place = place_of(panel, point);
  const ChartPictures& of = point.pictures;
  const std::string where = std::to_string(point.worst.side) + " pixels at " +
                            std::to_string(point.worst.x) + ", " + std::to_string(point.worst.y);
  const auto figure = [&](const char* kind, const std::string& png, const std::string& about,
                          const std::string& caption, bool is_crop) {
    Json made = report_figure(pictures, place + "." + kind + ".png", png, about, caption);
    if (is_crop) made["crop"] = true;
    return made;
  };
  std::string text;
  if (!std::isnan(point.median_ms)) text = short_number(point.median_ms) + " ms, ";
  for (const RankedError& error : panel.ranked) {
    text += (&error == &panel.ranked[0] ? "" : ", ") + error_text(error, point.errors.*error.value);
  }
  if (point.on_front) text += ": nothing is both faster and nearer to the truth";
  return {
      {"id", place},
      {"title", full_name(point)},
      {"text", json_list({text})},
      {"figures",
       json_list(
           {json_list({figure("picture", of.picture, "Picture by " + name, "the picture", false),
                       figure("error", of.error, "Map of the FLIP error of " + name, "its error",
                              false)}),
            json_list({figure("worst", of.worst, "Worst part of the picture by " + name,
                              "worst: " + where, true),
                       figure("worst-truth", of.worst_truth, "The ground truth of that part",
                              "the truth there", true),
                       figure("worst-error", of.worst_error, "Map of the FLIP error of that part",
                              "the error there", true)})})}};
}

Json scene_part(const ChartPage& page, const ChartPanel& panel, Json& pictures) {
  const std::string caption = page.subject.truth_of != nullptr
                                  ? "the truth, calculated"
                                  : "the truth: " + std::to_string(panel.truth_samples) + " " +
                                        std::string{page.subject.sample} +
                                        "; FLIP of one half of them against the other " +
                                        fixed(panel.noise_floor.flip, kFlipPlaces);
  Json cards = Json::array();
  for (const ChartPoint& point : panel.points) {
    if (!point.pictures.empty()) cards.push_back(point_card(panel, point, pictures));
  }
  return {{"id", "scene-" + panel.scene},
          {"title", panel.scene},
          {"below", true},
          {"text", json_list({panel.title})},
          {"figures", json_list({json_list(
                          {report_figure(pictures, panel.scene + ".truth.png", panel.truth_picture,
                                         "Ground truth of " + panel.scene, caption)})})},
          {"cards", std::move(cards)}};
}

// --- the whole ---

Json introduction(const ChartPage& page) {
  std::string text = "Each method on " + std::to_string(page.panels.size()) +
                     (page.panels.size() == 1 ? " scene" : " scenes") + " at " + page.size +
                     ": how far its picture is from the ground truth, " +
                     std::string{page.subject.truth};
  if (has_times(page.summary)) {
    text +=
        ", and how long a whole frame takes, from the drawing to the result. Times are medians; "
        "the contenders were run in turn. A pinhole frame is the time of the scene's sharp picture";
  }
  std::string measure{page.subject.measure};
  measure += measure.empty() ? "" : " ";
  return json_list(
      {text + ".", measure +
                       "FLIP is what an eye sees when the two pictures alternate: 0 is the same, 1 "
                       "as different as can be. It cuts light to 1, as a screen does; HDR-FLIP is "
                       "the largest FLIP over all exposures, and sees highlights."});
}

Json summary_part(const ChartPage& page) {
  std::string text = "In colour: each method at the setting with its least " +
                     std::string{page.summary.front().ranked[0].title} +
                     ", scene by scene. 90 %: nine scenes of ten have at most this.";
  if (has_times(page.summary)) {
    text =
        "The ratio is a contender's error over the least error that any contender reaches in its "
        "time or less: 1 is the best for its time. " +
        text;
  }
  return {{"id", "summary"},
          {"title", "All scenes"},
          {"text", json_list({text})},
          {"plots", summary_plots(page.summary)},
          {"table", summary_table(page.summary)}};
}

Json numbers_part(const ChartPage& page) {
  Json part{{"id", "results"}, {"title", "All numbers"}};
  if (page.panels.size() > kMostPanels) {
    part["text"] = json_list({"They are in chart.csv and chart.json."});
    return part;
  }
  part["text"] = json_list(
      {"A click on a heading sorts. Errors also by region: at silhouettes, nearer than the focus, "
       "in focus, beyond, and on edges in focus. Rows in colour are best for their time."});
  part["table"] = points_table(page.panels);
  return part;
}

}  // namespace

Json chart_report(const ChartPage& page) {
  Json pictures = Json::object(), parts = Json::array();
  const RankedErrors& ranked = page.panels.front().ranked;
  if (has_times(page.summary) && page.panels.size() <= kMostPanels) {
    parts.push_back(panels_part(page, ranked[0], "chart", true));
    parts.push_back(panels_part(page, ranked[1], "chart-" + std::string{ranked[1].key}, false));
  }
  parts.push_back(summary_part(page));
  parts.push_back({{"id", "best"},
                   {"title", "Best within a budget"},
                   {"text", json_list({"The method and setting with the least error of those that "
                                       "take at most so many pinhole frames."})},
                   {"table", best_table(page)}});
  parts.push_back(numbers_part(page));
  parts.push_back({{"id", "pictures"},
                   {"title", "Pictures"},
                   {"text", json_list({pictured_text(page.panels) +
                                       " In the maps black is right and pale yellow is wrong."})}});
  for (const ChartPanel& panel : page.panels) {
    if (!panel.truth_picture.empty()) parts.push_back(scene_part(page, panel, pictures));
  }
  return {{"title", std::string{page.subject.title} + ": speed against accuracy"},
          {"text", introduction(page)},
          {"command", page.command},
          {"machine", page.machine},
          {"parts", std::move(parts)},
          {"pictures", std::move(pictures)}};
}

}  // namespace softfocus
