#include "tools/crosscheck/cases.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

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

std::vector<Case> quick_cases(bool few) {
  constexpr std::array<std::string_view, 5> kBesides{
      "kernel/box-in-four-reads-61x43", "bloom/odd-61x43-steady", "reprojection/forward-61x43",
      "reprojection/refresh-61x43", "temporal/frame-reverse-filled"};
  std::vector<Case> chosen;
  std::set<std::string> stages;
  for (Case& one : crosscheck_cases()) {
    if (!one.quick || one.has_samples) continue;
    const bool is_first = stages.insert(one.stage).second;
    const std::string name = one.stage + '/' + one.name;
    const bool is_besides = std::find(kBesides.begin(), kBesides.end(), name) != kBesides.end();
    if (!few || is_first || is_besides) chosen.push_back(std::move(one));
  }
  return chosen;
}

}  // namespace softfocus
