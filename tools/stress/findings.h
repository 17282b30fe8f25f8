#pragma once
// `stress`'s findings: values by case, method and severity, and pictures to look at.

#include <optional>
#include <string>
#include <vector>

#include "tools/cli/parser.h"
#include "tools/report/laboratory.h"
#include "tools/stress/cases/stress_case.h"

namespace softfocus {

// Everything that `stress` is told.

struct StressOptions : LabOptions {
  std::vector<std::string> cases;  ///< none given: all
  int size_px = 0;                 ///< 0: 256, or 128 with `quick`
  bool json = false;
};

void add_stress_options(CLI::App& parser, StressOptions& options);

/// Settles what was not given. Throws UsageError.
void complete(StressOptions& options);

/// PNG in base64, of the telling severity.
struct StressPictures {
  std::string picture;
  std::string error;  ///< the map of FLIP
};

/// A method on a case.
struct StressCurve {
  std::string method;
  bool can_run = false;          ///< false: the case is a picture, and the method needs a scene
  std::vector<double> values{};  ///< one a severity, of 6 digits; not finite where all is spoilt
  StressPictures pictures{};
};

struct StressResult {
  StressCase of;
  std::vector<double> severities;
  /// The truth's one half against the other, one a severity; empty if it is calculated.
  std::vector<double> noise_floor;
  int views = 0;
  double shown = 0.0;  ///< the severity of the pictures
  std::string sharp, truth;
  std::vector<StressCurve> curves;
};

inline bool holds(const StressCase& of, double value) { return value <= of.limit; }

/// The index of the mildest severity that does not hold.
std::optional<std::size_t> first_failure(const StressResult& result, const StressCurve& curve);

/// Measures what `options.directory` does not hold yet, and keeps it there: in the order of
/// stress_cases().
std::vector<StressResult> measure_stress(const StressOptions& options, ThreadPool& pool);

}  // namespace softfocus
