#pragma once
// What a shader is given and gives besides built-ins, by location and name; and how a vertex
// shader's outputs become a fragment shader's inputs.

#include <string>
#include <string_view>
#include <vector>

#include "raster/shaders/shader.h"

namespace softfocus {

/// An input or output that is no built-in. Of a block each member is one: "Block.member".
struct ShaderPort {
  std::string name{};
  int location = -1, component = 0;  ///< -1: left to linking
  int locations = 1;                 ///< that it takes
  std::vector<SpirvKind> numbers{};  ///< each of its words: floating, integer or boolean
  bool is_used = true;               ///< by an instruction; of a block, whether any member is
  SpirvId of = 0;                    ///< the variable or the block's type
  int member = -1;                   ///< of the block
};

std::vector<ShaderPort> inputs_of(const SpirvModule& module);
std::vector<ShaderPort> outputs_of(const SpirvModule& module);

/// Gives a location to inputs of a vertex shader and outputs of a fragment shader that have none.
void give_locations(SpirvModule& module);

/// Gives a location to all inputs and outputs that have none: those of one name in both shaders
/// get the same. gl_Color of a fragment shader is gl_FrontColor of the vertex shader, and
/// gl_SecondaryColor likewise. Uniforms of one name get the same initial values. Throws ShaderError
/// if the shaders are not of these stages, if an input of the fragment shader has no output, or if
/// an input and its output, or a uniform of both, are of two types.
void link_shaders(UserShader& vertex, UserShader& fragment);

/// Two shaders that are linked.
struct ShaderPair {
  UserShader vertex{}, fragment{};
};

/// Throws ShaderError as make_shader() and link_shaders() do.
ShaderPair make_shader_pair(std::vector<std::uint32_t> vertex_words,
                            std::vector<std::uint32_t> fragment_words);

}  // namespace softfocus
