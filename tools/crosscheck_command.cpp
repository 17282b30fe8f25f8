// softfocus crosscheck: the same work on GL drivers and on the emulation, and what of it
// differs.

#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "raster/parallel.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/crosscheck/run_cases.h"
#include "tools/driver_option.h"
#include "tools/errors.h"
#include "tools/option_values.h"
#include "tools/profile_option.h"

namespace softfocus {
namespace {

using nlohmann::ordered_json;

// As for compare.
constexpr int kEqual = 0;
constexpr int kDifferent = 1;
constexpr int kIncomplete = 2;

struct CrosscheckOptions {
  std::vector<const Driver*> drivers;
  std::optional<Profile> profile;
  std::string cases = "*";
  std::filesystem::path pictures;
  std::filesystem::path shaders;
  bool quick = false;
  bool json = false;
};

Profile profile_for(const Driver& driver, const CrosscheckOptions& options) {
  if (options.profile) return *options.profile;
  if (driver.profile.empty()) {
    throw UsageError("--driver " + std::string(driver.name) +
                     " needs --profile: softfocus probe --driver " + std::string(driver.name) +
                     " makes one");
  }
  return find_profile(driver.profile).value();
}

// Without --driver: those whose profile is known.
std::vector<const Driver*> chosen_drivers(const CrosscheckOptions& options) {
  if (!options.drivers.empty()) return options.drivers;
  std::vector<const Driver*> chosen;
  for (const Driver& driver : drivers()) {
    if (!driver.profile.empty()) chosen.push_back(&driver);
  }
  return chosen;
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

void print_result(const CaseResult& result) {
  std::cout << "  " << padded(result.stage + '/' + result.name, 52);
  if (!result.error.empty()) {
    std::cout << "failed: " << result.error << '\n';
    return;
  }
  std::cout << padded(std::to_string(result.differing) + " of " + std::to_string(result.values),
                      24);
  if (result.differing == 0) {
    std::cout << "equal\n";
    return;
  }
  std::cout << "largest " << result.max_ulp << " ULP\n";
  const FirstDifference& first = *result.first;
  std::cout << "    first at pixel " << first.x << ',' << first.y << " channel " << first.channel
            << (first.where.empty() ? "" : ", " + first.where) << ": driver " << first.driver
            << ", emulation " << first.emulated << '\n';
  if (!result.picture.empty()) std::cout << "    " << result.picture << '\n';
}

ordered_json json_of(const Driver& driver, const Profile& profile, const CaseResult& result) {
  ordered_json entry{{"driver", driver.name},    {"profile", profile.name},
                     {"stage", result.stage},    {"case", result.name},
                     {"values", result.values},  {"differing", result.differing},
                     {"max_ulp", result.max_ulp}};
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

int crosscheck(const CrosscheckOptions& options) {
  ordered_json entries = ordered_json::array();
  int cases = 0, equal = 0, failed = 0;
  bool complete = true;
  for (const Driver* driver : chosen_drivers(options)) {
    const Profile profile = profile_for(*driver, options);
    if (matching_cases(options.cases, options.quick, driver->slow) == 0) {
      if (matching_cases(options.cases, false, false) == 0) {
        throw UsageError("--case '" + options.cases +
                         "' matches no case; names look like coverage/slivers-20000, and "
                         "--case 'coverage/*' takes a whole stage");
      }
      std::cerr << "softfocus: " << driver->name << ": no case of --case '" << options.cases
                << "' is run on this driver" << (options.quick ? " with --quick" : "") << '\n';
      continue;
    }
    if (!options.json) std::cout << driver->name << " against profile " << profile.name << '\n';
    const CrosscheckWork work{*driver,       profile,          {options.shaders}, options.cases,
                              options.quick, options.pictures, hardware_threads()};
    const DriverRun run = run_cases(work, [&](const CaseResult& result) {
      ++cases;
      if (!result.error.empty()) {
        ++failed;
      } else if (result.differing == 0) {
        ++equal;
      }
      if (options.json) {
        entries.push_back(json_of(*driver, profile, result));
      } else {
        print_result(result);
        std::cout.flush();
      }
    });
    if (!options.json && !run.renderer.empty()) std::cout << "  (" << run.renderer << ")\n";
    if (!run.error.empty()) {
      complete = false;
      std::cout.flush();
      std::cerr << "softfocus: driver " << driver->name << ": " << run.error << '\n';
    }
  }
  if (options.json) {
    std::cout << entries.dump(2) << '\n';
  } else {
    std::cout << equal << " of " << cases << " cases equal";
    if (failed != 0) std::cout << ", " << failed << " failed";
    std::cout << '\n';
  }
  if (equal + failed < cases) return kDifferent;
  return complete && failed == 0 ? kEqual : kIncomplete;
}

}  // namespace

Command add_crosscheck_command(CLI::App& program) {
  CLI::App* parser = program.add_subcommand("crosscheck",
                                            "Compare the emulation with GL drivers, value by "
                                            "value; status 0 equal, 1 different, 2 error");
  const auto options = std::make_shared<CrosscheckOptions>();
  add_driver_option(*parser, "Driver to compare with, may be repeated (default: Mesa's three)",
                    [options](const Driver& driver) { options->drivers.push_back(&driver); });
  add_profile_option(*parser, "Compare with this profile (default: the driver's own)",
                     [options](const Profile& profile) { options->profile = profile; });
  add_value(*parser, "--case", "GLOB", "Only cases whose STAGE/NAME matches, e.g. 'coverage/*'",
            [options](const std::string& text) { options->cases = text; });
  add_value(*parser, "--shaders", "DIR",
            "Shaders there take the place of those of the same name (see softfocus shaders)",
            [options](const std::string& text) {
              if (!std::filesystem::is_directory(text)) {
                throw UsageError("--shaders '" + text + "': there is no such folder");
              }
              options->shaders = text;
            });
  add_value(*parser, "--diff", "DIR", "Write a picture there for each case that differs",
            [options](const std::string& text) {
              if (!std::filesystem::is_directory(text)) {
                throw UsageError("--diff '" + text + "': there is no such folder");
              }
              options->pictures = text;
            });
  parser->add_flag("--quick", options->quick, "A representative part, under a minute");
  parser->add_flag("--json", options->json, "Print JSON");
  return {parser, [options] { return crosscheck(*options); }};
}

}  // namespace softfocus
