#pragma once
// The two-pass filter in strips of columns, on a unit with kernels.

#include <vector>

#include "dof/focus_map.h"
#include "dof/dof.h"
#include "dof/two_pass/two_pass_strip.h"

namespace softfocus {

/// A part of a picture that is to be filtered, and what it needs.
struct StripTask {
  int x_begin, x_end;
  int y_begin, y_end;
  int first_row, last_row;  ///< the rows that reach it
  int reach;                ///< of taps, to each side
};

/// The parts of a picture that are not in focus, or reached by what is not.
std::vector<StripTask> plan_strips(const FocusMap& map, int width, int height);

/// As two_pass() or two_pass_single().
void two_pass_strips(const DofInput& input, Between between, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus
