#include "scenes/load/scene_sections.h"

#include <array>
#include <bit>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "scenes/files/scene_error.h"
#include "scenes/files/texture_file.h"
#include "scenes/make/procedural_texture.h"

namespace softfocus {
namespace {

// More than any scene needs, less than would fill the memory.
constexpr std::size_t kMaxTextures = 64;
constexpr int kMaxProceduralSize = 2048;

constexpr std::array<std::string_view, 3> kTextureFilters = {"nearest", "bilinear", "trilinear"};
constexpr std::array<std::string_view, 3> kTextureWraps = {"repeat", "mirrored_repeat",
                                                           "clamp_to_edge"};

// Stands for a texture that no object shows: it is checked, and not made.
constexpr std::uint32_t kNotMade = std::numeric_limits<std::uint32_t>::max();

// Materials that objects name, and the textures that these name, as far as both are texts.
struct UsedNames {
  std::set<std::string> materials;
  std::set<std::string> textures;
};

void add_text(const toml::node_view<const toml::node>& node, std::set<std::string>& names) {
  if (const auto text = node.value<std::string>()) names.insert(*text);
}

UsedNames used_names(const Section& top) {
  UsedNames used;
  const toml::table& file = *top.table;
  const auto for_each_table = [](const toml::array* array, const auto& visit) {
    if (array == nullptr) return;
    for (const toml::node& entry : *array) visit(toml::node_view{entry});
  };
  for_each_table(file["object"].as_array(),
                 [&](const auto& object) { add_text(object["material"], used.materials); });
  for_each_table(file["scatter"].as_array(), [&](const auto& scatter) {
    for_each_table(scatter["materials"].as_array(),
                   [&](const auto& name) { add_text(name, used.materials); });
  });
  for (const std::string& name : used.materials) {
    const toml::node_view material = file["material"][name];
    add_text(material["texture"], used.textures);
    add_text(material["opacity_texture"], used.textures);
    if (const toml::table* textures = material["textures"].as_table()) {
      for (const auto& [key, value] : *textures) add_text(toml::node_view{value}, used.textures);
    }
  }
  return used;
}

ProceduralTexture read_procedural_texture(Section& section) {
  std::vector<std::string_view> names;
  for (const TexturePattern& pattern : texture_patterns()) names.push_back(pattern.name);
  const TexturePattern& pattern = texture_patterns()[read_choice(section, "kind", 0, names)];

  TextureRecipe recipe;
  recipe.size = read_whole_number(section, "size", recipe.size, 1, kMaxProceduralSize);
  if (!std::has_single_bit(static_cast<unsigned>(recipe.size))) {
    fail_at(section, "size",
            std::to_string(recipe.size) + " is no power of two; " +
                std::to_string(std::bit_floor(static_cast<unsigned>(recipe.size))) + " or " +
                std::to_string(std::bit_ceil(static_cast<unsigned>(recipe.size))) +
                " would be right");
  }
  recipe.cells = read_whole_number(section, "cells", recipe.cells, 1, 256);
  recipe.seed = static_cast<std::uint64_t>(read_whole_number(section, "seed", 1, 0, 1 << 30));

  const auto rows = read_rows(section, "colours", 3, {0.0, 1.0});
  if (rows.size() != pattern.colour_count) {
    fail_at(section, "colours",
            std::to_string(rows.size()) + " are given; the pattern \"" + std::string(pattern.name) +
                "\" needs " + std::to_string(pattern.colour_count) + " (" +
                std::string(pattern.colours) + "), each [red, green, blue] from 0 to 1");
  }
  for (const auto& row : rows) recipe.colours.emplace_back(glm::dvec3{row[0], row[1], row[2]});
  return {&pattern, std::move(recipe)};
}

// Textures that are made once all are known, and their places in the scene.
struct WantedTextures {
  std::vector<ProceduralTexture> recipes;
  std::vector<std::size_t> places;
};

void read_texture(Section& section, const std::filesystem::path& directory, bool is_used,
                  Scene& scene, WantedTextures& wanted) {
  const bool has_kind = has_key(section, "kind");
  const bool has_file = has_key(section, "file");
  if (has_kind == has_file) {
    fail_at(section, has_kind ? "file" : "",
            "a texture has either a `kind` (made by formula) or a `file` (PNG or JPEG)");
  }
  if (has_kind) {
    ProceduralTexture made = read_procedural_texture(section);
    if (!is_used) return;
    wanted.recipes.push_back(std::move(made));
    wanted.places.push_back(scene.textures.size());
    scene.textures.emplace_back();
    return;
  }
  // Used or not, no picture may be written over it.
  scene.files.push_back(directory / read_text(section, "file", ""));
  if (is_used) scene.textures.push_back(load_texture(scene.files.back()));
}

/// What `key` names among the tables [kind.NAME].
template <class Value>
Value named(const Section& section, std::string_view key, const std::string& kind,
            const std::string& name, const std::map<std::string, Value>& there) {
  const auto found = there.find(name);
  if (found != there.end()) return found->second;
  std::vector<std::string> names;
  names.reserve(there.size());
  for (const auto& [known, value] : there) names.push_back(known);
  fail_at(section, key,
          "there is no " + kind + " \"" + name + "\"; a table [" + kind + "." + name +
              "] would be right" + did_you_mean(name, names));
}

NamedSurfaces::NamedTexture texture_named(Section& section, std::string_view key,
                                          const NamedSurfaces& surfaces) {
  return named(section, key, "texture", read_text(section, key, ""), surfaces.textures);
}

void read_opacity(Section& section, NamedSurfaces& surfaces, Scene& scene, Material& material) {
  material.opacity = static_cast<float>(read_number(section, "opacity", 1.0, {0.0, 1.0}));
  if (!has_key(section, "opacity_texture")) {
    if (has_key(section, "cut_out")) {
      fail_at(section, "cut_out", "nothing says where; an `opacity_texture` would");
    }
    return;
  }
  const auto named = texture_named(section, "opacity_texture", surfaces);
  if (named.index == kNotMade) {
    read_flag(section, "cut_out", false);
    return;
  }
  const auto [entry, is_new] = surfaces.opacity_of_texture.emplace(
      named.index, static_cast<std::uint32_t>(scene.textures.size()));
  if (is_new) {
    scene.textures.push_back(make_opacity_texture(scene.textures[named.index].levels[0]));
  }
  material.opacity_texture = entry->second;
  material.opacity_sampler = named.sampler;
  material.cut_out = read_flag(section, "cut_out", is_cut_out(scene.textures[entry->second]));
}

Material read_material(Section& section, const std::string& name, NamedSurfaces& surfaces,
                       Scene& scene) {
  // No surface reflects more than it gets, but a lamp is an unlit one, and a mirror's highlight
  // is as bright as the lamp.
  constexpr double kLargest = 1000.0;
  Material material;
  material.name = name;
  material.diffuse = read_colour(section, "diffuse", material.diffuse, kLargest);
  material.ambient = read_colour(section, "ambient", material.diffuse, kLargest);
  material.specular = read_colour(section, "specular", material.specular, kLargest);
  material.shininess = read_whole_number(section, "shininess", material.shininess, 1, 1024);
  material.two_sided = read_flag(section, "two_sided", material.two_sided);
  material.lit = read_flag(section, "lit", material.lit);
  if (has_key(section, "texture")) {
    const auto named = texture_named(section, "texture", surfaces);
    if (named.index != kNotMade) material.texture = named.index;
    material.sampler = named.sampler;
  }
  read_opacity(section, surfaces, scene, material);
  return material;
}

}  // namespace

NamedSurfaces read_surfaces(Section& top, const std::filesystem::path& directory, Scene& scene,
                            ThreadPool* pool) {
  NamedSurfaces surfaces;
  auto textures = read_named_sections(top, "texture");
  if (textures.size() > kMaxTextures) {
    fail_at(top, "texture",
            "has " + std::to_string(textures.size()) + " textures; up to " +
                std::to_string(kMaxTextures) + " would do");
  }
  const UsedNames used = used_names(top);
  WantedTextures wanted;
  for (auto& [name, section] : textures) {
    Sampler sampler{Filter::trilinear, Wrap::repeat, Wrap::repeat};
    sampler.filter = static_cast<Filter>(
        read_choice(section, "filter", static_cast<std::size_t>(sampler.filter), kTextureFilters));
    sampler.wrap_u = sampler.wrap_v = static_cast<Wrap>(
        read_choice(section, "wrap", static_cast<std::size_t>(sampler.wrap_u), kTextureWraps));
    const bool is_used = used.textures.contains(name);
    const auto index = static_cast<std::uint32_t>(scene.textures.size());
    read_texture(section, directory, is_used, scene, wanted);
    finish_section(section);
    surfaces.textures[name] = {is_used ? index : kNotMade, sampler};
  }
  std::vector<Texture> made = make_procedural_textures(wanted.recipes, pool);
  for (std::size_t i = 0; i < made.size(); ++i) {
    scene.textures[wanted.places[i]] = std::move(made[i]);
  }
  for (auto& [name, section] : read_named_sections(top, "material")) {
    Material material = read_material(section, name, surfaces, scene);
    read_shaders(section, directory, surfaces, scene, material);
    finish_section(section);
    surfaces.materials[name] = static_cast<std::uint32_t>(scene.materials.size());
    scene.materials.push_back(std::move(material));
  }
  return surfaces;
}

std::uint32_t material_named(const Section& section, std::string_view key, const std::string& name,
                             const NamedSurfaces& surfaces) {
  return named(section, key, "material", name, surfaces.materials);
}

glm::vec3 read_colour(Section& section, std::string_view key, glm::vec3 fallback, double largest) {
  return glm::vec3{read_vector(section, key, glm::dvec3{fallback}, {0.0, largest})};
}

}  // namespace softfocus
