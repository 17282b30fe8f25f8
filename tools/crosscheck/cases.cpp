#include "tools/crosscheck/cases.h"

#include "tools/gl/driver/api.h"

namespace softfocus {

std::vector<Case> crosscheck_cases() {
  std::vector<Case> cases;
  add_store_cases(cases);
  add_texture_cases(cases);
  add_triangle_cases(cases);
  add_scene_cases(cases);
  if (!kIsWebGl) {  // not tried there
    add_peel_cases(cases);
    add_blend_cases(cases);
  }
  add_kernel_cases(cases);
  add_effect_cases(cases);
  add_shadow_cases(cases);
  if (!kIsWebGl) {  // which has no doubles
    add_shadow_map_cases(cases);
    add_shadow_volume_cases(cases);
  }
  add_motion_cases(cases);
  add_temporal_cases(cases);
  add_filter_cases(cases);
  add_polygon_cases(cases);
  if (!kIsWebGl) add_relief_cases(cases);  // not tried there
  return cases;
}

}  // namespace softfocus
