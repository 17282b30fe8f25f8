#pragma once
// Textures made by a formula. The texels are LINEAR 8-bit values (Format::rgba8), so
// that a driver samples the very same numbers without an sRGB decoder of its own.

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "raster/images/sampler.h"

namespace softfocus {

struct TextureRecipe {
  int size = 256;  ///< texels along a side, a power of two, 1 to kMaxTextureSize
  /// How often the pattern's unit fits along a side, 1 to 256: fields of a checker,
  /// courses of bricks, coarsest waves of a noise.
  int cells = 8;
  std::vector<glm::vec3> colours;  ///< linear, 0 to 1; as many as the pattern has
  std::uint64_t seed = 1;          ///< of the patterns that have an accident in them
};

inline constexpr int kMaxTextureSize = 4096;

struct TexturePattern {
  std::string_view name;
  std::string_view colours;  ///< what each colour is for, one word each
  std::size_t colour_count;
  /// The colour at (u, v), 0 to 1, v down. Repeats without a seam (a checker and its
  /// kin where `cells` is even).
  glm::dvec3 (*colour_at)(const TextureRecipe& recipe, double u, double v);
};

std::span<const TexturePattern> texture_patterns();

/// The pattern of that name, or nullptr.
const TexturePattern* find_texture_pattern(std::string_view name);

/// The texture with all its mipmaps (of the ieee profile). Each texel is the mean of
/// the pattern at 2x2 points in it. Needs a recipe within the limits above.
Texture make_procedural_texture(const TexturePattern& pattern, const TextureRecipe& recipe);

}  // namespace softfocus
