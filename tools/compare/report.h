#pragma once
// `compare`'s findings, as text and as JSON.

#include <optional>
#include <string>
#include <vector>

#include "dof/measure/difference.h"
#include "dof/measure/measures.h"
#include "dof/measure/point_image.h"
#include "tools/compare/assumed_lens.h"
#include "tools/compare/tolerance.h"

namespace softfocus {

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
  std::optional<PointFindings> point;
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
