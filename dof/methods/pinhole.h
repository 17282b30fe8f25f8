#pragma once
// A pinhole camera: no depth of field.

#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h): copies the picture.
void pinhole(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus
