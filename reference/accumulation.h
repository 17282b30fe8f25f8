#pragma once
// The accumulation buffer (Haeberli and Akeley 1990): the scene drawn from points of the
// lens, and the mean of the pictures.

#include "reference/scene_method.h"

namespace softfocus {

/// Each picture is drawn as the pinhole's is, in RGBA16F, from a point of lens_points() and
/// in the view of lens_view(). One sample without jitter is the pinhole's picture. What it
/// lacks at few samples: a thing out of focus is a handful of sharp ghosts.
SampledPicture accumulation(const SceneMethodInput& input, ThreadPool& pool);

}  // namespace softfocus
