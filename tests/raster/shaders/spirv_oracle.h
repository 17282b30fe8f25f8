#pragma once
// SPIR-V for one pixel, as the specification reads: blocks one after the other, memory as numbers,
// calls that call. No masks, no inlining, nothing known beforehand. Only the arithmetic of single
// numbers is the shaders' own (fold_shader_op).

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "raster/shaders/shader_lanes.h"
#include "raster/shaders/spirv_module.h"

namespace softfocus::test {

struct OracleSettings {
  std::span<const std::uint32_t> uniforms{};  ///< as ShaderUniforms::words
  std::span<const ShaderTexture> textures{};
  Profile profile{};
  /// The bits of a number of an input: its decorations, and which number of it.
  std::function<std::uint32_t(const SpirvDecorations&, std::uint32_t)> input{};
  std::uint64_t most_blocks = 20000;  ///< that a pixel may run
};

struct OracleResult {
  bool is_killed = false, is_stopped = false;             ///< stopped: it ran too many blocks
  std::array<std::array<std::uint32_t, 4>, 8> outputs{};  ///< by location
};

/// Needs a valid module of a fragment shader without derivatives.
OracleResult run_oracle(const SpirvModule& module, const OracleSettings& settings);

}  // namespace softfocus::test
