#include "tools/page/settings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/numbers/vector_math.h"
#include "tools/cli/errors.h"

namespace softfocus {
namespace {

struct ShowChoice {
  std::string_view name;
  Show show;
};
constexpr std::array kShowChoices{ShowChoice{"picture", Show::image},
                                  ShowChoice{"pinhole", Show::pinhole},
                                  ShowChoice{"coc", Show::coc}, ShowChoice{"depth", Show::depth}};

// As in scene files.
constexpr double kFarthest = 1e9;
constexpr double kLargestLens = 1e9;
constexpr int kMostPageSamples = 4096;

int checked_whole(const Json& value, std::string_view name, int least, int most) {
  const double number = checked_number(value, name, least, most);
  if (number != std::floor(number)) throw UsageError(std::string{name} + ": not a whole number");
  return static_cast<int>(number);
}

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
  const auto numbers = checked_numbers(camera.at(name), name, 3, -kFarthest, kFarthest);
  return {numbers[0], numbers[1], numbers[2]};
}

CameraChoice read_camera(const Json& camera) {
  return {read_place(camera, "position_m"), read_place(camera, "target_m"),
          checked_number(camera.at("fov_y_degrees"), "fov_y_degrees", 1.0, 170.0)};
}

MethodChoice read_method(const std::string& name) {
  const MethodChoice method{find_method(name), find_lens_view_method(name)};
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
  const auto* const found =
      std::find_if(kShowChoices.begin(), kShowChoices.end(),
                   [&](const ShowChoice& choice) { return choice.name == name; });
  if (found == kShowChoices.end()) {
    throw UsageError("show '" + name + "': there are " + names_of(kShowChoices));
  }
  return found->show;
}

void read_focus(const Json& focus, FrameSettings& settings) {
  if (const Json* at = focus.find("at")) {
    const auto numbers = checked_numbers(*at, "focus.at", 2, 0.0, 1.0);
    settings.focus_at = glm::dvec2{numbers[0], numbers[1]};
    return;
  }
  settings.lens.focus_m = checked_number(focus.at("m"), "focus.m", 1e-9, kLargestLens);
}

}  // namespace

const Json* given(const Json& request, std::string_view name) {
  const Json* value = request.find(name);
  return value != nullptr && !value->is_null() ? value : nullptr;
}

double checked_number(const Json& value, std::string_view name, double least, double most) {
  const double number = value.number();
  if (number >= least && number <= most) return number;
  throw UsageError(std::string{name} + " " + short_number(number) + ": give a number from " +
                   short_number(least) + " to " + short_number(most));
}

FrameSettings read_frame_settings(const Json& request) {
  FrameSettings settings;
  if (const Json* size = given(request, "size")) {
    const auto numbers = checked_numbers(*size, "size", 2, 1.0, kMaxImageSize);
    settings.size = {static_cast<int>(numbers[0]), static_cast<int>(numbers[1])};
  }
  if (const Json* time = given(request, "time")) {
    settings.frame = checked_number(*time, "time", -1e6, 1e6);
  }
  if (const Json* camera = given(request, "camera")) settings.camera = read_camera(*camera);
  if (const Json* show = given(request, "show")) settings.show = read_show(show->text());
  if (const Json* dof = given(request, "dof"); dof != nullptr && !dof->boolean()) {
    if (settings.show == Show::image) settings.show = Show::pinhole;
  }
  if (const Json* method = given(request, "method")) settings.method = read_method(method->text());
  if (const Json* focus = given(request, "focus")) read_focus(*focus, settings);
  const auto take = [&](const char* name, double least, double most, std::optional<double>& place) {
    if (const Json* value = given(request, name)) {
      place = checked_number(*value, name, least, most);
    }
  };
  take("focal_length_mm", 1e-9, kLargestLens, settings.lens.focal_length_mm);
  take("f_number", 1e-9, kLargestLens, settings.lens.f_number);
  take("coc_scale", 0.0, 1e6, settings.lens.coc_scale);
  if (const Json* radius = given(request, "max_coc_px")) {
    settings.max_coc_px = static_cast<float>(
        checked_number(*radius, "max_coc_px", 0.0, static_cast<double>(kLargestMaxCoc)));
  }
  if (const Json* samples = given(request, "samples")) {
    settings.sampling.samples = checked_whole(*samples, "samples", 1, kMostPageSamples);
  }
  if (const Json* hash = given(request, "hash")) settings.hash = hash->boolean();
  if (const Json* preview = given(request, "preview")) {
    settings.preview = checked_whole(*preview, "preview", 1, 16);
    settings.size.width = std::max(1, settings.size.width / settings.preview);
    settings.size.height = std::max(1, settings.size.height / settings.preview);
    if (settings.max_coc_px) *settings.max_coc_px /= static_cast<float>(settings.preview);
  }
  return settings;
}

Camera chosen_camera(const Camera& of_scene, const std::optional<CameraChoice>& choice) {
  Camera camera = of_scene;
  if (!choice) return camera;
  camera.position = choice->position;
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
