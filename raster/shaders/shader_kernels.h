#pragma once
// One form of every operation, for constants, for values that do not vary and for lanes.

#include <cstdint>

#include "raster/shaders/shader_ir.h"

namespace softfocus {

/// What an operation before ShaderOp::derivative_x makes of numbers that are known.
std::uint32_t fold_shader_op(ShaderOp op, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                             std::uint32_t d = 0);

}  // namespace softfocus
