#pragma once
// A user's shader on the emulated GPU: SPIR-V, with uniforms and textures, over every pixel of some
// targets. docs/shaders.md says what a shader may be, docs/specification.md what each operation
// gives: the same bits on every machine.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/shaders/lower_spirv.h"
#include "raster/shaders/shader_lanes.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// A shader whose uniforms are not set yet.
struct UserShader {
  std::unique_ptr<const SpirvModule> module{};
  ShaderUniforms uniforms{};
};

/// Throws ShaderError.
UserShader make_shader(std::vector<std::uint32_t> words);

/// The uniform of that name ("tint", "light.colour", "tint[0]" is "tint"), or null.
const ShaderUniform* find_uniform(const UserShader& shader, std::string_view name);

inline bool is_texture(const ShaderUniform& of) {
  return of.kind == SpirvKind::sampled_image || of.kind == SpirvKind::image ||
         of.kind == SpirvKind::sampler;
}

/// The bits of a number as a uniform of that kind has them; nothing if it cannot be one.
std::optional<std::uint32_t> uniform_word(const ShaderUniform& of, double value);

/// A shader with its uniforms: `words` as ShaderUniforms has them. Throws ShaderError.
ShaderProgram compile_shader(const UserShader& shader, std::span<const std::uint32_t> words);

/// A number that every pixel is given, by an input of the shader.
struct PassVarying {
  int location = 0, component = 0;
  float value = 0.0f;
};

struct ShaderPass {
  std::span<const ShaderTexture> textures{};  ///< by their numbers
  /// By location; those without texels are left out. All of one size.
  std::span<const ImageView> targets{};
  /// Inputs that are not among them are the place in the picture: u, v, 0, 1.
  std::span<const PassVarying> varyings{};
  Profile profile{};
  /// Turns of loops that a batch of pixels may take.
  std::uint64_t budget = std::uint64_t{1} << 24;
  int lanes = 0;  ///< that run together, for tests; 0: as many as are fastest
};

/// Runs the shader at every pixel. gl_FragCoord is (x + 1/2, y + 1/2, 1/2, 1) of column x and row
/// y, the first row 0. What a shader does not write is 0, and what it discards stays. Throws
/// ShaderError if a loop takes more turns than the budget has.
void run_shader(const ShaderProgram& program, const ShaderPass& pass, ThreadPool& pool);

}  // namespace softfocus
