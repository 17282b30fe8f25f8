#pragma once
// The loop that sampling methods share: groups of samples until there are enough.

#include <functional>

#include "scenes/lens_views/lens_view_method.h"
#include "scenes/lens_views/sample_sums.h"

namespace softfocus {

/// Adds the samples `begin` to `end` - 1, a step at most, to the sums, and counts them.
using AddSamples = std::function<void(int begin, int end, SampleSums& sums)>;

/// In steps of kSampleGroup, and from 16 samples on of `step`: kSampleGroup or twice that.
SampledPicture take_samples(const LensViewInput& input, const AddSamples& add_samples, int step,
                            ThreadPool& pool);

}  // namespace softfocus
