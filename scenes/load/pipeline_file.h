#pragma once
// Pipelines from TOML (docs/shaders.md has the keys), and methods made of them.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "dof/pipelines/pipeline.h"
#include "scenes/load/shader_file.h"

namespace softfocus {

/// A pipeline with what was read for it.
struct OpenedPipeline {
  Pipeline pipeline{};
  std::vector<std::string> files{};
  std::vector<std::string> warnings{};
};

/// Throws SceneError and ShaderError: "FILE:LINE: ...".
OpenedPipeline read_pipeline(const std::filesystem::path& file);

/// Opens a pass's shader by its name in the pipeline. Throws SceneError and ShaderError.
using ShaderOpener = std::function<OpenedShader(const std::string& name, const ShaderReading&)>;

/// A pipeline's text that is in no file; `name` is for errors. Its textures' files are relative to
/// where the program runs.
OpenedPipeline read_pipeline(const std::string& text, const std::string& name,
                             const ShaderOpener& open);

/// Values that a shader's text offers become those of its uniforms, unless others come later.
void add_constants(PipelinePass& pass, const std::vector<GlslParameter>& parameters);

/// Sets parameters, "NAME=NUMBER:...", before finish_pipeline() or after. Throws SceneError.
void set_parameters(Pipeline& pipeline, std::string_view settings);

/// Whether a method's name is a pipeline's: "FILE.toml" or "FILE.toml:NAME=NUMBER:...".
bool is_pipeline_name(std::string_view name);

/// The method of a pipeline. Files are read once, when a name is first asked for: what is returned
/// lasts as long as the program. Throws as read_pipeline().
const Method* pipeline_method(const std::string& name);

/// The same for a pipeline that is in no file: its name is the method's, and ends with ".toml". One
/// that is there already stays.
const Method* keep_pipeline(OpenedPipeline opened);

/// What was read for the method, for whoever writes files, and what the reader warned of. Empty for
/// other methods.
std::vector<std::string> files_of(const Method& method);
std::vector<std::string> warnings_of(const Method& method);

}  // namespace softfocus
