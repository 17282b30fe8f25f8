#include "scenes/random/random_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "scenes/random/stage.h"

namespace softfocus {
namespace {

constexpr std::array<std::string_view, 10> kClasses{
    "still life", "night lights", "near fence",   "foliage",  "grazing floor",
    "portrait",   "clutter",      "bright edges", "interior", "mixed"};

enum class Class : std::uint8_t {
  still_life,
  night_lights,
  near_fence,
  foliage,
  grazing_floor,
  portrait,
  clutter,
  bright_edges,
  interior,
  mixed,
};

void set_camera(Stage& stage, double steepest) {
  Camera& camera = stage.scene.camera;
  camera.fov_y_degrees = between(stage, 20.0, 58.0);
  stage.tangent = exact_math::tan_degrees(camera.fov_y_degrees / 2.0);
  stage.subject_m = log_between(stage, 0.4, 8.0);
  stage.subject_height = 2.0 * stage.tangent * stage.subject_m * between(stage, 0.35, 0.75);
  const double down = exact_math::tan_degrees(between(stage, 0.2 * steepest, steepest));
  const double aim = 0.5 * stage.subject_height;
  camera.position = {0.0, aim + stage.subject_m * down, 0.0};
  // The subject stands in the middle, or a little beside it.
  const double aside = between(stage, -0.35, 0.35) * stage.tangent * stage.subject_m;
  camera.target = {aside, aim, -stage.subject_m};
  stage.forwards = normalize(camera.target - camera.position);
  stage.right = normalize(cross(stage.forwards, camera.up));
  stage.up = cross(stage.right, stage.forwards);
}

void set_lights(Stage& stage) {
  stage.scene.ambient_light = glm::vec3{static_cast<float>(between(stage, 0.12, 0.4))};
  const double side = happens(stage, 0.5) ? 1.0 : -1.0;
  const glm::dvec3 key{side * between(stage, 0.2, 1.0), between(stage, 0.4, 1.0),
                       between(stage, 0.2, 1.0)};
  const auto strength = static_cast<float>(between(stage, 0.6, 1.0));
  const auto warmth = static_cast<float>(between(stage, 0.75, 1.0));
  stage.scene.lights.push_back(
      {LightKind::directional, glm::vec3{key}, {strength, strength, warmth * strength}});
  const glm::dvec3 fill{-key.x, 0.3, 0.5};
  const auto weak = static_cast<float>(between(stage, 0.05, 0.3));
  stage.scene.lights.push_back({LightKind::directional, glm::vec3{fill}, glm::vec3{weak}});
}

void add_any_backdrop(Stage& stage) {
  switch (count_between(stage, 0, 2)) {
    case 0: return add_wall(stage);
    case 1: return add_room(stage);
    default: return add_sky(stage);
  }
}

void add_subject(Stage& stage) {
  if (happens(stage, 0.25)) {
    add_bust(stage);
  } else {
    add_still_life(stage);
  }
}

// A foreground in most pictures of the mixed class.
double add_any_foreground(Stage& stage) {
  switch (count_between(stage, 0, 3)) {
    case 0: return add_fence(stage);
    case 1: return add_foliage(stage);
    case 2: return add_near_things(stage);
    default: return 0.0;
  }
}

double add_mixed(Stage& stage) {
  if (happens(stage, 0.25)) {
    add_night(stage);
  } else {
    add_any_backdrop(stage);
  }
  const bool has_blocks = happens(stage, 0.4);
  if (has_blocks || happens(stage, 0.6)) add_floor(stage, log_between(stage, 0.5, 6.0));
  add_subject(stage);
  if (has_blocks) add_blocks(stage, count_between(stage, 3, 14));
  if (happens(stage, 0.5)) add_clutter(stage, count_between(stage, 5, 80), 0.5, 5.0);
  if (happens(stage, 0.4)) add_lamps(stage, count_between(stage, 3, 40));
  if (happens(stage, 0.3)) add_bright_edges(stage, count_between(stage, 2, 12));
  return add_any_foreground(stage);
}

// Returns how far a foreground is that can be in focus, or 0.
double add_parts(Stage& stage, Class of) {
  switch (of) {
    case Class::still_life:
      add_any_backdrop(stage);
      add_floor(stage, log_between(stage, 0.7, 4.0));
      add_still_life(stage);
      return happens(stage, 0.5) ? add_near_things(stage) : 0.0;
    case Class::night_lights:
      add_night(stage);
      add_floor(stage, log_between(stage, 0.5, 2.0));
      add_blocks(stage, count_between(stage, 4, 12));
      add_subject(stage);
      add_lamps(stage, count_between(stage, 25, 120));
      return 0.0;
    case Class::near_fence:
      add_any_backdrop(stage);
      add_floor(stage, log_between(stage, 0.7, 4.0));
      add_subject(stage);
      return add_fence(stage);
    case Class::foliage:
      add_any_backdrop(stage);
      add_floor(stage, log_between(stage, 0.7, 4.0));
      add_subject(stage);
      return add_foliage(stage);
    case Class::grazing_floor:
      if (happens(stage, 0.5)) {
        add_sky(stage);
      } else {
        add_wall(stage);
      }
      add_floor(stage, log_between(stage, 3.0, 16.0));
      add_still_life(stage);
      return 0.0;
    case Class::portrait:
      add_any_backdrop(stage);
      add_bust(stage);
      add_clutter(stage, count_between(stage, 20, 90), 1.5, 8.0);
      if (happens(stage, 0.5)) add_lamps(stage, count_between(stage, 5, 25));
      return 0.0;
    case Class::clutter:
      add_any_backdrop(stage);
      add_clutter(stage, count_between(stage, 120, 320), 0.4, 6.0);
      add_still_life(stage);
      return 0.0;
    case Class::bright_edges:
      add_any_backdrop(stage);
      if (happens(stage, 0.6)) add_floor(stage, log_between(stage, 0.7, 4.0));
      add_subject(stage);
      add_bright_edges(stage, count_between(stage, 6, 30));
      return 0.0;
    case Class::interior:
      add_room(stage);
      add_blocks(stage, count_between(stage, 5, 16));
      add_subject(stage);
      return happens(stage, 0.3) ? add_near_things(stage) : 0.0;
    case Class::mixed: return add_mixed(stage);
  }
  return 0.0;
}

// The focus on the subject's front or, now and then, on the foreground.
void set_lens(Stage& stage, double foreground_m) {
  const glm::dvec3 subject{0.0, 0.5 * stage.subject_height, -stage.subject_m};
  const double front =
      dot(subject - stage.scene.camera.position, stage.forwards) - 0.2 * stage.subject_height;
  const bool near_in_focus = foreground_m > 0.0 && happens(stage, 0.2);
  const double focus = near_in_focus ? foreground_m : front;
  // With r = r_inf (1 - z_f / z): the horizon's radius such that the nearest part has at most
  // kNearestRadius.
  constexpr double kNearestRadius = 90.0;
  const double nearest = std::clamp(stage.nearest_m, 0.15 * stage.subject_m, 0.95 * focus);
  const double most = kNearestRadius / (focus / nearest - 1.0);
  // Things behind the subject have a circle of 6 pixels at least.
  const double behind = std::max(stage.backdrop_m, 1.25 * focus);
  const double least = 6.0 / (1.0 - focus / behind);
  const double at_infinity = std::min(std::max(log_between(stage, 6.0, 44.0), least), most);
  SceneLens& lens = stage.scene.lens;
  // Film 24 mm high.
  lens.lens.focal_length_mm = 12.0 / stage.tangent;
  lens.lens.focus_m = focus;
  const double aperture_m = 2.0 * pixels_at(stage, at_infinity, focus);
  lens.lens.f_number = lens.lens.focal_length_mm / (1000.0 * aperture_m);
  const double largest = std::max(at_infinity, at_infinity * (focus / nearest - 1.0));
  lens.max_coc_px_at_1024 = std::ceil(largest);
  stage.scene.camera.near_m = 0.08 * stage.subject_m;
  stage.scene.camera.far_m = 60.0 * stage.subject_m;
}

}  // namespace

std::span<const std::string_view> random_scene_classes() { return kClasses; }

Scene make_random_scene(std::uint64_t seed, ThreadPool* pool) {
  Stage stage;
  stage.random.state = mix_bits(seed);
  const auto of = static_cast<Class>(next_bits(stage.random) % kClasses.size());
  stage.scene.name = "random:" + std::to_string(seed);
  stage.scene.title = "Random scene " + std::to_string(seed) + ": " +
                      std::string{kClasses[static_cast<std::size_t>(of)]};
  set_camera(stage, of == Class::grazing_floor ? 8.0 : 22.0);
  set_lights(stage);
  const double foreground_m = add_parts(stage, of);
  set_lens(stage, foreground_m);
  stage.scene.textures = make_procedural_textures(stage.textures, pool);
  return std::move(stage.scene);
}

}  // namespace softfocus
