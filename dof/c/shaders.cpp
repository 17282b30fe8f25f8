// The functions of softfocus.h on shaders.

#include "raster/shaders/shader.h"

#include <bit>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dof/c/context.h"
#include "dof/c/settings.h"
#include "dof/c/shader_arguments.h"
#include "raster/images/sliced_texture.h"
#include "raster/shaders/draw_shaders.h"
#include "raster/shaders/glsl/glsl.h"
#include "raster/shaders/link_shaders.h"
#include "raster/threads/loops.h"

using namespace softfocus;

struct softfocus_shader {
  UserShader shader{};
  std::vector<std::uint32_t> words{};              // of the uniforms
  std::vector<bool> is_late{};                     // of the words; empty: none
  std::shared_ptr<const ShaderProgram> program{};  // with these words; made when it is needed
  bool is_linked = false;
  std::vector<Texture> textures{};        // by their numbers
  std::vector<ShaderTexture> samplers{};  // without the textures
};

namespace softfocus {
namespace {

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
    if (source.define_count > 0 || source.read_include != nullptr) {
      refuse("source", "words are compiled already; macros and includes are for text");
    }
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
  GlslSource text{
      .stage = source.stage == SOFTFOCUS_VERTEX ? ShaderStage::vertex : ShaderStage::fragment,
      .name = source.name != nullptr ? source.name : "shader",
      .text = source.text,
      .convention = convention_of(source.convention)};
  if (source.defines == nullptr && source.define_count > 0) {
    refuse("source.defines", "a null pointer");
  }
  for (const char* const of : std::span{source.defines, source.define_count}) {
    if (of == nullptr) refuse("source.defines", "a null pointer");
    const std::string fault = add_definition(text.defines, of);
    if (!fault.empty()) refuse("source.defines", "'" + std::string{of} + "': " + fault);
  }
  const auto read = [&](const std::string& path) -> std::optional<std::string> {
    if (source.read_include == nullptr) return {};
    const char* const found = source.read_include(source.user, path.c_str());
    if (found == nullptr) return {};
    return found;
  };
  return compile_glsl(text, read).words;
}

std::shared_ptr<const ShaderProgram> program_of(softfocus_shader& shader) {
  if (shader.program == nullptr) {
    shader.program = std::make_shared<const ShaderProgram>(
        compile_shader(shader.shader, shader.words, shader.is_late));
  }
  return shader.program;
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
  const std::optional<std::uint32_t> word = uniform_word(of, number);
  if (!word) {
    refuse("numbers[" + std::to_string(index) + "]", std::to_string(number) + "; '" + of.name +
                                                         "' is a whole number of 32 bits" +
                                                         (of.is_signed ? "" : ", not below 0"));
  }
  return *word;
}

// --- drawing ---

void copy_rows(const ConstImageView& from, const ImageView& to, ThreadPool& pool) {
  constexpr int kRowsAtOnce = 64;
  for_each_row(pool, from.height, kRowsAtOnce, [&](int y) {
    std::memcpy(to.texels + y * to.stride_bytes, from.texels + y * from.stride_bytes,
                bytes_per_texel(from.format) * static_cast<std::size_t>(from.width));
  });
}

/// OpenGL's lowest row is the emulation's last.
ImageView upside_down(ImageView image) {
  image.texels += (image.height - 1) * image.stride_bytes;
  image.stride_bytes = -image.stride_bytes;
  return image;
}

std::vector<ShaderTexture> bound_textures(const softfocus_shader& shader) {
  std::vector<ShaderTexture> bound = shader.samplers;
  for (std::size_t i = 0; i < bound.size(); ++i) {
    if (!shader.textures[i].levels.empty()) bound[i].texture = &shader.textures[i];
  }
  return bound;
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
    for (std::size_t i = 0; i < words.size(); ++i) {
      const bool is_late = !to.is_late.empty() && to.is_late[i];
      if (words[i] != to.words[i] && !is_late) to.program.reset();
    }
    to.words = std::move(words);
  });
}

