#include "tools/compare/assumed_lens.h"

#include "scenes/load/load_scene.h"
#include "tools/cli/option_values.h"
#include "tools/options/lens_options.h"

namespace softfocus {
namespace {

AssumedLens known_lens(const CompareOptions& options, const std::vector<NamedNotes>& pictures) {
  if (options.scene) {
    const Scene scene = load_scene(*options.scene, scene_search_path(options.scene_path));
    return {{scene.lens.lens, scene.lens.coc_scale, scene.camera.fov_y_degrees},
            "scene",
            scene.name,
            {},
            scene.files};
  }
  for (const NamedNotes& picture : pictures) {
    if (picture.found.notes && picture.found.notes->lens) {
      return {*picture.found.notes->lens, "picture", picture.found.place.string(), {}, {}};
    }
  }
  return {{}, "default", "", {}, {}};
}

std::string degrees_text(double degrees) { return short_number(degrees) + " degrees"; }

}  // namespace

AssumedLens assumed_lens(const CompareOptions& options, const std::vector<NamedNotes>& pictures) {
  AssumedLens assumed = known_lens(options, pictures);
  const auto overrule = [&](const char* option, std::optional<double> value, double& place) {
    if (!value) return;
    place = *value;
    assumed.given.emplace_back(option);
  };
  NotedLens& lens = assumed.lens;
  overrule("--focus", options.lens.focus_m, lens.lens.focus_m);
  overrule("--focal-length", options.lens.focal_length_mm, lens.lens.focal_length_mm);
  overrule("--f-number", options.lens.f_number, lens.lens.f_number);
  overrule("--coc-scale", options.lens.coc_scale, lens.coc_scale);
  overrule("--fov", options.fov_y_degrees, lens.fov_y_degrees);
  constexpr std::size_t kAllOptions = 5;
  if (assumed.given.size() == kAllOptions) assumed.source = "options";
  check_lens(lens.lens, options.lens,
             assumed.source == "default" ? "the default lens" : "the lens of " + assumed.name);
  return assumed;
}

std::string lens_text(const NotedLens& lens) {
  return short_number(lens.lens.focal_length_mm) + " mm, f/" + short_number(lens.lens.f_number) +
         ", focused at " + short_number(lens.lens.focus_m) + " m, coc scale " +
         short_number(lens.coc_scale) + ", field of view " + degrees_text(lens.fov_y_degrees);
}

std::string source_text(const AssumedLens& assumed) {
  if (assumed.source == "options") return "all of it as given";
  std::string text = assumed.source == "scene"     ? "by the scene " + assumed.name
                     : assumed.source == "picture" ? "by " + assumed.name
                                                   : "assumed: no picture says, nor does --scene";
  std::string given;
  for (const std::string& option : assumed.given) given += (given.empty() ? "" : ", ") + option;
  return given.empty() ? text : text + "; " + given + " as given";
}

std::vector<std::string> lens_doubts(const std::vector<NamedNotes>& pictures) {
  std::vector<std::string> doubts;
  const NamedNotes* first = nullptr;
  for (const NamedNotes& picture : pictures) {
    const FoundNotes& found = picture.found;
    if (found.stale) {
      doubts.push_back("'" + found.place.string() + "' is of another picture than '" +
                       picture.name + "': it is not read");
    }
    if (!found.notes || !found.notes->lens) continue;
    if (first == nullptr) first = &picture;
    const NotedLens& lens = *first->found.notes->lens;
    if (*found.notes->lens == lens) continue;
    doubts.push_back("the pictures have different lenses: '" + first->name + "' " +
                     lens_text(lens) + "; '" + picture.name + "' " + lens_text(*found.notes->lens));
  }
  return doubts;
}

}  // namespace softfocus
