#pragma once
// The vertex and the fragment stage of a lit, perhaps textured surface. A feature that a material
// lacks is neither computed nor interpolated.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <span>

#include "raster/images/decoded_texture.h"
#include "raster/images/sampler.h"
#include "raster/numbers/vector_math.h"
#include "raster/pipeline/multisample.h"
#include "raster/pipeline/stages.h"
#include "scenes/scene.h"
#include "scenes/surfaces/lighting.h"

namespace softfocus {

/// A depth as alpha holds it: cut to the largest half, because an infinite depth has no
/// circle of confusion.
inline float alpha_depth(float depth_m) { return depth_m < 65504.0f ? depth_m : 65504.0f; }

struct SurfaceVariant {
  bool textured = false;
  bool specular = false;
  bool two_sided = false;
  bool holed = false;  ///< an opacity texture says where it is
};

constexpr bool has_uvs(SurfaceVariant variant) { return variant.textured || variant.holed; }

/// How a surface hides what lies behind it.
struct SurfaceOpacity {
  float value = 1.0f;
  const Texture* texture = nullptr;  ///< of a holed variant
  Sampler sampler = {};
  /// Whether the texture only says where the surface is. If not, its red multiplies `value`.
  bool cuts_out = true;
  /// Whether fragments are blended: then their colour is multiplied by their opacity, which is
  /// in alpha in place of the depth.
  bool blends = false;
};

/// A cut-out surface is there where its opacity, as sampled, is this or more.
inline constexpr float kLeastOpacity = 0.5f;
/// A transparent one is there where it would show: half a step of 8 bits.
inline constexpr float kLeastBlended = 1.0f / 512.0f;

/// A holed surface is there where its texture has this or more.
constexpr float least_texel(const SurfaceOpacity& opacity) {
  return opacity.cuts_out ? kLeastOpacity : kLeastBlended;
}

/// Where each varying lies: depth, base colour, u and v, highlight, and the back's colours if it is
/// lit by itself. What a variant lacks takes no place.
struct SurfaceLayout {
  static constexpr std::size_t kDepth = 0;
  static constexpr std::size_t kFront = 1;
  static constexpr std::size_t kTexture = 4;
  std::size_t highlight;
  std::size_t back;
  std::size_t back_highlight;
  std::size_t count;
};

constexpr SurfaceLayout surface_layout(SurfaceVariant variant) {
  const std::size_t highlight = SurfaceLayout::kTexture + (has_uvs(variant) ? 2 : 0);
  const std::size_t back = highlight + (variant.specular ? 3 : 0);
  const std::size_t back_highlight = back + 3;
  const std::size_t side_size = variant.specular ? 6 : 3;
  return {highlight, back, back_highlight, back + (variant.two_sided ? side_size : 0)};
}

/// What the vertex stage reads; matrices are rounded to binary32 once a draw.
struct SurfaceVertexInput {
  const Mesh* mesh;
  const Material* material;
  std::span<const Light> lights;
  glm::vec3 ambient_light;
  glm::mat4 to_clip;
  glm::mat4 to_world;
  glm::mat3 normal_to_world;  ///< inverse transpose
  glm::vec3 eye;
};

/// What all variants have room for.
inline constexpr std::size_t kMostSurfaceVaryings = surface_layout({true, true, true, true}).count;

/// Depth and colours are 4, 7 or 13 varyings.
constexpr bool may_have_uvs(std::size_t varyings) {
  return varyings != 4 && varyings != 7 && varyings != 13;
}
constexpr bool may_be_specular(std::size_t varyings) { return varyings >= 7; }

/// For variants of N varyings or fewer.
template <std::size_t N>
struct SurfaceVertexStage {
  SurfaceVertexInput input;
  SurfaceVariant variant;
  SurfaceLayout layout = surface_layout(variant);

