#pragma once
// `compare`'s options: two pictures and measures of them, or two sequences.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dof/measure/code_difference.h"
#include "dof/measure/difference.h"
#include "dof/measure/measures.h"
#include "tools/cli/parser.h"
#include "tools/files/whole_file.h"
#include "tools/options/lens_options.h"

namespace softfocus {

// How far off a picture may be: limits, and whether they were kept.

struct Tolerance {
  std::optional<int> max_half_ulps;  ///< of any value, alpha too
  std::optional<double> max_flip;    ///< mean over the picture
  std::optional<double> max_error;   ///< of a colour's value (Difference::max_error)
  std::optional<double> max_pixels;  ///< that differ (PixelLimit); 0 if what follows is given
  bool is_percent = false;           ///< max_pixels is of all pixels
  std::optional<double> max_difference;
  std::optional<int> search_px;

  bool operator==(const Tolerance&) const = default;
};

bool counts_pixels(const Tolerance& tolerance);
bool has_limits(const Tolerance& tolerance);

/// A limit, what was found, and the names of both.
struct LimitFinding {
  std::string option;  ///< "--max-ulps"
  std::string unit;    ///< " half-ULPs", or nothing
  double limit = 0.0;
  double value = 0.0;
};

inline bool is_kept(const LimitFinding& finding) { return finding.value <= finding.limit; }

/// A finding for each limit. `flip` is needed with max_flip alone, `pixels_beyond` if pixels count.
std::vector<LimitFinding> check_limits(const Tolerance& tolerance, const Difference& difference,
                                       std::optional<double> flip,
                                       std::optional<std::uint64_t> pixels_beyond);

/// "--max-ulps 4: broken by 1, 5 half-ULPs".
std::string limit_text(const LimitFinding& finding);

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

  std::optional<double> code_threshold;  ///< codes are compared too (dof/measure/code_difference.h)

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
