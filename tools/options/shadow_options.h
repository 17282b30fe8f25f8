#pragma once
// --map: how shadow maps are made and read.

#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene.h"
#include "tools/cli/parser.h"

namespace softfocus {

/// What --map says: keys and values, of all lights in place of what the scene says.
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
