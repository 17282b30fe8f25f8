#include "tools/effects/shader_on_picture.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "dof/pipelines/picture_codes.h"
#include "dof/pipelines/pipeline.h"
#include "scenes/files/decimal.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/pipeline_file.h"
#include "scenes/load/shader_file.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/options/parameter_options.h"
#include "tools/pictures/picture_file.h"
#include "tools/refocus/chosen_layers.h"

namespace softfocus {
namespace {

/// "NAME=VALUE" of an option.
std::pair<std::string, std::string> split_setting(const std::string& option,
                                                  const std::string& text) {
  const auto at = text.find('=');
  if (at == text.npos || at == 0) {
    throw UsageError(option + " '" + text + "': NAME=VALUE would be right");
  }
  return {text.substr(0, at), text.substr(at + 1)};
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

[[noreturn]] void refuse_whole(const std::string& setting, const ShaderUniform& of) {
  throw UsageError("--set '" + setting + "': '" + of.name + "' is a whole number of 32 bits" +
                   (of.is_signed ? "" : ", not below 0"));
}

struct ReadShader {
  UserShader shader{};
  GlslConvention convention{};
  std::vector<GlslParameter> parameters{};
};

/// Sets a uniform as --set says, if the pass has one of that name.
void set_uniform(const std::string& setting, PipelinePass& pass) {
  const auto [name, text] = split_setting("--set", setting);
  const std::vector<ShaderUniform>& all = pass.shader.uniforms.all;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const ShaderUniform& of = all[i];
    if (of.name != name || is_texture(of)) continue;
    const std::vector<double> numbers = numbers_of(setting, text);
    if (numbers.size() != of.words && numbers.size() != 1) {
      throw UsageError("--set '" + setting + "': " +
                       count_text(static_cast<int>(of.words), "number") + " would be right");
    }
    PipelineUniform uniform{.number = i};
    for (const double number : numbers) {
      if (!uniform_word(of, number)) refuse_whole(setting, of);
      uniform.values.push_back(constant_expression(number));
    }
    pass.uniforms.push_back(std::move(uniform));
  }
}

/// Throws UsageError for a setting or a texture that no shader has.
void check_names(const ShaderOptions& options, const std::vector<ReadShader>& all,
                 const Pipeline* pipeline) {
  const auto check = [&](const std::string& option, const std::string& text, bool textures) {
    const std::string name = split_setting(option, text).first;
    std::vector<std::string> names;
    for (const ReadShader& opened : all) {
      for (const ShaderUniform& of : opened.shader.uniforms.all) {
        if (is_texture(of) == textures) names.push_back(of.name);
      }
    }
    if (pipeline != nullptr && !textures) {
      for (const PipelineParameter& of : pipeline->parameters) names.push_back(of.name);
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

/// Binds the textures that --texture names to the pass.
void bind_files(const ShaderOptions& options, Pipeline& pipeline, PipelinePass& pass) {
  for (const std::string& text : options.textures) {
    const auto [name, file] = split_setting("--texture", text);
    const ShaderUniform* of = find_uniform(pass.shader, name);
    if (of == nullptr || !is_texture(*of)) continue;  // of another shader
    PictureFile opened = open_picture_file(file);
    Image image = read_colour(opened, choose_colour(opened, {}, "--texture"), false).image;
    pass.inputs.push_back({.texture = pass.shader.uniforms.words[of->first],
                           .source = PipelineSource::texture,
                           .number = pipeline.textures.size()});
    pipeline.textures.push_back(make_texture(pipeline.by_codes ? codes_of(image) : image));
  }
}

/// A shader as a pipeline of its own: each has texels by its own convention.
Pipeline pipeline_of(const ShaderOptions& options, const std::string& file, ReadShader opened) {
  Pipeline pipeline;
  pipeline.by_codes = opened.convention != GlslConvention::plain;
  PipelinePass& pass = add_pass(pipeline, file, std::move(opened.shader));
  add_constants(pass, opened.parameters);
  for (const std::string& setting : options.settings) set_uniform(setting, pass);
  bind_files(options, pipeline, pass);
  try {
    finish_pipeline(pipeline,
                    "give all but one with --texture NAME=FILE, the other is the picture");
  } catch (const UnnamedTextures& error) {
    throw UsageError(error.what());
  }
  return pipeline;
}

/// With the parameters that --set names.
OpenedPipeline open_pipeline(const ShaderOptions& options) {
  OpenedPipeline opened = read_pipeline(*options.pipeline);
  for (const std::string& warning : opened.warnings) warn(warning);
  if (reads_lens(opened.pipeline)) {
    throw UsageError("--pipeline '" + *options.pipeline +
                     "': it reads the lens, and apply has none; softfocus refocus --method " +
                     *options.pipeline + " would be right");
  }
  for (const std::string& setting : options.settings) {
    const std::string name = split_setting("--set", setting).first;
    const auto& all = opened.pipeline.parameters;
    const bool has_it = std::any_of(all.begin(), all.end(),
                                    [&](const PipelineParameter& of) { return of.name == name; });
    if (has_it) set_parameters(opened.pipeline, setting);
  }
  return opened;
}

}  // namespace

void add_shader_options(CLI::App& parser, ShaderOptions& options) {
  add_repeatable_value(parser, "--shader", "FILE",
                       "A fragment shader of yours, GLSL or SPIR-V, on the picture before all "
                       "effects; several come in their order (docs/shaders.md)",
                       [&options](const std::string& text) { options.files.push_back(text); });
  add_text(parser, "--pipeline", "FILE",
           "Passes of yours, behind the shaders: a TOML file (docs/shaders.md)", options.pipeline);
  add_repeatable_value(parser, "--set", "NAME=NUMBER,...",
                       "A uniform of the shaders, or a parameter of the pipeline",
                       [&options](const std::string& text) { options.settings.push_back(text); });
  add_repeatable_value(parser, "--texture", "NAME=FILE",
                       "A texture of the shaders; the one that is left is the picture",
                       [&options](const std::string& text) { options.textures.push_back(text); });
  add_choice(parser, "--convention",
             "Where the shaders come from (default: recognised by their text)", kGlslConventions,
             options.convention);
  add_repeatable_value(parser, "--define", "NAME[=VALUE]",
                       "A macro of the --shader files; without a value it is 1",
                       [&options](const std::string& text) {
                         const std::string fault = add_definition(options.defines, text);
                         if (!fault.empty()) throw UsageError("--define '" + text + "': " + fault);
                       });
  add_repeatable_value(parser, "--include", "FOLDER",
                       "Where #include of the --shader files looks for what is not beside them",
                       [&options](const std::string& text) {
                         std::error_code error;
                         if (!std::filesystem::is_directory(text, error)) {
                           throw UsageError("--include '" + text + "': there is no such folder");
                         }
                         options.include_folders.push_back(text);
                       });
}

std::vector<std::string> shader_inputs(const ShaderOptions& options) {
  std::vector<std::string> files = options.files;
  if (options.pipeline) files.push_back(*options.pipeline);
  for (const std::string& text : options.textures) {
    files.push_back(split_setting("--texture", text).second);
  }
  return files;
}

Image with_shaders(const ShaderOptions& options, Image picture, const Profile& profile,
                   ThreadPool& pool) {
  if (options.files.empty() && !(options.defines.empty() && options.include_folders.empty())) {
    throw UsageError(
        "--define and --include are of --shader; a pipeline's passes have `defines` and `include`");
  }
  std::vector<ReadShader> all;
  for (const std::string& file : options.files) {
    OpenedShader opened =
        open_shader(file, {.convention = options.convention.value_or(GlslConvention::recognised),
                           .defines = options.defines,
                           .include_folders = options.include_folders,
                           .is_of_several = options.files.size() > 1});
    for (const std::string& warning : opened.warnings) warn(warning);
    all.push_back(
        {make_shader(std::move(opened.words)), opened.convention, std::move(opened.parameters)});
  }
  OpenedPipeline opened;
  if (options.pipeline) opened = open_pipeline(options);
  check_names(options, all, options.pipeline ? &opened.pipeline : nullptr);
  const auto run = [&](const Pipeline& pipeline) {
    Image result = make_image(Format::rgba16f, picture.width, picture.height);
    run_pipeline(pipeline, {.scene = picture, .settings = {}, .profile = profile}, result, pool);
    picture = std::move(result);
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    run(pipeline_of(options, options.files[i], std::move(all[i])));
  }
  if (options.pipeline) run(opened.pipeline);
  return picture;
}

}  // namespace softfocus
