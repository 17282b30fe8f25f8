#pragma once
// The loop of every experiment: contenders make their pictures of a case, and measures compare them
// with its truth. What is kept of an earlier run is taken over. `chart` and `stress` give cases,
// contenders, measures and truths as data.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenes/lens_views/accumulation.h"
#include "tools/cli/progress.h"
#include "tools/options/run_options.h"
#include "tools/report/kept_results.h"

namespace softfocus {

// What every experiment is told.

struct LabOptions {
  std::filesystem::path directory;
  std::vector<std::string> methods;  ///< none given: all
  bool quick = false;
  bool quiet = false;
  PoolOptions pool;
};

/// Adds -o. `what` goes there: "the chart".
void add_results_option(CLI::App& parser, LabOptions& options, const std::string& what);

/// Throws UsageError if -o is missing. `what` and `name`: "the chart", "chart".
void check_results_option(const LabOptions& options, const std::string& what,
                          const std::string& name);

// What an experiment does.

/// Something that is found of a contender's pictures: a number, errors, a picture of them.
struct LabMeasure {
  std::string name;  ///< in the record
  std::function<Json()> make;
  /// Gets what was made or kept. Throws JsonError at what is damaged, which is made again.
  std::function<void(const Json&)> take;
  bool is_result = true;  ///< it is counted
  std::string kind{};     ///< of its work; empty: none is planned
  double units = 1.0;     ///< that are planned of it
};

/// What makes pictures of a case.
struct LabContender {
  std::string name;   ///< in the record
  std::string stage;  ///< on the terminal
  std::string kind;   ///< of its work: one unit
  /// Makes the pictures and returns their hash; none: the case is not for it.
  std::function<std::optional<std::string>()> run;
  std::function<std::vector<LabMeasure>(const std::string& hash)> measures;
};

/// An experiment under way.
struct Laboratory {
  explicit Laboratory(bool quiet, bool makes_again = false) : again(makes_again), progress(quiet) {}

  /// With the time that is left.
  void show(const std::string& stage);
  void settle(KeptResults& record, const std::string& entry, const std::string& hash,
              const LabMeasure& measure);
  /// One contender on a case. The record is not saved.
  void run(KeptResults& record, const LabContender& contender);
  /// "went on: 3 of 8 results were there already"; nothing if none were.
  void print_kept(const char* results) const;

  bool again;  ///< nothing kept is taken over
  Progress progress;
  TimeLeft left{};
  int kept = 0;  ///< results that an earlier run left
  int all = 0;   ///< results
};

/// The mean of views of the lens, and the means of either half: one half against the other is the
/// noise of a truth.
struct HalvedViews {
  Image all, first_half, second_half;
};

/// Views `first` to `first + count`, which is a multiple of 2 * kSampleGroup: half of them must end
/// a group, or the bits would differ from accumulation()'s. `on_views` is told how many are in.
HalvedViews halved_views(const LensViewInput& input, int first, int count,
                         const std::function<void(int)>& on_views, ThreadPool& pool);

}  // namespace softfocus
