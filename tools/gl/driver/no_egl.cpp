// Stands in for EGL in a build without libepoxy.

#include "tools/gl/driver/context.h"

namespace softfocus {

bool has_egl() { return false; }

void GlContext::open_by_egl(const Driver& /*driver*/, std::optional<int> /*threads*/) {
  throw DriverError(
      "this program was built without GL drivers, because libepoxy was not there; "
      "docs/building.md says how to build it with them");
}

void GlContext::close() {}

}  // namespace softfocus
