#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "raster/images/sliced_texture.h"
#include "raster/shaders/glsl/glsl.h"
#include "scenes/files/file_bytes.h"
#include "scenes/files/scene_error.h"
#include "scenes/files/texture_file.h"
#include "scenes/load/scene_sections.h"
#include "scenes/load/shader_file.h"
#include "scenes/surfaces/shader_surface.h"

namespace softfocus {
namespace {

std::vector<std::uint32_t> words_of(OpenedShader opened, Scene& scene) {
  for (std::string& warning : opened.warnings) scene.warnings.push_back(std::move(warning));
  for (const std::string& file : opened.files) scene.files.emplace_back(file);
  return std::move(opened.words);
}

std::vector<std::uint32_t> words_of_file(Section& section, std::string_view key,
                                         const std::filesystem::path& directory, ShaderStage stage,
                                         Scene& scene) {
  ShaderReading reading = read_shader_keys(section, directory);
  reading.stage = stage;
  return words_of(open_shader(directory / read_text(section, key, ""), reading), scene);
}

bool is_sampler(const ShaderUniform& of) { return is_texture(of); }
bool is_number(const ShaderUniform& of) {
  return of.kind == SpirvKind::floating || of.kind == SpirvKind::integer ||
         of.kind == SpirvKind::boolean;
}

/// The uniforms of both, of that kind, by name; without those that the scene gives.
std::vector<std::string> names_of(const ShaderPair& pair, bool (*is)(const ShaderUniform&)) {
  std::vector<std::string> names;
  for (const UserShader* shader : {&pair.vertex, &pair.fragment}) {
    const std::vector<bool> late = late_words(shader->uniforms);
    for (const ShaderUniform& of : shader->uniforms.all) {
      if (is(of) && !late[of.first] &&
          std::find(names.begin(), names.end(), of.name) == names.end()) {
        names.push_back(of.name);
      }
    }
  }
  return names;
}

[[noreturn]] void fail_unknown_uniform(const Section& section, std::string_view key,
                                       const std::vector<std::string>& names,
                                       const std::string& what) {
  fail_at(section, key,
          "the shaders have no " + what + " of that name; there are " +
              (names.empty() ? "none" : list_words(names)) + did_you_mean(key, names));
}

// --- numbers ---

void flatten(const Section& section, std::string_view key, const toml::node& node,
             std::vector<double>& to) {
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& part : *array) flatten(section, key, part, to);
  } else if (const auto number = node.value<double>(); number && std::isfinite(*number)) {
    to.push_back(*number);
  } else if (const auto flag = node.value<bool>()) {
    to.push_back(*flag ? 1.0 : 0.0);
  } else {
    fail_at(section, key, "is no number; a number, true, false or an array would be right");
  }
}

std::uint32_t word_of(const Section& section, std::string_view key, const ShaderUniform& of,
                      double value) {
  const std::optional<std::uint32_t> word = uniform_word(of, value);
  if (!word) {
    fail_at(section, key,
            std::string{"is a whole number of 32 bits"} + (of.is_signed ? "" : ", not below 0"));
  }
  return *word;
}

void read_uniforms(Section section, ShaderPair& pair) {
  if (section.table == nullptr) return;
  for (const auto& [name, node] : *section.table) {
    const std::string key{name.str()};
    find_key(section, key);
    std::vector<double> numbers;
    flatten(section, key, node, numbers);
    bool any = false;
    for (UserShader* shader : {&pair.vertex, &pair.fragment}) {
      const ShaderUniform* of = find_uniform(*shader, key);
      if (of == nullptr || !is_number(*of)) continue;
      any = true;
      if (late_words(shader->uniforms)[of->first]) {
        fail_at(section, key, "is given by the scene; another name would be right");
      }
      if (numbers.size() != of->words && numbers.size() != 1) {
        fail_at(section, key,
                "has " + std::to_string(numbers.size()) + " numbers; " + std::to_string(of->words) +
                    " would be right");
      }
      for (std::uint32_t i = 0; i < of->words; ++i) {
        shader->uniforms.words[of->first + i] =
            word_of(section, key, *of, numbers[numbers.size() == 1 ? 0 : i]);
      }
    }
    if (!any) fail_unknown_uniform(section, key, names_of(pair, is_number), "uniform");
  }
}

// --- textures ---

using BoundTextures = std::map<std::string, ShaderSurfaceTexture, std::less<>>;

/// The shape that the shaders read a texture as.
TextureShape shape_in(const ShaderPair& pair, const std::string& name) {
  for (const UserShader* shader : {&pair.vertex, &pair.fragment}) {
    const ShaderUniform* of = find_uniform(*shader, name);
    if (of != nullptr && is_sampler(*of)) return of->shape;
  }
  return TextureShape::flat;
}

