// The functions of softfocus.h on shaders.

#include "raster/shaders/shader.h"

#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dof/c/context.h"
#include "dof/c/settings.h"
#include "raster/images/sampler.h"
#include "raster/shaders/glsl/glsl.h"
#include "raster/threads/loops.h"

using namespace softfocus;

struct softfocus_shader {
  UserShader shader{};
  std::vector<std::uint32_t> words{};      // of the uniforms
  std::optional<ShaderProgram> program{};  // with these words
  std::vector<Texture> textures{};         // by their numbers
  std::vector<Sampler> samplers{};
};

namespace softfocus {
namespace {

bool is_texture(const ShaderUniform& of) {
  return of.kind == SpirvKind::sampled_image || of.kind == SpirvKind::image ||
         of.kind == SpirvKind::sampler;
}

softfocus_shader& given(softfocus_shader* shader) {
  if (shader == nullptr) refuse("shader", "a null pointer");
  return *shader;
}

// --- compiling ---

GlslConvention convention_of(const char* name) {
  if (name == nullptr) return GlslConvention::recognised;
  std::string all;
  for (const GlslConvention one :
       {GlslConvention::plain, GlslConvention::shadertoy, GlslConvention::three,
        GlslConvention::libretro, GlslConvention::gl_transitions}) {
    if (name_of(one) == name) return one;
    if (!all.empty()) all += ", ";
    all += name_of(one);
  }
  refuse("source.convention", "there is no '" + std::string{name} + "'; there are " + all);
}

std::vector<std::uint32_t> words_of(const softfocus_shader_source& source) {
  if (source.words != nullptr) {
    if (source.text != nullptr) refuse("source", "it has both text and words");
    if (source.word_count > kMostSpirvWords) {
      refuse("source.word_count", std::to_string(source.word_count) + " is more than " +
                                      std::to_string(kMostSpirvWords));
    }
    return spirv_words(std::as_bytes(std::span{source.words, source.word_count}));
  }
  if (source.text == nullptr) refuse("source", "neither text nor words");
  if (!missing_glsl().empty()) refuse("source.text", std::string{missing_glsl()});
  if (source.stage != SOFTFOCUS_FRAGMENT && source.stage != SOFTFOCUS_VERTEX) {
    refuse("source.stage", std::to_string(source.stage) +
                               " is no stage; there are SOFTFOCUS_FRAGMENT and SOFTFOCUS_VERTEX");
  }
  const GlslSource text{
      .stage = source.stage == SOFTFOCUS_VERTEX ? ShaderStage::vertex : ShaderStage::fragment,
      .name = source.name != nullptr ? source.name : "shader",
      .text = source.text,
      .convention = convention_of(source.convention)};
  return compile_glsl(text, [](const std::string&) { return std::nullopt; }).words;
}

const ShaderProgram& program_of(softfocus_shader& shader) {
  if (!shader.program) shader.program = compile_shader(shader.shader, shader.words);
  return *shader.program;
}

// --- uniforms ---

[[noreturn]] void refuse_name(const softfocus_shader& shader, const std::string& name,
                              bool textures) {
  std::string all;
  for (const ShaderUniform& of : shader.shader.uniforms.all) {
    if (is_texture(of) != textures) continue;
    if (!all.empty()) all += ", ";
    all += of.name;
  }
  refuse("name", "the shader has no " + std::string{textures ? "texture" : "uniform"} + " '" +
                     name + "'; there " + (all.empty() ? "is none" : "are " + all));
}

/// The uniform that "name" or "name[2]" names, from that element on.
struct NamedUniform {
  const ShaderUniform& uniform;
  std::uint32_t element;
};

NamedUniform named(const softfocus_shader& shader, const char* given_name, bool textures) {
  if (given_name == nullptr) refuse("name", "a null pointer");
  const std::string name{given_name};
  std::string base = name;
  std::uint32_t element = 0;
  const auto find = [&](const std::string& text) -> const ShaderUniform* {
    const ShaderUniform* found = find_uniform(shader.shader, text);
    return found != nullptr && is_texture(*found) == textures ? found : nullptr;
  };
  if (const ShaderUniform* found = find(name)) return {*found, 0};
  const std::size_t bracket = name.rfind('[');
  constexpr std::size_t kMostDigits = 5;
  if (bracket != name.npos && name.ends_with(']') && name.size() - bracket <= kMostDigits + 2) {
    base.resize(bracket);
    for (std::size_t i = bracket + 1; i + 1 < name.size(); ++i) {
      if (name[i] < '0' || name[i] > '9') refuse_name(shader, name, textures);
      element = element * 10 + static_cast<std::uint32_t>(name[i] - '0');
    }
    const ShaderUniform* found = find(base);
    if (found != nullptr && element < found->count) return {*found, element};
  }
  refuse_name(shader, name, textures);
}

std::uint32_t word_of(const ShaderUniform& of, std::size_t index, double number) {
  if (of.kind == SpirvKind::floating) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(number));
  }
  if (of.kind == SpirvKind::boolean) return number != 0.0 ? ~0u : 0u;
  const double least = of.is_signed ? -0x1p31 : 0.0, end = of.is_signed ? 0x1p31 : 0x1p32;
  if (!(number >= least && number < end) || number != std::floor(number)) {
    refuse("numbers[" + std::to_string(index) + "]", std::to_string(number) + "; '" + of.name +
                                                         "' is a whole number of 32 bits" +
                                                         (of.is_signed ? "" : ", not below 0"));
  }
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(number));
}

