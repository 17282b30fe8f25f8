#pragma once
// A user's shader on the emulated GPU: SPIR-V, with uniforms and textures, over every pixel of some
// targets. docs/shaders.md says what a shader may be, docs/specification.md what each operation
// gives: the same bits on every machine.

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
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
  std::unique_ptr<SpirvModule> module{};
  ShaderUniforms uniforms{};
};

/// Inputs of a vertex shader and outputs of a fragment shader that have no location get one. Throws
/// ShaderError.
UserShader make_shader(std::vector<std::uint32_t> words);

/// The uniform of that name ("tint", "light.colour", "tint[0]" is "tint"), or null.
const ShaderUniform* find_uniform(const UserShader& shader, std::string_view name);

/// The bits of a number as a uniform of that kind has them; nothing if it cannot be one.
std::optional<std::uint32_t> uniform_word(const ShaderUniform& of, double value);

/// A shader with its uniforms: `words` as ShaderUniforms has them. With `is_late`, the words that
/// it marks are given when the shader runs (BatchSettings::uniforms), and the program is slower.
/// With `are_places`, for run_shader() without varyings alone, and faster. Throws ShaderError.
ShaderProgram compile_shader(const UserShader& shader, std::span<const std::uint32_t> words,
                             const std::vector<bool>& is_late = {}, bool are_places = false);

/// Which of a shader's textures a program samples, by their numbers.
std::vector<bool> sampled_textures(const ShaderProgram& program, std::size_t count);

/// A number that every pixel is given, by an input of the shader.
struct PassVarying {
  int location = 0, component = 0;
  float value = 0.0f;
};

struct ShaderPass {
  std::span<const ShaderTexture> textures{};  ///< by their numbers
  /// By location; those without texels are left out. All of one size. Whole numbers go into
  /// rgba32f, bit by bit.
  std::span<const ImageView> targets{};
  /// Inputs that are not among them are the place in the picture: u, v, 0, 1.
  std::span<const PassVarying> varyings{};
  Profile profile{};
  /// Turns of loops that a batch of pixels may take.
  std::uint64_t budget = std::uint64_t{1} << 24;
  int lanes = 0;  ///< that run together, for tests; 0: as many as are fastest
  std::span<const std::uint32_t> uniforms{};  ///< all words, for a program with late ones
};

/// Runs the shader at every pixel. gl_FragCoord is (x + 1/2, y + 1/2, 1/2, 1) of column x and row
/// y, the first row 0. What a shader does not write is 0, and what it discards stays. Throws
/// ShaderError if a loop takes more turns than the budget has.
void run_shader(const ShaderProgram& program, const ShaderPass& pass, ThreadPool& pool);

/// What vertices are given at a location of a vertex shader: numbers of 32 bits, floats or whole
/// numbers as the shader has them.
struct VertexAttribute {
  int location = 0;
  int components = 4;                ///< 1 to 4; those behind them are 0, 0, 0, 1
  const std::byte* first = nullptr;  ///< of vertex 0
  std::size_t stride = 0;            ///< bytes from a vertex to the next
};

/// A number that goes from a vertex shader to a fragment shader.
struct ShaderVarying {
  int location = 0, component = 0;
};

struct VertexRun {
  std::uint32_t vertex_count = 0;
  std::span<const VertexAttribute> attributes{};  ///< others are 0, 0, 0, 1
  std::span<const ShaderTexture> textures{};      ///< by their numbers
  std::span<const ShaderVarying> varyings{};      ///< that are wanted
  std::span<glm::vec4> positions{};               ///< gl_Position of each vertex
  /// The bits of the varyings: vertex by vertex, each vertex's in the order of `varyings`.
  std::span<std::uint32_t> values{};
  Profile profile{};
  std::uint64_t budget = std::uint64_t{1} << 24;  ///< as ShaderPass has it
  int lanes = 0;                                  ///< likewise
  std::span<const std::uint32_t> uniforms{};      ///< all words, for a program with late ones
};

/// Runs a vertex shader at every vertex. gl_VertexID and gl_VertexIndex are its number, other
/// built-ins 0. What a shader does not write is 0. Throws ShaderError as run_shader() does.
void run_vertices(const ShaderProgram& program, const VertexRun& run, ThreadPool& pool);

}  // namespace softfocus
