#include "dof/pipelines/pipeline_textures.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "raster/images/sliced_texture.h"

namespace softfocus {
namespace {

[[noreturn]] void fail_texture(const PipelinePass& pass, const ShaderUniform& of,
                               const std::string& why) {
  throw ShaderError(pass.where + ": the shader's texture '" + of.name + "' is a " +
                    std::string{sampler_name(of.shape)} + why);
}

void bind_rest(const Pipeline& pipeline, PipelinePass& pass, const std::vector<bool>& used,
               std::string_view how_to_name) {
  std::string left;
  for (const ShaderUniform& of : pass.shader.uniforms.all) {
    if (!is_texture(of)) continue;
    const std::uint32_t number = pass.shader.uniforms.words[of.first];
    const bool is_bound =
        std::any_of(pass.inputs.begin(), pass.inputs.end(),
                    [&](const PipelineInput& input) { return input.texture == number; });
    if (is_bound) continue;
    std::optional<PipelineInput> input = source_named(pipeline, of.name);
    if (!input && used[number] && of.shape != TextureShape::flat) {
      fail_texture(pass, of,
                   "; a picture of its slices would be right, by --texture " + of.name +
                       "=FILE or [textures] " + of.name + " = \"FILE\"");
    }
    if (!input) {
      input = PipelineInput{};
      if (used[number]) {
        if (!left.empty()) {
          throw UnnamedTextures(pass.where + ": the shader reads textures '" + left + "' and '" +
                                of.name + "'; " + std::string{how_to_name});
        }
        left = of.name;
      }
    }
    input->texture = number;
    pass.inputs.push_back(*input);
  }
}

Image upside_down(const Image& image) {
  Image turned = make_image(image.format, image.width, image.height);
  const auto rows = static_cast<std::size_t>(image.height);
  for (std::size_t y = 0; y < rows; ++y) {
    std::memcpy(&turned.bytes[(rows - 1 - y) * turned.stride_bytes],
                &image.bytes[y * image.stride_bytes], image.stride_bytes);
  }
  return turned;
}

/// Why an input cannot be read as that shape; "" if it can.
std::string why_not_read(const Pipeline& pipeline, const ShaderUniform& of,
                         const PipelineInput& input) {
  if (input.source != PipelineSource::texture) {
    return ", and it is to read what is drawn; a file would be right";
  }
  const Image& picture = pipeline.textures[input.number].levels[0];
  const std::string why = why_not_cut(picture.width, picture.height, of.shape);
  return why.empty() ? why : ", and its file's " + why;
}

/// A texture of a file, which is flat, as the shader reads it.
Texture cut_input(const Pipeline& pipeline, TextureShape shape, const PipelineInput& input) {
  const Texture& flat = pipeline.textures[input.number];
  const Image& picture = flat.levels[0];
  // Slices have their first row at v = 0 in every convention, as textures of data have.
  Texture cut = cut_texture(pipeline.by_codes ? upside_down(picture) : picture, shape);
  const bool has_levels = flat.levels.size() > 1 || input.sampler.filter == Filter::trilinear;
  if (has_levels) generate_mipmaps(cut, {});
  return cut;
}

}  // namespace

void bind_textures(Pipeline& pipeline, PipelinePass& pass, const ShaderProgram& program,
                   std::string_view how_to_name) {
  const std::vector<bool> used = sampled_textures(program, pass.shader.uniforms.texture_count);
  bind_rest(pipeline, pass, used, how_to_name);
  for (const ShaderUniform& of : pass.shader.uniforms.all) {
    if (!is_texture(of) || of.shape == TextureShape::flat) continue;
    const std::uint32_t number = pass.shader.uniforms.words[of.first];
    for (PipelineInput& input : pass.inputs) {
      if (input.texture != number) continue;
      // What these parameters do not read others may.
      const std::string why = why_not_read(pipeline, of, input);
      if (!why.empty() && used[number]) fail_texture(pass, of, why);
      if (!why.empty()) continue;
      Texture cut = cut_input(pipeline, of.shape, input);
      input.number = pipeline.textures.size();
      pipeline.textures.push_back(std::move(cut));
    }
  }
}

}  // namespace softfocus