/// A scene's picture cut into slices, as another of its textures.
std::uint32_t cut_of(const Section& section, const std::string& key, TextureShape shape,
                     std::uint32_t number, Scene& scene) {
  const Image& picture = scene.textures[number].levels[0];
  const std::string why = why_not_cut(picture.width, picture.height, shape);
  if (!why.empty()) {
    fail_at(section, key, "is a " + std::string{sampler_name(shape)} + ", and its file's " + why);
  }
  Texture cut = cut_texture(picture, shape);
  generate_mipmaps(cut, {});
  scene.textures.push_back(std::move(cut));
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

BoundTextures read_textures(Section section, const std::filesystem::path& directory,
                            const NamedSurfaces& surfaces, const ShaderPair& pair, Scene& scene) {
  BoundTextures bound;
  if (section.table == nullptr) return bound;
  const std::vector<std::string> names = names_of(pair, is_sampler);
  for (const auto& [name, node] : *section.table) {
    const std::string key{name.str()};
    if (std::find(names.begin(), names.end(), key) == names.end()) {
      fail_unknown_uniform(section, key, names, "texture");
    }
    const std::string value = read_text(section, key, "");
    const auto named = surfaces.textures.find(value);
    if (named != surfaces.textures.end()) {
      bound[key] = {named->second.index, named->second.sampler, true};
    } else {
      scene.files.push_back(directory / value);
      bound[key] = {static_cast<std::uint32_t>(scene.textures.size()),
                    {Filter::trilinear, Wrap::repeat, Wrap::repeat},
                    true};
      scene.textures.push_back(load_texture(scene.files.back()));
    }
    const TextureShape shape = shape_in(pair, key);
    if (shape != TextureShape::flat) {
      bound[key].texture = cut_of(section, key, shape, bound[key].texture, scene);
    }
  }
  return bound;
}

SurfaceShader made_shader(const Section& section, const UserShader& shader,
                          const BoundTextures& bound, const Scene& scene) {
  SurfaceShader made{.program = std::make_shared<const ShaderProgram>(compile_shader(
                         shader, shader.uniforms.words, late_words(shader.uniforms))),
                     .uniforms = shader.uniforms};
  made.textures.resize(shader.uniforms.texture_count);
  const std::vector<bool> used = sampled_textures(*made.program, made.textures.size());
  for (const ShaderUniform& of : shader.uniforms.all) {
    if (!is_sampler(of)) continue;
    const std::uint32_t number = shader.uniforms.words[of.first];
    if (const auto found = bound.find(of.name); found != bound.end()) {
      if (scene.textures[found->second.texture].shape != of.shape) {
        fail_at(section, "textures",
                "the material's texture is flat, and the shaders read '" + of.name + "' as a " +
                    std::string{sampler_name(of.shape)} + "; another name would be right");
      }
      made.textures[number] = found->second;
    } else if (used[number]) {
      fail_at(section, "textures",
              "the shaders read a texture '" + of.name + "'; " + section.name + ".textures." +
                  of.name + " = \"FILE.png\" would be right");
    }
  }
  return made;
}

}  // namespace

void read_shaders(Section& section, const std::filesystem::path& directory,
                  const NamedSurfaces& surfaces, Scene& scene, Material& material) {
  const bool has_vertex = has_key(section, "vertex");
  if (!has_key(section, "fragment")) {
    if (!has_vertex && !has_key(section, "uniforms") && !has_key(section, "textures") &&
        !has_key(section, "defines") && !has_key(section, "include")) {
      return;
    }
    fail_at(section, "fragment",
            "is missing; the file of a fragment shader would be right (docs/shaders.md)");
  }
  if (has_key(section, "opacity_texture")) {
    fail_at(section, "opacity_texture", "is the shaders' part; `discard` would do");
  }
  const char* key = has_vertex ? "vertex" : "fragment";
  try {
    std::vector<std::uint32_t> vertex =
        has_vertex
            ? words_of_file(section, "vertex", directory, ShaderStage::vertex, scene)
            : open_shader_text("the usual vertex shader", std::string{usual_surface_vertex()},
                               {.stage = ShaderStage::vertex})
                  .words;
    key = "fragment";
    ShaderPair pair = make_shader_pair(
        std::move(vertex),
        words_of_file(section, "fragment", directory, ShaderStage::fragment, scene));
    std::vector<ShaderPort> attributes = inputs_of(*pair.vertex.module);
    check_attributes(attributes);
    read_uniforms(read_section(section, "uniforms"), pair);
    BoundTextures bound =
        read_textures(read_section(section, "textures"), directory, surfaces, pair, scene);
    if (material.texture) {
      for (const char* name : {"map", "surface_texture"}) {
        bound.try_emplace(name, ShaderSurfaceTexture{*material.texture, material.sampler, true});
      }
    }
    material.shaders = std::make_shared<const SurfaceShaders>(
        SurfaceShaders{made_shader(section, pair.vertex, bound, scene),
                       made_shader(section, pair.fragment, bound, scene), std::move(attributes)});
  } catch (const ShaderError& error) {
    fail_at(section, key, error.what());
  }
}

}  // namespace softfocus
