#include "scenes/load/load_scene.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "dof/parameters.h"
#include "raster/numbers/parameter_text.h"
#include "raster/numbers/vector_math.h"
#include "scenes/files/file_bytes.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/model_scene.h"
#include "scenes/load/scene_sections.h"
#include "scenes/load/toml_reading.h"
#include "scenes/make/backdrop.h"
#include "scenes/parameters.h"
#include "scenes/random/random_scene.h"

namespace softfocus {
namespace {

constexpr std::size_t kMaxSceneBytes = std::size_t{1} << 24;
constexpr double kBrightest = 1000.0;

constexpr Range kFramesAndPlaces{std::min(parameter::kFrame.least, kAnyPlace.low),
                                 std::max(parameter::kFrame.most, kAnyPlace.high)};

glm::dvec3 key_place(const PlaceKeys& keys, std::size_t i) {
  return {keys[0][i].value, keys[1][i].value, keys[2][i].value};
}

/// Three numbers, or an array of [frame, x, y, z]: then the first place, and all of them in `keys`.
glm::dvec3 read_keyed_place(Section& section, std::string_view key, glm::dvec3 fallback,
                            PlaceKeys& keys) {
  const toml::node* node = find_key(section, key);
  const toml::array* rows = node != nullptr ? node->as_array() : nullptr;
  if (rows == nullptr || rows->empty() || !rows->front().is_array()) {
    return read_vector(section, key, fallback, kAnyPlace);
  }
  for (const auto& row : read_rows(section, key, 4, kFramesAndPlaces)) {
    if (!is_allowed(parameter::kFrame, row[0]) ||
        (!keys[0].empty() && row[0] <= keys[0].back().frame)) {
      fail_at(section, key,
              "has frames that do not increase from 0 on; [[0, 0, 1, 5], [90, 0, 1, 2]] would be "
              "right");
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double value = row[axis + 1];
      if (value < kAnyPlace.low || value > kAnyPlace.high) {
        fail_at(section, key,
                "has a place out of range; " + wanted_text(parameter::kPlace) + " would be right");
      }
      keys[axis].push_back({row[0], value});
    }
  }
  return key_place(keys, 0);
}

/// Throws SceneError where the camera cannot look.
void check_view(const Section& section, const Camera& camera, glm::dvec3 position,
                glm::dvec3 target) {
  const glm::dvec3 forwards = target - position;
  if (forwards == glm::dvec3{0.0}) {
    fail_at(section, "target", "is the camera's position; another point would be right");
  }
  // Shorter than this, the sideways axis would be rounding noise.
  const glm::dvec3 sideways = cross(normalize(forwards), normalize(camera.up));
  if (dot(sideways, sideways) < 1e-12) {
    fail_at(section, "up",
            "points along the view (or nowhere); a direction across it would be right");
  }
}

Camera read_camera(Section section) {
  Camera camera;
  camera.position = read_keyed_place(section, "position", camera.position, camera.position_keys);
  camera.target = read_keyed_place(section, "target", camera.target, camera.target_keys);
  camera.easing = read_choice(section, "keyframes", camera.easing, parameter::kEasings);
  camera.up = read_vector(section, "up", camera.up, kAnyPlace);
  camera.fov_y_degrees = read_number(section, parameter::kFov, camera.fov_y_degrees);
  camera.near_m = read_number(section, "near_m", camera.near_m, kAnySize);
  camera.far_m = read_number(section, "far_m", camera.far_m, kAnySize);
  camera.orbit_degrees_per_frame = read_number(section, "orbit_degrees_per_frame",
                                               camera.orbit_degrees_per_frame, {-360.0, 360.0});
  camera.shutter_frames = read_number(section, parameter::kShutter, camera.shutter_frames);
  if (camera.near_m >= camera.far_m) {
    fail_at(section, "far_m", "must be larger than near_m");
  }
  check_view(section, camera, camera.position, camera.target);
  // With both on their way, keys alone do not say where they meet.
  if (camera.target_keys[0].empty()) {
    for (std::size_t i = 0; i < camera.position_keys[0].size(); ++i) {
      check_view(section, camera, key_place(camera.position_keys, i), camera.target);
    }
  } else if (camera.position_keys[0].empty()) {
    for (std::size_t i = 0; i < camera.target_keys[0].size(); ++i) {
      check_view(section, camera, camera.position, key_place(camera.target_keys, i));
    }
  }
  finish_section(section);
  return camera;
}

/// A number, or an array of [frame, number]: then the first number, and all of them in `keys`.
double read_keyed_number(Section& section, const Parameter& parameter, double fallback,
                         std::vector<Keyframe>& keys) {
  const std::string_view key = key_of(parameter);
  const toml::node* node = find_key(section, key);
  if (node == nullptr || !node->is_array()) return read_number(section, parameter, fallback);
  constexpr Range kFramesAndValues{parameter::kFrame.least, parameter::kFrame.most};
  for (const auto& row : read_rows(section, key, 2, kFramesAndValues)) {
    const Keyframe next{row[0], row[1]};
    if (!keys.empty() && next.frame <= keys.back().frame) {
      fail_at(section, key, "has frames that do not increase; [[0, 2], [48, 6]] would be right");
    }
    if (!is_allowed(parameter, next.value)) {
      fail_at(section, key,
              "has a value out of range; " + wanted_text(parameter) + " would be right");
    }
    keys.push_back(next);
  }
  if (keys.empty()) {
    fail_at(section, key, "is empty; a number, or [frame, number] at some frames, would be right");
  }
  return keys.front().value;
}

SceneLens read_lens(Section section) {
  SceneLens lens;
  for (const auto& [number, place, has_keys] : kLensNumbers) {
    double& value = lens.lens.*place;
    value = has_keys ? read_keyed_number(section, number, value, lens.keys[place])
                     : read_number(section, number, value);
  }
  lens.easing = read_choice(section, "keyframes", lens.easing, parameter::kEasings);
  lens.coc_scale = read_number(section, parameter::kCocScale, lens.coc_scale);
  lens.max_coc_px_at_1024 = read_number(section, parameter::kMaxCoc, lens.max_coc_px_at_1024);
  ThinLens nearest = lens.lens;
  for (const Keyframe& key : lens.keys[&ThinLens::focus_m]) {
    nearest.focus_m = std::min(nearest.focus_m, key.value);
  }
  if (const char* error = lens_error(nearest)) fail_at(section, "focus_m", error);
  finish_section(section);
  return lens;
}

ShadowMapSettings read_map(Section section) {
  ShadowMapSettings map;
  for (const auto& [number, set] : parameter::kMapParameters) {
    set(map, read_number(section, number, number.preset));
  }
  map.fits_camera = read_choice(section, "fit", map.fits_camera, parameter::kMapFits);
  if (map.cascades > 1 && !map.fits_camera) {
    fail_at(section, "cascades", "are of the camera's picture; fit = \"camera\" would be right");
  }
  finish_section(section);
  return map;
}

Light read_light(Section& section) {
  Light light;
  if (!has_key(section, "kind")) {
    fail_at(section, "kind", "is missing; \"directional\" or \"point\" would be right");
  }
  light.kind = read_choice(section, "kind", light.kind, parameter::kLightKinds);
  const std::string_view place = light.kind == LightKind::point ? "position" : "direction";
  if (!has_key(section, place)) {
    fail_at(section, place, "is missing; an array of three numbers would be right");
  }
  light.position_or_direction = glm::vec3{read_vector(section, place, glm::dvec3{0.0}, kAnyPlace)};
  // Its length is squared in binary32, where less would vanish.
  if (light.kind == LightKind::directional &&
      dot(light.position_or_direction, light.position_or_direction) < 1e-12f) {
    fail_at(section, place, "points nowhere; a vector towards the light would be right");
  }
  light.colour = read_colour(section, "colour", light.colour, kBrightest);
  light.shadows = read_choice(section, "shadows", light.shadows, parameter::kShadowKinds);
  light.map = read_map(read_section(section, "map"));
  light.shadow_darkness = static_cast<float>(read_number(section, parameter::kShadowDarkness, 1.0));
  light.terminator = read_choice(section, "terminators", light.terminator, parameter::kTerminators);
  if (light.kind == LightKind::point) {
    light.radius_m = read_number(section, parameter::kLightRadius, light.radius_m);
  } else {
    light.angular_radius_degrees =
        read_number(section, parameter::kLightAngle, light.angular_radius_degrees);
  }
  finish_section(section);
  return light;
}

ImpostorBudget read_impostors(Section section) {
  ImpostorBudget budget;
  budget.tolerance_px = read_number(section, parameter::kImpostorTolerance, budget.tolerance_px);
  budget.memory_mb = read_number(section, parameter::kImpostorMemory, budget.memory_mb);
  budget.milliseconds = read_number(section, parameter::kImpostorMilliseconds, budget.milliseconds);
  finish_section(section);
  return budget;
}

void read_backdrop(Section section, Scene& scene) {
  if (section.table == nullptr) return;
  for (const char* key : {"eye", "beyond_m"}) {
    if (!has_key(section, key))
      fail_at(section, key, "is missing; docs/scene-format.md has both keys");
  }
  Backdrop& backdrop = scene.backdrop.emplace();
  backdrop.eye = read_vector(section, "eye", {}, kAnyPlace);
  backdrop.beyond_m = read_number(section, "beyond_m", 0.0, kAnySize);
  if (!backdrop_distance_m(scene)) {
    fail_at(section, "beyond_m",
            "leaves no object; a distance from eye that some are beyond would be right");
  }
  finish_section(section);
}

ChosenEffect read_effect(Section& section) {
  const std::string name = read_text(section, "name", "");
  const Effect* const effect = find_effect(name);
  if (effect == nullptr) {
    std::vector<std::string> there;
    for (const Effect& known : effects()) there.emplace_back(known.name);
    fail_at(section, "name",
            "is no effect; there are " + list_words(there) + did_you_mean(name, there));
  }
  ChosenEffect chosen{effect, {}};
  for (const Parameter& parameter : effect->parameters) {
    chosen.parameters.push_back(read_number(section, parameter, parameter.preset));
  }
  finish_section(section);
  return chosen;
}

}  // namespace

Scene read_scene_text(std::string_view text, const std::filesystem::path& file, ThreadPool* pool) {
  const toml::table table = parse_toml(text, file.string(), "docs/scene-format.md");
  Section top{&table, file.string(), "", {}};
  Scene scene;
  scene.name = file.stem().string();
  scene.title = printable(read_text(top, "title", scene.name));
  scene.background = read_colour(top, "background", scene.background, kBrightest);
  scene.ambient_light = read_colour(top, "ambient_light", scene.ambient_light, kBrightest);
  scene.camera = read_camera(read_section(top, "camera"));
  scene.lens = read_lens(read_section(top, "lens"));

  scene.light_points =
      static_cast<int>(read_number(top, parameter::kLightPoints, scene.light_points));
  std::vector<Section> lights = read_sections(top, "light");
  if (lights.size() > kMostLights) {
    fail_at(top, "light",
            "has " + std::to_string(lights.size()) + " lights; up to " +
                std::to_string(kMostLights) + " would do");
  }
  int with_shadows = 0;
  for (Section& light : lights) {
    scene.lights.push_back(read_light(light));
    if (scene.lights.back().shadows == ShadowKind::none) continue;
    if (++with_shadows > kMostShadowLights) {
      fail_at(light, "shadows",
              "is one light's too many; up to " + std::to_string(kMostShadowLights) +
                  " lights may have shadows");
    }
  }
  for (Section& effect : read_sections(top, "effect")) scene.effects.push_back(read_effect(effect));

  const NamedSurfaces surfaces = read_surfaces(top, file.parent_path(), scene, pool);
  scene.impostors = read_impostors(read_section(top, "impostors"));
  read_objects(top, file.parent_path(), surfaces, scene, pool);
  read_backdrop(read_section(top, "backdrop"), scene);
  finish_section(top);
  return scene;
}

Scene read_scene_file(const std::filesystem::path& file, ThreadPool* pool) {
  Scene scene = read_scene_text(read_file_bytes(file, kMaxSceneBytes), file, pool);
  scene.files.push_back(file);
  return scene;
}

std::string read_scene_title(const std::filesystem::path& file) {
  const std::string text = read_file_bytes(file, kMaxSceneBytes);
  const auto title_in = [&](std::string_view part) {
    const toml::table table = parse_toml(part, file.string(), "docs/scene-format.md");
    return printable(table["title"].value_or(std::string{}));
  };
  // The top ends at the first table, which a text over several lines may look like.
  try {
    return title_in(std::string_view{text}.substr(0, text.find("\n[")));
  } catch (const SceneError&) {
    return title_in(text);
  }
}

namespace {

[[noreturn]] void fail_unknown(std::string_view name, const std::vector<SceneListing>& listings) {
  std::error_code unreadable;
  if (std::filesystem::exists(name, unreadable)) {
    throw SceneError(
        std::string{name} +
        ": scenes are .toml files and models .gltf, .glb, .obj, .ply and .stl files; Blender, "
        "MeshLab and assimp write others so");
  }
  std::vector<std::string> there;
  std::string names;
  for (const SceneListing& listing : listings) {
    there.push_back(listing.name);
    names += (names.empty() ? "" : ", ") + listing.name;
  }
  throw SceneError(
      "there is no scene \"" + std::string(name) + "\"" +
      (names.empty() ? "; no scenes were found at all: give a .toml, .glb, .obj, .ply or .stl file"
                     : "; there are " + names +
                           ", random:SEED, and any .toml, .gltf, .glb, .obj, .ply or "
                           ".stl file can be given") +
      did_you_mean(name, there));
}

constexpr std::string_view kRandom = "random:";

// One number has one spelling, so that one scene has one name.
std::uint64_t read_seed(std::string_view scene) {
  const std::string_view digits = scene.substr(kRandom.size());
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), seed);
  if (error != std::errc{} || end != digits.data() + digits.size() ||
      std::to_string(seed) != digits) {
    throw SceneError("\"" + std::string(scene) +
                     "\" has no seed; a whole number from 0 to 18446744073709551615 without "
                     "leading zeros would be right, as in random:7");
  }
  return seed;
}

}  // namespace

bool is_random_scene(std::string_view scene) { return scene.starts_with(kRandom); }

Scene load_scene(std::string_view scene, const std::vector<std::filesystem::path>& search_path,
                 ThreadPool* pool) {
  if (is_random_scene(scene)) return make_random_scene(read_seed(scene), pool);
  const std::filesystem::path file{scene};
  if (has_extension(scene, ".toml")) return read_scene_file(file, pool);
  if (is_model_name(scene)) {
    return make_model_scene(load_model(file, pool), file.stem().string());
  }
  const auto listings = find_scenes(search_path);
  const auto found = std::find_if(listings.begin(), listings.end(),
                                  [&](const SceneListing& l) { return l.name == scene; });
  if (found == listings.end()) fail_unknown(scene, listings);
  return read_scene_file(found->file, pool);
}

std::size_t triangle_count(const Scene& scene) {
  std::size_t count = 0;
  for (const Object& object : scene.objects) count += scene.meshes[object.mesh].indices.size() / 3;
  return count;
}

}  // namespace softfocus
