#pragma once
// The command line's settings of a scene's look, of lights with shadows and of their shadow maps,
// in place of the scene's.

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene.h"
#include "tools/cli/parser.h"

namespace softfocus {

/// What a scene is drawn with, in place of what it says itself.
struct SceneLook {
  std::optional<ShadowKind> shadows{};     ///< of all lights
  std::optional<ImpostorUse> impostors{};  ///< of all objects
  std::optional<glm::vec3> light{};        ///< the first light: towards it, or where it is
  bool textures = true;
  std::optional<double> backdrop_m{};  ///< as set_backdrop() has it

  bool operator==(const SceneLook&) const = default;
};

/// Adds --shadows, --light, --textures, --impostors and --backdrop.
void add_look_options(CLI::App& parser, SceneLook& look);

/// Throws UsageError for more lights than can have shadows, and where there is no light or
/// backdrop.
void set_look(const SceneLook& look, Scene& scene);

/// X,Y,Z that are not all next to 0: squares of these are no subnormals.
glm::vec3 parse_towards(const std::string& text);

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

/// --map's keys and values, of all lights, in place of the scene's.
struct MapOptions {
  struct Value {
    std::size_t key;
    double value;
  };
  std::vector<Value> values;
};

/// "size=N,bias=..."; throws UsageError, listing the keys there are.
MapOptions parse_map_options(std::string_view option, const std::string& text);

/// Adds --map.
void add_map_option(CLI::App& parser, MapOptions& options);

/// Puts the values into lights that have a map; throws UsageError if none has, or if they do not
/// fit together.
void set_maps(const MapOptions& options, Scene& scene);

}  // namespace softfocus
