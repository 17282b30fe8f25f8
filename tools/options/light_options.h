#pragma once
// The command line's settings of lights with shadows and of their shadow maps, in place of the
// scene's.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

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
