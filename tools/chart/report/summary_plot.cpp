#include "tools/chart/report/summary_plot.h"

#include <algorithm>
#include <cmath>

#include "tools/chart/report/gnuplot.h"
#include "tools/chart/report/plot_style.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

// Pixels.
constexpr int kHalfWidth = 660, kHalfHeight = 520;
constexpr int kNames = 190, kRow = 22;

constexpr const char* kRatioTics = "(1, 1.2, 1.5, 2, 3, 4, 5, 7, 10, 15, 20, 30, 50, 100)";

std::vector<std::string> series_of(const std::vector<SummaryRow>& summary) {
  std::vector<std::string> names;
  for (const SummaryRow& row : summary) {
    if (names.empty() || names.back() != row.method) names.push_back(row.method);
  }
  return names;
}

/// A panel of ratios over times.
struct RatioPanel {
  std::size_t ranked;  ///< of a row's errors
  double OverScenes::*number;
  const char* name;
};

std::string ratio_panel(std::size_t index, const RatioPanel& panel,
                        const std::vector<SummaryRow>& summary,
                        const std::vector<std::string>& series) {
  PlotRange frames, ratios;
  std::string data, plots;
  for (std::size_t i = 0; i < series.size(); ++i) {
    std::string lines;
    for (const SummaryRow& row : summary) {
      if (row.method != series[i] || row.settings == kBestSetting) continue;
      const double ratio = row.ratios[panel.ranked].*panel.number;
      widen(frames, row.pinhole_frames.median);
      widen(ratios, ratio);
      lines += short_number(row.pinhole_frames.median) + " " + short_number(ratio) + "\n";
    }
    const std::string name = "$s" + std::to_string(index) + "_" + std::to_string(i);
    data.append(name).append(" << END\n").append(lines).append("END\n");
    plots.append(plots.empty() ? "plot " : ", ").append(name);
    plots.append(series_style(series[i], i)).append(" notitle");
  }
  const std::string title = std::string{panel.name} + " over the scenes: " +
                            std::string{summary.front().ranked[panel.ranked].title};
  return data + "set title " + gnuplot_quoted(title) + " offset 0,-0.4\nset xrange " +
         range_text(frames) + "\nset yrange " + range_text(ratios) + "\n" + plots + "\n";
}

std::string script_with_times(const std::vector<SummaryRow>& summary, std::string_view terminal,
                              const std::filesystem::path& file) {
  const std::vector<std::string> series = series_of(summary);
  const int below = key_height(series.size());
  const PlotSize size{2 * kHalfWidth, 2 * kHalfHeight + below};
  std::string script =
      plot_head(terminal, file.string(), size) + "set logscale xy\nset xtics " + log_tics() +
      "\nset ytics " + kRatioTics +
      "\nset xlabel 'median time, in frames of the pinhole: further left is faster'\n"
      "set ylabel 'times the least error in its time: 1 is best'\n";
  const RatioPanel panels[]{{0, &OverScenes::median, "Median"},
                            {0, &OverScenes::worst, "Worst"},
                            {1, &OverScenes::median, "Median"},
                            {1, &OverScenes::worst, "Worst"}};
  for (std::size_t i = 0; i < std::size(panels); ++i) {
    const int left = static_cast<int>(i % 2) * kHalfWidth;
    const int bottom = below + static_cast<int>(1 - i / 2) * kHalfHeight;
    script += margins({left + kLeft, left + kHalfWidth - kRight, bottom + kBottom,
                       bottom + kHalfHeight - kTop},
                      size) +
              ratio_panel(i, panels[i], summary, series);
  }
  std::vector<KeyLine> key;
  for (std::size_t i = 0; i < series.size(); ++i) {
    key.push_back({series_style(series[i], i), series[i]});
  }
  return script + key_script(key, size) + "unset multiplot\nset output\n";
}

/// Each series at its best setting, or its only one; the least median of FLIP first.
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

/// A line of "error place median 90th worst" for each row, from the top down.
std::string error_panel(std::size_t ranked, const std::vector<SummaryRow>& rows) {
  const std::string name = "$e" + std::to_string(ranked);
  const RankedError& of_rank = rows.front().ranked[ranked];
  PlotRange errors;
  std::string data = name + " << END\n", labels;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const OverScenes& of = rows[i].errors[ranked];
    const std::string place = std::to_string(rows.size() - i);
    data += place;
    for (const double error : {of.median, of.p90, of.worst}) {
      const double shown = std::max(error, of_rank.least_shown);
      widen(errors, shown);
      data += " " + short_number(shown);
    }
    data += "\n";
    labels += (i == 0 ? "" : ", ") + gnuplot_quoted(rows[i].method) + " " + place;
  }
  return data + "END\nset title " +
         gnuplot_quoted(std::string{of_rank.title} + " of each method at its best setting") +
         " offset 0,-0.4\nset xrange " + range_text(errors) +
         "\nset yrange [0.4:" + std::to_string(rows.size()) + ".6]\nset ytics (" + labels +
         ")\nplot " + name +
         " using 2:1:($4-$2):(0) with vectors nohead lc rgb '#b0b0b0' lw 2 notitle, " + name +
         " using 2:1 with points pt 7 ps 1 lc rgb '#1f77b4' notitle, " + name +
         " using 3:1 with points pt 5 ps 0.8 lc rgb '#ff7f0e' notitle, " + name +
         " using 4:1 with points pt 9 ps 1 lc rgb '#d62728' notitle\n";
}

std::string script_without_times(const std::vector<SummaryRow>& summary, std::string_view terminal,
                                 const std::filesystem::path& file) {
  const std::vector<SummaryRow> rows = best_rows(summary);
  const int below = key_height(kKeyColumns);
  const int panel_height = kRow * (static_cast<int>(rows.size()) + 1) + kTop + kBottom;
  const PlotSize size{2 * (kHalfWidth + kNames - kLeft), panel_height + below};
  std::string script = plot_head(terminal, file.string(), size) + "set logscale x\nset xtics " +
                       log_tics() +
                       "\nset xlabel 'mean error against the truth: further left is better'\n";
  for (std::size_t i = 0; i < rows.front().ranked.size(); ++i) {
    const int left = static_cast<int>(i) * size.width / 2;
    script += margins({left + kNames, left + size.width / 2 - kRight, below + kBottom,
                       below + panel_height - kTop},
                      size) +
              error_panel(i, rows);
  }
  const std::vector<KeyLine> key{{" with points pt 7 ps 1 lc rgb '#1f77b4'", "median"},
                                 {" with points pt 5 ps 0.8 lc rgb '#ff7f0e'", "90th percentile"},
                                 {" with points pt 9 ps 1 lc rgb '#d62728'", "worst scene"}};
  return script + key_script(key, size) + "unset multiplot\nset output\n";
}

}  // namespace

bool has_times(const std::vector<SummaryRow>& summary) {
  return std::none_of(summary.begin(), summary.end(),
                      [](const SummaryRow& row) { return std::isnan(row.pinhole_frames.median); });
}

std::string summary_script(const std::vector<SummaryRow>& summary, std::string_view terminal,
                           const std::filesystem::path& file) {
  return has_times(summary) ? script_with_times(summary, terminal, file)
                            : script_without_times(summary, terminal, file);
}

}  // namespace softfocus
