#include "tools/refocus/chosen_layers.h"

#include <algorithm>
#include <array>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

std::string lower_case(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

std::string last_part(const std::string& name) { return name.substr(name.rfind('.') + 1); }

/// The part of a name before its last dot.
std::string before_last(const std::string& name) {
  const auto dot = name.rfind('.');
  return dot == name.npos ? "" : name.substr(0, dot);
}

bool any_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string layers_there(const std::vector<ColourLayer>& layers) {
  std::string names;
  for (const ColourLayer& layer : layers) {
    names += (names.empty() ? "" : ", ") +
             (layer.name.empty() ? "R, G, B without a name" : "'" + layer.name + "'");
  }
  return names;
}

/// How surely a plane is a depth by its name: 0 for certain, or nothing.
std::optional<int> depth_rank(const std::string& full_name) {
  const std::string name = lower_case(full_name);
  const std::string channel = last_part(name), layer = last_part(before_last(name));
  if (name == "z" || name == "depth") return 0;
  if (any_of(layer, {"depth", "z", "zdepth"}) && any_of(channel, {"z", "v", "y", "r", "depth"})) {
    return 1;
  }
  if (channel == "depth" || channel == "zdepth") return 2;
  if (channel == "z" && any_of(layer, {"rgba", "beauty", "combined", "viewlayer", "view layer"})) {
    return 3;
  }
  return std::nullopt;
}

}  // namespace

ColourLayer choose_colour(const PictureFile& file, const std::optional<std::string>& name,
                          const std::string& option) {
  const std::vector<ColourLayer> layers = colour_layers(file);
  if (layers.empty()) {
    throw UsageError("'" + file.path.string() + "' has no colour, but " + plane_names(file));
  }
  if (name) {
    for (const ColourLayer& layer : layers) {
      if (layer.name == *name) return layer;
    }
    throw UsageError(option + " '" + *name + "': '" + file.path.string() + "' has " +
                     layers_there(layers));
  }
  for (const std::string_view usual : {"", "combined", "rgba", "beauty"}) {
    for (const ColourLayer& layer : layers) {
      const bool has_parts = layer.name.find('.') != std::string::npos;
      const std::string last = has_parts ? last_part(layer.name) : layer.name;
      if (lower_case(last) == usual) return layer;
    }
  }
  return layers.front();
}

std::vector<std::size_t> depth_planes(const PictureFile& file) {
  std::vector<std::size_t> planes;
  for (int rank = 0; rank <= 3; ++rank) {
    for (std::size_t i = 0; i < file.planes.size(); ++i) {
      if (depth_rank(file.planes[i].name) == rank) planes.push_back(i);
    }
  }
  return planes;
}

std::optional<std::size_t> find_depth_beside_colour(const PictureFile& file) {
  const std::vector<std::size_t> by_name = depth_planes(file);
  if (!by_name.empty()) return by_name.front();
  const bool is_ours = file.reader == &kNpyReader && !file.is_srgb && file.planes.size() == 4;
  return is_ours ? std::optional<std::size_t>{3} : std::nullopt;
}

std::size_t choose_depth(const PictureFile& file, const std::optional<std::string>& name,
                         bool beside_colour) {
  if (name) {
    for (std::size_t i = 0; i < file.planes.size(); ++i) {
      if (file.planes[i].name == *name) return i;
    }
    for (const std::string_view channel : {"Z", "V", "Y", "R"}) {
      for (std::size_t i = 0; i < file.planes.size(); ++i) {
        if (file.planes[i].name == *name + "." + std::string{channel}) return i;
      }
    }
    throw UsageError("--depth-layer '" + *name + "': '" + file.path.string() + "' has " +
                     plane_names(file));
  }
  if (beside_colour) {
    if (const auto found = find_depth_beside_colour(file)) return *found;
    throw UsageError("'" + file.path.string() + "' has no depth that its names tell, but " +
                     plane_names(file) + "; give the depth as a second file, or say --depth-layer");
  }
  const std::vector<std::size_t> by_name = depth_planes(file);
  if (!by_name.empty()) return by_name.front();
  if (file.planes.size() <= 4 && file.reader != &kExrReader) return 0;
  if (file.planes.size() == 1) return 0;
  const auto layers = colour_layers(file);
  if (layers.size() == 1) return layers.front().red;
  throw UsageError("'" + file.path.string() + "' has no depth that its names tell; give a " +
                   "--depth-layer of " + plane_names(file));
}

std::vector<std::size_t> planes_of_depth(const PictureFile& file, std::size_t plane) {
  std::vector<std::size_t> planes{plane};
  for (const ColourLayer& layer : colour_layers(file)) {
    if (layer.red == plane && layer.green != plane) {
      planes.insert(planes.end(), {layer.green, layer.blue});
    }
  }
  return planes;
}

void check_one_depth(const PictureFile& file, std::span<const PlaneValues> values) {
  const auto same = [](float a, float b) { return a == b || (a != a && b != b); };
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (std::equal(values[0].begin(), values[0].end(), values[i].begin(), same)) continue;
    throw UsageError("'" + file.path.string() +
                     "' has three channels that differ, which is no depth; give a grey file, or "
                     "say --depth-layer");
  }
}

PlaneValues depth_codes(const PictureFile& file, std::size_t plane) {
  std::vector<PlaneValues> values = read_planes(file, planes_of_depth(file, plane), kNoDepthThere);
  check_one_depth(file, values);
  return std::move(values[0]);
}

}  // namespace softfocus
