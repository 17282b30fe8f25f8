#pragma once
// A module of SPIR-V (Khronos, SPIR-V Specification 1.6), read into tables: what its types,
// constants, variables and functions are. Everything that the words promise of each other is
// checked here, so that what walks the tables need not: ids are defined, once, and are what they
// stand for.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raster/shaders/shader_error.h"
#include "raster/shaders/spirv_words.h"

namespace softfocus {

using SpirvId = std::uint32_t;  ///< 0: none

/// Where in its source an instruction comes from (OpLine).
struct ShaderLine {
  SpirvId file = 0;
  std::uint32_t line = 0;  ///< from 1 on; 0: not known
};

struct SpirvInstruction {
  SpirvOp op{};
  SpirvId type = 0, result = 0;
  std::span<const std::uint32_t> operands{};  ///< behind type and result
  ShaderLine line{};
};

enum class SpirvKind : std::uint8_t {
  none,  ///< void
  boolean,
  integer,
  floating,
  vector,
  matrix,
  array,
  structure,
  pointer,
  function,
  image,
  sampler,
  sampled_image,
};

struct SpirvType {
  SpirvKind kind = SpirvKind::none;
  bool is_signed = false;
  /// Of a vector its components', of a matrix its columns', of an array its elements', of a pointer
  /// what it points to, of a function what it returns, of an image what a texel has, of a sampled
  /// image the image.
  SpirvId element = 0;
  std::uint32_t count = 0;         ///< of a vector, matrix or array
  std::vector<SpirvId> members{};  ///< of a structure; of a function its parameters
  SpirvStorage storage{};          ///< of a pointer
  SpirvDim dim{};                  ///< of an image
  bool is_arrayed = false, is_shadow = false, is_multisampled = false;
  /// Scalars of 32 bits that a value consists of, a double of two; 0 of what holds none.
  std::uint32_t scalars = 0;
  int depth = 0;  ///< of arrays and structures inside it
};

/// Decorations of an id, or of a structure's member.
struct SpirvDecorations {
  std::string name{};
  int location = -1, component = 0, binding = -1, index = 0;
  int builtin = -1;  ///< a SpirvBuiltin
  int offset = -1, array_stride = -1, matrix_stride = -1;
  int constant = -1;  ///< SpecId
  bool is_flat = false, is_linear = false, is_block = false, is_row_major = false;
  bool is_relaxed = false, is_invariant = false;  ///< what linking alone asks for
  std::vector<SpirvDecorations> members{};
};

/// A scalar or composite constant as the bits of its scalars; undefined ones are 0.
struct SpirvConstant {
  SpirvId type = 0;
  std::vector<std::uint32_t> words{};
};

struct SpirvVariable {
  SpirvId id = 0, type = 0;  ///< the pointer's
  SpirvStorage storage{};
  SpirvId initial = 0;  ///< a constant
};

/// Instructions up to a branch or an end, which is the last.
struct SpirvBlock {
  SpirvId label = 0;
  std::vector<SpirvInstruction> instructions{};
  /// Of OpSelectionMerge and OpLoopMerge, which are not among the instructions.
  SpirvId merge = 0, continues = 0;  ///< `continues`: of a loop alone
};

struct SpirvFunction {
  SpirvId id = 0, type = 0, returns = 0;
  std::vector<SpirvInstruction> parameters{};
  std::vector<SpirvVariable> variables{};
  std::vector<SpirvBlock> blocks{};           ///< the first is where it begins
  std::map<SpirvId, std::size_t> block_of{};  ///< by label
};

enum class ShaderStage : std::uint8_t { vertex, fragment };

struct SpirvModule {
  std::vector<std::uint32_t> words{};  ///< that instructions' operands lie in
  ShaderStage stage{};
  SpirvId main = 0;
  bool origin_is_upper_left = false, depth_replacing = false;
  int glsl_version = 0;  ///< 110 to 460; of ES and other languages 0
  int es_version = 0;    ///< 100 to 320; of other languages 0
  std::map<SpirvId, SpirvType> types{};
  std::map<SpirvId, SpirvConstant> constants{};
  std::map<SpirvId, SpirvVariable> variables{};  ///< of the module
  std::map<SpirvId, SpirvFunction> functions{};
  std::map<SpirvId, SpirvDecorations> decorations{};
  std::map<SpirvId, std::string> strings{};
  SpirvId glsl = 0;  ///< of "GLSL.std.450"
  bool has_doubles = false;

  const SpirvType& type(SpirvId id) const { return types.at(id); }
  const SpirvType& pointed(SpirvId pointer) const { return type(type(pointer).element); }
};

/// What a module may have at the most: a shader that a person wrote has less.
inline constexpr std::size_t kMostSpirvWords = std::size_t{1} << 22;
inline constexpr std::uint32_t kMostScalars = 1u << 16;                    ///< of a value
inline constexpr std::size_t kMostConstantScalars = std::size_t{1} << 22;  ///< of all constants
inline constexpr int kDeepestTypes = 64;

/// The words of a file, of either byte order. Throws ShaderError.
std::vector<std::uint32_t> spirv_words(std::span<const std::byte> file);

/// Reads and checks a module of a vertex or fragment shader. Throws ShaderError for what is damaged
/// and for what is not supported (other stages, integers of other than 32 bits, storage buffers).
SpirvModule read_spirv(std::vector<std::uint32_t> words);

/// "FILE:LINE: ", or nothing if the module does not say.
std::string place_of(const std::map<SpirvId, std::string>& strings, ShaderLine line);
inline std::string place_of(const SpirvModule& module, ShaderLine line) {
  return place_of(module.strings, line);
}

}  // namespace softfocus
