#pragma once
// No depth of field at all: the camera model that every other method is measured by.

#include "dof/method.h"

namespace softfocus {

/// The picture as it was drawn.
void pinhole(const DofInput& input, Image& result, ThreadPool& pool);

}  // namespace softfocus
