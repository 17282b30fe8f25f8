#include "tools/options/effect_options.h"

#include "raster/effects/tone_map.h"
#include "raster/numbers/parameter_text.h"
#include "tools/cli/errors.h"
#include "tools/options/parameter_options.h"

namespace softfocus {

ChosenEffect parse_effect(std::string_view option, const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  ChosenEffect chosen{find_effect(name), {}};
  if (chosen.effect == nullptr) refuse_name(option, name, names_in(effects()));
  for (const Parameter& parameter : chosen.effect->parameters) {
    chosen.parameters.push_back(parameter.preset);
  }
  if (colon == std::string::npos) return chosen;
  const std::string where = std::string{option} + " '" + text + "'";
  const std::span<const Parameter> parameters = chosen.effect->parameters;
  read_pairs(where, std::string_view{text}.substr(colon + 1), names_in(parameters),
             [&](std::size_t key, const std::string& value) {
               const Parameter& of = parameters[key];
               chosen.parameters[key] =
                   parse_number(where + ": " + std::string{of.name}, value, of.least, of.most,
                                std::string{of.summary} + ", " + range_text(of));
             });
  return chosen;
}

std::string effect_text(const ChosenEffect& chosen) {
  std::string text{chosen.effect->name};
  for (std::size_t i = 0; i < chosen.parameters.size(); ++i) {
    text += (i == 0 ? ":" : ",") + std::string{chosen.effect->parameters[i].name} + "=" +
            short_number(chosen.parameters[i]);
  }
  return text;
}

void add_effect_options(CLI::App& parser, EffectOptions& options) {
  add_repeatable_value(
      parser, "--effect", "NAME:KEY=VALUE,...",
      "An effect on the picture (softfocus effects); several come in their order; in place "
      "of a scene's own; none: none",
      [&options](const std::string& text) {
        options.are_given = true;
        if (text == "none") return;
        options.effects.push_back(parse_effect("--effect", text));
      });
  offer(parser, "--effect", [] { return names_in(effects()); });
  std::vector<std::string> curves = names_in(kToneCurves);
  curves.insert(curves.begin(), "none");
  add_choice(parser, "--tone-map",
             "Last of all: light of any strength becomes 0 to 1 by a curve (default: none, which "
             "cuts it)",
             curves, [curves, &options](std::size_t number) {
               options.tone_map.reset();
               if (number != 0) options.tone_map = parse_effect("--tone-map", curves[number]);
             });
}

std::vector<ChosenEffect> all_effects(const EffectOptions& options,
                                      std::span<const ChosenEffect> of_scene) {
  std::vector<ChosenEffect> all = options.effects;
  if (!options.are_given) all.assign(of_scene.begin(), of_scene.end());
  if (options.tone_map) all.push_back(*options.tone_map);
  return all;
}

namespace {

/// Refuses an effect that makes frames and comes after `first`.
[[noreturn]] void refuse_of_frames(const std::string& where, const Effect& effect,
                                   const Effect& first) {
  const std::string name{effect.name};
  throw UsageError(
      where + ": " + name +
      (is_of_frames(first)
           ? " and " + std::string{first.name} + " both make frames from those before; give one"
           : " is part of the drawing; name it before all other effects"));
}

std::string order_text(const std::string& before, const std::string& after) {
  return "the effect " + before + " comes before " + after + ": a camera has " + after +
         " first, then " + before + " (docs/effects/order.md)";
}

}  // namespace

std::optional<ChosenEffect> effect_of_frames(const std::vector<ChosenEffect>& effects,
                                             const std::string& where) {
  for (std::size_t i = 1; i < effects.size(); ++i) {
    if (!is_of_frames(*effects[i].effect)) continue;
    refuse_of_frames(where, *effects[i].effect, *effects.front().effect);
  }
  if (effects.empty() || !is_of_frames(*effects.front().effect)) return {};
  return effects.front();
}

namespace {

// Effects without a place in the order have 0.
int place_in_order(const Effect& effect) {
  if (effect.name.starts_with("motion-blur")) return 1;
  if (effect.name.starts_with("bloom") || effect.name == "lens-flare") return 2;
  return find_tone_curve(effect.name) != nullptr ? 3 : 0;
}

}  // namespace

std::string order_warning(const std::vector<ChosenEffect>& effects) {
  const Effect* last = nullptr;
  for (const ChosenEffect& chosen : effects) {
    const int place = place_in_order(*chosen.effect);
    if (place == 0) continue;
    if (last != nullptr && place < place_in_order(*last)) {
      return order_text(std::string{last->name}, std::string{chosen.effect->name});
    }
    last = chosen.effect;
  }
  return "";
}

}  // namespace softfocus
