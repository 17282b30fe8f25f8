#pragma once
// The transcendental functions of GLSL with defined bits: binary32 (binary64 where said) + - * /
// and square roots in a fixed order, the same on every vector unit. Methods, errors and special
// values: docs/specification.md, "Functions of shaders". A kernel file includes math_lanes.inl;
// the function here is for tests and tools.

#include <cstdint>

#include "raster/lanes/isa.h"

namespace softfocus {

enum class ShaderFunction : std::uint8_t {
  sine,
  cosine,
  tangent,
  arcsine,
  arccosine,
  arctangent,
  arctangent_of_two,  ///< atan(a, b)
  hyperbolic_sine,
  hyperbolic_cosine,
  hyperbolic_tangent,
  inverse_hyperbolic_sine,
  inverse_hyperbolic_cosine,
  inverse_hyperbolic_tangent,
  exponential,
  logarithm,
  binary_exponential,
  binary_logarithm,
  power,  ///< pow(a, b)
  inverse_square_root,
};
inline constexpr int kShaderFunctions = 19;

/// Of each of `count` values, on a unit of this CPU; `scalar` takes the least. `b` may be null but
/// for the functions of two values. `to` may be one of the two.
void evaluate(ShaderFunction function, const float* a, const float* b, int count, float* to,
              Isa isa);

}  // namespace softfocus
