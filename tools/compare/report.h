#pragma once
// `compare`'s findings, as text and as JSON.

#include <optional>
#include <string>
#include <vector>

#include "dof/measure/code_difference.h"
#include "dof/measure/difference.h"
#include "dof/measure/measures.h"
#include "dof/measure/point_image.h"
#include "dof/measure/regions.h"
#include "tools/compare/options.h"
#include "tools/pictures/picture_notes.h"

namespace softfocus {

// Which lens the regions are of, and who says so.

/// A picture's file and its notes.
struct NamedNotes {
  std::string name;  ///< of the picture, as it was given
  FoundNotes found;
};

struct AssumedLens {
  NotedLens lens;
  std::string source;              ///< "scene", "picture", "options" or "default"
  std::string name;                ///< of the scene or of the file that has the lens; else empty
  std::vector<std::string> given;  ///< the options that overrule the source
  std::vector<std::filesystem::path> files;  ///< that the scene was read from
};

/// The lens for --regions: of --scene, else the first that a picture carries, else ThinLens's and
/// 40 degrees; in each of them the options that were given overrule. Throws UsageError for a lens
/// that cannot be, and SceneError.
AssumedLens assumed_lens(const CompareOptions& options, const std::vector<NamedNotes>& pictures);

/// "85 mm, f/2, focused at 1 m, coc scale 1, field of view 28 degrees".
std::string lens_text(const NotedLens& lens);

/// Who says so: "by a.npy.json", "by the scene figures, --focus as given".
std::string source_text(const AssumedLens& assumed);

/// A line each, on what is doubtful: pictures of two lenses, a sidecar of another picture.
std::vector<std::string> lens_doubts(const std::vector<NamedNotes>& pictures);

struct PointFindings {
  PointShape a, b;
  double disc_radius_px = 0.0;
  double a_deviation = 0.0;
  double b_deviation = 0.0;
};

struct CompareFindings {
  Difference difference;
  /// The first differing value. Valid if difference.differing > 0.
  char channel = 'R';
  float first_a = 0.0f;
  float first_b = 0.0f;
  std::optional<MeasuredPictures> measured;  ///< not where the text says all in one line
  std::optional<AssumedLens> lens;           ///< of --regions: then measured->by_region is filled
  std::vector<std::string> doubts;           ///< lens_doubts()
  std::vector<LimitFinding> limits;
  std::optional<CodeDifference> codes;
  std::optional<PointFindings> point;
  float focus_px = kFocusRadiusPx;  ///< the largest circle of the region in focus
  std::string go_on;                ///< for those to whom the pictures are not equal enough
};

/// Whether all limits were kept.
bool within_limits(const CompareFindings& findings);

void print_compare_text(const CompareFindings& findings);
void print_compare_json(const CompareFindings& findings);

/// One value for each step from frame to frame.
void print_flicker_text(const std::vector<double>& steps);
void print_flicker_json(const std::vector<double>& steps);

/// The mean over the steps.
double mean_flicker(const std::vector<double>& steps);

}  // namespace softfocus
