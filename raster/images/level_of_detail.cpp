#include "raster/images/level_of_detail.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "raster/numbers/exact_math.h"

namespace softfocus {
namespace {

constexpr int kMantissaBits = 23;
constexpr std::uint32_t kMantissaMask = 0x7FFFFF;

float larger(float a, float b) { return a > b ? a : b; }

// The larger squared length of two differences, in texels.
float largest_square(glm::vec2 uv_per_x, glm::vec2 uv_per_y, float width, float height) {
  const auto squared_length = [&](glm::vec2 uv) {
    const float s = uv.x * width;
    const float t = uv.y * height;
    return s * s + t * t;
  };
  return larger(squared_length(uv_per_x), squared_length(uv_per_y));
}

int exponent_of(std::uint32_t bits) { return static_cast<int>(bits >> kMantissaBits & 0xFF) - 127; }

std::array<float, 257> logarithms() {
  std::array<float, 257> table{};
  for (std::size_t k = 0; k < table.size(); ++k) {
    table[k] = static_cast<float>(exact_math::log2(1.0 + static_cast<double>(k) / 256.0));
  }
  return table;
}

}  // namespace

float log2_linear(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const auto mantissa = std::bit_cast<float>((bits & kMantissaMask) | 0x3F800000u);
  return static_cast<float>(exponent_of(bits) - 1) + mantissa;
}

float log2_by_table(float x) {
  static const std::array<float, 257> table = logarithms();
  const auto bits = std::bit_cast<std::uint32_t>(x);
  constexpr int kCut = kMantissaBits - 8;
  const std::uint32_t index = ((bits & kMantissaMask) + (1u << (kCut - 1))) >> kCut;
  return static_cast<float>(exponent_of(bits)) + table[index];
}

float log2_of_root_by_bits(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x * x);
  return (static_cast<float>(bits) - 0x1.FCp+29f) * 0x1p-25f;
}

float level_of_detail(const Texture& texture, glm::vec2 uv_per_x, glm::vec2 uv_per_y,
                      const Profile& profile) {
  const auto width = static_cast<float>(texture.levels.front().width);
  const auto height = static_cast<float>(texture.levels.front().height);
  if (profile.texture_unit == TextureUnit::swiftshader) {
    return log2_of_root_by_bits(largest_square(uv_per_x, uv_per_y, width, height));
  }
  if (profile.texture_unit != TextureUnit::softpipe) {
    return level_of_detail(texture, uv_per_x, uv_per_y);
  }
  const float along_u = larger(std::fabs(uv_per_x.x), std::fabs(uv_per_y.x)) * width;
  const float along_v = larger(std::fabs(uv_per_x.y), std::fabs(uv_per_y.y)) * height;
  return log2_by_table(larger(along_u, along_v));
}

float level_of_detail(const Texture& texture, glm::vec2 uv_per_x, glm::vec2 uv_per_y) {
  const auto width = static_cast<float>(texture.levels.front().width);
  const auto height = static_cast<float>(texture.levels.front().height);
  return 0.5f * log2_linear(largest_square(uv_per_x, uv_per_y, width, height));
}

}  // namespace softfocus
