#pragma once
// What a value that is given at some frames is at the others, and the lens at a frame.

#include <span>

#include "scenes/scene.h"

namespace softfocus {

/// The value at `frame` of at least one key, whose frames increase. Before the first key and after
/// the last it stands still; a key's own value comes back exactly. In between it lies between the
/// values of the two keys:
///
///   linear   on the straight line
///   smooth   on a cubic for each pair of keys, with one speed for both at a key. It is 0 at the
///            first key, at the last, and where the way turns; else it is the weighted harmonic
///            mean of the two slopes, which never overshoots (Fritsch and Butland 1984).
///
/// In binary64 by + - * / alone: the same bits on every machine.
double value_at(std::span<const Keyframe> keys, Easing easing, double frame);

/// The scene's lens at a frame.
ThinLens lens_at(const SceneLens& lens, double frame);

}  // namespace softfocus
