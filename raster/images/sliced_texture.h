#pragma once
// Textures of layers, slices or faces: OpenGL 4.6, section 8.13 and 8.14. Each slice is a flat
// texture. Array layers are sampled as flat textures by any profile's unit; volumes and cubes by
// llvmpipe's float filter or, for the other units, by the standard one.

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "raster/images/sampler.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// Layers, slices or faces of a level; 1 of a flat texture.
int slice_count(const Texture& texture, std::size_t level = 0);

/// GLSL's name of what reads such a texture: "sampler3D".
constexpr std::string_view sampler_name(TextureShape shape) {
  constexpr std::array<std::string_view, 4> kNames{"sampler2D", "sampler2DArray", "sampler3D",
                                                   "samplerCube"};
  return kNames[static_cast<std::size_t>(shape)];
}

/// Needs 0 <= slice < slice_count(texture, level).
inline const Image& slice_level(const Texture& texture, int slice, std::size_t level) {
  return slice == 0 ? texture.levels[level]
                    : texture.behind[static_cast<std::size_t>(slice) - 1].levels[level];
}

/// A texture of one level. Slices are of one format and size; a cube has six, and they are square.
Texture make_sliced_texture(TextureShape shape, std::vector<Image> slices);

/// generate_mipmaps() of what is not flat.
void generate_sliced_mipmaps(Texture& texture, const Profile& profile);

/// Why a picture of that size cannot be cut into slices, and what would be right; "" if it can.
/// A cube is a row or column of six squares, or a cross of 4 x 3:
///        +y
///     -x +z +x -z
///        -y
/// A volume or array is a row or column of squares, at least two.
std::string why_not_cut(int width, int height, TextureShape shape);

/// Cuts a picture for which why_not_cut() says nothing. The first row of a slice is its picture's.
Texture cut_texture(const Image& picture, TextureShape shape);

/// Where a direction meets a cube: its face, and the place there. The main axis is z unless
/// |z| < |x| or |z| < |y|, then y if |x| <= |y|, else x; if its part is NaN, the face is the
/// positive one. By face, s and t are
///   +x -z, -y   -x z, -y   +y x, z   -y x, -z   +z x, -y   -z -x, -y
/// of the direction, times h = 0.5 / |its main part|, plus 0.5.
struct CubePlace {
  int face = 0;
  glm::vec2 at{};
};
CubePlace cube_place(glm::vec3 direction);

/// A texel of a face from 0 to 5, or one that lies beyond one of its edges by one texel: that of
/// the face there.
struct CubeTexel {
  int face = 0, x = 0, y = 0;
};
CubeTexel cube_texel(const CubeTexel& at, int size);

/// The value of a texel of a level, or beyond its edges or corners: beyond a corner lies
/// ((a + b) + c) * (1/3) of the other three texels round it, the upper row first.
glm::vec4 fetch_cube_texel(const Texture& texture, const CubeTexel& at, std::size_t level,
                           const Profile& profile);

/// Where a texture that is not flat is sampled: u, v and a layer, which is rounded to nearest, ties
/// to even, and clamped; u, v, w; or a direction.
///
/// A volume is filtered in two slices, and `lerp` mixes them; then the levels are mixed. A cube has
/// no wraps: beyond an edge lies fetch_cube_texel(). Both are filtered in floats, but bytes of
/// volumes by llvmpipe. sample_vectors() (decoded_texture.h) does so in lanes.
glm::vec4 sample_sliced(const Texture& texture, const Sampler& sampler, glm::vec3 at, float lod,
                        const Profile& profile);

/// level_of_detail() of what is not flat. Of a volume r, the difference of w times its slices, is a
/// third part: (s s + t t) + r r. Of a cube's direction d with the main part m, the parts on the
/// face of `at` change by (d' - (m' i) d) (0.5 i), with i = 1 / m. softpipe's rule is not here.
float sliced_level_of_detail(const Texture& texture, glm::vec3 at, glm::vec3 per_x, glm::vec3 per_y,
                             const Profile& profile);

/// Layer `at` of an array. llvmpipe converts as x86 does: what no integer holds is layer 0.
int nearest_layer(const Texture& texture, float at, const Profile& profile);

}  // namespace softfocus
