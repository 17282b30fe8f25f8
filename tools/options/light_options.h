#pragma once
// What the command line says of lights with shadows, in place of what the scene says.

#include <optional>

#include "scenes/scene.h"
#include "tools/cli/parser.h"

namespace softfocus {

struct LightOptions {
  std::optional<double> darkness;          ///< --shadow-darkness
  std::optional<int> points;               ///< --soft
  std::optional<double> radius_m;          ///< --light-radius
  std::optional<double> angle_degrees;     ///< --light-angle
  std::optional<Terminator> terminator{};  ///< --soften-terminators
};

/// Adds --shadow-darkness, --soft, --light-radius and --light-angle.
void add_light_options(CLI::App& parser, LightOptions& options);

/// Adds --soften-terminators.
void add_terminator_option(CLI::App& parser, LightOptions& options);

/// Puts the values into lights with shadows; throws UsageError where no light has what an option
/// is of.
void set_lights(const LightOptions& options, Scene& scene);

}  // namespace softfocus
