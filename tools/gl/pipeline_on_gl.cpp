#include "tools/gl/pipeline_on_gl.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "tools/gl/driver/driver.h"

namespace softfocus {
namespace {

/// The type of an input that is a number, vector or matrix; else nothing.
std::string glsl_type(const SpirvModule& module, const SpirvType& type) {
  if (type.kind == SpirvKind::matrix) {
    const std::uint32_t rows = module.type(type.element).count;
    const std::string name = "mat" + std::to_string(type.count);
    return rows == type.count ? name : name + "x" + std::to_string(rows);
  }
  const bool is_vector = type.kind == SpirvKind::vector;
  const SpirvType& number = is_vector ? module.type(type.element) : type;
  const bool is_float = number.kind == SpirvKind::floating;
  if (!is_float && number.kind != SpirvKind::integer) return {};
  if (!is_vector) return is_float ? "float" : number.is_signed ? "int" : "uint";
  return (is_float ? "vec" : number.is_signed ? "ivec" : "uvec") + std::to_string(type.count);
}

constexpr const char* kCorner = "softfocus_corner";

/// The place in the picture as a value of such a type: u, v, 0, 1, in each column.
std::string place_of(const SpirvModule& module, const SpirvType& type) {
  std::string made = glsl_type(module, type) + "(";
  if (type.kind == SpirvKind::matrix) {
    for (std::uint32_t i = 0; i < type.count; ++i) {
      made.append(i == 0 ? "" : ", ").append(place_of(module, module.type(type.element)));
    }
    return made + ")";
  }
  const std::string parts = "xyzw";
  made.append("vec4(").append(kCorner).append(" * 0.5 + 0.5, 0.0, 1.0).");
  return made + parts.substr(0, type.kind == SpirvKind::vector ? type.count : 1) + ")";
}

/// A shader's version, as its first line says it.
struct DriverVersion {
  std::string line{};
  int number = 0;
  bool is_es = false;

  /// in and out in place of varying, and numbers of vertices.
  bool has_outputs() const { return number >= (is_es ? 300 : 130); }
};

DriverVersion version_of(const PipelinePass& pass) {
  DriverVersion version{.line = pass.text.substr(0, pass.text.find('\n') + 1)};
  version.is_es = version.line.find(" es") != version.line.npos;
  version.number = std::atoi(version.line.c_str() + std::string_view{"#version "}.size());
  version.is_es = version.is_es || version.number == 100;
  return version;
}

/// A triangle over the target for a fragment shader whose inputs are the place in the picture, as
/// run_shader() has them: u, v, 0, 1.
ShaderSource vertex_text(const PipelinePass& pass) {
  const SpirvModule& module = *pass.shader.module;
  const DriverVersion version = version_of(pass);
  const std::string in = version.has_outputs() ? "in" : "attribute";
  const std::string out = version.has_outputs() ? "out " : "varying ";
  std::string head = version.line + in + " vec2 " + kCorner + ";\n", body;
  for (const auto& [id, variable] : module.variables) {
    if (variable.storage != SpirvStorage::input) continue;
    const auto decorations = module.decorations.find(id);
    if (decorations == module.decorations.end() || decorations->second.builtin >= 0) continue;
    const SpirvDecorations& of = decorations->second;
    const SpirvType& whole = module.pointed(variable.type);
    const bool is_array = whole.kind == SpirvKind::array;
    const SpirvType& type = is_array ? module.type(whole.element) : whole;
    const std::string name = glsl_type(module, type);
    if (name.empty()) {
      throw DriverError(
          pass.where + ": the input '" + of.name +
          "' is a structure or an array of arrays; for drivers a vector, a matrix or an "
          "array of them would be right");
    }
    if (of.location >= 0) {
      head.append("layout(location = ").append(std::to_string(of.location)).append(") ");
    }
    if (of.is_flat) head += "flat ";
    head.append(out).append(name).append(" ").append(of.name);
    if (is_array) head.append("[").append(std::to_string(whole.count)).append("]");
    head += ";\n";
    for (std::uint32_t i = 0; i < (is_array ? whole.count : 1); ++i) {
      body.append("  ").append(of.name);
      if (is_array) body.append("[").append(std::to_string(i)).append("]");
      body.append(" = ").append(place_of(module, type)).append(";\n");
    }
  }
  return {head + "void main() {\n  gl_Position = vec4(" + kCorner + ", 0.0, 1.0);\n" + body + "}\n",
          {"the triangle of " + pass.where}};
}

GlProgram link_pass(const GlContext& context, const PipelinePass& pass) {
  if (pass.text.empty()) {
    throw DriverError(pass.where + ": it is SPIR-V; for drivers GLSL would be right");
  }
  const SpirvModule& module = *pass.shader.module;
  for (const auto& [id, variable] : module.variables) {
    if (variable.storage == SpirvStorage::uniform) {
      throw DriverError(
          pass.where +
          ": it has uniform blocks; for drivers uniforms by themselves would be right");
    }
  }
  return link_texts(context, vertex_text(pass), {pass.text, {pass.where}});
}

}  // namespace

PipelineOnGl::PipelineOnGl(const GlContext& context, const Pipeline& pipeline,
                           const DofInput& input)
    : pipeline_(pipeline), drawn_(pipeline.passes.size()) {
  std::vector<PassRun> runs = pass_runs(pipeline, input);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const PipelinePass& pass = pipeline.passes[i];
    Pass made{link_pass(context, pass), std::move(runs[i]), {}};
    for (std::size_t k = 0; k < std::min<std::size_t>(made.run.words.size(), 2); ++k) {
      made.targets.push_back(make_target(pass.targets, made.run.width, made.run.height, false));
    }
    passes_.push_back(std::move(made));
    for (const PipelineInput& of : pass.inputs) {
      const bool is_depth =
          of.source == PipelineSource::depth || of.source == PipelineSource::buffer_depth;
      if (is_depth && !depths_.contains(of.source)) {
        depths_.emplace(of.source, upload(source_image(pipeline, input, of.source)));
      }
    }
  }
  constexpr std::array kCorners{-1.0f, -1.0f, 3.0f, -1.0f, -1.0f, 3.0f};
  GLuint corners = 0;
  glGenBuffers(1, &corners);
  corners_ = GlBuffer{corners};
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glBufferData(GL_ARRAY_BUFFER, sizeof kCorners, kCorners.data(), GL_STATIC_DRAW);
  textures_.reserve(pipeline.textures.size());
  for (const Texture& texture : pipeline.textures) textures_.push_back(upload(texture, Sampler{}));
}

