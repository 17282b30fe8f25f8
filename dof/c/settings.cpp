#include "dof/c/settings.h"

#include <cmath>
#include <string>
#include <string_view>

#include "dof/c/arguments.h"
#include "dof/lens.h"
#include "dof/parameters.h"
#include "raster/numbers/parameter_text.h"

namespace softfocus {
namespace {

constexpr std::string_view kAuto = "auto";

double checked(const Parameter& parameter, std::string_view name, double value) {
  if (!is_allowed(parameter, value)) {
    refuse("settings." + std::string{name},
           std::to_string(value) + " is not " + wanted_text(parameter));
  }
  return value;
}

double checked(const Parameter& parameter, double value) {
  return checked(parameter, key_of(parameter), value);
}

/// Where settings have the numbers of the lens.
constexpr OfLensNumbers<double softfocus_settings::*> kLensFields{
    {&softfocus_settings::focus_m, &softfocus_settings::focal_length_mm,
     &softfocus_settings::f_number}};
static_assert(kLensFields.values.back() != nullptr);

PixelCoc coc_of(const softfocus_settings& settings, int width_px, int height_px) {
  if (settings.blur_at_infinity_px != 0.0) {
    return {static_cast<float>(checked(parameter::kBlurAtInfinity, settings.blur_at_infinity_px)),
            static_cast<float>(checked(parameter::kFocus, settings.focus_m))};
  }
  ThinLens lens;
  for (const auto& [parameter, place, has_keys] : kLensNumbers) {
    lens.*place = checked(parameter, settings.*kLensFields[place]);
  }
  if (const char* error = lens_error(lens)) refuse("settings", error);
  const double scale = checked(parameter::kCocScale, settings.coc_scale);
  PixelCoc coc;
  if (settings.fov_y_degrees != 0.0) {
    coc = pixel_coc(lens, checked(parameter::kFov, "fov_y_degrees", settings.fov_y_degrees),
                    height_px, scale);
  } else {
    const double pixels_per_mm = pixels_per_sensor_mm(
        checked(parameter::kSensorSide, "sensor_width_mm", settings.sensor_width_mm),
        checked(parameter::kSensorSide, "sensor_height_mm", settings.sensor_height_mm), width_px,
        height_px);
    coc = sensor_coc(lens, image_distance_mm(lens, lens.focus_m) * pixels_per_mm, scale);
  }
  if (!std::isfinite(coc.radius_at_infinity_px)) {
    refuse("settings", "the lens's circles are too large; a larger f_number has smaller ones");
  }
  return coc;
}

std::string listed(std::string all, std::string_view name) {
  if (!all.empty()) all += ", ";
  return all.append(name);
}

const Method* method_of(const char* name) {
  if (name == nullptr) refuse("settings.method", "a null pointer");
  if (kAuto == name) return nullptr;
  const Method* method = find_method(name);
  if (method == nullptr) {
    std::string all{kAuto};
    for (const Method& one : methods()) all = listed(all, one.name);
    refuse("settings.method", "there is no '" + std::string{name} + "'; there are " + all);
  }
  return method;
}

Profile profile_of(const char* name) {
  if (name == nullptr) refuse("settings.profile", "a null pointer");
  const auto profile = find_profile(name);
  if (!profile) {
    std::string all;
    for (const NamedProfile& one : profiles()) all = listed(all, one.name);
    refuse("settings.profile", "there is no '" + std::string{name} + "'; there are " + all);
  }
  return *profile;
}

}  // namespace

softfocus_settings default_settings() {
  return {.struct_size = sizeof(softfocus_settings),
          .method = "two-pass",
          .profile = "ieee",
          .focal_length_mm = parameter::kFocalLength.preset,
          .f_number = parameter::kFNumber.preset,
          .focus_m = parameter::kFocus.preset,
          .sensor_width_mm = 36.0,
          .sensor_height_mm = 24.0,
          .fov_y_degrees = 0.0,
          .coc_scale = parameter::kCocScale.preset,
          .blur_at_infinity_px = 0.0,
          .max_radius_px = 0.0,
          .leak = parameter::kLeak.preset,
          .budget = parameter::kBudget.preset,
          .max_error = parameter::kMaxError.preset};
}

ReadSettings read_settings(const softfocus_settings* given, int width_px, int height_px) {
  const auto settings = read_struct("settings", given, default_settings());
  ReadSettings read;
  read.method = method_of(settings.method);
  read.profile = profile_of(settings.profile);
  read.dof.coc = coc_of(settings, width_px, height_px);
  read.dof.leak = static_cast<float>(checked(parameter::kLeak, settings.leak));
  read.dof.budget = static_cast<float>(checked(parameter::kBudget, settings.budget));
  read.max_error = checked(parameter::kMaxError, settings.max_error);
  if (settings.max_radius_px != 0.0) {
    read.max_radius_px =
        static_cast<float>(checked(parameter::kMaxCoc, "max_radius_px", settings.max_radius_px));
  }
  return read;
}

}  // namespace softfocus
