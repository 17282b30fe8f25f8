#include "tools/effects/shader_on_picture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "raster/images/texel.h"
#include "raster/numbers/srgb.h"
#include "raster/shaders/glsl/glsl.h"
#include "scenes/files/decimal.h"
#include "scenes/files/scene_error.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/options/parameter_options.h"
#include "tools/pictures/image_file.h"
#include "tools/pictures/picture_file.h"
#include "tools/refocus/chosen_layers.h"

namespace softfocus {
namespace {

constexpr std::array kConventions{
    Choice<GlslConvention>{"plain", GlslConvention::plain},
    Choice<GlslConvention>{"shadertoy", GlslConvention::shadertoy},
    Choice<GlslConvention>{"three", GlslConvention::three},
    Choice<GlslConvention>{"libretro", GlslConvention::libretro},
    Choice<GlslConvention>{"gl-transitions", GlslConvention::gl_transitions}};

// --- the shader's file ---

bool is_spirv(const Bytes& bytes) {
  constexpr unsigned char kMagic[] = {0x03, 0x02, 0x23, 0x07}, kOther[] = {0x07, 0x23, 0x02, 0x03};
  return bytes.size() >= 4 &&
         (std::memcmp(bytes.data(), kMagic, 4) == 0 || std::memcmp(bytes.data(), kOther, 4) == 0);
}

/// A file that a shader includes.
std::optional<std::string> read_include(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  const Bytes bytes = read_picture_bytes(path);
  return std::string{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct OpenedShader {
  UserShader shader{};
  GlslConvention convention = GlslConvention::plain;
  std::vector<GlslParameter> parameters{};
};

OpenedShader open_shader(const std::string& file, GlslConvention convention) {
  const Bytes bytes = read_picture_bytes(file);
  if (is_spirv(bytes)) return {make_shader(spirv_words(bytes)), GlslConvention::plain, {}};
  if (!missing_glsl().empty()) throw UsageError("--shader: " + std::string{missing_glsl()});
  const GlslSource source{.name = file,
                          .text = {reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                          .convention = convention};
  CompiledGlsl compiled = compile_glsl(source, read_include);
  for (const std::string& warning : compiled.warnings) warn(warning);
  return {make_shader(std::move(compiled.words)), compiled.convention,
          std::move(compiled.parameters)};
}

// --- uniforms ---

/// "NAME=VALUE" of an option.
std::pair<std::string, std::string> split_setting(const std::string& option,
                                                  const std::string& text) {
  const auto at = text.find('=');
  if (at == text.npos || at == 0) {
    throw UsageError(option + " '" + text + "': NAME=VALUE would be right");
  }
  return {text.substr(0, at), text.substr(at + 1)};
}

/// The bits of a number as a uniform of that kind; nothing if it cannot be one.
std::optional<std::uint32_t> word_of(const ShaderUniform& of, double value) {
  if (of.kind == SpirvKind::floating) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  }
  if (of.kind == SpirvKind::boolean) return value != 0.0 ? ~0u : 0u;
  const double least = of.is_signed ? -0x1p31 : 0.0, most = of.is_signed ? 0x1p31 : 0x1p32;
  if (!(value >= least && value < most) || value != std::floor(value)) return {};
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
}

std::vector<double> numbers_of(const std::string& setting, const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view one = std::string_view{text}.substr(begin, end - begin);
    const bool is_word = one == "true" || one == "false";
    const std::optional<double> value =
        is_word ? std::optional{one == "true" ? 1.0 : 0.0} : decimal_to_double(one);
    if (!value) {
      throw UsageError("--set '" + setting + "': '" + std::string{one} + "' is no number");
    }
    numbers.push_back(*value);
    begin = end + 1;
  }
  return numbers;
}

/// The uniforms' words: what most shaders call the size of what is drawn, and what the text offers.
std::vector<std::uint32_t> known_words(const OpenedShader& opened, const Image& picture) {
  std::vector<std::uint32_t> words = opened.shader.uniforms.words;
  // Also as a member of a block without a name of its own, as libretro's .slang have it.
  const auto set = [&](const std::string& name, const std::vector<double>& values) {
    for (const ShaderUniform& of : opened.shader.uniforms.all) {
      if (of.name != name && !of.name.ends_with("." + name)) continue;
      for (std::uint32_t i = 0; i < of.words; ++i) {
        const std::size_t at = values.size() == 1 ? 0 : i % of.rows;
        words[of.first + i] = word_of(of, at < values.size() ? values[at] : 0.0).value_or(0);
      }
    }
  };
  const auto width = static_cast<double>(picture.width);
  const auto height = static_cast<double>(picture.height);
  for (const char* name :
       {"iResolution", "iChannelResolution", "resolution", "u_resolution", "uResolution"}) {
    set(name, {width, height, 1.0});
  }
  for (const char* name :
       {"OutputSize", "InputSize", "TextureSize", "SourceSize", "OriginalSize"}) {
    set(name, {width, height, 1.0 / width, 1.0 / height});
  }
  set("ratio", {width / height});
  set("iFrameRate", {60.0});
  for (const GlslParameter& parameter : opened.parameters) {
    if (!parameter.value.empty()) set(parameter.name, parameter.value);
  }
  return words;
}

[[noreturn]] void refuse_whole(const std::string& setting, const ShaderUniform& of) {
  throw UsageError("--set '" + setting + "': '" + of.name + "' is a whole number of 32 bits" +
                   (of.is_signed ? "" : ", not below 0"));
}

/// Sets a uniform as --set says. False if the shader has none of that name.
bool set_uniform(const OpenedShader& opened, const std::string& setting,
                 std::vector<std::uint32_t>& words) {
  const auto [name, text] = split_setting("--set", setting);
  const ShaderUniform* of = find_uniform(opened.shader, name);
  if (of == nullptr || is_texture(*of)) return false;
  const std::vector<double> numbers = numbers_of(setting, text);
  if (numbers.size() != of->words && numbers.size() != 1) {
    throw UsageError("--set '" + setting +
                     "': " + count_text(static_cast<int>(of->words), "number") + " would be right");
  }
  for (std::uint32_t i = 0; i < of->words; ++i) {
    const std::optional<std::uint32_t> word = word_of(*of, numbers[numbers.size() == 1 ? 0 : i]);
    if (!word) refuse_whole(setting, *of);
    words[of->first + i] = *word;
  }
  return true;
}

/// Throws UsageError for a setting or a texture that no shader has.
void check_names(const ShaderOptions& options, const std::vector<OpenedShader>& all) {
  const auto check = [&](const std::string& option, const std::string& text, bool textures) {
    const std::string name = split_setting(option, text).first;
    std::vector<std::string> names;
    for (const OpenedShader& opened : all) {
      for (const ShaderUniform& of : opened.shader.uniforms.all) {
        if (is_texture(of) == textures) names.push_back(of.name);
      }
    }
    if (std::find(names.begin(), names.end(), name) != names.end()) return;
    std::string list;
    for (const std::string& of : names) {
      if (!list.empty()) list += ", ";
      list += of;
    }
    throw UsageError(option + " '" + text + "': the shaders have no " +
                     (textures ? "texture" : "uniform") + " of that name; there are " +
                     (list.empty() ? "none" : list) + did_you_mean(name, names));
  };
  for (const std::string& setting : options.settings) check("--set", setting, false);
  for (const std::string& texture : options.textures) check("--texture", texture, true);
}

// --- textures ---

/// sRGB codes of 8 bits, opaque, the lowest row first.
Image as_codes(const Image& picture) {
  Image codes = make_image(Format::rgba8, picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y) {
    const auto to = row<std::uint8_t>(codes, picture.height - 1 - y);
    for (int x = 0; x < picture.width; ++x) {
      const glm::vec4 texel = load_texel(picture, x, y);
      const auto at = static_cast<std::size_t>(4 * x);
      for (int c = 0; c < 3; ++c) to[at + static_cast<std::size_t>(c)] = linear_to_srgb8(texel[c]);
      to[at + 3] = 255;
    }
  }
  return codes;
}

/// Colours of codes, with the depths of `like`.
Image from_codes(const Image& codes, const Image& like) {
  Image picture = make_image(Format::rgba16f, like.width, like.height);
  for (int y = 0; y < like.height; ++y) {
    const auto from = row<std::uint8_t>(codes, like.height - 1 - y);
    for (int x = 0; x < like.width; ++x) {
      const auto at = static_cast<std::size_t>(4 * x);
      store_texel(picture, x, y,
                  {srgb8_to_linear(from[at]), srgb8_to_linear(from[at + 1]),
                   srgb8_to_linear(from[at + 2]), load_texel(like, x, y).w},
                  {});
    }
  }
  return picture;
}

/// Each texture's number: the picture's for those that no --texture names.
std::vector<const Texture*> bind(const ShaderOptions& options, const OpenedShader& opened,
                                 const ShaderProgram& program, const Texture& picture,
                                 std::map<std::string, Texture>& files) {
  const UserShader& shader = opened.shader;
  std::vector<const Texture*> bound(shader.uniforms.texture_count, nullptr);
  std::vector<bool> used(bound.size());
  for (const ShaderSampleRegisters& sample : program.samples) {
    for (const ShaderProgram::Constant& constant : program.constants) {
      if (!sample.texture.varies && constant.number == sample.texture.number &&
          constant.bits < used.size()) {
        used[constant.bits] = true;
      }
    }
  }
  for (const std::string& text : options.textures) {
    const auto [name, file] = split_setting("--texture", text);
    const ShaderUniform* of = find_uniform(shader, name);
    if (of == nullptr || of->kind != SpirvKind::sampled_image) continue;  // of another shader
    const auto [at, is_new] = files.try_emplace(file);
    if (is_new) {
      PictureFile opened_file = open_picture_file(file);
      Image image =
          read_colour(opened_file, choose_colour(opened_file, {}, "--texture"), false).image;
      at->second = make_texture(opened.convention == GlslConvention::plain ? std::move(image)
                                                                           : as_codes(image));
    }
    bound[shader.uniforms.words[of->first]] = &at->second;
  }
  std::string of_picture;
  for (const ShaderUniform& of : shader.uniforms.all) {
    if (of.kind != SpirvKind::sampled_image) continue;
    const std::uint32_t number = shader.uniforms.words[of.first];
    if (of.dim != SpirvDim::two && of.dim != SpirvDim::one && of.dim != SpirvDim::rectangle &&
        used[number]) {
      throw UsageError("the shader's texture '" + of.name +
                       "' is a cube or has layers; textures of two dimensions are there");
    }
    if (bound[number] != nullptr || !used[number]) continue;
    if (!of_picture.empty()) {
      throw UsageError("the shader reads textures '" + of_picture + "' and '" + of.name +
                       "'; give all but one with --texture NAME=FILE, the other is the picture");
    }
    of_picture = of.name;
    bound[number] = &picture;
  }
  return bound;
}

Image with_shader(const ShaderOptions& options, const OpenedShader& opened, const Image& picture,
                  const Profile& profile, ThreadPool& pool) {
  std::vector<std::uint32_t> words = known_words(opened, picture);
  for (const std::string& setting : options.settings) set_uniform(opened, setting, words);
  const ShaderProgram program = compile_shader(opened.shader, words);

  const bool by_codes = opened.convention != GlslConvention::plain;
  const Texture source = make_texture(by_codes ? as_codes(picture) : picture);
  std::map<std::string, Texture> files;
  std::vector<ShaderTexture> textures;
  for (const Texture* of : bind(options, opened, program, source, files)) {
    textures.push_back(
        {.texture = of, .sampler = {Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge}});
  }
  Image result =
      make_image(by_codes ? Format::rgba8 : Format::rgba16f, picture.width, picture.height);
  const ImageView target = result;
  run_shader(program, {.textures = textures, .targets = {&target, 1}, .profile = profile}, pool);
  if (by_codes) return from_codes(result, picture);
  for (int y = 0; y < picture.height; ++y) {
    const auto from = row<std::uint16_t>(picture, y);
    const auto to = row<std::uint16_t>(result, y);
    for (std::size_t i = 3; i < to.size(); i += 4) to[i] = from[i];
  }
  return result;
}

}  // namespace

void add_shader_options(CLI::App& parser, ShaderOptions& options) {
  add_repeatable_value(parser, "--shader", "FILE",
                       "A fragment shader of yours, GLSL or SPIR-V, on the picture before all "
                       "effects; several come in their order (docs/shaders.md)",
                       [&options](const std::string& text) { options.files.push_back(text); });
  add_repeatable_value(parser, "--set", "NAME=NUMBER,...", "A uniform of the shaders",
                       [&options](const std::string& text) { options.settings.push_back(text); });
  add_repeatable_value(parser, "--texture", "NAME=FILE",
                       "A texture of the shaders; the one that is left is the picture",
                       [&options](const std::string& text) { options.textures.push_back(text); });
  add_choice(parser, "--convention",
             "Where the shaders come from (default: recognised by their text)", kConventions,
             options.convention);
}

std::vector<std::string> shader_inputs(const ShaderOptions& options) {
  std::vector<std::string> files = options.files;
  for (const std::string& text : options.textures) {
    files.push_back(split_setting("--texture", text).second);
  }
  return files;
}

Image with_shaders(const ShaderOptions& options, Image picture, const Profile& profile,
                   ThreadPool& pool) {
  std::vector<OpenedShader> all;
  for (const std::string& file : options.files) {
    all.push_back(open_shader(file, options.convention.value_or(GlslConvention::recognised)));
    if (all.back().shader.module->stage != ShaderStage::fragment) {
      throw ShaderError(file + ": it is a vertex shader; a fragment shader would be right");
    }
  }
  check_names(options, all);
  for (const OpenedShader& opened : all) {
    picture = with_shader(options, opened, picture, profile, pool);
  }
  return picture;
}

}  // namespace softfocus
