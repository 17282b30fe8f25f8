// softfocus crosscheck: does the same work on GL drivers and on the emulation, and compares.

#include <algorithm>
#include <iostream>
#include <memory>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/pipeline_file.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/crosscheck/run_cases.h"
#include "tools/files/json.h"
#include "tools/files/whole_file.h"
#include "tools/gl/driver/context.h"
#include "tools/options/method_options.h"
#include "tools/options/run_options.h"

namespace softfocus {
namespace {

// As for compare.
constexpr int kEqual = 0;
constexpr int kDifferent = 1;
constexpr int kIncomplete = 2;

struct CrosscheckOptions {
  std::vector<const Driver*> drivers;
  std::optional<ChosenProfile> profile;
  std::vector<std::string> cases;
  std::string pipeline;
  std::filesystem::path pictures;
  Shaders shaders;
  bool quick = false;
  bool json = false;
};

/// The work of a driver's process.
struct DriverWork {
  const Driver* driver;
  ChosenProfile profile;
  int cases;
};

ChosenProfile profile_for(const Driver& driver, const CrosscheckOptions& options) {
  if (options.profile) return *options.profile;
  if (driver.profile.empty()) {
    throw UsageError("--driver " + std::string(driver.name) +
                     " needs --profile: softfocus probe --driver " + std::string(driver.name) +
                     " makes one");
  }
  return {std::string(driver.profile), "", find_profile(driver.profile).value()};
}

// Without --driver, the machine's drivers whose profile is known, or if the build has none, the
// emulated GPU. Checks the options first, before a driver
// has worked for minutes.
std::vector<DriverWork> planned_work(const CrosscheckOptions& options) {
  std::vector<const Driver*> chosen = options.drivers;
  if (chosen.empty()) {
    for (const Driver& driver : drivers()) {
      if (!driver.profile.empty() && driver.is_emulated != has_egl()) chosen.push_back(&driver);
    }
  }
  std::vector<DriverWork> work;
  work.reserve(chosen.size());
  for (const Driver* driver : chosen) work.push_back({driver, profile_for(*driver, options), 0});
  for (const std::string& pattern : options.cases) {
    if (matching_cases({pattern}, options.pipeline, false, nullptr) != 0) continue;
    throw UsageError("--case '" + pattern +
                     "' matches no case; names look like coverage/slivers-20000, and "
                     "--case 'coverage/*' takes a whole stage");
  }
  for (DriverWork& one : work) {
    one.cases = matching_cases(options.cases, options.pipeline, options.quick, one.driver);
  }
  return work;
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

bool was_compared(const CaseResult& result) { return result.values != 0; }

void print_result(const CaseResult& result) {
  std::cout << "  " << padded(result.stage + '/' + result.name, 52);
  if (was_compared(result)) {
    std::cout << padded(std::to_string(result.differing) + " of " + std::to_string(result.values),
                        24);
  }
  if (!result.error.empty()) {
    std::cout << "failed: " << printable(result.error) << '\n';
  } else if (result.differing == 0) {
    std::cout << "equal\n";
  } else {
    std::cout << "largest " << result.max_ulp << " ULP\n";
  }
  if (!result.first) return;
  const FirstDifference& first = *result.first;
  std::cout << "    first at pixel " << first.x << ',' << first.y << " channel " << first.channel
            << (first.where.empty() ? "" : ", " + first.where) << ": driver " << first.driver
            << ", emulation " << first.emulated << '\n';
  if (!result.picture.empty()) std::cout << "    " << printable(result.picture) << '\n';
}

Json json_of(const DriverWork& work, const CaseResult& result) {
  Json entry{{"driver", work.driver->name}, {"profile", work.profile.name}, {"stage", result.stage},
             {"case", result.name},         {"values", result.values},      {"differing", nullptr},
             {"max_ulp", nullptr}};
  // A result that was not compared is not equal.
  if (was_compared(result)) {
    entry["differing"] = result.differing;
    entry["max_ulp"] = result.max_ulp;
  }
  if (!result.picture.empty()) entry["picture"] = result.picture;
  if (!result.error.empty()) entry["error"] = result.error;
  if (result.first) {
    const FirstDifference& first = *result.first;
    entry["first"] = {
        {"x", first.x},         {"y", first.y},           {"channel", first.channel},
        {"where", first.where}, {"driver", first.driver}, {"emulated", first.emulated}};
  }
  return entry;
}

// For a driver that could not be used, or not to its end.
Json json_of(const DriverWork& work, const std::string& error) {
  return {{"driver", work.driver->name},
          {"profile", work.profile.name},
          {"stage", nullptr},
          {"case", nullptr},
          {"values", 0},
          {"differing", nullptr},
          {"max_ulp", nullptr},
          {"error", error}};
}

struct Count {
  int planned = 0;
  int run = 0;
  int equal = 0;
  int different = 0;
  int failed = 0;
};

void add(Count& count, const CaseResult& result) {
  ++count.run;
  count.different += result.differing != 0 ? 1 : 0;
  count.failed += !result.error.empty() ? 1 : 0;
  count.equal += result.differing == 0 && result.error.empty() ? 1 : 0;
}

void print_summary(const Count& count, const CrosscheckOptions& options) {
  std::cout << count.equal << " of " << count.planned << " cases equal";
  if (count.failed != 0) std::cout << ", " << count.failed << " failed";
  if (count.run != count.planned) std::cout << ", " << count.planned - count.run << " not run";
  if (count.different != 0 && options.pictures.empty()) {
    std::cout << "; --diff DIR shows where";
  }
  std::cout << '\n';
}

// Makes the folder if it is not there, and checks that pictures can be written into it.
void prepare_folder(const std::filesystem::path& folder) {
  std::error_code error, unknown;
  std::filesystem::create_directories(folder, error);
  // Another process may have made it in the meantime.
  if (!std::filesystem::is_directory(folder, unknown)) {
    throw UsageError("--diff: cannot make the folder '" + folder.string() + "'" +
                     (error ? ": " + error.message() : "") + "; give another place");
  }
  try {
    check_writable(folder / "picture.png");
  } catch (const FileError& unwritable) {
    throw UsageError(std::string("--diff: ") + unwritable.what());
  }
}

int crosscheck(const CrosscheckOptions& options) {
  Json entries = Json::array();
  Count count;
  bool complete = true;
  const std::vector<DriverWork> planned = planned_work(options);
  if (!options.pictures.empty()) prepare_folder(options.pictures);
  for (const DriverWork& work : planned) {
    count.planned += work.cases;
    std::string error;
    if (work.cases == 0) {
      error = std::string{"no case that --case names is for this driver"} +
              (options.quick ? " and --quick" : "");
    } else {
      if (!options.json) {
        std::cout << work.driver->name << " against profile " << printable(work.profile.name)
                  << '\n';
      }
      const DriverRun run =
          run_cases({*work.driver, work.profile.profile, options.shaders, options.cases,
                     options.pipeline, options.quick, options.pictures, hardware_threads()},
                    [&](const CaseResult& result) {
                      add(count, result);
                      if (options.json) {
                        entries.push_back(json_of(work, result));
                      } else {
                        print_result(result);
                        std::cout.flush();
                      }
                    });
      if (!options.json && !run.renderer.empty()) {
        std::cout << "  (" << printable(run.renderer) << ")\n";
      }
      error = run.error;
    }
    if (error.empty()) continue;
    complete = false;
    entries.push_back(json_of(work, error));
    std::cout.flush();
    tell("driver " + std::string{work.driver->name} + ": " + error);
  }
  if (options.json) {
    // A file's name need not be UTF-8, but JSON must be.
    std::cout << json_text(entries, 2) << '\n';
  } else {
    print_summary(count, options);
  }
  if (count.different != 0) return kDifferent;
  return complete && count.failed == 0 ? kEqual : kIncomplete;
}

}  // namespace

Command add_crosscheck_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "crosscheck",
                                 "Compare the emulation with GL drivers, value by "
                                 "value; status 0 equal, 1 different, 2 error");
  const auto options = std::make_shared<CrosscheckOptions>();
  add_driver_option(
      *parser,
      "Driver to compare with, may be repeated (default: Mesa's four; without libepoxy, emulated)",
      [options](const Driver& driver) {
        auto& chosen = options->drivers;
        if (std::find(chosen.begin(), chosen.end(), &driver) == chosen.end()) {
          chosen.push_back(&driver);
        }
      });
  add_profile_option(*parser, "Compare with this profile (default: the driver's own)",
                     [options](const ChosenProfile& chosen) { options->profile = chosen; });
  add_repeatable_value(*parser, "--case", "GLOB",
                       "Only cases whose STAGE/NAME matches, e.g. 'coverage/*'; may be repeated",
                       [options](const std::string& text) { options->cases.push_back(text); });
  add_value(*parser, "--pipeline", "FILE",
            "Passes of yours in place of all cases, pass by pass (docs/shaders.md)",
            [options](const std::string& text) {
              if (!is_pipeline_name(text)) {
                throw UsageError("--pipeline '" + text + "': FILE.toml would be right");
              }
              find_named_method("--pipeline", text);
              options->pipeline = text;
            });
  add_shaders_option(*parser, options->shaders);
  add_value(*parser, "--diff", "DIR",
            "Write there a picture and both sides' values of each case that differs",
            [options](const std::string& text) {
              if (text.empty()) throw UsageError("--diff '': give the name of a folder");
              options->pictures = text;
            });
  add_flag(*parser, "--quick", "A representative part, under a minute", options->quick);
  add_flag(*parser, "--json", "Print JSON", options->json);
  return {parser, [options] { return crosscheck(*options); }};
}

}  // namespace softfocus
