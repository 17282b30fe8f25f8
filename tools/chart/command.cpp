// softfocus chart: speed against accuracy of every method on every scene.

#include <algorithm>
#include <iostream>
#include <memory>

#include "tools/chart/measure.h"
#include "tools/chart/options.h"
#include "tools/chart/record.h"
#include "tools/chart/report/numbers.h"
#include "tools/chart/report/page.h"
#include "tools/chart/scene.h"
#include "tools/chart/work.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/files/same_file.h"
#include "tools/files/whole_file.h"
#include "tools/report/report.h"

namespace softfocus {
namespace {

void write_list(const Json& list, const std::string& name, const ChartOptions& options) {
  write_text(options.directory / (name + ".csv"), csv_of(list));
  write_json(options.directory / (name + ".json"), list);
}

/// The command with what was settled, but for what is usual.
std::string command_of(const ChartOptions& options) {
  std::vector<std::string> words{"softfocus", "chart",
                                 "--of",      std::string{options.subject->name},
                                 "--scenes",  joined_names(options.scenes),
                                 "--size",    size_text(options.size),
                                 "--rounds",  std::to_string(options.rounds),
                                 "--frame",   short_number(options.frame)};
  if (options.methods != options.subject->methods()) {
    words.insert(words.end(), {"--methods", joined_names(options.methods)});
  }
  if (options.subject->truth_of == nullptr) {
    words.insert(words.end(), {"--samples", std::to_string(options.truth_samples)});
  }
  if (options.quick) words.emplace_back("--quick");
  return command_text(words);
}

void write_chart(const std::vector<ChartPanel>& panels, const ChartOptions& options) {
  const std::vector<BestForBudget> best = best_for_budgets(panels);
  const std::vector<SummaryRow> summary = summary_of(panels);
  write_list(chart_json(panels), "chart", options);
  write_list(best_json(best), "best", options);
  write_list(summary_json(summary), "summary", options);
  write_text(options.directory / "index.html",
             report_page(chart_report({.subject = *options.subject,
                                       .panels = panels,
                                       .best = best,
                                       .summary = summary,
                                       .size = size_text(options.size),
                                       .command = command_of(options),
                                       .machine = machine_key(options.pool)})));
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
std::vector<std::filesystem::path> output_files(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files{directory / "index.html"};
  for (const char* name : {"chart", "best", "summary"}) {
    for (const char* ending : {".csv", ".json"}) {
      files.push_back(directory / (std::string{name} + ending));
    }
  }
  return files;
}

int chart(const ChartOptions& options) {
  const std::vector<std::filesystem::path> outputs = output_files(options.directory);
  const std::vector<ReadFile> inputs = check_scenes(options);
  for (const auto& file : outputs) check_not_read("-o", file, inputs);
  prepare_results(options.directory, outputs);
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
