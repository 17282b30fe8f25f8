// shader, shader_text: passes with a shader of the visitor's as a method, and shaders of ours to
// begin with.

#include "dof/shaders.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/pipeline_file.h"
#include "tools/cli/errors.h"
#include "tools/files/hash_text.h"
#include "tools/page/compiled_shader.h"
#include "tools/page/requests.h"

namespace softfocus {

Json answer_shader(Page& /*page*/, const Json& request) {
  const std::string& name = request.at("name").text();
  const auto open = [&](const std::string& wanted, const ShaderReading& reading) {
    if (wanted != name) {
      throw SceneError("'" + wanted + "' is not here; \"" + name + "\" would be right");
    }
    if (!reading.defines.empty() || !reading.include_folders.empty()) {
      throw SceneError(
          "the page has no `defines` and no `include`; they would belong into the text");
    }
    OpenedShader shader = compiled_shader(request.at("compiled"));
    if (reading.convention != GlslConvention::recognised &&
        reading.convention != shader.convention) {
      throw SceneError("the page recognises conventions by the text, which is taken for " +
                       std::string{name_of(shader.convention)});
    }
    return shader;
  };
  OpenedPipeline opened = read_pipeline(request.at("passes").text(), "mine.toml", open);
  opened.pipeline.name = "shader-" + hash_text(opened.pipeline.hash) + ".toml";
  Json warnings = Json::array();
  for (const std::string& warning : opened.warnings) warnings.push_back(warning);
  return {{"method", keep_pipeline(std::move(opened))->name}, {"warnings", warnings}};
}

Json answer_shader_text(Page& /*page*/, const Json& request) {
  const std::string& name = request.at("name").text();
  const std::string_view text = shader_text(name);
  if (text.empty()) throw UsageError("there is no shader '" + name + "'");
  return {{"text",
           "#version 300 es\nprecision highp float;\nprecision highp int;\n"
           "precision highp sampler2D;\n#define precise\n\n" +
               std::string{text}}};
}

}  // namespace softfocus
