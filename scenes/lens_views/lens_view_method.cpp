#include "scenes/lens_views/lens_view_method.h"

#include <array>

#include "scenes/filtered_views/filtered_views.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/lens_views/ray_traced.h"
#include "scenes/surface_splatting/surface_splatting.h"
#include "scenes/warped_views/warped_views.h"

namespace softfocus {
namespace {

constexpr std::string_view kScene = "the scene";

const std::array kMethods{
    LensViewMethod{"accumulation",
                   "the mean of pictures from points of the lens: the ground truth",
                   kScene,
                   {},
                   accumulation,
                   true,
                   Sampling{}.samples,
                   Sampling{}.samples,
                   true},
    LensViewMethod{"filtered-views",
                   "few views, each spread over its part of the lens, and averaged",
                   kScene,
                   {},
                   filtered_views,
                   true,
                   kFilteredViews,
                   kMostFilteredViewsByTile},
    LensViewMethod{"warped-accumulation",
                   "few views drawn, and warped to many points of the lens",
                   kScene,
                   {},
                   warped_accumulation,
                   true,
                   kUsualWarpedViews,
                   0,
                   false,
                   true},
    LensViewMethod{"ray-traced", "the mean of rays through the lens, after Cook et al. 1984",
                   kScene, ray_traced_missing(), ray_traced},
    LensViewMethod{"surface-splatting",
                   "surfaces as Gaussian points, after Krivanek, Zara and Bouatouch 2003",
                   kScene,
                   {},
                   surface_splatting,
                   false},
};

}  // namespace

double aperture_radius_m(const ThinLens& lens, double coc_scale) {
  constexpr double kMillimetres = 1000.0;  // per metre
  return aperture_mm(lens) / kMillimetres / 2.0 * coc_scale;
}

std::span<const LensViewMethod> lens_view_methods() { return kMethods; }

const LensViewMethod* find_lens_view_method(std::string_view name) {
  for (const LensViewMethod& method : kMethods) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

}  // namespace softfocus
