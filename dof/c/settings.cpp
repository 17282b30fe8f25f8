#include "dof/c/settings.h"

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "dof/c/arguments.h"
#include "dof/sensor.h"

namespace softfocus {
namespace {

constexpr std::string_view kAuto = "auto";

/// Throws for what is no number from `least` to `most`.
double checked(const char* name, double value, double least, double most, const char* wanted) {
  if (!(value >= least && value <= most)) {
    refuse("settings." + std::string{name}, std::to_string(value) + " is not " + wanted);
  }
  return value;
}

constexpr double kMost = std::numeric_limits<float>::max();

double from_zero(const char* name, double value) {
  return checked(name, value, 0.0, kMost, "a number from 0");
}

double above_zero(const char* name, double value) {
  return checked(name, value, 1e-30, kMost, "a number above 0");
}

PixelCoc coc_of(const softfocus_settings& settings, int width_px, int height_px) {
  if (settings.blur_at_infinity_px != 0.0) {
    return {static_cast<float>(from_zero("blur_at_infinity_px", settings.blur_at_infinity_px)),
            static_cast<float>(above_zero("focus_m", settings.focus_m))};
  }
  const ThinLens lens{above_zero("focal_length_mm", settings.focal_length_mm),
                      above_zero("f_number", settings.f_number),
                      above_zero("focus_m", settings.focus_m)};
  if (const char* error = lens_error(lens)) refuse("settings", error);
  const double scale = from_zero("coc_scale", settings.coc_scale);
  PixelCoc coc;
  if (settings.fov_y_degrees != 0.0) {
    coc = pixel_coc(lens,
                    checked("fov_y_degrees", settings.fov_y_degrees, 0.001, 179.999,
                            "from 0.001 to 179.999, or 0 for a sensor"),
                    height_px, scale);
  } else {
    const double pixels_per_mm = pixels_per_sensor_mm(
        above_zero("sensor_width_mm", settings.sensor_width_mm),
        above_zero("sensor_height_mm", settings.sensor_height_mm), width_px, height_px);
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
  const ThinLens lens;
  const DofSettings dof;
  return {.struct_size = sizeof(softfocus_settings),
          .method = "two-pass",
          .profile = "ieee",
          .focal_length_mm = lens.focal_length_mm,
          .f_number = lens.f_number,
          .focus_m = lens.focus_m,
          .sensor_width_mm = 36.0,
          .sensor_height_mm = 24.0,
          .fov_y_degrees = 0.0,
          .coc_scale = 1.0,
          .blur_at_infinity_px = 0.0,
          .max_radius_px = 0.0,
          .leak = static_cast<double>(dof.leak),
          .budget = static_cast<double>(dof.budget),
          .max_error = 0.02};
}

ReadSettings read_settings(const softfocus_settings* given, int width_px, int height_px) {
  const auto settings = read_struct("settings", given, default_settings());
  ReadSettings read;
  read.method = method_of(settings.method);
  read.profile = profile_of(settings.profile);
  read.dof.coc = coc_of(settings, width_px, height_px);
  read.dof.leak = static_cast<float>(from_zero("leak", settings.leak));
  read.dof.budget = static_cast<float>(checked("budget", settings.budget, 0.0, 1.0, "from 0 to 1"));
  read.max_error = from_zero("max_error", settings.max_error);
  if (settings.max_radius_px != 0.0) {
    read.max_radius_px = static_cast<float>(checked("max_radius_px", settings.max_radius_px, 0.0,
                                                    SOFTFOCUS_LARGEST_RADIUS, "from 0 to 1024"));
  }
  return read;
}

}  // namespace softfocus
