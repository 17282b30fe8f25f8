#pragma once
// Runs cases on a driver, in a process of its own: Mesa settles for one driver and one
// set of CPU features a process, and a driver that crashes takes nothing else along.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "raster/numbers/profile.h"
#include "tools/crosscheck/tally.h"
#include "tools/gl/driver/driver.h"
#include "tools/gl/shaders.h"

namespace softfocus {

struct CaseResult {
  std::string stage;
  std::string name;
  std::uint64_t values = 0;
  std::uint64_t differing = 0;
  std::uint32_t max_ulp = 0;
  std::optional<FirstDifference> first;
  std::string picture;  ///< the file that shows the difference, if one was asked for
  std::string error;    ///< what went wrong; with `values` 0, nothing was compared
};

struct CrosscheckWork {
  const Driver& driver;
  Profile profile;
  Shaders shaders;
  std::vector<std::string> cases;  ///< patterns for "stage/name"; none: all
  std::string pipeline{};          ///< a method's name: its cases in place of all others
  bool quick = false;
  /// The folder for differing cases: the picture, and both sides' values. Empty: none.
  std::filesystem::path pictures;
  int threads = 1;
};

/// A driver's process: its words besides its results.
struct DriverRun {
  std::string renderer;  ///< GL_RENDERER and GL_VERSION
  std::string error;     ///< why the driver could not be used, or how it ended
};

/// Calls `report` for each case as it is done.
DriverRun run_cases(const CrosscheckWork& work,
                    const std::function<void(const CaseResult&)>& report);

/// How many cases the patterns stand for, of all or of a pipeline, on a driver, or on any.
int matching_cases(const std::vector<std::string>& patterns, const std::string& pipeline,
                   bool quick, const Driver* driver);

}  // namespace softfocus
