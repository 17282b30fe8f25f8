#include "tools/page/settings.h"

#include <algorithm>
#include <array>
#include <type_traits>

#include "dof/parameters.h"
#include "raster/numbers/parameter_text.h"
#include "raster/numbers/vector_math.h"
#include "scenes/parameters.h"
#include "tools/cli/errors.h"
#include "tools/options/effect_options.h"

namespace softfocus {
namespace {

// Scene files and the command line call these otherwise.
constexpr Parameter with_key(Parameter parameter, std::string_view key) {
  parameter.key = key;
  return parameter;
}
constexpr Parameter kPageFov = with_key(parameter::kFov, "fov_y_degrees");
constexpr Parameter kPageTime = with_key(parameter::kFrame, "time");
constexpr Parameter kPreview{"preview", "What sizes and radii are divided by", 1, 16, 1, "", "", "",
                             1};
constexpr Parameter kPageTurn = with_key(parameter::kApertureTurn, "aperture_turn_degrees");
constexpr Parameter kPageGain = with_key(parameter::kHighlightGain, "highlight_gain");
constexpr Parameter kPageThreshold =
    with_key(parameter::kHighlightThreshold, "highlight_threshold");
constexpr std::array kPageParameters{parameter::kCocScale,
                                     parameter::kMaxCoc,
                                     kPageSamples,
                                     kPageFov,
                                     kPageTime,
                                     parameter::kBackdrop,
                                     parameter::kApertureBlades,
                                     kPageTurn,
                                     parameter::kAnamorphic,
                                     kPageGain,
                                     kPageThreshold};

std::vector<double> checked_numbers(const Json& value, std::string_view name, std::size_t count,
                                    double least, double most) {
  if (value.values().size() != count) {
    throw UsageError(std::string{name} + ": give " + std::to_string(count) + " numbers");
  }
  std::vector<double> numbers;
  for (const Json& number : value.values()) {
    numbers.push_back(checked_number(number, name, least, most));
  }
  return numbers;
}

glm::dvec3 read_place(const Json& camera, const char* name) {
  const auto numbers =
      checked_numbers(camera.at(name), name, 3, parameter::kPlace.least, parameter::kPlace.most);
  return {numbers[0], numbers[1], numbers[2]};
}

CameraChoice read_camera(const Json& camera) {
  return {read_place(camera, "position_m"), read_place(camera, "target_m"),
          checked_number(camera.at("fov_y_degrees"), kPageFov)};
}

MethodChoice read_method(const std::string& name) {
  const MethodChoice method = find_method_choice(name);
  if (method.is_auto()) {
    throw UsageError("method '" + name + "': there are " + names_of(methods()) + ", " +
                     names_of(lens_view_methods()));
  }
  if (method.of_scene != nullptr && !method.of_scene->missing.empty()) {
    throw UsageError("method " + name + ": not in this build");
  }
  return method;
}

Show read_show(const std::string& name) {
  for (const Choice<Show>& choice : kShows) {
    if (choice.name == name) return choice.value;
  }
  throw UsageError("show '" + name + "': there are " + names_of(kShows));
}

template <class Choices>
auto read_choice(const Json& value, std::string_view name, const Choices& choices) {
  for (const auto& choice : choices) {
    if (choice.name == value.text()) return choice.value;
  }
  throw UsageError(std::string{name} + " '" + value.text() + "': there are " + names_of(choices));
}

void read_look(const Json& request, FrameSettings& settings) {
  SceneLook& look = settings.look;
  if (const Json* shadows = given(request, "shadows")) {
    look.shadows = read_choice(*shadows, "shadows", parameter::kShadowKinds);
  }
  if (const Json* impostors = given(request, "impostors")) {
    look.impostors = read_choice(*impostors, "impostors", parameter::kImpostorUses);
  }
  if (const Json* light = given(request, "light")) {
    const auto numbers =
        checked_numbers(*light, "light", 3, parameter::kPlace.least, parameter::kPlace.most);
    look.light = glm::vec3{numbers[0], numbers[1], numbers[2]};
    if (dot(*look.light, *look.light) < 1e-12f) {
      throw UsageError("light: it points nowhere; give three numbers, one of them not 0");
    }
  }
  if (const Json* textures = given(request, "textures")) look.textures = textures->boolean();
  if (const Json* metres = given(request, key_of(parameter::kBackdrop))) {
    look.backdrop_m = checked_number(*metres, parameter::kBackdrop);
  }
  if (const Json* effect = given(request, "effect")) {
    settings.effect = effect->text();
    if (*settings.effect != "none") parse_effect("effect", *settings.effect);
  }
}

void read_focus(const Json& focus, FrameSettings& settings) {
  if (const Json* at = focus.find("at")) {
    const auto numbers = checked_numbers(*at, "focus.at", 2, 0.0, 1.0);
    settings.focus_at = glm::dvec2{numbers[0], numbers[1]};
    return;
  }
  settings.lens.given[&ThinLens::focus_m] = checked_number(focus.at("m"), parameter::kFocus);
}

}  // namespace

const Json* given(const Json& request, std::string_view name) {
  const Json* value = request.find(name);
  return value != nullptr && !value->is_null() ? value : nullptr;
}

double checked_number(const Json& value, std::string_view name, double least, double most) {
  return checked_number(value, Parameter{name, "", least, most, least});
}

double checked_number(const Json& value, const Parameter& parameter) {
  const double number = value.number();
  if (is_allowed(parameter, number)) return number;
  throw UsageError(std::string{key_of(parameter)} + " " + short_number(number) + ": give " +
                   wanted_text(parameter));
}

std::span<const Parameter> page_parameters() { return kPageParameters; }

FrameSettings read_frame_settings(const Json& request) {
  FrameSettings settings;
  if (const Json* size = given(request, "size")) {
    const auto numbers = checked_numbers(*size, "size", 2, 1.0, kMaxImageSize);
    settings.size = {static_cast<int>(numbers[0]), static_cast<int>(numbers[1])};
  }
  if (const Json* time = given(request, "time")) {
    settings.frame = checked_number(*time, kPageTime);
  }
  if (const Json* camera = given(request, "camera")) settings.camera = read_camera(*camera);
  read_look(request, settings);
  if (const Json* show = given(request, "show")) settings.show = read_show(show->text());
  if (const Json* dof = given(request, "dof"); dof != nullptr && !dof->boolean()) {
    if (settings.show == Show::image) settings.show = Show::pinhole;
  }
  if (const Json* method = given(request, "method")) settings.method = read_method(method->text());
  if (const Json* focus = given(request, "focus")) read_focus(*focus, settings);
  const auto take = [&](const Parameter& parameter, auto& place) {
    if (const Json* value = given(request, key_of(parameter))) {
      place =
          static_cast<std::remove_reference_t<decltype(place)>>(checked_number(*value, parameter));
    }
  };
  for (const LensNumber& number : kLensNumbers) {
    take(number.parameter, settings.lens.given[number.place]);
  }
  take(parameter::kCocScale, settings.lens.coc_scale);
  take(parameter::kMaxCoc, settings.max_coc_px);
  take(kPageSamples, settings.sampling.samples);
  take(parameter::kApertureBlades, settings.aperture.blades);
  take(kPageTurn, settings.aperture.turn_degrees);
  take(parameter::kAnamorphic, settings.aperture.stretch);
  const Aperture aperture = used_aperture(settings);
  if (const char* error = aperture_error(aperture)) throw UsageError(error);
  settings.sampling.aperture.blades = aperture.blades;
  if (given(request, key_of(kPageGain)) != nullptr) {
    HighlightCurve& curve = settings.highlights.emplace();
    curve.threshold = kPageThreshold.preset;
    take(kPageGain, curve.gain);
    take(kPageThreshold, curve.threshold);
  }
  if (const Json* hash = given(request, "hash")) settings.hash = hash->boolean();
  take(kPreview, settings.preview);
  settings.size.width = std::max(1, settings.size.width / settings.preview);
  settings.size.height = std::max(1, settings.size.height / settings.preview);
  if (settings.max_coc_px) *settings.max_coc_px /= static_cast<float>(settings.preview);
  return settings;
}

Aperture used_aperture(const FrameSettings& settings) {
  if (!settings.method.has_blades()) return {};
  if (!settings.method.has_any_aperture()) return {.blades = settings.aperture.blades};
  Aperture aperture = settings.aperture;
  if (aperture.blades == 0) aperture.turn_degrees = 0.0f;
  return aperture;
}

Camera chosen_camera(const Camera& of_scene, const std::optional<CameraChoice>& choice) {
  Camera camera = of_scene;
  if (!choice) return camera;
  camera.position = choice->position;
  camera.position_keys = camera.target_keys = {};
  camera.target = choice->target;
  camera.fov_y_degrees = choice->fov_y_degrees;
  const glm::dvec3 forwards = camera.target - camera.position;
  if (dot(forwards, forwards) < 1e-18) throw UsageError("camera: it stands at its target");
  // Shorter than this, the sideways axis would be rounding noise.
  const glm::dvec3 sideways = cross(normalize(forwards), normalize(camera.up));
  if (dot(sideways, sideways) < 1e-12) throw UsageError("camera: it looks along its upward axis");
  return camera;
}

}  // namespace softfocus
