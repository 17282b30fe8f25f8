#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "raster/shaders/shader_math.h"

#include <array>
#include <bit>

#define SOFTFOCUS_KERNELS "raster/shaders/shader_math.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void evaluate(ShaderFunction function, const float* a, const float* b, int count, float* to,
              Isa isa) {
  SOFTFOCUS_KERNEL(isa, evaluate_values)(function, a, b != nullptr ? b : a, count, to);
}

}  // namespace softfocus

#else  // the kernels

#include "raster/shaders/math_lanes.inl"

template <ShaderFunction function>
SOFTFOCUS_INLINE Floats value_of(Floats a, [[maybe_unused]] Floats b) {
  if constexpr (function == ShaderFunction::sine) return sine(a);
  if constexpr (function == ShaderFunction::cosine) return cosine(a);
  if constexpr (function == ShaderFunction::tangent) return tangent(a);
  if constexpr (function == ShaderFunction::arcsine) return arcsine(a);
  if constexpr (function == ShaderFunction::arccosine) return arccosine(a);
  if constexpr (function == ShaderFunction::arctangent) return arctangent(a);
  if constexpr (function == ShaderFunction::arctangent_of_two) return arctangent(a, b);
  if constexpr (function == ShaderFunction::hyperbolic_sine) return hyperbolic_sine(a);
  if constexpr (function == ShaderFunction::hyperbolic_cosine) return hyperbolic_cosine(a);
  if constexpr (function == ShaderFunction::hyperbolic_tangent) return hyperbolic_tangent(a);
  if constexpr (function == ShaderFunction::inverse_hyperbolic_sine)
    return inverse_hyperbolic_sine(a);
  if constexpr (function == ShaderFunction::inverse_hyperbolic_cosine)
    return inverse_hyperbolic_cosine(a);
  if constexpr (function == ShaderFunction::inverse_hyperbolic_tangent)
    return inverse_hyperbolic_tangent(a);
  if constexpr (function == ShaderFunction::exponential) return exponential(a);
  if constexpr (function == ShaderFunction::logarithm) return logarithm(a);
  if constexpr (function == ShaderFunction::binary_exponential) return binary_exponential(a);
  if constexpr (function == ShaderFunction::binary_logarithm) return binary_logarithm(a);
  if constexpr (function == ShaderFunction::power) return power(a, b);
  if constexpr (function == ShaderFunction::inverse_square_root) return inverse_square_root(a);
}

template <ShaderFunction function>
void evaluate_all(const float* a, const float* b, int count, float* to) {
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    store(to + i, value_of<function>(load(a + i), load(b + i)));
  }
  if (i == count) return;
  std::array<float, kLanes> last_a{};
  std::array<float, kLanes> last_b{};
  const std::size_t size = sizeof(float) * static_cast<std::size_t>(count - i);
  std::memcpy(last_a.data(), a + i, size);
  std::memcpy(last_b.data(), b + i, size);
  store(last_a.data(), value_of<function>(load(last_a.data()), load(last_b.data())));
  std::memcpy(to + i, last_a.data(), size);
}

using EvaluateAll = void (*)(const float*, const float*, int, float*);
template <std::size_t... function>
constexpr std::array<EvaluateAll, sizeof...(function)> all_functions(
    std::index_sequence<function...>) {
  return {evaluate_all<static_cast<ShaderFunction>(function)>...};
}

void evaluate_values(ShaderFunction function, const float* a, const float* b, int count,
                     float* to) {
  static constexpr auto kAll = all_functions(std::make_index_sequence<kShaderFunctions>{});
  kAll[static_cast<std::size_t>(function)](a, b, count, to);
}

#endif
