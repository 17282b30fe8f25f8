#pragma once
// --sharp-depths: which depths are sharp, for methods that take radii (dof/sharp_depths.h).

#include <string>
#include <vector>

#include "dof/sharp_depths.h"
#include "tools/cli/parser.h"
#include "tools/files/json.h"
#include "tools/options/method_options.h"

namespace softfocus {

struct SharpDepthRange {
  double near_m = 0.0;
  double far_m = 0.0;
};

/// Adds --sharp-depths.
void add_sharp_depths_option(CLI::App& parser, std::vector<SharpDepthRange>& ranges);

/// Throws UsageError if it was given, and the method takes no radii or another option settles
/// what is sharp.
void check_sharp_depths(const CLI::App& parser, const MethodChoice& method, bool shows_image);

/// The lens focused at the ends of the ranges. Throws UsageError if it cannot be.
std::vector<SharpDepths> sharp_depths(const std::vector<SharpDepthRange>& ranges,
                                      const ThinLens& lens, double fov_y_degrees, int height_px,
                                      double coc_scale);

/// "1:2,4:8".
std::string ranges_text(const std::vector<SharpDepthRange>& ranges);

/// [[1, 2], [4, 8]].
Json ranges_json(const std::vector<SharpDepthRange>& ranges);

}  // namespace softfocus
