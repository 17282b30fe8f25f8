#pragma once
// The lens on the command line, as `render` and `lens` share it.

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "dof/lens.h"
#include "tools/cli/parser.h"

namespace softfocus {

/// The lens values that were given.
struct LensOptions {
  std::optional<double> focal_length_mm;
  std::optional<double> f_number;
  std::optional<double> focus_m;
  std::optional<double> coc_scale;
};

/// Adds --focus, --focal-length, --f-number and --coc-scale, whose defaults are the scene's. A
/// value that no lens can have is refused as it is read.
void add_lens_options(CLI::App& parser, LensOptions& options);

/// Likewise for a command without a scene: the defaults are ThinLens's, and --fov is added.
void add_own_lens_options(CLI::App& parser, LensOptions& options,
                          std::function<void(double degrees)> on_fov);

/// Likewise for pictures that may carry a lens: the defaults are theirs.
void add_compared_lens_options(CLI::App& parser, LensOptions& options,
                               std::function<void(double degrees)> on_fov);

/// Likewise for a picture to refocus, which may carry a lens.
void add_refocus_lens_options(CLI::App& parser, LensOptions& options,
                              std::function<void(double degrees)> on_fov);

/// `lens` with what was given put in.
ThinLens overruled(ThinLens lens, const LensOptions& options);

/// Throws UsageError if `lens` cannot be, naming the options that made it so or, if
/// none was given, `otherwise`.
void check_lens(const ThinLens& lens, const LensOptions& options, std::string_view otherwise);

/// pixel_coc(), whose circles single precision must be able to hold: UsageError.
PixelCoc checked_pixel_coc(const ThinLens& lens, double fov_y_degrees, int height_px,
                           double coc_scale);

}  // namespace softfocus
