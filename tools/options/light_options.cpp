#include "tools/options/light_options.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "scenes/draw/light_points.h"
#include "scenes/draw/shadowed_layers.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

struct TerminatorChoice {
  std::string_view name;
  Terminator rule;
};
constexpr std::array kTerminatorChoices{TerminatorChoice{"facets", Terminator::facets},
                                        TerminatorChoice{"normals", Terminator::normals},
                                        TerminatorChoice{"fade", Terminator::fade}};

// Calls set(light) for each light of a kind that has shadows; there must be one.
template <class Set>
void set_lights_of(Scene& scene, const std::string& option, LightKind kind, std::string_view name,
                   const Set& set) {
  bool has_any = false;
  for (Light& light : scene.lights) {
    if (light.shadows == ShadowKind::none || light.kind != kind) continue;
    has_any = true;
    set(light);
  }
  if (!has_any) {
    throw UsageError(option + ": no " + std::string{name} + " light has shadows");
  }
}

bool is_empty(const LightOptions& options) {
  return !options.darkness && !options.points && !options.radius_m && !options.angle_degrees &&
         !options.terminator;
}

}  // namespace

void add_light_options(CLI::App& parser, LightOptions& options) {
  add_value(parser, "--shadow-darkness", "X",
            "The part of a light's share that its shadow takes away, 0 to 1 (default: 1)",
            [&options](const std::string& text) {
              options.darkness =
                  parse_number("--shadow-darkness", text, 0.0, 1.0, "a number from 0 to 1");
            });
  add_value(parser, "--soft", "N",
            "Draw lights that have a size from N points, 1 to 4096 (default: the scene's)",
            [&options](const std::string& text) {
              options.points = parse_whole("--soft", text, 1, kMostLightPoints,
                                           "a number of points from 1 to 4096");
            });
  add_value(parser, "--light-radius", "METRES", "Point lights with shadows are balls of this size",
            [&options](const std::string& text) {
              options.radius_m =
                  parse_number("--light-radius", text, 0.0, 1e6, "metres from 0 to 1000000");
            });
  add_value(parser, "--light-angle", "DEGREES",
            "Directional lights with shadows are discs of this angular radius; the sun has .27",
            [&options](const std::string& text) {
              options.angle_degrees = parse_number("--light-angle", text, 0.0, kMostAngularRadius,
                                                   "degrees from 0 to 90");
            });
}

void add_terminator_option(CLI::App& parser, LightOptions& options) {
  add_value(parser, "--soften-terminators", "facets|normals|fade",
            "Where lights with shadows end on curves of few facets (default: facets)",
            [&options](const std::string& text) {
              for (const TerminatorChoice& choice : kTerminatorChoices) {
                if (choice.name == text) {
                  options.terminator = choice.rule;
                  return;
                }
              }
              refuse_name("--soften-terminators", text, names_in(kTerminatorChoices));
            });
}

void set_lights(const LightOptions& options, Scene& scene) {
  if (is_empty(options)) return;
  if (!has_shadows(scene)) {
    throw UsageError(
        "--shadow-darkness, --soft, --light-radius, --light-angle and --soften-terminators are of "
        "lights with shadows, and none has; give --shadows too");
  }
  for (Light& light : scene.lights) {
    if (options.darkness) light.shadow_darkness = static_cast<float>(*options.darkness);
    if (options.terminator) light.terminator = *options.terminator;
  }
  if (options.radius_m) {
    set_lights_of(scene, "--light-radius", LightKind::point, "point",
                  [&](Light& light) { light.radius_m = *options.radius_m; });
  }
  if (options.angle_degrees) {
    set_lights_of(scene, "--light-angle", LightKind::directional, "directional",
                  [&](Light& light) { light.angular_radius_degrees = *options.angle_degrees; });
  }
  if (!options.points) return;
  if (!has_soft_shadows(scene)) {
    throw UsageError("--soft: no light has a size; give --light-radius or --light-angle too");
  }
  scene.light_points = *options.points;
}

}  // namespace softfocus
