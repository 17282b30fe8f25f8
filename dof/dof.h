#pragma once
// Depth of field on a picture with depth: what a program that embeds it includes.
// docs/embedding.md has an example.
//
// The bits of a result depend on the input alone: not on threads, vector unit, compiler,
// or the flags and the floating-point mode of the program around it.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "dof/lens.h"
#include "dof/pack.h"
#include "dof/shaders.h"
#include "raster/images/image_view.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

struct Image;
struct Pipeline;

inline constexpr float kLargestMaxCoc = 1024.0f;

/// Layers behind the first that a method may read.
inline constexpr std::size_t kMostBehind = 3;

/// Transparent layers before a picture.
inline constexpr std::size_t kMostTransparent = 4;

/// A layer of transparent surfaces before a picture: two pictures of its size and format with the
/// same depths.
struct TransparentLayer {
  /// Colour times opacity. Depths of the layer's surfaces, and of the picture where it has none.
  ConstImageView colour;
  /// The opacity, 0 to 1, in red, green and blue.
  ConstImageView opacity;
};

/// Pixels that another surface shares with the scene's, as an edge's are: pictures of its size.
struct EdgeSurfaces {
  ConstImageView coverage = {};  ///< r8: the part of a pixel that `other` has; without texels: none
  ConstImageView other = {};     ///< RGBA16F: the other surface; anything where it has no part
};

/// The frame that a picture is of, for pipelines (dof/pipelines).
struct FrameValues {
  double near_m = 0.1, far_m = 1000.0;  ///< the camera's planes
  double aperture_radius_m = 0.0;
  double number = 0.0;  ///< of a sequence
};

/// What every method is told about the lens and the filter.
struct DofSettings {
  PixelCoc coc;
  /// The largest circle of confusion, a radius in pixels, 0 to kLargestMaxCoc. Larger circles
  /// are cut to it.
  float max_coc_px = 16.0f;
  /// How readily a background gives its colour to what lies before it, 0 or more: the factor
  /// of the leakage weight (dof/weights.h), per pixel of the receiver's radius.
  float leak = 1.0f;
  /// The share, 0 to 1, of one-pass's work that importance-ordered spends.
  float budget = 0.25f;
  /// Of scatter-aperture, one without an aperture_error(); the others know round ones alone.
  Aperture aperture{};
  FrameValues frame{};
};

/// The part of a result that is wanted; without a width all of it.
struct KeptPart {
  int x = 0, y = 0, width = 0, height = 0;

  /// Whether any pixel from (x_begin, y_begin) up to (x_end, y_end) is in it.
  bool meets(int x_begin, int y_begin, int x_end, int y_end) const {
    return width == 0 || (x_begin < x + width && x < x_end && y_begin < y + height && y < y_end);
  }
  bool has_row(int row) const { return width == 0 || (row >= y && row < y + height); }
};

/// A picture and how to blur it.
struct DofInput {
  /// RGBA16F: linear colour, and in alpha the depth in metres along the axis. pack() makes
  /// such a picture of other formats.
  ConstImageView scene;
  DofSettings settings;
  Profile profile;  ///< the rounding of the result's halves
  /// The number of the object that each pixel shows, row by row from the top, or empty if that
  /// is not known.
  std::span<const std::uint16_t> objects = {};
  /// What lies behind the surface that each pixel shows: the next surface, the one after it, and so
  /// on, as pictures like `scene`, up to kMostBehind; or empty if that is not known. Where nothing
  /// lies behind, a picture repeats the background.
  std::span<const ConstImageView> behind = {};
  /// Transparent surfaces before `scene`, which shows what is opaque: the nearest layer first, up
  /// to kMostTransparent, or empty. apply() has the method blur the picture and each layer by
  /// itself, so that each surface has its own circle, and lays them over each other
  /// (transparent.h).
  std::span<const TransparentLayer> transparent = {};
  /// Of `scene`, which shows one surface in each pixel; without a coverage none. apply() smooths
  /// the edges of what the method makes of it, and without `objects` and `behind` chooses which of
  /// two surfaces the method sees (smooth_edges.h).
  EdgeSurfaces edges = {};
  /// Signed radii in pixels, row by row from the top, in place of those that the lens gives, or
  /// empty. Only methods that take_radii read them.
  std::span<const float> radii_px = {};
  /// A method may leave what is not kept of the result as it is. What it does not keep, such as a
  /// border, still is blurred into what it keeps.
  KeptPart kept = {};
};

/// A depth-of-field method: an entry of the table in method.cpp.
struct Method {
  std::string_view name;
  std::string_view summary;
  /// The inputs that the method reads, for the list of methods.
  std::string_view needs;
  /// Null of a pipeline.
  void (*filter)(const DofInput& input, const ImageView& result, ThreadPool& pool);
  /// Whether a larger max_coc_px costs nothing and leaves smaller circles as they are: then no
  /// circle need be cut.
  bool any_radius_costs_the_same = false;
  /// Whether it makes use of DofInput::objects.
  bool reads_objects = false;
  /// How many layers it works from: with more than 1 it makes use of DofInput::behind.
  std::size_t layers = 1;
  /// Whether it makes use of DofInput::radii_px.
  bool takes_radii = false;
  const Pipeline* pipeline = nullptr;  ///< a user's passes
};

std::span<const Method> methods();

/// The method of that name, or nullptr.
const Method* find_method(std::string_view name);

/// What is wrong with an input and a place for its result, as a sentence, or nullptr.
const char* input_error(const DofInput& input, const ConstImageView& result);

/// Writes every pixel of `result`, depth in alpha. It has the scene's size and format and
/// shares no memory with it. Needs an input without input_error(). Throws std::bad_alloc
/// if there is no memory for what the method keeps meanwhile, of a pipeline ShaderError too.
void apply(const Method& method, const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The same into a new image (raster/images/image.h).
Image apply(const Method& method, const DofInput& input, ThreadPool& pool);

}  // namespace softfocus
