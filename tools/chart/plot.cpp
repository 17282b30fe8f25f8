#include "tools/chart/plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/chart/gnuplot.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

constexpr int kPanelsInRow = 3;
constexpr int kPanelWidth = 520, kPanelHeight = 540;  // pixels
constexpr int kLeft = 96, kRight = 16, kTop = 44, kBottom = 58, kBetween = 34;
constexpr int kKeyRow = 24, kKeyColumns = 5;

/// Stands for FLIP 0, the truth itself, which has no logarithm.
constexpr double kLeastFlip = 1e-5;

/// Neighbours look different, also on white. After the last they repeat with other shapes.
constexpr std::array kColours{"#000000", "#d62728", "#1f77b4", "#2ca02c", "#ff7f0e", "#9467bd",
                              "#8c564b", "#e377c2", "#17becf", "#bcbd22", "#003f88", "#7f0000",
                              "#00a087", "#ffb000", "#606060", "#a8d800"};
constexpr int kShapes = 15;  // of gnuplot's

struct Range {
  double least;
  double most;
};

constexpr Range kNothing{1e30, 0.0};

void widen(Range& range, double value) {
  range = {std::min(range.least, value), std::max(range.most, value)};
}

struct Layout {
  std::size_t columns;
  std::size_t rows;
  int width;
  int height;
  int key_height;
};

double shown(double flip) { return std::max(flip, kLeastFlip); }

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
  const int key_rows = static_cast<int>((series + 2 + kKeyColumns - 1) / kKeyColumns);
  layout.key_height = kKeyRow * key_rows + 12;
  // One panel alone leaves no room for the key's columns.
  const int columns = static_cast<int>(std::max(layout.columns, std::size_t{2}));
  layout.width = kLeft + columns * (kPanelWidth + kBetween) + kRight;
  layout.height = static_cast<int>(layout.rows) * kPanelHeight + layout.key_height;
  return layout;
}

std::string fraction(int pixels, int of) { return short_number(static_cast<double>(pixels) / of); }

std::string margins(int left, int right, int bottom, int top, const Layout& layout) {
  return "set lmargin at screen " + fraction(left, layout.width) + "\nset rmargin at screen " +
         fraction(right, layout.width) + "\nset bmargin at screen " +
         fraction(bottom, layout.height) + "\nset tmargin at screen " +
         fraction(top, layout.height) + "\n";
}

std::string panel_margins(std::size_t index, const Layout& layout) {
  const int column = static_cast<int>(index % kPanelsInRow);
  const int row_from_below = static_cast<int>(layout.rows - 1 - index / kPanelsInRow);
  const int left = kLeft + column * (kPanelWidth + kBetween);
  const int bottom = layout.key_height + row_from_below * kPanelHeight;
  return margins(left, left + kPanelWidth, bottom + kBottom, bottom + kPanelHeight - kTop, layout);
}

/// With some room on both sides.
std::string range_text(const Range& range) {
  return "[" + short_number(range.least / 1.3) + ":" + short_number(range.most * 1.3) + "]";
}

/// Marks at 1, 2 and 5 times the powers of ten.
std::string tics(bool labelled) {
  std::string list;
  for (int power = -5; power <= 6; ++power) {
    for (const int digit : {1, 2, 5}) {
      const double value = digit * std::pow(10.0, power);
      const std::string number = short_number(value);
      list += (list.empty() ? "'" : ", '") + (labelled ? number : "") + "' " + number;
    }
  }
  return "(" + list + ")";
}

std::string style(std::size_t series) {
  return "lc rgb '" + std::string{kColours[series % kColours.size()]} + "' lw 1.5 ps 0.9 pt " +
         std::to_string(series % kShapes + 1);
}

/// auto's points are rings around those of what it chose.
std::string curve(const std::string& name, std::size_t series) {
  if (name == "auto") return " with points lc rgb '#000000' lw 2.5 ps 2.4 pt 6";
  return " with linespoints " + style(series);
}

constexpr const char* kFrontStyle = "lc rgb '#c8c8c8' lw 7";
constexpr const char* kFloorStyle = "lc rgb '#707070' lw 1.5 dt 2";

std::string line(const ChartPoint& point) {
  return short_number(point.median_ms) + " " + short_number(shown(point.errors.flip)) + "\n";
}

