#include "scenes/lens_views/scene_method.h"

#include <array>

#include "scenes/lens_views/accumulation.h"
#include "scenes/lens_views/ray_traced.h"

namespace softfocus {
namespace {

constexpr std::string_view kScene = "the scene";

const std::array kMethods{
    SceneMethod{"accumulation",
                "the mean of pictures from points of the lens: the ground truth",
                kScene,
                {},
                accumulation},
    SceneMethod{"ray-traced", "the mean of rays through the lens, after Cook et al. 1984", kScene,
                ray_traced_missing(), ray_traced},
};

}  // namespace

double aperture_radius_m(const ThinLens& lens, double coc_scale) {
  constexpr double kMillimetres = 1000.0;  // per metre
  return aperture_mm(lens) / kMillimetres / 2.0 * coc_scale;
}

std::span<const SceneMethod> scene_methods() { return kMethods; }

const SceneMethod* find_scene_method(std::string_view name) {
  for (const SceneMethod& method : kMethods) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

}  // namespace softfocus
