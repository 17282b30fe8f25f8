#pragma once
// Depth of field on a picture with depth: what a program that embeds it includes.
//
//   ThreadPool pool(hardware_threads());
//   const ThinLens lens{.focal_length_mm = 85, .f_number = 2, .focus_m = 1.2};
//   DofSettings settings;
//   settings.coc = pixel_coc(lens, 30.0, scene.height, 1.0);
//   find_method("two-pass")->apply({scene, settings, Profile{}}, result, pool);
//
// The bits of a result depend on the input alone, not on threads, vector unit or memory.

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
  /// The largest circle of confusion, a radius in pixels, 0 to kLargestMaxCoc. Larger circles
  /// are cut to it.
  float max_coc_px = 16.0f;
  /// How readily a background gives its colour to what lies before it, 0 or more: the factor
  /// of the leakage weight (dof/weights.h), per pixel of the receiver's radius.
  float leak = 1.0f;
};

inline constexpr float kLargestMaxCoc = 1024.0f;

/// A picture and how to blur it.
struct DofInput {
  /// RGBA16F, 1 to kMaxImageSize pixels wide and high. Red, green and blue: linear colour, of
  /// any value. Alpha: the depth in metres along the axis; infinity and NaN count as far away.
  ConstImageView scene;
  DofSettings settings;
  Profile profile;  ///< the rounding of the result's halves
};

/// A depth-of-field method. Each is one entry of the table in method.cpp.
struct Method {
  std::string_view name;
  std::string_view summary;
  /// The inputs that the method reads, for the list of methods.
  std::string_view needs;
  /// Writes every pixel of `result`: colour, and the scene's depth in alpha. Needs a result of
  /// the scene's size and format that shares no memory with it. Reports no errors; throws
  /// std::bad_alloc if there is no memory for what it needs in between.
  void (*apply)(const DofInput& input, const ImageView& result, ThreadPool& pool);
};

/// Applies a method and returns its result as a new image.
Image apply(const Method& method, const DofInput& input, ThreadPool& pool);

/// All methods, in the order of the table.
std::span<const Method> methods();

/// The method of that name, or nullptr.
const Method* find_method(std::string_view name);

}  // namespace softfocus
