#include "tools/stress/stress_options.h"

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/stress/answers.h"

namespace softfocus {
namespace {

constexpr int kSmallestStressPx = 64, kLargestStressPx = 1024, kSizeStep = 16;
constexpr int kUsualStressPx = 256, kQuickStressPx = 128;

std::vector<std::string> case_names() {
  std::vector<std::string> names;
  for (const StressCase& of : stress_cases()) names.emplace_back(of.name);
  return names;
}

}  // namespace

void add_stress_options(CLI::App& parser, StressOptions& options) {
  begin_group(parser, "Output");
  add_flag(parser, "--json", "Print what stress.json holds, and nothing else", options.json);
  add_value(parser, "-o,--output", "DIR", "Where the atlas and what was measured go; required",
            [&options](const std::string& text) { options.directory = text; });
  begin_group(parser, "What is measured");
  add_value(parser, "--methods", "A,B,...",
            "Methods (default: all; each case takes those that it is for)",
            [&options](const std::string& text) {
              options.methods = listed_names("--methods", text, stress_methods());
            });
  offer(parser, "--methods", stress_methods);
  add_value(parser, "--cases", "A,B,...", "Cases (default: all)",
            [&options](const std::string& text) {
              options.cases = listed_names("--cases", text, case_names());
            });
  offer(parser, "--cases", case_names);
  add_value(parser, "--size", "N",
            "Width and height of the pictures, a multiple of 16 from 64 to 1024 (default: 256; 128 "
            "with --quick); circles larger than a quarter of it are left out",
            [&options](const std::string& text) {
              constexpr std::string_view kWanted = "a multiple of 16 from 64 to 1024";
              options.size_px =
                  parse_whole("--size", text, kSmallestStressPx, kLargestStressPx, kWanted);
              if (options.size_px % kSizeStep != 0) {
                throw UsageError("--size '" + text + "': give " + std::string{kWanted});
              }
            });
  add_flag(parser, "--quick", "Small pictures, three severities a case: under a minute",
           options.quick);
  begin_group(parser, "Run");
  add_pool_options(parser, options.pool, "the results are the same");
  add_quiet_option(parser, options.quiet);
}

void complete(StressOptions& options) {
  if (options.directory.empty()) {
    throw UsageError("-o is missing; give a directory for the atlas, such as -o atlas");
  }
  if (options.size_px == 0) options.size_px = options.quick ? kQuickStressPx : kUsualStressPx;
  if (options.methods.empty()) options.methods = stress_methods();
  if (options.cases.empty()) options.cases = case_names();
}

}  // namespace softfocus
