#include "dof/c/settings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "dof/lens.h"
#include "dof/parameters.h"
#include "raster/numbers/parameter_text.h"

namespace softfocus {

void refuse(const std::string& argument, const std::string& reason) {
  throw BadArgument(argument + ": " + reason);
}

std::size_t struct_bytes(const std::string& argument, const void* given, std::size_t first_bytes,
                         std::size_t our_bytes) {
  constexpr std::size_t kMostBytes = 4096;  // more is memory that was never set
  if (given == nullptr) refuse(argument, "a null pointer");
  std::size_t bytes = 0;
  std::memcpy(&bytes, given, sizeof bytes);
  if (bytes < first_bytes || bytes > kMostBytes) {
    refuse(argument + ".struct_size", std::to_string(bytes) + "; set it to the struct's sizeof, " +
                                          std::to_string(our_bytes) + " in this library");
  }
  const auto* end = static_cast<const std::byte*>(given) + bytes;
  if (bytes > our_bytes && std::any_of(end - (bytes - our_bytes), end,
                                       [](std::byte byte) { return byte != std::byte{0}; })) {
    refuse(argument, "a field is set that this library does not know; a newer libsoftfocus does");
  }
  return bytes;
}

MemoryRange range_of(const PixelPlane& plane, int width, int height) {
  if (plane.first == nullptr) refuse(plane.name, "a null pointer");
  std::ptrdiff_t across = 0, down = 0, low = 0, high = 0;
  const bool is_too_far =
      __builtin_mul_overflow(plane.pixel_bytes, std::ptrdiff_t{width} - 1, &across) ||
      __builtin_mul_overflow(plane.row_bytes, std::ptrdiff_t{height} - 1, &down) ||
      __builtin_add_overflow(std::min(across, std::ptrdiff_t{0}), std::min(down, std::ptrdiff_t{0}),
                             &low) ||
      __builtin_add_overflow(std::max(across, std::ptrdiff_t{0}), std::max(down, std::ptrdiff_t{0}),
                             &high) ||
      __builtin_add_overflow(high, plane.value_bytes, &high);
  const auto first = reinterpret_cast<std::uintptr_t>(plane.first);
  // Of a negative number, as its magnitude.
  const std::uintptr_t before = std::uintptr_t{0} - static_cast<std::uintptr_t>(low);
  if (is_too_far || before > first ||
      static_cast<std::uintptr_t>(high) > std::numeric_limits<std::uintptr_t>::max() - first) {
    refuse(plane.name, "with these strides its pixels lie outside of memory");
  }
  return {first - before, first + static_cast<std::uintptr_t>(high)};
}

void check_apart(const PixelPlane& plane, int width, int height) {
  struct Step {
    std::uint64_t bytes;
    std::uint64_t count;
  };
  const auto step = [](std::ptrdiff_t bytes, int count) {
    const auto magnitude = static_cast<std::uint64_t>(bytes);
    return Step{count == 1  ? 0
                : bytes < 0 ? std::uint64_t{0} - magnitude
                            : magnitude,
                static_cast<std::uint64_t>(count)};
  };
  // Rows of pixels, or columns of them.
  Step shorter = step(plane.pixel_bytes, width), longer = step(plane.row_bytes, height);
  if (longer.bytes < shorter.bytes) std::swap(longer, shorter);
  const auto value_bytes = static_cast<std::uint64_t>(plane.value_bytes);
  const std::uint64_t line_bytes = (shorter.count - 1) * shorter.bytes + value_bytes;
  if ((shorter.count > 1 && shorter.bytes < value_bytes) ||
      (longer.count > 1 && longer.bytes < line_bytes)) {
    refuse(plane.name, "with these strides its pixels lie over each other");
  }
}

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

}  // namespace

Profile profile_of(const std::string& argument, const char* name) {
  if (name == nullptr) refuse(argument, "a null pointer");
  const auto profile = find_profile(name);
  if (!profile) {
    std::string all;
    for (const NamedProfile& one : profiles()) all = listed(all, one.name);
    refuse(argument, "there is no '" + std::string{name} + "'; there are " + all);
  }
  return *profile;
}

softfocus_settings default_settings() {
  softfocus_settings settings{};
  settings.struct_size = sizeof settings;
  settings.method = "two-pass";
  settings.profile = "ieee";
  for (const LensNumber& number : kLensNumbers) {
    settings.*kLensFields[number.place] = number.parameter.preset;
  }
  settings.sensor_width_mm = 36.0;
  settings.sensor_height_mm = 24.0;
  settings.coc_scale = parameter::kCocScale.preset;
  settings.leak = parameter::kLeak.preset;
  settings.budget = parameter::kBudget.preset;
  settings.max_error = parameter::kMaxError.preset;
  return settings;
}

ReadSettings read_settings(const softfocus_settings* given, int width_px, int height_px) {
  const auto settings = read_struct("settings", given, default_settings());
  ReadSettings read;
  read.method = method_of(settings.method);
  read.profile = profile_of("settings.profile", settings.profile);
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
