#pragma once
// Textures made by a formula. The texels are LINEAR 8-bit values (Format::rgba8), so
// that a driver samples the very same numbers without an sRGB decoder of its own.

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "raster/images/sampler.h"
#include "raster/threads/parallel.h"

namespace softfocus {

// Opacity from a picture, as `map_d` of materials and `opacity_texture` of scenes name one.

/// Format::rgba8 with all its mipmaps (of the ieee profile); the four channels of a texel are its
/// opacity. That is the picture's alpha if any texel's is below 1, or else the mean of red, green
/// and blue, rounded, as the file has them: a mask is no colour, and is not decoded. Needs a
/// picture of Format::rgba8 or srgb8.
Texture make_opacity_texture(const Image& picture);

/// Whether each texel of level 0 is 0 or 1. Such a surface needs no blending.
bool is_cut_out(const Texture& opacity);

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

struct ProceduralTexture {
  const TexturePattern* pattern;
  TextureRecipe recipe;
};

/// The textures with all their mipmaps (of the ieee profile). Each texel is the mean of
/// the pattern at 2x2 points in it. Needs recipes within the limits above. Without a pool on this
/// thread.
std::vector<Texture> make_procedural_textures(std::span<const ProceduralTexture> wanted,
                                              ThreadPool* pool);

/// One, on this thread.
Texture make_procedural_texture(const TexturePattern& pattern, const TextureRecipe& recipe);

}  // namespace softfocus