  VertexOutput<N> operator()(std::uint32_t index) const {
    const glm::vec3 position = input.mesh->positions[index];
    VertexOutput<N> output{transform_point(input.to_clip, position), {}};
    output.varyings[SurfaceLayout::kDepth] = output.position.w;

    const Material& material = *input.material;
    const glm::vec4 world4 = transform_point(input.to_world, position);
    const glm::vec3 world{world4.x, world4.y, world4.z};
    const glm::vec3 normal =
        normalize(transform_direction(input.normal_to_world, input.mesh->normals[index]));
    const glm::vec3 towards_eye = normalize(input.eye - world);
    const auto light_side = [&](glm::vec3 side_normal, std::size_t at, std::size_t highlight_at) {
      LitColour lit = material.lit ? light_point(material, input.ambient_light, input.lights, world,
                                                 side_normal, towards_eye)
                                   : LitColour{material.diffuse, glm::vec3{0.0f}};
      if (!input.mesh->colours.empty()) lit.base *= input.mesh->colours[index];
      for (std::size_t i = 0; i < 3; ++i) {
        output.varyings[at + i] = lit.base[static_cast<int>(i)];
        if constexpr (!may_be_specular(N)) continue;
        if (variant.specular) {
          output.varyings[highlight_at + i] = lit.specular[static_cast<int>(i)];
        }
      }
    };
    light_side(normal, SurfaceLayout::kFront, layout.highlight);
    if (variant.two_sided) light_side(-normal, layout.back, layout.back_highlight);
    if (may_have_uvs(N) && has_uvs(variant)) {
      output.varyings[SurfaceLayout::kTexture] = input.mesh->uvs[index].x;
      output.varyings[SurfaceLayout::kTexture + 1] = input.mesh->uvs[index].y;
    }
    return output;
  }
};

/// Where a pixel reads its base colour's texture, beside its centre, in 1/256 pixel: there 1 time,
/// 2 or 4 times at the standard places of as many samples. The texel is the sum in their order,
/// times 1 / reads; all are of the centre's level of detail. What a texture shows within a pixel is
/// then averaged as its samples average edges: one read is now sharper, now softer than the mean,
/// by where among texels it falls.
inline std::span<const glm::ivec2> texture_read_places(int reads) {
  static constexpr std::array<glm::ivec2, 2> kTwo{{{-64, -64}, {64, 64}}};
  return reads == 2 ? std::span<const glm::ivec2>{kTwo} : sample_places(reads);
}

/// For variants of N varyings or fewer.
template <std::size_t N>
struct SurfaceFragmentStage {
  static constexpr bool kNeedsDerivatives = may_have_uvs(N);
  static constexpr bool kDiscards = kNeedsDerivatives;
  static constexpr std::array<Interpolation, N> kInterpolation{};  // perspective

  const Texture* texture;
  Sampler sampler;
  Profile profile;
  SurfaceOpacity opacity;
  SurfaceVariant variant;
  // For the form in lanes.
  const DecodedTexture* decoded = nullptr;
  const DecodedTexture* decoded_opacity = nullptr;
  int texture_reads = 1;  ///< texture_read_places()
  SurfaceLayout layout = surface_layout(variant);

  bool discards() const { return variant.holed; }
  std::size_t varying_count() const { return layout.count; }

  FragmentOutput<1> operator()(const Fragment<N>& in) const {
    float hides = opacity.value;
    if (may_have_uvs(N) && variant.holed) {
      const float red = texel(*opacity.texture, opacity.sampler, in).x;
      if (red < least_texel(opacity)) return {{}, true};
      if (!opacity.cuts_out) hides *= red;
    }
    const bool back = variant.two_sided && !in.front_facing;
    const std::size_t side = back ? layout.back : layout.kFront;
    glm::vec3 colour{in.varyings[side], in.varyings[side + 1], in.varyings[side + 2]};
    if (may_have_uvs(N) && variant.textured) colour *= base_texel(in);
    if (may_be_specular(N) && variant.specular) {
      const std::size_t at = back ? layout.back_highlight : layout.highlight;
      colour += glm::vec3{in.varyings[at], in.varyings[at + 1], in.varyings[at + 2]};
    }
    if (opacity.blends) return {{glm::vec4{colour * hides, hides}}, false};
    return {{glm::vec4{colour, alpha_depth(in.varyings[SurfaceLayout::kDepth])}}, false};
  }

 private:
  glm::vec4 texel(const Texture& of, const Sampler& by, const Fragment<N>& in) const {
    const std::size_t u = SurfaceLayout::kTexture, v = u + 1;
    const float lod = level_of_detail(of, {in.ddx[u], in.ddx[v]}, {in.ddy[u], in.ddy[v]}, profile);
    return sample(of, by, {in.varyings[u], in.varyings[v]}, lod, profile);
  }

  glm::vec3 base_texel(const Fragment<N>& in) const {
    if (texture_reads == 1) return glm::vec3{texel(*texture, sampler, in)};
    const std::size_t u = SurfaceLayout::kTexture, v = u + 1;
    const float lod =
        level_of_detail(*texture, {in.ddx[u], in.ddx[v]}, {in.ddy[u], in.ddy[v]}, profile);
    const auto moved = [&](std::size_t i, glm::vec2 by) {
      return in.varyings[i] + (in.ddx[i] * by.x + in.ddy[i] * by.y);
    };
    glm::vec3 sum{0.0f};
    for (const glm::ivec2 place : texture_read_places(texture_reads)) {
      const glm::vec2 by = glm::vec2{place} * (1.0f / 256.0f);
      sum += glm::vec3{sample(*texture, sampler, {moved(u, by), moved(v, by)}, lod, profile)};
    }
    return sum * (1.0f / static_cast<float>(texture_reads));
  }
};

}  // namespace softfocus
