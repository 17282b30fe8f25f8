#pragma once
// Everything that `chart` is told.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/chart/subject.h"
#include "tools/cli/option_values.h"
#include "tools/cli/parser.h"
#include "tools/report/laboratory.h"

namespace softfocus {

/// The pinhole is always among the methods.
struct ChartOptions : LabOptions {
  const ChartSubject* subject = &chart_subjects().front();
  std::vector<std::string> scenes;  ///< as `render` takes them; none given: the subject's
  std::vector<std::filesystem::path> scene_path;
  std::optional<PictureSize> given_size;
  std::optional<int> given_samples;
  std::optional<int> given_rounds;
  double frame = 0.0;
  bool again = false;

  // Settled by complete().
  PictureSize size;
  int truth_samples = 0;  ///< a multiple of kTruthSampleStep
  int rounds = 0;         ///< 0: nothing is timed
};

void add_chart_options(CLI::App& parser, ChartOptions& options);

/// Settles what was not given. Throws UsageError if memory is too small for the size, or if no
/// scene is found.
void complete(ChartOptions& options);

/// The names of "a,b,c". "random:8..11" stands for random:8, random:9, random:10 and random:11.
/// Throws UsageError for an empty name, a name given twice, or a malformed range.
std::vector<std::string> scene_names(const std::string& text);

/// A scene's name as the name of a file: "random-8", for not every system has ':' in names.
std::string name_for_files(std::string_view scene);

}  // namespace softfocus
