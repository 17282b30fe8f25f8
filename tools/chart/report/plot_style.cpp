#include "tools/chart/report/plot_style.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/chart/report/gnuplot.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

constexpr int kKeyRow = 24;

/// Neighbours look different, also on white. After the last they repeat with other shapes.
constexpr std::array kColours{"#000000", "#d62728", "#1f77b4", "#2ca02c", "#ff7f0e", "#9467bd",
                              "#8c564b", "#e377c2", "#17becf", "#bcbd22", "#003f88", "#7f0000",
                              "#00a087", "#ffb000", "#606060", "#a8d800"};
constexpr int kShapes = 15;  // of gnuplot's

std::string fraction(int pixels, int of) { return short_number(static_cast<double>(pixels) / of); }

}  // namespace

void widen(PlotRange& range, double value) {
  range = {std::min(range.least, value), std::max(range.most, value)};
}

std::string range_text(const PlotRange& range) {
  return "[" + short_number(range.least / 1.3) + ":" + short_number(range.most * 1.3) + "]";
}

std::string log_tics() {
  std::string list;
  for (int power = -5; power <= 6; ++power) {
    for (const int digit : {1, 2, 5}) {
      const std::string number = short_number(digit * std::pow(10.0, power));
      list.append(list.empty() ? "'" : ", '").append(number).append("' ").append(number);
    }
  }
  return "(" + list + ")";
}

std::string plot_head(std::string_view terminal, const std::string& file, const PlotSize& size) {
  return "set terminal " + std::string{terminal} + " size " + std::to_string(size.width) + "," +
         std::to_string(size.height) +
         " noenhanced font 'DejaVu Sans,12' background rgb '#ffffff'\nset output " +
         gnuplot_quoted(file) +
         "\nset multiplot\nset key off\nset grid lc rgb '#d8d8d8' lw 1 dt 1\n";
}

std::string margins(const PlotBox& box, const PlotSize& size) {
  return "set lmargin at screen " + fraction(box.left, size.width) + "\nset rmargin at screen " +
         fraction(box.right, size.width) + "\nset bmargin at screen " +
         fraction(box.bottom, size.height) + "\nset tmargin at screen " +
         fraction(box.top, size.height) + "\n";
}

std::string series_style(const std::string& series, std::size_t number) {
  if (series == "auto") return " with points lc rgb '#000000' lw 2.5 ps 2.4 pt 6";
  return " with linespoints lc rgb '" + std::string{kColours[number % kColours.size()]} +
         "' lw 1.5 ps 0.9 pt " + std::to_string(number % kShapes + 1);
}

int key_height(std::size_t lines) {
  return kKeyRow * static_cast<int>((lines + kKeyColumns - 1) / kKeyColumns) + 12;
}

std::string key_script(const std::vector<KeyLine>& lines, const PlotSize& size) {
  std::string script =
      "unset title\nunset xlabel\nunset ylabel\nunset tics\nunset border\n"
      "unset logscale\nunset grid\nset xrange [0:1]\nset yrange [0:1]\n" +
      margins({10, size.width - 10, 2, key_height(lines.size()) - 4}, size) +
      "set key center center horizontal Left reverse maxcols " + std::to_string(kKeyColumns) +
      " width 1 samplen 3\nplot ";
  for (const KeyLine& line : lines) {
    script += (&line == &lines.front() ? "NaN" : ", NaN") + line.style + " title " +
              gnuplot_quoted(line.name);
  }
  return script + "\n";
}

}  // namespace softfocus
