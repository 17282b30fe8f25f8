// softfocus chart: speed against accuracy of every method on every scene.

#include <algorithm>
#include <iostream>
#include <memory>

#include "scenes/load/file_bytes.h"
#include "tools/chart/gnuplot.h"
#include "tools/chart/key.h"
#include "tools/chart/measure.h"
#include "tools/chart/options.h"
#include "tools/chart/page.h"
#include "tools/chart/plot.h"
#include "tools/chart/record.h"
#include "tools/chart/report.h"
#include "tools/chart/scene.h"
#include "tools/chart/work.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/files/whole_file.h"

namespace softfocus {
namespace {

void write_text(const std::filesystem::path& file, std::string_view text) {
  WholeFile whole{file};
  whole.write(text);
  whole.commit();
}

void make_directory(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) {
    throw FileError("cannot make the directory '" + directory.string() + "': " + error.message() +
                    "; give -o a place that can be written to");
  }
}

constexpr std::size_t kLargestPlot = std::size_t{1} << 28;

/// gnuplot's own file is not there under its name before it is whole.
std::string plotted(const std::vector<ChartPanel>& panels, const char* terminal,
                    const std::filesystem::path& scratch) {
  run_gnuplot(plot_script(panels, terminal, scratch));
  const std::string bytes = read_file_bytes(scratch, kLargestPlot);
  std::error_code ignored;
  std::filesystem::remove(scratch, ignored);
  return bytes;
}

void write_chart(const std::vector<ChartPanel>& panels, const ChartOptions& options) {
  const std::filesystem::path& directory = options.directory;
  write_text(directory / "chart.csv", chart_csv(panels));
  write_json(directory / "chart.json", chart_json(panels));
  const std::filesystem::path scratch = directory / "cache" / "plot";
  write_text(directory / "chart.png", plotted(panels, "pngcairo", scratch));
  const std::string svg = plotted(panels, "svg", scratch);
  write_text(directory / "chart.svg", svg);
  write_text(directory / "index.html",
             chart_page(panels, svg, {size_text(options.size), machine_key(options.pool)}));
}

void print_fronts(const std::vector<ChartPanel>& panels) {
  for (const ChartPanel& panel : panels) {
    std::cout << panel.scene << ": noise of the truth, FLIP "
              << short_number(panel.noise_floor.flip) << "; best for their time:\n";
    std::vector<const ChartPoint*> front;
    for (const ChartPoint& point : panel.points) {
      if (point.on_front) front.push_back(&point);
    }
    std::sort(front.begin(), front.end(),
              [](const ChartPoint* a, const ChartPoint* b) { return a->median_ms < b->median_ms; });
    for (const ChartPoint* point : front) {
      std::cout << "  " << short_number(point->median_ms) << " ms, FLIP "
                << short_number(point->errors.flip) << ": " << point->entry.method << ' '
                << settings_text(point->entry) << '\n';
    }
  }
}

int chart(const ChartOptions& options) {
  check_scenes(options);
  check_gnuplot();
  make_directory(options.directory / "cache");
  // So that nothing is measured in vain.
  for (const char* name : {"chart.csv", "chart.json", "chart.svg", "chart.png", "index.html"}) {
    check_writable(options.directory / name);
  }
  ThreadPool pool{options.pool.threads, options.pool.isa};
  ChartFindings findings = measure_chart(options, pool);
  for (ChartPanel& panel : findings.panels) settle_points(panel);
  write_chart(findings.panels, options);
  if (findings.kept > 0) {
    std::cout << "went on: " << findings.kept << " of " << findings.all
              << " results were there already\n";
  }
  print_fronts(findings.panels);
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
