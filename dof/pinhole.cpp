#include "dof/pinhole.h"

namespace softfocus {

Image pinhole(const DofInput& input, ThreadPool&) { return input.scene; }

}  // namespace softfocus
