#pragma once
// No depth of field at all: the camera model that every other method is measured by.

#include "dof/dof.h"

namespace softfocus {

/// The picture as it was drawn.
void pinhole(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus
