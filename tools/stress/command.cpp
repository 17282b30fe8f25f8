// softfocus stress: where each method fails, on cases with a known answer.

#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/report/report.h"
#include "tools/stress/findings.h"
#include "tools/stress/stress_report.h"

namespace softfocus {
namespace {

int stress(const StressOptions& options) {
  const std::filesystem::path& directory = options.directory;
  const auto csv = directory / "stress.csv", list = directory / "stress.json",
             page = directory / "index.html";
  prepare_results(directory, {csv, list, page});
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const StressFindings findings = measure_stress(options, pool);
  const Json json = stress_json(findings);
  write_json(list, json);
  write_text(csv, stress_csv(json));
  write_text(page, report_page(stress_report(findings, options)));
  if (options.json) {
    std::cout << json_text(json, 1) << '\n';
    return kDone;
  }
  if (findings.kept > 0) {
    std::cout << "went on: " << findings.kept << " of " << findings.all
              << " values were there already\n";
  }
  std::cout << stress_summary(findings) << "written to " << page.string() << '\n';
  return kDone;
}

}  // namespace

Command add_stress_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "stress",
                                 "Measure where each method fails, on cases with known answers");
  const auto options = std::make_shared<StressOptions>();
  add_stress_options(*parser, *options);
  return {parser, [options] {
            complete(*options);
            return stress(*options);
          }};
}

}  // namespace softfocus
