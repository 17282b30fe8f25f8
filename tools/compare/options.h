#pragma once
// `compare`'s options: two pictures and measures of them, or two sequences.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dof/measure/measures.h"
#include "tools/cli/parser.h"
#include "tools/compare/tolerance.h"
#include "tools/files/same_file.h"
#include "tools/options/lens_options.h"

namespace softfocus {

struct CompareOptions {
  std::string first;   ///< what is judged
  std::string second;  ///< the reference: its depths make regions, its light exposures
  std::optional<std::string> flip_map_file;
  std::optional<std::string> ulp_map_file;
  MeasureSettings measures;

  bool regions = false;
  std::optional<std::string> depth_file;  ///< instead of the pictures' alpha
  std::optional<std::string> scene;       ///< whose lens and field of view make the regions
  std::vector<std::filesystem::path> scene_path;
  LensOptions lens;
  std::optional<double> fov_y_degrees;

  std::optional<double> point_radius_px;  ///< both are images of a point with this disc

  Tolerance tolerance;

  std::vector<std::string> frames;  ///< --flicker
  std::vector<std::string> truth;   ///< --against

  bool json = false;
};

void add_compare_options(CLI::App& parser, CompareOptions& options);

/// Throws UsageError if a map would be written over one of these files.
void check_maps(const CompareOptions& options, const std::vector<ReadFile>& inputs);

/// Throws UsageError where options need or exclude each other.
void check_compare_options(const CompareOptions& options);

}  // namespace softfocus