// --- texels ---

Format texel_format(const std::string& name, std::int32_t format) {
  switch (format) {
    case SOFTFOCUS_FORMAT_R8: return Format::r8;
    case SOFTFOCUS_FORMAT_RGBA8: return Format::rgba8;
    case SOFTFOCUS_FORMAT_SRGB8: return Format::srgb8;
    case SOFTFOCUS_FORMAT_RGBA16F: return Format::rgba16f;
    case SOFTFOCUS_FORMAT_R32F: return Format::r32f;
    case SOFTFOCUS_FORMAT_RGBA32F: return Format::rgba32f;
    case SOFTFOCUS_FORMAT_RGBA32I:
    case SOFTFOCUS_FORMAT_RGBA32UI: return Format::rgba32f;
    default: refuse(name + ".format", std::to_string(format) + " is no softfocus_format");
  }
}

/// Texels of a caller's, checked.
struct ReadTexels {
  ImageView view{};
  MemoryRange range{};
};

ReadTexels read_texels(const std::string& name, const softfocus_texels* from, bool is_written) {
  const auto texels = read_struct(name, from);
  const auto is_side = [](std::int32_t side) { return side >= 1 && side <= kMaxImageSize; };
  if (!is_side(texels.width) || !is_side(texels.height)) {
    refuse(name, "its width and height are " + std::to_string(texels.width) + " and " +
                     std::to_string(texels.height) + ", not from 1 to " +
                     std::to_string(kMaxImageSize));
  }
  const Format format = texel_format(name, texels.format);
  const ImageView view =
      view_of(format, texels.first, texels.width, texels.height, texels.row_bytes);
  const auto texel = static_cast<std::ptrdiff_t>(bytes_per_texel(format));
  const std::ptrdiff_t channel = texel / channel_count(format);
  const PixelPlane plane{name + ".first", texels.first, texel, view.stride_bytes, texel};
  const MemoryRange range = range_of(plane, texels.width, texels.height);
  if (is_written) check_apart(plane, texels.width, texels.height);
  if (range.begin % static_cast<std::uintptr_t>(channel) != 0 || view.stride_bytes % channel != 0) {
    refuse(plane.name, "it or row_bytes is not aligned to " + std::to_string(channel) + " bytes");
  }
  return {view, range};
}

template <class Value>
Value one_of(const std::string& name, std::int32_t given_value,
             std::initializer_list<std::pair<int, Value>> values, const char* words) {
  for (const auto& [number, value] : values) {
    if (number == given_value) return value;
  }
  refuse(name, std::to_string(given_value) + " is none; there are " + words);
}

// --- a run ---

struct ReadPass {
  std::vector<ImageView> targets{};
  Profile profile{};
  std::uint64_t budget = ShaderPass{}.budget;
};

ReadPass read_pass(const softfocus_pass* from) {
  const auto pass = read_struct("pass", from);
  if (pass.target_count < 1 || pass.target_count > SOFTFOCUS_MOST_TARGETS) {
    refuse("pass.target_count", std::to_string(pass.target_count) + " is not from 1 to " +
                                    std::to_string(SOFTFOCUS_MOST_TARGETS));
  }
  if (pass.targets == nullptr) refuse("pass.targets", "a null pointer");
  ReadPass read;
  if (pass.profile != nullptr) read.profile = profile_of("pass.profile", pass.profile);
  if (pass.budget != 0) read.budget = pass.budget;
  std::vector<MemoryRange> ranges;
  for (std::int32_t i = 0; i < pass.target_count; ++i) {
    read.targets.emplace_back();
    if (pass.targets[i] == nullptr) continue;
    const std::string name = "pass.targets[" + std::to_string(i) + "]";
    const ReadTexels texels = read_texels(name, pass.targets[i], true);
    for (const ImageView& other : read.targets) {
      if (other.texels != nullptr &&
          (other.width != texels.view.width || other.height != texels.view.height)) {
        refuse(name, "it has not the size of the others");
      }
    }
    for (const MemoryRange& other : ranges) {
      if (overlap(other, texels.range)) refuse(name, "it lies over another target");
    }
    ranges.push_back(texels.range);
    read.targets.back() = texels.view;
  }
  if (ranges.empty()) refuse("pass.targets", "all are null");
  return read;
}

}  // namespace
}  // namespace softfocus

