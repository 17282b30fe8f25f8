#include "tools/page/compiled_shader.h"

namespace softfocus {

Json compiled_json(const CompiledGlsl& compiled) {
  Json words = Json::array();
  for (const std::uint32_t word : compiled.words) words.push_back(word);
  Json parameters = Json::array();
  for (const GlslParameter& parameter : compiled.parameters) {
    parameters.push_back({{"name", parameter.name}, {"value", parameter.value}});
  }
  Json warnings = Json::array();
  for (const std::string& warning : compiled.warnings) warnings.push_back(warning);
  return {{"words", words},
          {"convention", name_of(compiled.convention)},
          {"text", compiled.text},
          {"parameters", parameters},
          {"warnings", warnings}};
}

OpenedShader compiled_shader(const Json& json) {
  OpenedShader shader;
  shader.words.reserve(json.at("words").values().size());
  for (const Json& word : json.at("words").values()) {
    shader.words.push_back(static_cast<std::uint32_t>(word.integer()));
  }
  for (const Choice<GlslConvention>& choice : kGlslConventions) {
    if (choice.name == json.at("convention").text()) shader.convention = choice.value;
  }
  shader.text = json.at("text").text();
  for (const Json& parameter : json.at("parameters").values()) {
    GlslParameter& made = shader.parameters.emplace_back();
    made.name = parameter.at("name").text();
    made.value = parameter.at("value").numbers();
  }
  for (const Json& warning : json.at("warnings").values()) {
    shader.warnings.push_back(warning.text());
  }
  return shader;
}

}  // namespace softfocus