const GlTexture& PipelineOnGl::texture_of(const PipelineInput& input,
                                          const GlTexture& picture) const {
  switch (input.source) {
    case PipelineSource::picture: return picture;
    case PipelineSource::depth:
    case PipelineSource::buffer_depth: return depths_.at(input.source);
    case PipelineSource::texture: return textures_[input.number];
    case PipelineSource::pass:
      if (drawn_[input.number] != nullptr) return drawn_[input.number]->colour[input.output];
      break;
    case PipelineSource::previous: break;
  }
  return last_ != nullptr ? last_->colour[0] : picture;
}

void PipelineOnGl::draw(std::size_t number, std::size_t turn, const GlTexture& picture) {
  const PipelinePass& of = pipeline_.passes[number];
  const Pass& pass = passes_[number];
  const std::vector<std::uint32_t>& words = pass.run.words[turn];
  int unit = 0;
  for (const ShaderUniform& uniform : of.shader.uniforms.all) {
    if (!is_texture(uniform)) {
      set_uniform(pass.program, uniform, std::span{words}.subspan(uniform.first, uniform.words));
      continue;
    }
    for (const PipelineInput& input : of.inputs) {
      if (input.texture != words[uniform.first]) continue;
      const bool is_cut = input.source == PipelineSource::texture &&
                          pipeline_.textures[input.number].shape == uniform.shape;
      if (uniform.shape != TextureShape::flat && !is_cut) {
        // It is not read, and must not share a unit with a sampler of another kind.
        set_uniform(pass.program, uniform.name.c_str(), unit++);
        continue;
      }
      const GlTexture& texture = texture_of(input, picture);
      const bool has_levels = input.source == PipelineSource::texture &&
                              pipeline_.textures[input.number].levels.size() > 1;
      if (input.sampler.filter == Filter::trilinear && !has_levels) generate_levels(texture);
      set_sampler(texture, input.sampler, uniform.shape);
      set_texture(pass.program, uniform.name.c_str(), unit++, texture, uniform.shape);
    }
  }
  const GlTarget& target = pass.targets[turn % pass.targets.size()];
  const auto corner = static_cast<GLuint>(glGetAttribLocation(pass.program, kCorner));
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glEnableVertexAttribArray(corner);
  glVertexAttribPointer(corner, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  draw_fullscreen(target, pass.program);
  glDisableVertexAttribArray(corner);
  drawn_[number] = last_ = &target;
}

void PipelineOnGl::run(const GlTexture& picture, const OnPass& on_pass) {
  std::fill(drawn_.begin(), drawn_.end(), nullptr);
  last_ = nullptr;
  for (std::size_t i = 0; i < passes_.size(); ++i) {
    for (std::size_t turn = 0; turn < passes_[i].run.words.size(); ++turn) {
      draw(i, turn, picture);
      if (on_pass) on_pass(i, *last_);
    }
  }
}

}  // namespace softfocus