int softfocus_compile_shader(softfocus_context* context, const softfocus_shader_source* source,
                             softfocus_shader** shader) {
  if (shader != nullptr) *shader = nullptr;
  return guarded(context, [&](ThreadPool&) {
    if (shader == nullptr) refuse("shader", "a null pointer");
    auto made = std::make_unique<softfocus_shader>();
    made->shader = make_shader(words_of(read_struct("source", source)));
    made->words = made->shader.uniforms.words;
    made->textures.resize(made->shader.uniforms.texture_count);
    made->samplers.resize(made->textures.size());
    program_of(*made);  // refuses now what cannot run
    *shader = made.release();
  });
}

void softfocus_free_shader(softfocus_shader* shader) { delete shader; }

const char* softfocus_uniform_name(const softfocus_shader* shader, size_t index) {
  if (shader == nullptr || index >= shader->shader.uniforms.all.size()) return nullptr;
  return shader->shader.uniforms.all[index].name.c_str();
}

int softfocus_set_uniform(softfocus_context* context, softfocus_shader* shader, const char* name,
                          const double* numbers, size_t count) {
  return guarded(context, [&](ThreadPool&) {
    softfocus_shader& to = given(shader);
    const auto [uniform, element] = named(to, name, false);
    if (numbers == nullptr) refuse("numbers", "a null pointer");
    const std::size_t each = uniform.words / std::max(uniform.count, 1u);
    const std::size_t most = uniform.words - element * each;
    if (count == 0 || count > most || count % each != 0) {
      refuse("count", std::to_string(count) + "; '" + uniform.name + "' takes " +
                          std::to_string(each) +
                          (most > each ? ", or a multiple to " + std::to_string(most) : ""));
    }
    std::vector<std::uint32_t> words = to.words;
    for (std::size_t i = 0; i < count; ++i) {
      words[uniform.first + element * each + i] = word_of(uniform, i, numbers[i]);
    }
    if (words == to.words) return;
    to.words = std::move(words);
    to.program.reset();
  });
}

int softfocus_set_texture(softfocus_context* context, softfocus_shader* shader, const char* name,
                          const softfocus_texels* texels, int32_t filter, int32_t wrap) {
  return guarded(context, [&](ThreadPool& pool) {
    softfocus_shader& to = given(shader);
    const auto [uniform, element] = named(to, name, true);
    if (uniform.dim != SpirvDim::two && uniform.dim != SpirvDim::one &&
        uniform.dim != SpirvDim::rectangle) {
      refuse("name", "'" + uniform.name +
                         "' is a cube or has layers; textures of two dimensions are there");
    }
    const ImageView from = read_texels("texels", texels, false).view;
    const auto chosen = one_of<Filter>("filter", filter,
                                       {{SOFTFOCUS_NEAREST, Filter::nearest},
                                        {SOFTFOCUS_BILINEAR, Filter::bilinear},
                                        {SOFTFOCUS_TRILINEAR, Filter::trilinear}},
                                       "SOFTFOCUS_NEAREST, BILINEAR and TRILINEAR");
    const auto edge = one_of<Wrap>("wrap", wrap,
                                   {{SOFTFOCUS_REPEAT, Wrap::repeat},
                                    {SOFTFOCUS_MIRROR, Wrap::mirrored_repeat},
                                    {SOFTFOCUS_CLAMP, Wrap::clamp_to_edge}},
                                   "SOFTFOCUS_REPEAT, MIRROR and CLAMP");
    Texture made = make_texture(make_image(from.format, from.width, from.height));
    Image& image = made.levels.front();
    constexpr int kRowsAtOnce = 64;
    for_each_row(pool, from.height, kRowsAtOnce, [&](int y) {
      std::memcpy(image.bytes.data() + static_cast<std::size_t>(y) * image.stride_bytes,
                  from.texels + y * from.stride_bytes,
                  bytes_per_texel(from.format) * static_cast<std::size_t>(from.width));
    });
    if (chosen == Filter::trilinear) generate_mipmaps(made, {});
    const std::size_t number = to.shader.uniforms.words[uniform.first + element];
    to.textures[number] = std::move(made);
    to.samplers[number] = {chosen, edge, edge};
  });
}

int softfocus_run_shader(softfocus_context* context, softfocus_shader* shader,
                         const softfocus_pass* pass) {
  return guarded(context, [&](ThreadPool& pool) {
    softfocus_shader& of = given(shader);
    if (of.shader.module->stage != ShaderStage::fragment) {
      refuse("shader", "it is a vertex shader; a fragment shader would be right");
    }
    const ReadPass read = read_pass(pass);
    std::vector<ShaderTexture> textures;
    for (std::size_t i = 0; i < of.textures.size(); ++i) {
      textures.push_back(
          {of.textures[i].levels.empty() ? nullptr : &of.textures[i], of.samplers[i]});
    }
    run_shader(program_of(of),
               {.textures = textures,
                .targets = read.targets,
                .profile = read.profile,
                .budget = read.budget},
               pool);
  });
}
