#pragma once
// Depth of field on a picture with depth: what a program that embeds it includes.
//
//   ThreadPool pool(hardware_threads());
//   DofSettings settings;
//   settings.coc = pixel_coc({.focal_length_mm = 85, .f_number = 2, .focus_m = 1.2}, 30.0, height, 1.0);
//   find_method("two-pass")->apply({scene, settings, Profile{}}, result, pool);

#include <span>
#include <string_view>

#include "dof/lens.h"
#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// What every method is told about the lens and the filter.
struct DofSettings {
  PixelCoc coc;
  /// Largest circle of confusion, a radius in pixels, 0 to kLargestMaxCoc: larger
  /// ones are cut to it.
  float max_coc_px = 16.0f;
  /// How readily a background gives its colour to what lies before it: the factor
  /// of the leakage weight, per pixel of the receiver's radius. 0 or more.
  float leak = 1.0f;
};

inline constexpr float kLargestMaxCoc = 1024.0f;

/// A picture and how to blur it.
struct DofInput {
  /// RGBA16F: linear colour, and in alpha the depth in metres along the axis.
  ConstImageView scene;
  DofSettings settings;
  Profile profile;
};

/// A depth-of-field method. Each is one entry of the table in method.cpp.
struct Method {
  std::string_view name;
  std::string_view summary;
  /// What the method works from, for the list of methods.
  std::string_view needs;
  /// Writes every pixel of `result`, depth in alpha. It has the scene's size and format,
  /// and shares no memory with it; one that is used again from frame to frame spares the
  /// cost of fresh memory.
  void (*apply)(const DofInput& input, const ImageView& result, ThreadPool& pool);
};

/// The same into a new image.
Image apply(const Method& method, const DofInput& input, ThreadPool& pool);

std::span<const Method> methods();

/// The method of that name, or nullptr.
const Method* find_method(std::string_view name);

}  // namespace softfocus
