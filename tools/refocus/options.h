#pragma once
// Everything that `refocus` is told.

#include <optional>
#include <string>

#include "dof/fixed_pictures/arithmetic.h"
#include "dof/lens.h"
#include "tools/options/method_options.h"
#include "tools/options/run_options.h"
#include "tools/pictures/image_file.h"
#include "tools/refocus/borders.h"
#include "tools/refocus/highlights.h"
#include "tools/refocus/picture_with_depth.h"
#include "tools/sequence/sequence_options.h"

namespace softfocus {

/// The written picture, or a map of what it is made from.
enum class RefocusShow : std::uint8_t { image, coc, depth };

struct RefocusOptions {
  std::string colour;
  std::string depth;   ///< empty: COLOUR has it
  std::string output;  ///< "-" for standard output
  FileFormat format = FileFormat::png;
  DepthOptions reading;
  PhotoLens photo;
  MethodChoice method{.filter = find_method("two-pass")};
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
  Profile profile;
  std::string profile_name = "ieee";
  PoolOptions pool;
  SequenceOptions sequence;  ///< of many pictures
  bool json = false;
  bool verbose = false;
  bool quiet = false;
};

void add_refocus_options(CLI::App& parser, RefocusOptions& options);

/// Checks options against each other: throws UsageError for options that are missing or exclude
/// each other and for methods that need the scene, and settles the format.
void complete(RefocusOptions& options, const CLI::App& parser);

}  // namespace softfocus