/// The corners of the stair: until a point is reached, the one before it is the nearest to the
/// truth.
std::string front_data(const ChartPanel& panel, double right_end_ms) {
  std::vector<const ChartPoint*> front;
  for (const ChartPoint& point : panel.points) {
    if (point.on_front && !point.entry.max_error) front.push_back(&point);
  }
  std::sort(front.begin(), front.end(),
            [](const ChartPoint* a, const ChartPoint* b) { return a->median_ms < b->median_ms; });
  std::string data;
  for (const ChartPoint* point : front) data += line(*point);
  if (!front.empty()) {
    data +=
        short_number(right_end_ms) + " " + short_number(shown(front.back()->errors.flip)) + "\n";
  }
  return data;
}

std::string panel_script(std::size_t index, const ChartPanel& panel,
                         const std::vector<std::string>& series, const Layout& layout) {
  Range ms = kNothing;
  for (const ChartPoint& point : panel.points) widen(ms, point.median_ms);
  const std::string block = "$p" + std::to_string(index) + "_";
  const double floor = shown(panel.noise_floor.flip);
  std::string data = block + "front << END\n" + front_data(panel, ms.most * 1.3) + "END\n";
  std::string plots = "plot " + block + "front with steps " + kFrontStyle + " notitle, " +
                      short_number(floor) + " " + kFloorStyle + " notitle";
  for (std::size_t i = 0; i < series.size(); ++i) {
    std::string lines;
    for (const ChartPoint& point : panel.points) {
      if (series_name(point.entry) == series[i]) lines += line(point);
    }
    if (lines.empty()) continue;
    const std::string name = block + std::to_string(i);
    data += name + " << END\n" + lines + "END\n";
    plots += ", " + name + curve(series[i], i) + " notitle";
  }
  std::string script = data + panel_margins(index, layout);
  script += "set title " + gnuplot_quoted(panel.scene) + " offset 0,-0.4\nset xrange " +
            range_text(ms) + "\n";
  script += index % kPanelsInRow == 0
                ? "set ylabel 'mean FLIP against the ground truth: lower is better'\nset ytics " +
                      tics(true) + "\n"
                : "unset ylabel\nset ytics " + tics(false) + "\n";
  return script + plots + "\n";
}

std::string key_script(const std::vector<std::string>& series, const Layout& layout) {
  std::string script =
      "unset title\nunset xlabel\nunset ylabel\nunset tics\nunset border\n"
      "unset logscale\nunset grid\nset xrange [0:1]\nset yrange [0:1]\n" +
      margins(10, layout.width - 10, 2, layout.key_height - 4, layout) +
      "set key center center horizontal Left reverse maxcols " + std::to_string(kKeyColumns) +
      " width 1 samplen 3\nplot ";
  for (std::size_t i = 0; i < series.size(); ++i) {
    script += "NaN" + curve(series[i], i) + " title " + gnuplot_quoted(series[i]) + ", ";
  }
  return script + "NaN with lines " + kFrontStyle + " title 'best for its time', NaN with lines " +
         kFloorStyle + " title 'noise of the truth'\n";
}

}  // namespace

std::string series_name(const ChartEntry& entry) {
  std::string name = entry.method;
  if (entry.profile != "ieee") name += ", " + entry.profile;
  if (entry.arithmetic != Arithmetic::floats) {
    name += ", " + std::string{arithmetic_name(entry.arithmetic)};
  }
  return name;
}

std::string plot_script(const std::vector<ChartPanel>& panels, std::string_view terminal,
                        const std::filesystem::path& file) {
  Range flip = kNothing;
  for (const ChartPanel& panel : panels) {
    widen(flip, shown(panel.noise_floor.flip));
    for (const ChartPoint& point : panel.points) {
      widen(flip, shown(point.errors.flip));
    }
  }
  const std::vector<std::string> series = series_of(panels);
  const Layout layout = layout_of(panels.size(), series.size());
  std::string script = "set terminal " + std::string{terminal} + " size " +
                       std::to_string(layout.width) + "," + std::to_string(layout.height) +
                       " noenhanced font 'DejaVu Sans,12' background rgb '#ffffff'\nset output " +
                       gnuplot_quoted(file.string()) +
                       "\nset multiplot\nset key off\nset logscale xy\n"
                       "set grid lc rgb '#e4e4e4' lw 1 dt 1\nset xtics " +
                       tics(true) +
                       "\nset xlabel 'whole frame, milliseconds: further left is faster'\n" +
                       "set yrange " + range_text(flip) + "\n";
  for (std::size_t i = 0; i < panels.size(); ++i) {
    script += panel_script(i, panels[i], series, layout);
  }
  return script + key_script(series, layout) + "unset multiplot\nset output\n";
}

}  // namespace softfocus
