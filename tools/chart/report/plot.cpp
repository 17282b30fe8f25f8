#include "tools/chart/report/plot.h"

#include <algorithm>
#include <cmath>

#include "tools/chart/front.h"
#include "tools/chart/report/gnuplot.h"
#include "tools/chart/report/plot_style.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

constexpr int kPanelsInRow = 3;
constexpr int kPanelWidth = 520, kPanelHeight = 480;  // pixels
constexpr int kBetween = 76;

constexpr const char* kFrontStyle = " with steps lc rgb '#c8c8c8' lw 7";
constexpr const char* kFloorStyle = " with lines lc rgb '#707070' lw 1.5 dt 2";

struct Layout {
  std::size_t columns;
  std::size_t rows;
  int key_height;
  PlotSize size;
};

/// The error that a plot shows, and its series.
struct Shown {
  RankedError error;
  std::vector<std::string> series;
  std::string label;  ///< in quotes

  double of(const ChartErrors& errors) const {
    return std::max(errors.*error.value, error.least_shown);
  }
};

std::vector<std::string> series_of(const std::vector<ChartPanel>& panels) {
  std::vector<std::string> names;
  for (const ChartPanel& panel : panels) {
    for (const ChartPoint& point : panel.points) {
      const std::string name = series_name(point.entry);
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

Layout layout_of(std::size_t panels, std::size_t series) {
  Layout layout{};
  layout.columns = std::min(panels, std::size_t{kPanelsInRow});
  layout.rows = (panels + kPanelsInRow - 1) / kPanelsInRow;
  layout.key_height = key_height(series + 2);
  // One panel alone leaves no room for the key's columns.
  const int columns = static_cast<int>(std::max(layout.columns, std::size_t{2}));
  layout.size.width = kLeft + columns * kPanelWidth + (columns - 1) * kBetween + kRight;
  layout.size.height = static_cast<int>(layout.rows) * kPanelHeight + layout.key_height;
  return layout;
}

PlotBox panel_box(std::size_t index, const Layout& layout) {
  const int column = static_cast<int>(index % kPanelsInRow);
  const int row_from_below = static_cast<int>(layout.rows - 1 - index / kPanelsInRow);
  const int left = kLeft + column * (kPanelWidth + kBetween);
  const int bottom = layout.key_height + row_from_below * kPanelHeight;
  return {left, left + kPanelWidth, bottom + kBottom, bottom + kPanelHeight - kTop};
}

std::string line(double ms, double error) {
  return short_number(ms) + " " + short_number(error) + "\n";
}

/// The corners of the stair: until a point is reached, the one before it is the nearest to the
/// truth. auto makes no front.
std::string front_data(const ChartPanel& panel, const Shown& shown, double right_end_ms) {
  std::vector<TwoCosts> costs;
  for (const ChartPoint& point : panel.points) {
    if (!point.entry.max_error) costs.push_back({point.median_ms, shown.of(point.errors)});
  }
  std::string data;
  const std::vector<std::size_t> front = pareto_front(costs);
  for (const std::size_t i : front) data += line(costs[i].time, costs[i].error);
  if (!front.empty()) data += line(right_end_ms, costs[front.back()].error);
  return data;
}

std::string panel_script(std::size_t index, const ChartPanel& panel, const Shown& shown,
                         const Layout& layout) {
  const bool has_floor = !std::isnan(panel.noise_floor.*shown.error.value);
  const double floor = has_floor ? shown.of(panel.noise_floor) : 0.0;
  PlotRange ms, errors;
  if (has_floor) widen(errors, floor);
  for (const ChartPoint& point : panel.points) {
    widen(ms, point.median_ms);
    widen(errors, shown.of(point.errors));
  }
  const std::string block = "$p" + std::to_string(index) + "_";
  std::string data = block + "front << END\n" + front_data(panel, shown, ms.most * 1.3) + "END\n";
  std::string plots = "plot " + block + "front" + kFrontStyle + " notitle";
  if (has_floor) plots += ", " + short_number(floor) + kFloorStyle + " notitle";
  for (std::size_t i = 0; i < shown.series.size(); ++i) {
    std::string lines;
    for (const ChartPoint& point : panel.points) {
      if (series_name(point.entry) != shown.series[i]) continue;
      lines += line(point.median_ms, shown.of(point.errors));
    }
    if (lines.empty()) continue;
    const std::string name = block + std::to_string(i);
    data.append(name).append(" << END\n").append(lines).append("END\n");
    plots.append(", ").append(name).append(series_style(shown.series[i], i)).append(" notitle");
  }
  return data + margins(panel_box(index, layout), layout.size) + "set title " +
         gnuplot_quoted(panel.scene) + " offset 0,-0.4\nset xrange " + range_text(ms) +
         "\nset yrange " + range_text(errors) + "\n" +
         (index % kPanelsInRow == 0 ? "set ylabel " + shown.label + "\n" : "unset ylabel\n") +
         plots + "\n";
}

}  // namespace

std::string plot_script(const std::vector<ChartPanel>& panels, const RankedError& error,
                        std::string_view terminal, const std::filesystem::path& file) {
  const Shown shown{error, series_of(panels),
                    "'" + std::string{error.places > 0 ? "mean " : ""} + std::string{error.title} +
                        " against the truth" + (error.places > 0 ? "" : " (0.5 is none)") +
                        ": lower is better'"};
  const Layout layout = layout_of(panels.size(), shown.series.size());
  std::string script = plot_head(terminal, file.string(), layout.size) +
                       "set logscale xy\nset xtics " + log_tics() + "\nset ytics " + log_tics() +
                       "\nset xlabel 'whole frame, milliseconds: further left is faster'\n";
  for (std::size_t i = 0; i < panels.size(); ++i) {
    script += panel_script(i, panels[i], shown, layout);
  }
  std::vector<KeyLine> key;
  for (std::size_t i = 0; i < shown.series.size(); ++i) {
    key.push_back({series_style(shown.series[i], i), shown.series[i]});
  }
  key.push_back({kFrontStyle, "best for its time"});
  if (std::any_of(panels.begin(), panels.end(), [&](const ChartPanel& panel) {
        return !std::isnan(panel.noise_floor.*error.value);
      })) {
    key.push_back({kFloorStyle, "noise of the truth"});
  }
  return script + key_script(key, layout.size) + "unset multiplot\nset output\n";
}

}  // namespace softfocus
