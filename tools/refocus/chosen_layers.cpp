#include "tools/refocus/chosen_layers.h"

#include <algorithm>
#include <array>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

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

/// Whether a part of a name, in small letters, speaks of a depth: VRayZDepth, WorldDepth, Z-Depth.
bool speaks_of_depth(const std::string& part) {
  const auto has = [&](const char* word) { return part.find(word) != part.npos; };
  return has("depth") && !has("field") && !has("mask") && !has("matte");
}

constexpr int kLastRank = 5;

/// How surely a plane is a depth by its name: 0 for certain, or nothing.
std::optional<int> depth_rank(const PictureFile& file, std::size_t plane) {
  const std::string name = lower_case(name_without_view(file.planes[plane]));
  const std::string channel = last_part(name), layer = last_part(before_last(name));
  if (name == "z" || name == "depth") return 0;
  if (any_of(layer, {"depth", "z", "zdepth"}) && any_of(channel, {"z", "v", "y", "r", "depth"})) {
    return 1;
  }
  if (any_of(channel, {"depth", "zdepth", "pz"})) return 2;
  if (channel == "z" && any_of(layer, {"rgba", "beauty", "combined", "viewlayer", "view layer"})) {
    return 3;
  }
  if (speaks_of_depth(channel) ||
      (speaks_of_depth(layer) && any_of(channel, {"z", "v", "y", "r"}))) {
    return 4;
  }
  // X, Y, Z are a direction or a place.
  const bool is_of_three =
      std::any_of(file.planes.begin(), file.planes.end(), [&](const PlaneInfo& other) {
        const std::string other_name = lower_case(name_without_view(other));
        return other.view == file.planes[plane].view &&
               before_last(other_name) == before_last(name) &&
               any_of(last_part(other_name), {"x", "y"});
      });
  if (channel == "z" && !is_of_three) return kLastRank;
  return std::nullopt;
}

/// Whether a name is `wanted`, or ends in it behind a dot.
bool ends_in(const std::string& name, const std::string& wanted, bool is_whole) {
  return is_whole ? name == wanted : name.ends_with("." + wanted);
}

[[noreturn]] void refuse_layer(const std::string& option, const std::string& name,
                               const PictureFile& file, const std::string& there) {
  throw UsageError(option + " '" + name + "': '" + file.path.string() + "' has " + there);
}

}  // namespace

std::string name_without_view(const PlaneInfo& plane) {
  std::string name = plane.name;
  if (plane.view.empty()) return name;
  // A part of its own between dots, else part of a word, "rgba_left.R".
  for (const std::string& text : {plane.view + ".", plane.view}) {
    for (auto at = name.find(text); at != name.npos; at = name.find(text, at + 1)) {
      const bool is_whole = text.back() == '.' && (at == 0 || name[at - 1] == '.');
      if (is_whole || text.back() != '.') return name.erase(at, text.size());
    }
  }
  return name;
}

std::optional<std::size_t> plane_in_view(const PictureFile& file, std::size_t plane,
                                         const std::string& view) {
  const std::string name = name_without_view(file.planes[plane]);
  for (std::size_t i = 0; i < file.planes.size(); ++i) {
    if (file.planes[i].view == view && name_without_view(file.planes[i]) == name) return i;
  }
  return std::nullopt;
}

std::optional<ColourLayer> layer_in_view(const PictureFile& file, const ColourLayer& layer,
                                         const std::string& view) {
  const auto red = plane_in_view(file, layer.red, view);
  for (ColourLayer& other : colour_layers(file)) {
    if (red == other.red) return std::move(other);
  }
  return std::nullopt;
}

ColourLayer choose_colour(const PictureFile& file, const std::optional<std::string>& name,
                          const std::string& option) {
  const std::vector<ColourLayer> layers = colour_layers(file);
  if (layers.empty()) {
    throw UsageError("'" + file.path.string() + "' has no colour, but " + plane_names(file));
  }
  if (name) {
    for (const bool is_whole : {true, false}) {
      std::vector<ColourLayer> found;
      for (const ColourLayer& layer : layers) {
        if (ends_in(layer.name, *name, is_whole)) found.push_back(layer);
      }
      if (found.size() == 1) return found.front();
      if (found.size() > 1) refuse_layer(option, *name, file, layers_there(found));
    }
    refuse_layer(option, *name, file, layers_there(layers));
  }
  for (const std::string_view usual : {"", "combined", "rgba", "beauty"}) {
    for (const ColourLayer& layer : layers) {
      const std::string last = last_part(before_last(name_without_view(file.planes[layer.red])));
      if (lower_case(last) == usual) return layer;
    }
  }
  for (const ColourLayer& layer : layers) {
    if (!depth_rank(file, layer.red)) return layer;
  }
  return layers.front();
}

std::vector<std::size_t> depth_planes(const PictureFile& file) {
  std::vector<std::size_t> planes;
  for (int rank = 0; rank <= kLastRank; ++rank) {
    for (std::size_t i = 0; i < file.planes.size(); ++i) {
      if (depth_rank(file, i) == rank) planes.push_back(i);
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
                         bool beside_colour, bool of_circles) {
  if (name) {
    for (const bool is_whole : {true, false}) {
      for (const std::string channel : {"", ".Z", ".V", ".Y", ".R"}) {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < file.planes.size(); ++i) {
          if (ends_in(file.planes[i].name, *name + channel, is_whole)) found.push_back(i);
        }
        if (found.size() == 1) return found.front();
        std::string names;
        for (const std::size_t i : found)
          names.append(names.empty() ? "" : ", ").append(file.planes[i].name);
        if (found.size() > 1) refuse_layer("--depth-layer", *name, file, names);
      }
    }
    refuse_layer("--depth-layer", *name, file, plane_names(file));
  }
  for (std::size_t i = 0; of_circles && i < file.planes.size(); ++i) {
    if (last_part(file.planes[i].name) == "coc") return i;
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
