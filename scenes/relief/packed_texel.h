#pragma once
// A relief's colours and normals as they are stored.

#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "raster/numbers/vector_math.h"

namespace softfocus {

/// Three halves of linear light; `codes` has linear_to_srgb8() of each half.
inline std::uint32_t packed_colour(const std::uint16_t* texel,
                                   const std::vector<std::uint8_t>& codes) {
  return std::uint32_t{codes[texel[0]]} | std::uint32_t{codes[texel[1]]} << 8 |
         std::uint32_t{codes[texel[2]]} << 16 | 0xFF000000u;
}

/// Of any length above 0.
inline std::uint32_t packed_normal(glm::vec3 normal) {
  const glm::vec3 unit = normalize(normal);
  const auto byte = [](float v) {
    return static_cast<std::uint32_t>(std::lrint(127.0f * v + 128.0f));
  };
  return byte(unit.x) | byte(unit.y) << 8 | byte(unit.z) << 16;
}

}  // namespace softfocus
