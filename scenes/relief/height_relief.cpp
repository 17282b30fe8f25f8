#include "scenes/relief/height_relief.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "raster/numbers/srgb.h"
#include "raster/numbers/vector_math.h"
#include "scenes/relief/relief_texture.h"

namespace softfocus {
namespace {

/// Upwards, of length 1: from the neighbours on both sides, or on one beside a hole or border.
glm::dvec3 normal_at(const HeightField& field, int x, int y) {
  const auto height_at = [&](int u, int v) {
    if (u < 0 || v < 0 || u >= field.width || v >= field.height) return HUGE_VAL;
    return static_cast<double>(
        field.heights[static_cast<std::size_t>(v) * static_cast<std::size_t>(field.width) +
                      static_cast<std::size_t>(u)]);
  };
  const auto slope = [&](double before, double after) {
    const double here = height_at(x, y);
    if (std::isfinite(before) && std::isfinite(after)) return 0.5 * (after - before);
    if (std::isfinite(after)) return after - here;
    return std::isfinite(before) ? here - before : 0.0;
  };
  const double right = slope(height_at(x - 1, y), height_at(x + 1, y));
  const double up = slope(height_at(x, y + 1), height_at(x, y - 1));
  return normalize(glm::dvec3{-right, -up, 1.0});
}

/// At most .9 of white.
std::uint32_t lit_white(glm::dvec3 normal) {
  const glm::dvec3 to_light = normalize(glm::dvec3{-1.0, 1.0, 1.5});
  const double light = 0.4 + 0.5 * std::max(0.0, dot(normal, to_light));
  const std::uint32_t code = linear_to_srgb8(static_cast<float>(light));
  return code | code << 8 | code << 16 | 0xFF000000u;
}

}  // namespace

std::optional<ReliefTexture> relief_of_heights(const HeightField& field, const HeightForm& form) {
  assert(field.width >= 1 && field.width <= kMostReliefSize && field.height >= 1 &&
         field.height <= kMostReliefSize);
  float low = HUGE_VALF, high = -HUGE_VALF;
  for (const float height : field.heights) {
    if (!std::isfinite(height)) continue;
    low = std::min(low, height);
    high = std::max(high, height);
  }
  if (low > high) return std::nullopt;
  const double top = static_cast<double>(high);
  const double range = high > low ? top - static_cast<double>(low) : 1.0;

  ReliefTexture relief;
  relief.width = field.width;
  relief.height = field.height;
  relief.depth_bits = form.depth_bits;
  relief.camera = {{-0.5 * (field.width - 1) * form.texel_m,
                    0.5 * (field.height - 1) * form.texel_m, top * form.texel_m},
                   {form.texel_m, 0.0, 0.0},
                   {0.0, -form.texel_m, 0.0},
                   {0.0, 0.0, -1.0},
                   range * form.texel_m};
  const std::size_t texels = field.heights.size();
  relief.depths.assign(texels, empty_depth(form.depth_bits));
  relief.colours.assign(texels, 0);
  if (form.with_normals) relief.normals.assign(texels, 0);
  const double codes = last_depth(form.depth_bits) / range;
  for (int y = 0; y < field.height; ++y) {
    for (int x = 0; x < field.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(field.width) +
                             static_cast<std::size_t>(x);
      if (!std::isfinite(field.heights[at])) continue;
      const double depth = top - static_cast<double>(field.heights[at]);
      relief.depths[at] = static_cast<std::uint16_t>(std::lrint(depth * codes));
      const glm::dvec3 normal = normal_at(field, x, y);
      relief.colours[at] =
          field.colours.empty() ? lit_white(normal) : field.colours[at] | 0xFF000000u;
      if (form.with_normals) relief.normals[at] = packed_normal(glm::vec3{normal});
    }
  }
  return relief;
}

}  // namespace softfocus