int softfocus_make_uniform_late(softfocus_context* context, softfocus_shader* shader,
                                const char* name) {
  return guarded(context, [&](ThreadPool&) {
    softfocus_shader& to = given(shader);
    const ShaderUniform& uniform = named(to, name, false).uniform;
    to.is_late.resize(to.words.size());
    std::fill_n(to.is_late.begin() + uniform.first, uniform.words, true);
    to.program.reset();
  });
}

int softfocus_set_texture(softfocus_context* context, softfocus_shader* shader, const char* name,
                          const softfocus_texels* texels, const softfocus_sampler* sampler) {
  return guarded(context, [&](ThreadPool& pool) {
    softfocus_shader& to = given(shader);
    const auto [uniform, element] = named(to, name, true);
    const std::vector<ImageView> from = read_slices("texels", texels, uniform);
    const ShaderTexture chosen = read_sampler(sampler);
    std::vector<Image> slices;
    slices.reserve(from.size());
    for (const ImageView& slice : from) {
      slices.push_back(make_image(slice.format, slice.width, slice.height));
      copy_rows(slice, slices.back(), pool);
    }
    Texture made = make_sliced_texture(uniform.shape, std::move(slices));
    if (chosen.sampler.filter == Filter::trilinear) generate_mipmaps(made, {});
    const std::size_t number = to.shader.uniforms.words[uniform.first + element];
    to.textures[number] = std::move(made);
    to.samplers[number] = chosen;
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
    const std::vector<ShaderTexture> textures = bound_textures(of);
    run_shader(*program_of(of),
               {.textures = textures,
                .targets = read.targets,
                .profile = read.profile,
                .budget = read.budget,
                .uniforms = of.words},
               pool);
  });
}

int softfocus_link_shaders(softfocus_context* context, softfocus_shader* vertex,
                           softfocus_shader* fragment) {
  return guarded(context, [&](ThreadPool&) {
    softfocus_shader &first = given(vertex), &second = given(fragment);
    link_shaders(first.shader, second.shader);
    first.words = first.shader.uniforms.words;
    second.words = second.shader.uniforms.words;
    first.is_late.clear();
    second.is_late.clear();
    first.is_linked = second.is_linked = true;
    first.program.reset();
    second.program.reset();
  });
}

int softfocus_draw_shaders(softfocus_context* context, softfocus_shader* vertex,
                           softfocus_shader* fragment, const softfocus_vertices* vertices,
                           const softfocus_pass* pass) {
  return guarded(context, [&](ThreadPool& pool) {
    softfocus_shader &first = given(vertex), &second = given(fragment);
    if (!first.is_linked || !second.is_linked) {
      refuse("vertex", "the shaders are not linked; softfocus_link_shaders() comes first");
    }
    const ReadVertices read_from = read_vertices(vertices, *first.shader.module);
    const ReadPass read = read_pass(pass);
    if (read.targets.size() > kMaxColourTargets) {
      refuse("pass.target_count", "a draw has at most " + std::to_string(kMaxColourTargets));
    }
    std::vector<Image> images;
    images.reserve(read.targets.size());
    RenderPass render;
    render.profile = read.profile;
    render.isa = pool.isa();
    for (std::size_t i = 0; i < read.targets.size(); ++i) {
      const ImageView& target = read.targets[i];
      if (target.texels == nullptr) continue;
      images.push_back(make_image(target.format, target.width, target.height));
      copy_rows(upside_down(target), images.back(), pool);
      render.targets.colour[i] = &images.back();
    }
    DrawState state;
    state.cull = Cull::none;
    state.depth.reset();
    draw_shaders(render, state, read_from.indices, read_from.count,
                 {.vertex = program_of(first),
                  .fragment = program_of(second),
                  .vertex_uniforms = first.words,
                  .fragment_uniforms = second.words,
                  .attributes = read_from.attributes,
                  .vertex_textures = bound_textures(first),
                  .fragment_textures = bound_textures(second),
                  .budget = read.budget});
    finish(render, pool);
    std::size_t drawn = 0;
    for (const ImageView& target : read.targets) {
      if (target.texels != nullptr) copy_rows(images[drawn++], upside_down(target), pool);
    }
  });
}
