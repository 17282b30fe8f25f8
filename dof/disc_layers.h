#pragma once
// Layered discs.
#include "dof/method.h"

namespace softfocus {

void disc_layers(const DofInput& input, Image& result, ThreadPool& pool);

}  // namespace softfocus
