#pragma once
// Flicker: change from frame to frame that the ground truth does not have.

#include <span>

#include "dof/measure/tone.h"
#include "raster/images/image.h"

namespace softfocus {

/// Two frames of a sequence, and the same two of its ground truth. All RGBA16F, of one size.
struct FlickerStep {
  const Image& before;
  const Image& after;
  const Image& truth_before;
  const Image& truth_after;
};

/// Mean over pixels, red, green and blue of |(I_t - I_t-1) - (G_t - G_t-1)| on toned
/// values, 0 to 2. A picture that is wrong in the same way in both frames has 0.
double flicker(const FlickerStep& step, const ToneTable& tone);

/// The mean over the steps of two frames or more, and as many of the ground truth.
double flicker(std::span<const Image> frames, std::span<const Image> truth, const ToneTable& tone);

}  // namespace softfocus
