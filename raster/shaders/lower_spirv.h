#pragma once
// From SPIR-V to a tree of scalar instructions (shader_ir.h).

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "raster/shaders/shader_ir.h"

namespace softfocus {

/// A uniform: what a shader is given once for all pixels. Structures and blocks are taken apart:
/// "light.colour", "lights[1].colour"; an array of numbers, vectors or matrices is one.
struct ShaderUniform {
  std::string name{};
  SpirvKind kind{};              ///< floating, integer or boolean; sampled_image, image or sampler
  bool is_signed = false;        ///< integers, and a texture's
  bool is_shadow = false;        ///< a texture is compared with
  SpirvDim dim = SpirvDim::two;  ///< of a texture
  TextureShape shape = TextureShape::flat;
  std::uint32_t rows = 1, columns = 1;
  std::uint32_t count = 0;  ///< elements of an array; 0 if it is none
  std::uint32_t first = 0;  ///< its first word, of the words of all uniforms
  std::uint32_t words = 1;
};

inline bool is_texture(const ShaderUniform& uniform) {
  return uniform.kind == SpirvKind::sampled_image || uniform.kind == SpirvKind::image ||
         uniform.kind == SpirvKind::sampler;
}

struct ShaderUniforms {
  std::vector<ShaderUniform> all{};
  /// What they are unless they are set: 0, or the shader's own values. A texture's words are its
  /// number, for the image and for its sampler.
  std::vector<std::uint32_t> words{};
  std::uint32_t texture_count = 0;
};

ShaderUniforms uniforms_of(const SpirvModule& module);

/// The tree of a module whose uniforms are `words`. Those words that `is_late` marks, if it is not
/// empty, are known only when the shader runs. Throws ShaderError for what is not supported, and
/// for control flow that is not structured.
ShaderTree lower_spirv(const SpirvModule& module, std::span<const std::uint32_t> words,
                       const std::vector<bool>& is_late = {});

}  // namespace softfocus
