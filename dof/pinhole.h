#pragma once
// No depth of field at all: the camera model that every other method is measured by.

#include "dof/method.h"

namespace softfocus {

/// The picture as it was drawn.
Image pinhole(const DofInput& input, ThreadPool& pool);

}  // namespace softfocus
