#include "tools/options/effect_options.h"

#include <algorithm>

#include "raster/effects/tone_map.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

std::string keys_of(const Effect& effect) {
  return effect.parameters.empty() ? "it takes none" : "there are " + names_of(effect.parameters);
}

void take_parameter(const std::string& text, const std::string& where, ChosenEffect& chosen,
                    std::vector<bool>& given) {
  const Effect& effect = *chosen.effect;
  const std::size_t equals = text.find('=');
  const std::string key = text.substr(0, equals);
  const auto found =
      std::find_if(effect.parameters.begin(), effect.parameters.end(),
                   [&](const EffectParameter& parameter) { return parameter.name == key; });
  if (found == effect.parameters.end() || equals == std::string::npos) {
    throw UsageError(where + ": '" + text + "' is no key=value of " + std::string{effect.name} +
                     "; " + keys_of(effect));
  }
  const auto index = static_cast<std::size_t>(found - effect.parameters.begin());
  if (given[index]) throw UsageError(where + ": " + key + " is there twice; give it once");
  given[index] = true;
  chosen.parameters[index] =
      parse_number(where + ": " + key, text.substr(equals + 1), found->least, found->most,
                   std::string{found->summary} + ", " + short_number(found->least) + " to " +
                       short_number(found->most));
}

}  // namespace

ChosenEffect parse_effect(std::string_view option, const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  ChosenEffect chosen{find_effect(name), {}};
  if (chosen.effect == nullptr) refuse_name(option, name, names_in(effects()));
  for (const EffectParameter& parameter : chosen.effect->parameters) {
    chosen.parameters.push_back(parameter.preset);
  }
  std::vector<bool> given(chosen.parameters.size());
  for (std::size_t begin = colon; begin != std::string::npos;) {
    const std::size_t end = text.find(',', begin + 1);
    take_parameter(text.substr(begin + 1, end - begin - 1), std::string{option} + " '" + text + "'",
                   chosen, given);
    begin = end;
  }
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
  add_value(parser, "--tone-map", "none|reinhard|aces|hable",
            "Last of all: light of any strength becomes 0 to 1 by a curve (default: none, which "
            "cuts it)",
            [&options](const std::string& text) {
              options.tone_map.reset();
              if (text == "none") return;
              if (find_tone_curve(text) == nullptr) {
                std::vector<std::string> names = names_in(kToneCurves);
                names.insert(names.begin(), "none");
                refuse_name("--tone-map", text, names);
              }
              options.tone_map = parse_effect("--tone-map", text);
            });
}

std::vector<ChosenEffect> all_effects(const EffectOptions& options,
                                      std::span<const ChosenEffect> of_scene) {
  std::vector<ChosenEffect> all = options.effects;
  if (!options.are_given) all.assign(of_scene.begin(), of_scene.end());
  if (options.tone_map) all.push_back(*options.tone_map);
  return all;
}

std::optional<ChosenEffect> effect_of_frames(const std::vector<ChosenEffect>& effects,
                                             const std::string& where) {
  for (std::size_t i = 1; i < effects.size(); ++i) {
    if (!is_of_frames(*effects[i].effect)) continue;
    const std::string name{effects[i].effect->name};
    throw UsageError(where + ": " + name +
                     (is_of_frames(*effects.front().effect)
                          ? " and " + std::string{effects.front().effect->name} +
                                " both make frames from those before; give one"
                          : " is part of the drawing; name it before all other effects"));
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
      const std::string before{last->name}, after{chosen.effect->name};
      return "the effect " + before + " comes before " + after + ": a camera has " + after +
             " first, then " + before + " (docs/effects/order.md)";
    }
    last = chosen.effect;
  }
  return "";
}

Image with_effects(Image picture, const std::vector<ChosenEffect>& effects,
                   const MakeVelocity& make_velocity, const Profile& profile, ThreadPool& pool) {
  for (const ChosenEffect& chosen : effects) {
    if (is_of_frames(*chosen.effect)) continue;  // it has been drawn so
    Image velocity;
    EffectInput input{picture, chosen.parameters, profile};
    if (chosen.effect->velocity != VelocityOf::nothing) {
      velocity = make_velocity(chosen, picture);
      input.velocity = velocity;
    }
    picture = apply(*chosen.effect, input, pool);
  }
  return picture;
}

}  // namespace softfocus
