#pragma once
// Effects on a command line: --effect NAME:key=value,..., one after the other.

#include <string>
#include <vector>

#include "raster/effects/effect.h"
#include "tools/cli/parser.h"

namespace softfocus {

/// An effect with its numbers.
struct ChosenEffect {
  const Effect* effect;
  std::vector<double> parameters;  ///< one for each of the effect's
};

/// Throws UsageError for an effect or a key that there is not, a key that comes twice, and a number
/// beyond its limits.
ChosenEffect parse_effect(std::string_view option, const std::string& text);

/// "gaussian:sigma=2": as parse_effect() reads it.
std::string effect_text(const ChosenEffect& chosen);

/// Adds --effect, which may be repeated.
void add_effect_option(CLI::App& parser, std::vector<ChosenEffect>& effects);

/// The picture with all of them, in their order.
Image with_effects(Image picture, const std::vector<ChosenEffect>& effects, const Profile& profile,
                   ThreadPool& pool);

}  // namespace softfocus
