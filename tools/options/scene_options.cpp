#include "tools/options/scene_options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "scenes/draw/light_points.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/make/backdrop.h"
#include "scenes/parameters.h"
#include "tools/cli/errors.h"
#include "tools/options/parameter_options.h"

namespace softfocus {
namespace {

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

constexpr std::array kTextures{Choice<bool>{"on", true}, Choice<bool>{"off", false}};

bool is_empty(const LightOptions& options) {
  return !options.darkness && !options.points && !options.radius_m && !options.angle_degrees &&
         !options.terminator;
}

}  // namespace

glm::vec3 parse_towards(const std::string& text) {
  glm::vec3 towards{0.0f};
  std::size_t begin = 0;
  for (int i = 0; i < 3; ++i) {
    const std::size_t end = i < 2 ? text.find(',', begin) : text.size();
    if (end == std::string::npos) break;
    towards[i] = static_cast<float>(parse_number("--light", text.substr(begin, end - begin), -1e6,
                                                 1e6, "three numbers such as 1,2,3"));
    begin = end + 1;
    const float largest =
        std::max({std::fabs(towards.x), std::fabs(towards.y), std::fabs(towards.z)});
    if (i == 2 && largest >= 1e-6f) return towards;
  }
  throw UsageError("--light '" + text +
                   "': give three numbers such as 1,2,3, one of them 0.000001 or more from 0");
}

void add_look_options(CLI::App& parser, SceneLook& look) {
  add_choice(parser, "--shadows", "Shadows of all lights, in place of what the scene says of each",
             parameter::kShadowKinds, look.shadows);
  add_value(parser, "--light", "X,Y,Z",
            "The first light: towards it, or where it is if it is a point",
            [&look](const std::string& text) { look.light = parse_towards(text); });
  add_choice(parser, "--textures", "Surfaces with their textures, or in their own colours",
             kTextures, look.textures);
  add_choice(parser, "--impostors",
             "Objects as relief impostors where that costs less, or as geometry (default: as the "
             "scene says of each)",
             parameter::kImpostorUses, look.impostors);
  add_parameter(parser, parameter::kBackdrop, "the scene's", look.backdrop_m);
}

void set_look(const SceneLook& look, Scene& scene) {
  if (look.light) {
    if (scene.lights.empty()) throw UsageError("--light: the scene has no light");
    scene.lights.front().position_or_direction = *look.light;
  }
  if (look.shadows) {
    set_shadows(scene, *look.shadows);
    if (*look.shadows != ShadowKind::none && scene.lights.size() > kMostShadowLights) {
      throw UsageError("--shadows: '" + scene.name + "' has " +
                       count_text(static_cast<int>(scene.lights.size()), "light") + "; up to " +
                       std::to_string(kMostShadowLights) + " may have shadows");
    }
  }
  if (look.impostors) {
    for (Object& object : scene.objects) object.impostor = *look.impostors;
  }
  if (look.backdrop_m) {
    if (!scene.backdrop) {
      throw UsageError("--backdrop: '" + scene.name +
                       "' has no backdrop; a scene's file says by [backdrop] what it is");
    }
    set_backdrop(scene, *look.backdrop_m);
  }
  if (look.textures) return;
  for (Material& material : scene.materials) material.texture.reset();
}

void add_light_options(CLI::App& parser, LightOptions& options) {
  add_parameter(parser, parameter::kShadowDarkness, options.darkness);
  add_parameter(parser, parameter::kLightPoints, "the scene's", options.points);
  add_parameter(parser, parameter::kLightRadius, "", options.radius_m);
  add_parameter(parser, parameter::kLightAngle, "", options.angle_degrees);
}

void add_terminator_option(CLI::App& parser, LightOptions& options) {
  add_choice(parser, "--soften-terminators",
             "Where lights with shadows end on curves of few facets (default: facets)",
             parameter::kTerminators, options.terminator);
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

MapOptions parse_map_options(std::string_view option, const std::string& text) {
  std::vector<std::string> keys;
  keys.reserve(parameter::kMapParameters.size() + 1);
  for (const parameter::OfMap& of : parameter::kMapParameters) keys.emplace_back(of.number.name);
  keys.emplace_back("fit");
  MapOptions options;
  const std::string where = std::string{option} + " '" + text + "'";
  read_pairs(where, text, keys, [&](std::size_t key, const std::string& value) {
    const std::string which = where + ": " + keys[key];
    if (key == parameter::kMapParameters.size()) {
      for (const Choice<bool>& fit : parameter::kMapFits) {
        if (fit.name != value) continue;
        options.values.push_back({key, fit.value ? 1.0 : 0.0});
        return;
      }
      refuse_name(which, value, names_in(parameter::kMapFits));
    }
    options.values.push_back(
        {key, parse_parameter(which, value, parameter::kMapParameters[key].number)});
  });
  return options;
}

void add_map_option(CLI::App& parser, MapOptions& options) {
  add_value(parser, "--map", "KEY=VALUE,...",
            "Of shadow maps: size, bias, slope-bias, kernel, cascades, fit=camera|scene",
            [&options](const std::string& text) { options = parse_map_options("--map", text); });
}

void set_maps(const MapOptions& options, Scene& scene) {
  if (options.values.empty()) return;
  bool has_map = false;
  for (Light& light : scene.lights) {
    if (light.shadows != ShadowKind::map) continue;
    has_map = true;
    for (const auto& [key, value] : options.values) {
      if (key == parameter::kMapParameters.size()) {
        light.map.fits_camera = value != 0.0;
      } else {
        parameter::kMapParameters[key].set(light.map, value);
      }
    }
    if (light.map.cascades > 1 && !light.map.fits_camera) {
      throw UsageError("--map: cascades are of the camera's picture; give fit=camera");
    }
  }
  if (!has_map) throw UsageError("--map: no light has a shadow map; give --shadows map too");
}

}  // namespace softfocus
