#include <stdexcept>
#include <string>

#include "scenes/lens_views/ray_traced.h"

namespace softfocus {

std::string_view ray_traced_missing() {
  return "this build has no Embree, which traces the rays: install it (Debian and Ubuntu: "
         "libembree-dev), then configure and build again";
}

SampledPicture ray_traced(const LensViewInput&, ThreadPool&) {
  throw std::runtime_error("ray-traced: " + std::string{ray_traced_missing()});
}

}  // namespace softfocus
