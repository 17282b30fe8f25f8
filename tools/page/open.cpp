// open: a scene, a case of the atlas, or a picture.

#include <algorithm>
#include <cmath>

#include "scenes/load/load_scene.h"
#include "scenes/make/backdrop.h"
#include "scenes/parameters.h"
#include "scenes/relief/impostors/scene_impostors.h"
#include "tools/cli/errors.h"
#include "tools/page/picture.h"
#include "tools/page/requests.h"
#include "tools/stress/cases/stress_case.h"

namespace softfocus {
namespace {

/// The animation's length that a slider needs: until spinning and swaying things and the camera
/// are where they began, or nearly.
constexpr int kAnimationFrames = 360;

bool is_moving(const Scene& scene) {
  return moves(scene.camera) || std::any_of(scene.objects.begin(), scene.objects.end(),
                                            [](const Object& object) { return moves(object); });
}

Json vector_json(const glm::dvec3& v) { return std::vector<double>{v.x, v.y, v.z}; }

StressCase find_case(const std::string& name) {
  const std::vector<StressCase> cases = stress_cases();
  for (const StressCase& known : cases) {
    if (known.name == name) return known;
  }
  throw UsageError("there is no case '" + name + "'; there are " + names_of(cases));
}

std::unique_ptr<Opened> opened_case(const Json& request) {
  auto opened = std::make_unique<Opened>();
  opened->stress_case = find_case(request.at("case").text());
  const StressCase& of = *opened->stress_case;
  opened->severity = of.telling;
  if (const Json* value = request.find("value")) {
    const auto [least, most] = std::minmax_element(of.severities.begin(), of.severities.end());
    opened->severity = checked_number(*value, of.parameter.name, *least, *most);
  }
  opened->scene = flat_scene();
  opened->scene.name = of.name;
  opened->scene.title = of.title;
  opened->scene.lens.lens = {.focal_length_mm = 50.0, .f_number = 2.0, .focus_m = kStressFocusM};
  return opened;
}

std::unique_ptr<Opened> opened_scene(const std::string& source) {
  auto opened = std::make_unique<Opened>();
  opened->source = source;
  opened->scene = load_scene(source, scene_search_path({}));
  const Scene& scene = opened->scene;
  opened->camera = scene.camera;
  opened->far_m = scene.camera.far_m;
  opened->lights = scene.lights;
  opened->materials = scene.materials;
  opened->objects = scene.objects;
  return opened;
}

Json lens_json(const SceneLens& of, double fov_y_degrees) {
  Json json;
  add_lens(json, of.lens, of.coc_scale);
  json["sensor_height_mm"] = film_height_mm(of.lens, fov_y_degrees);
  return json;
}

/// The largest radius that cuts no circle of the case, in pixels of the usual size.
float case_radius(const Opened& opened, ThreadPool& pool) {
  constexpr int kUsualSide = 512;
  const StressTrial trial = opened.stress_case->make(opened.severity, kUsualSide, pool);
  return trial.frames.front().settings.max_coc_px;
}

/// What a frame's look can change.
Json look_json(const Scene& scene) {
  const bool has_light = !scene.lights.empty();
  const bool has_textures =
      std::any_of(scene.materials.begin(), scene.materials.end(),
                  [](const Material& material) { return material.texture.has_value(); });
  Json look{{"light", nullptr},
            {"light_kind", nullptr},
            {"shadows", nullptr},
            {"textures", has_textures},
            {"impostors", has_impostors(scene)},
            {"backdrop_m", nullptr}};
  if (const auto distance_m = backdrop_distance_m(scene)) look["backdrop_m"] = *distance_m;
  if (!has_light) return look;
  const Light& light = scene.lights.front();
  look["light"] = vector_json(glm::dvec3{light.position_or_direction});
  look["light_kind"] = std::string{word_for(parameter::kLightKinds, light.kind)};
  look["shadows"] = std::string{word_for(parameter::kShadowKinds, light.shadows)};
  return look;
}

Json warnings_json(const Scene& scene) {
  Json warnings = Json::array();
  for (const std::string& warning : scene.warnings) warnings.push_back(warning);
  return warnings;
}

void put_in_place(Page& page, std::unique_ptr<Opened> opened) {
  page.truth.reset();
  page.begun.reset();
  page.shown.reset();
  page.memory = {};
  page.drawn = {};
  page.gpu_scene.reset();
  page.opened = std::move(opened);
}

}  // namespace

Json answer_open(Page& page, const Json& request) {
  if (request.find("picture") != nullptr) {
    auto [opened, reply] = open_picture(request, *page.pool);
    put_in_place(page, std::move(opened));
    return reply;
  }
  const bool is_case = request.find("case") != nullptr;
  std::unique_ptr<Opened> opened =
      is_case ? opened_case(request) : opened_scene(request.at("scene").text());
  const Scene& scene = opened->scene;
  const Camera& camera = scene.camera;
  Json reply{{"title", scene.title},
             {"warnings", warnings_json(scene)},
             {"triangles", is_case ? 0 : triangle_count(scene)},
             {"animation_frames", !is_case && is_moving(scene) ? kAnimationFrames : 0},
             {"camera",
              {{"position_m", vector_json(camera.position)},
               {"target_m", vector_json(camera.target)},
               {"up", vector_json(camera.up)},
               {"fov_y_degrees", camera.fov_y_degrees},
               {"near_m", camera.near_m},
               {"far_m", camera.far_m}}},
             {"lens", lens_json(scene.lens, camera.fov_y_degrees)},
             {"look", look_json(scene)},
             {"autofocus", false}};
  if (is_case) {
    reply["lens"]["max_coc_px"] = case_radius(*opened, *page.pool);
  } else {
    reply["lens"]["max_coc_px_at_1024"] = scene.lens.max_coc_px_at_1024;
  }
  put_in_place(page, std::move(opened));
  return reply;
}

}  // namespace softfocus
