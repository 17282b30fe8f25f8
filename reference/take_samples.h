#pragma once
// The loop that sampling methods share: groups of samples until there are enough.

#include <functional>

#include "reference/sample_sums.h"
#include "reference/scene_method.h"

namespace softfocus {

/// Adds the samples `begin` to `end` - 1, at most kSampleGroup, to the sums and their count.
using AddSamples = std::function<void(int begin, int end, SampleSums& sums)>;

SampledPicture take_samples(const SceneMethodInput& input, const AddSamples& add_samples,
                            ThreadPool& pool);

}  // namespace softfocus
