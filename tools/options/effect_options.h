#pragma once
// Effects on a command line: --effect NAME:key=value,..., one after the other.

#include <optional>
#include <string>
#include <vector>

#include "scenes/frame/frame.h"
#include "tools/cli/parser.h"

namespace softfocus {

/// Throws UsageError for an effect or a key that there is not, a key that comes twice, and a number
/// beyond its limits.
ChosenEffect parse_effect(std::string_view option, const std::string& text);

/// "gaussian:sigma=2": as parse_effect() reads it.
std::string effect_text(const ChosenEffect& chosen);

struct EffectOptions {
  bool are_given = false;                ///< --effect is: the scene's do not count
  std::vector<ChosenEffect> effects;     ///< in their order
  std::optional<ChosenEffect> tone_map;  ///< after all others
};

/// Adds --effect, which may be repeated, and --tone-map. `none` is no effect.
void add_effect_options(CLI::App& parser, EffectOptions& options);

/// All in the order in which they come. Those `of_scene` make way for given ones.
std::vector<ChosenEffect> all_effects(const EffectOptions& options,
                                      std::span<const ChosenEffect> of_scene = {});

/// The effect that is_of_frames(), which must be the first. Throws UsageError, naming
/// `where` they are, if it is not, and if there are two.
std::optional<ChosenEffect> effect_of_frames(const std::vector<ChosenEffect>& effects,
                                             const std::string& where);

/// A warning if one comes before another that a camera has before it, or "": motion blur, then
/// bloom and lens flare, then tone mapping (docs/effects/order.md).
std::string order_warning(const std::vector<ChosenEffect>& effects);

}  // namespace softfocus
