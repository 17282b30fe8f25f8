// softfocus chart: speed against accuracy of every method on every scene.

#include <algorithm>
#include <cerrno>
#include <functional>
#include <iostream>
#include <memory>
#include <system_error>

#include "scenes/files/file_bytes.h"
#include "tools/chart/key.h"
#include "tools/chart/options.h"
#include "tools/chart/pictures.h"
#include "tools/chart/report/gnuplot.h"
#include "tools/chart/report/numbers.h"
#include "tools/chart/report/page.h"
#include "tools/chart/report/plot.h"
#include "tools/chart/report/summary_plot.h"
#include "tools/chart/scene.h"
#include "tools/chart/work.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/interrupts.h"
#include "tools/cli/platform.h"
#include "tools/files/same_file.h"
#include "tools/files/whole_file.h"
#include "tools/report/report_files.h"

namespace softfocus {
namespace {

constexpr std::size_t kLargestPlot = std::size_t{1} << 28;

/// A new empty file, so that two charts into one directory do not draw into the same.
std::filesystem::path scratch_file(const std::filesystem::path& directory) {
  for (int attempt = 0;; ++attempt) {
    std::filesystem::path file =
        directory / ("plot-" + std::to_string(process_number()) + "-" + std::to_string(attempt));
    const int descriptor = create_file(file);
    if (descriptor >= 0) {
      close_file(descriptor);
      return file;
    }
    if (errno != EEXIST) {
      throw FileError("cannot write '" + file.string() +
                      "': " + std::generic_category().message(errno));
    }
  }
}

/// What gnuplot draws, by a script for a terminal and a file. gnuplot draws into a scratch file,
/// so that the chart's own appears whole.
using PlotScript =
    std::function<std::string(std::string_view terminal, const std::filesystem::path& file)>;

std::string plotted(const PlotScript& script, const char* terminal, const ChartOptions& options) {
  const std::filesystem::path scratch = scratch_file(options.directory / "cache");
  const RemovedByInterrupt removed{scratch};
  std::string bytes;
  try {
    run_gnuplot(script(terminal, scratch));
    bytes = read_file_bytes(scratch, kLargestPlot);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(scratch, ignored);
    throw;
  }
  std::error_code ignored;
  std::filesystem::remove(scratch, ignored);
  return bytes;
}

/// Draws NAME.png and NAME.svg. Returns the text of the SVG.
std::string write_plots(const PlotScript& script, const std::string& name,
                        const ChartOptions& options) {
  write_text(options.directory / (name + ".png"), plotted(script, "pngcairo", options));
  std::string svg = plotted(script, "svg", options);
  write_text(options.directory / (name + ".svg"), svg);
  return svg;
}

/// A panel a scene, of errors against times. Old ones would not belong to the new numbers.
std::string write_panels(const std::vector<ChartPanel>& panels, const RankedError& error,
                         const std::string& name, const ChartOptions& options) {
  if (options.rounds == 0 || panels.size() > kMostPanels) {
    for (const char* ending : {".png", ".svg"}) {
      std::error_code ignored;
      std::filesystem::remove(options.directory / (name + ending), ignored);
    }
    return "";
  }
  return write_plots(
      [&](std::string_view terminal, const std::filesystem::path& file) {
        return plot_script(panels, error, terminal, file);
      },
      name, options);
}

void write_list(const Json& list, const std::string& name, const ChartOptions& options) {
  write_text(options.directory / (name + ".csv"), csv_of(list));
  write_json(options.directory / (name + ".json"), list);
}

/// "chart-hdr-flip".
std::string second_plot(const RankedErrors& ranked) {
  std::string name = "chart-" + std::string{ranked[1].key};
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

void write_chart(const std::vector<ChartPanel>& panels, const ChartOptions& options) {
  const std::vector<BestForBudget> best = best_for_budgets(panels);
  const std::vector<SummaryRow> summary = summary_of(panels);
  const RankedErrors& ranked = options.subject->ranked;
  write_list(chart_json(panels), "chart", options);
  write_list(best_json(best), "best", options);
  write_list(summary_json(summary), "summary", options);
  const std::string summary_svg = write_plots(
      [&](std::string_view terminal, const std::filesystem::path& file) {
        return summary_script(summary, terminal, file);
      },
      "summary", options);
  write_text(
      options.directory / "index.html",
      chart_page({.subject = *options.subject,
                  .panels = panels,
                  .best = best,
                  .summary = summary,
                  .size = size_text(options.size),
                  .machine = machine_key(options.pool),
                  .summary_svg = summary_svg,
                  .first_svg = write_panels(panels, ranked[0], "chart", options),
                  .second_svg = write_panels(panels, ranked[1], second_plot(ranked), options)}));
}

void print_fronts(const std::vector<ChartPanel>& panels) {
  for (const ChartPanel& panel : panels) {
    const RankedError& error = panel.ranked[0];
    std::cout << panel.scene << ": ";
    if (panel.noise_floor.flip > 0.0) {
      std::cout << "noise of the truth, FLIP " << short_number(panel.noise_floor.flip) << "; ";
    }
    std::cout << "best for their time:\n";
    std::vector<const ChartPoint*> front;
    for (const ChartPoint& point : panel.points) {
      if (point.on_front) front.push_back(&point);
    }
    std::sort(front.begin(), front.end(),
              [](const ChartPoint* a, const ChartPoint* b) { return a->median_ms < b->median_ms; });
    for (const ChartPoint* point : front) {
      std::cout << "  " << short_number(point->median_ms) << " ms, " << error.title << ' '
                << short_number(point->errors.*error.value) << ": " << point->entry.method << ' '
                << settings_text(point->entry) << '\n';
    }
  }
}

/// Each method at its best setting.
void print_summary(const std::vector<ChartPanel>& panels) {
  std::cout << panels.front().ranked[0].title << " over " << panels.size()
            << " scenes, at the best setting of each: median, 90 %"
            << ", worst\n";
  for (const SummaryRow& row : summary_of(panels)) {
    if (row.settings != kBestSetting && !row.settings.empty()) continue;
    const OverScenes& error = row.errors[0];
    std::cout << "  " << short_number(error.median) << ", " << short_number(error.p90) << ", "
              << short_number(error.worst) << ": " << row.method << '\n';
  }
}

/// All that a chart writes but its cache.
std::vector<std::filesystem::path> output_files(const std::filesystem::path& directory,
                                                const RankedErrors& ranked) {
  std::vector<std::filesystem::path> files{directory / "index.html"};
  for (const char* name : {"chart", "best", "summary"}) {
    for (const char* ending : {".csv", ".json"}) {
      files.push_back(directory / (std::string{name} + ending));
    }
  }
  for (const std::string& name :
       {std::string{"chart"}, second_plot(ranked), std::string{"summary"}}) {
    for (const char* ending : {".svg", ".png"}) {
      files.push_back(directory / (name + ending));
    }
  }
  return files;
}

int chart(const ChartOptions& options) {
  const std::vector<std::filesystem::path> outputs =
      output_files(options.directory, options.subject->ranked);
  const std::vector<ReadFile> inputs = check_scenes(options);
  for (const auto& file : outputs) check_not_read("-o", file, inputs);
  check_gnuplot();
  make_directory(options.directory / "cache");
  // So that nothing is measured in vain.
  for (const auto& file : outputs) check_writable(file);
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const ChartFindings findings = measure_chart(options, pool);
  write_chart(findings.panels, options);
  if (findings.kept > 0) {
    std::cout << "went on: " << findings.kept << " of " << findings.all
              << " results were there already\n";
  }
  if (options.rounds > 0 && findings.panels.size() <= kMostPanels) print_fronts(findings.panels);
  if (findings.panels.size() > 1) print_summary(findings.panels);
  std::cout << "written to " << (options.directory / "index.html").string() << '\n';
  return kDone;
}

}  // namespace

Command add_chart_command(CLI::App& program) {
  CLI::App* parser =
      add_command(program, "chart", "Measure speed against accuracy of all methods, and draw it");
  const auto options = std::make_shared<ChartOptions>();
  add_chart_options(*parser, *options);
  return {parser, [options] {
            complete(*options);
            return chart(*options);
          }};
}

}  // namespace softfocus
