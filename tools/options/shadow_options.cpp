#include "tools/options/shadow_options.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

struct MapKey {
  std::string_view name;
  double least, most;
  std::string_view wanted;
  void (*set)(ShadowMapSettings& settings, double value);
};

constexpr std::array kMapKeys{
    MapKey{"size", kLeastMapSize, kMostMapSize, "texels along an edge, 16 to 8192",
           [](ShadowMapSettings& map, double value) { map.size = static_cast<int>(value); }},
    MapKey{"bias", 0.0, kMostMapBias, "0 to 1000",
           [](ShadowMapSettings& map, double value) { map.bias = value; }},
    MapKey{"slope-bias", 0.0, kMostMapBias, "0 to 1000",
           [](ShadowMapSettings& map, double value) { map.slope_bias = value; }},
    MapKey{"kernel", 1, kMostMapKernel, "1, 3, 5, 7 or 9",
           [](ShadowMapSettings& map, double value) { map.kernel = static_cast<int>(value); }},
    MapKey{"cascades", 1, kMostCascades, "1 to 4",
           [](ShadowMapSettings& map, double value) { map.cascades = static_cast<int>(value); }},
    MapKey{"fit", 0, 1, "camera or scene",
           [](ShadowMapSettings& map, double value) { map.fits_camera = value == 0.0; }}};

double value_of(const MapKey& key, const std::string& where, const std::string& text) {
  if (key.name == "fit") {
    if (text == "camera") return 0.0;
    if (text == "scene") return 1.0;
    throw UsageError(where + " '" + text + "': give " + std::string{key.wanted});
  }
  const double value = parse_number(where, text, key.least, key.most, key.wanted);
  const bool is_bias = key.name == "bias" || key.name == "slope-bias";
  const bool is_whole = value == std::floor(value);
  const bool is_odd = std::fmod(value, 2.0) == 1.0;
  if ((!is_bias && !is_whole) || (key.name == "kernel" && !is_odd)) {
    throw UsageError(where + " '" + text + "': give " + std::string{key.wanted});
  }
  return value;
}

}  // namespace

MapOptions parse_map_options(std::string_view option, const std::string& text) {
  MapOptions options;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string name = part.substr(0, equals);
    const auto key = std::find_if(kMapKeys.begin(), kMapKeys.end(),
                                  [&](const MapKey& known) { return known.name == name; });
    const std::string where = std::string{option} + " '" + text + "'";
    if (key == kMapKeys.end() || equals == part.size()) {
      throw UsageError(where + ": '" + part + "' is no key=value; there are " + names_of(kMapKeys));
    }
    const auto number = static_cast<std::size_t>(key - kMapKeys.begin());
    if (std::any_of(options.values.begin(), options.values.end(),
                    [&](const MapOptions::Value& value) { return value.key == number; })) {
      throw UsageError(where + ": " + name + " is there twice; give it once");
    }
    options.values.push_back(
        {number, value_of(*key, where + ": " + name, part.substr(equals + 1))});
    begin = end + 1;
  }
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
    for (const MapOptions::Value& value : options.values) {
      kMapKeys[value.key].set(light.map, value.value);
    }
    if (light.map.cascades > 1 && !light.map.fits_camera) {
      throw UsageError("--map: cascades are of the camera's picture; give fit=camera");
    }
  }
  if (!has_map) throw UsageError("--map: no light has a shadow map; give --shadows map too");
}

}  // namespace softfocus
