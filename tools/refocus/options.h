#pragma once
// Everything that `refocus` is told.

#include <optional>
#include <string>

#include "dof/fixed_pictures/arithmetic.h"
#include "dof/lens.h"
#include "tools/options/method_options.h"
#include "tools/options/run_options.h"
#include "tools/pictures/image_file.h"
#include "tools/pictures/picture_file.h"
#include "tools/refocus/picture_with_depth.h"
#include "tools/sequence/sequence_options.h"

namespace softfocus {

// Pixels beyond the borders of a picture that is refocused.

/// `by_method`: as each filter has it (docs/refocus.md). The others are pixels around the picture,
/// which the filter then sees: its edge again and again, its mirror image, or black, where nothing
/// is opaque. Depths of black ones are those of the edge.
enum class Border : std::uint8_t { by_method, clamp, mirror, black };

/// clamp, mirror, black; by-method.
std::string_view name_of(Border border);

/// The picture, RGBA16F with depth in alpha, with `margin` pixels more on each side.
Image with_border(const Image& picture, int margin, Border border);

/// Enlarges a plane of numbers; black ones are 0.
PlaneValues with_border(const PlaneValues& values, int width, int height, int margin,
                        Border border);

/// The way back: `width` and `height` are those with the border.
Image without_border(const Image& picture, int margin);
PlaneValues without_border(const PlaneValues& values, int width, int height, int margin);

// Light that a camera clipped: white that was a lamp is raised before the filter, so that it shows
// as a disc, and lowered by the same curve afterwards, so that what is sharp stays as it was.

/// With the luminance L = .2126 R + .7152 G + .0722 B in linear light, of the colour without its
/// opacity, colours are multiplied by L' / L,
///
///   L' = L + (gain - 1) max(L - threshold, 0)
///
/// It rises with L, and so has an inverse.
struct HighlightCurve {
  double gain = 1.0;       ///< 1 or more
  double threshold = 1.0;  ///< 0 or more
};

namespace parameter {
inline constexpr Parameter kHighlightGain{
    "gain", "How much light above the threshold is raised before the blur", 1.0, 1e4, 1.0};
inline constexpr Parameter kHighlightThreshold{
    "threshold", "Light above this is a highlight, of which 8 bits have lost a part", 0.0, 1e4,
    0.9};
}  // namespace parameter

/// GAIN,THRESHOLD. Throws UsageError.
HighlightCurve parse_highlights(const std::string& text);

/// `opacity` is empty or has a number a pixel, by which the colours are multiplied.
void raise_highlights(const HighlightCurve& highlights, const PlaneValues& opacity, Image& picture);
void lower_highlights(const HighlightCurve& highlights, const PlaneValues& opacity, Image& picture);

/// The written picture, or a map of what it is made from.
enum class RefocusShow : std::uint8_t { image, coc, depth };

struct RefocusOptions {
  std::string colour;
  std::string depth;   ///< empty: COLOUR has it
  std::string output;  ///< "-" for standard output
  FileFormat format = FileFormat::png;
  std::optional<std::string> circles;  ///< `depth` is this file, and `reading` reads its radii
  DepthOptions reading;
  PhotoLens photo;
  MethodChoice method = find_method_choice(kDefaultMethod);
  bool method_by_size = false;  ///< two-pass, by rows, where the memory is too small for `method`
  Arithmetic arithmetic = Arithmetic::floats;
  AutoGoal goal;                    ///< of auto
  std::optional<float> max_coc_px;  ///< none: the picture's largest circle
  float leak = DofSettings{}.leak;
  float budget = DofSettings{}.budget;
  RefocusShow show = RefocusShow::image;
  bool keep_layers = true;  ///< of an EXR, in an EXR
  Aperture aperture;
  std::optional<HighlightCurve> highlights;
  Border border = Border::by_method;
  bool unmix = false;  ///< edges
  Profile profile;
  std::string profile_name = "ieee";
  PoolOptions pool;
  SequenceOptions sequence;  ///< of many pictures
  bool json = false;
  bool verbose = false;
  bool quiet = false;
};

void add_refocus_options(CLI::App& parser, RefocusOptions& options);

inline constexpr const char* kCirclesText =
    "Radii of circles in pixels in place of depth and lens, negative before the focus: of any "
    "camera, by any program";

/// Puts `options.circles` in the depth's place.
void read_circles(RefocusOptions& options);

/// The same for --circles. Throws UsageError for options that it excludes.
void take_circles(RefocusOptions& options, const CLI::App& parser);

/// Checks options against each other: throws UsageError for options that are missing or exclude
/// each other and for methods that need the scene, and settles the format.
void complete(RefocusOptions& options, const CLI::App& parser);

}  // namespace softfocus
