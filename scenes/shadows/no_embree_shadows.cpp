#include <stdexcept>
#include <string>

#include "scenes/shadows/embree_shadows.h"

namespace softfocus {

struct EmbreeShadows::Tree {};

std::string_view embree_shadows_missing() {
  return "this build has no Embree: install it (Debian and Ubuntu: libembree-dev), then configure "
         "and build again";
}

EmbreeShadows::EmbreeShadows(const Facets&) {
  throw std::runtime_error("shadows by Embree: " + std::string{embree_shadows_missing()});
}

EmbreeShadows::~EmbreeShadows() = default;

bool EmbreeShadows::is_dark(std::uint32_t, bool, glm::dvec3, const ShadowLight&) const {
  return false;
}

}  // namespace softfocus
