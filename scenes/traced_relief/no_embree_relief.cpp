#include <stdexcept>
#include <string>

#include "scenes/traced_relief/traced_relief.h"

namespace softfocus {

std::string_view traced_relief_missing() {
  return "this build has no Embree, which traces the rays: install it (Debian and Ubuntu: "
         "libembree-dev), then configure and build again";
}

ReliefTexture trace_relief(const ReliefMaker&, const ReliefView&, const ReliefForm&, ThreadPool&) {
  throw std::runtime_error("traced relief: " + std::string{traced_relief_missing()});
}

}  // namespace softfocus
