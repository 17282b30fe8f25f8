#pragma once
// The lens on the command line, as `render` and `lens` share it.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dof/lens.h"
#include "scenes/scene.h"
#include "tools/cli/parser.h"

namespace softfocus {

/// The lens values that were given.
struct LensOptions {
  OfLensNumbers<std::optional<double>> given{};
  std::optional<double> coc_scale;
  /// Keys of commands that animate, in place of one value if not empty: frames from 0 on,
  /// increasing.
  OfLensNumbers<std::vector<Keyframe>> keys{};
  Easing easing = Easing::linear;
};

/// The options with the values at a frame in place of keys.
LensOptions at_frame(LensOptions options, double frame);

/// The values given of numbers that may have keys, every bit of them.
std::string lens_text(const LensOptions& options);

/// Throws UsageError if there are keys: of a picture that is no frame.
void check_no_keys(const LensOptions& options);

/// Adds --focus, --focal-length, --f-number and --coc-scale, whose defaults are the scene's.
void add_lens_options(CLI::App& parser, LensOptions& options);

/// Adds them for a command that animates: --focus and --f-number may have keys, such as '1:2m
/// 48:6m', and --keyframes is added.
void add_animated_lens_options(CLI::App& parser, LensOptions& options);

/// Adds them for a command without a scene: the defaults are ThinLens's, and --fov is added.
void add_own_lens_options(CLI::App& parser, LensOptions& options,
                          std::function<void(double degrees)> on_fov);

/// Adds them for pictures that may carry a lens: the defaults are theirs.
void add_compared_lens_options(CLI::App& parser, LensOptions& options,
                               std::function<void(double degrees)> on_fov);

/// Adds them for pictures to refocus, which may carry a lens, with keys.
void add_refocus_lens_options(CLI::App& parser, LensOptions& options,
                              std::function<void(double degrees)> on_fov);

/// `lens` with what was given put in.
ThinLens overruled(ThinLens lens, const LensOptions& options);

/// Throws UsageError if `lens` cannot be, naming the options that made it so or, if
/// none was given, `otherwise`.
void check_lens(const ThinLens& lens, const LensOptions& options, std::string_view otherwise);

/// Throws UsageError for circles that single precision cannot hold.
void check_pixel_coc(const PixelCoc& coc);

/// pixel_coc(), whose circles single precision must be able to hold: UsageError.
PixelCoc checked_pixel_coc(const ThinLens& lens, double fov_y_degrees, int height_px,
                           double coc_scale);

}  // namespace softfocus
