#pragma once
// The commonest step of a walk, many at once: from one neighbour to the next, past the centre of
// one texel at the most.

#include <cstdint>

#include "raster/lanes/isa.h"
#include "scenes/relief/warp/pre_warp.h"
#include "scenes/relief/warp/resample.h"

namespace softfocus {

/// The two neighbours of each step, number by number. A colour of 0 is no texel.
struct WalkSteps {
  const float *from_along, *along;
  const float *from_across, *across;  ///< of rows; of columns anything
  const float *from_depth, *depth;
  const std::uint32_t *from_colour, *colour;
};

struct StepRule {
  PreWarp warp;
  float most_m;
  int sign;        ///< which way the walk goes
  int row;         ///< of a row's walk, for the place in its columns
  bool to_column;  ///< whether the place in the column is the two-pass or the compensated one
  bool compensated;
};

/// The texel that a step puts. A step that passes several centres, or ends or begins a run, is left
/// to walk()'s own rule.
struct SteppedTexels {
  /// The texel that is filled, kNoTexel if none, or kOtherStep.
  std::int32_t* reached;
  std::uint32_t* colour;
  float *across, *depth;
};
inline constexpr std::int32_t kNoTexel = INT32_MIN, kOtherStep = INT32_MIN + 1;

/// fill_between() of `count` steps, with its bits.
void step_texels(const WalkSteps& steps, const StepRule& rule, int count, const SteppedTexels& to,
                 Isa isa);

}  // namespace softfocus
