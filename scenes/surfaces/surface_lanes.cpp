// The stages of surface_stages.h for kLanes vertices or pixels at once: the same operations in
// the same order. For vertices a draw's variant is a choice at run time: compiled for each, their
// kernels take longer to compile and run no faster.

#ifndef SOFTFOCUS_ISA

#include "scenes/surfaces/surface_lanes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <utility>

#include "raster/numbers/fixed_point.h"

#define SOFTFOCUS_KERNELS "scenes/surfaces/surface_lanes.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

template <SurfaceVariant variant>
SurfaceLaneStages<variant> surface_lane_stages(Isa isa) {
  SurfaceLaneStages<variant> stages{SOFTFOCUS_KERNEL(isa, place_surface_vertices<variant>),
                                    SOFTFOCUS_KERNEL(isa, shade_surface_vertices<variant>),
                                    SOFTFOCUS_KERNEL(isa, shade_surface_fragments<variant>)};
  if constexpr (variant.holed) {
    stages.keep_fragments = SOFTFOCUS_KERNEL(isa, keep_surface_fragments<variant>);
  }
  return stages;
}

#define SOFTFOCUS_SURFACE_VARIANT(...) \
  template SurfaceLaneStages<SurfaceVariant{__VA_ARGS__}> surface_lane_stages(Isa);
SOFTFOCUS_SURFACE_VARIANT(false, false, false, false)
SOFTFOCUS_SURFACE_VARIANT(false, false, true, false)
SOFTFOCUS_SURFACE_VARIANT(false, true, false, false)
SOFTFOCUS_SURFACE_VARIANT(false, true, true, false)
SOFTFOCUS_SURFACE_VARIANT(true, false, false, false)
SOFTFOCUS_SURFACE_VARIANT(true, false, true, false)
SOFTFOCUS_SURFACE_VARIANT(true, true, false, false)
SOFTFOCUS_SURFACE_VARIANT(true, true, true, false)
SOFTFOCUS_SURFACE_VARIANT(false, false, false, true)
SOFTFOCUS_SURFACE_VARIANT(false, false, true, true)
SOFTFOCUS_SURFACE_VARIANT(false, true, false, true)
SOFTFOCUS_SURFACE_VARIANT(false, true, true, true)
SOFTFOCUS_SURFACE_VARIANT(true, false, false, true)
SOFTFOCUS_SURFACE_VARIANT(true, false, true, true)
SOFTFOCUS_SURFACE_VARIANT(true, true, false, true)
SOFTFOCUS_SURFACE_VARIANT(true, true, true, true)
#undef SOFTFOCUS_SURFACE_VARIANT

}  // namespace softfocus

#else  // the kernels, once a vector unit

#include "raster/images/sample_lanes.inl"
#include "raster/lanes/vector_math_lanes.inl"
#include "raster/pipeline/lanes/block_lanes.inl"
#include "raster/pipeline/lanes/edge_lanes.inl"
#include "raster/pipeline/lanes/interpolate_lanes.inl"
#include "raster/pipeline/lanes/shade_lanes.inl"
#include "raster/pipeline/lanes/vertex_lanes.inl"
#include "scenes/surfaces/lighting_lanes.inl"
#include "scenes/surfaces/opacity_lanes.inl"

namespace {

// What all variants have room for.
inline constexpr std::size_t kMostVaryings = surface_layout({true, true, true, true}).count;

// --- vertices ---

struct SurfaceVertexLanes {
  static constexpr std::size_t kVaryings = kMostVaryings;
  const SurfaceVertexInput& input;
  SurfaceVariant variant;
  SurfaceLayout layout = surface_layout(variant);

  SOFTFOCUS_INLINE std::size_t varying_count() const { return layout.count; }

  SOFTFOCUS_INLINE void position(Ints index, std::array<Floats, 4>& in_clip_space) const {
    const Vec3Lanes p = load_vectors(input.mesh->positions, index);
    for (int i = 0; i < 4; ++i) {
      const glm::mat4& m = input.to_clip;
      in_clip_space[static_cast<std::size_t>(i)] =
          ((m[0][i] * p.x + m[1][i] * p.y) + m[2][i] * p.z) + m[3][i];
    }
  }

  SOFTFOCUS_INLINE void operator()(Ints index, std::array<Floats, 4>& in_clip_space,
                                   std::array<Floats, kVaryings>& varyings) const {
    position(index, in_clip_space);
    varyings[SurfaceLayout::kDepth] = in_clip_space[3];

    const Vec3Lanes p = load_vectors(input.mesh->positions, index);
    const glm::mat4& w = input.to_world;
    const Vec3Lanes world{((w[0][0] * p.x + w[1][0] * p.y) + w[2][0] * p.z) + w[3][0],
                          ((w[0][1] * p.x + w[1][1] * p.y) + w[2][1] * p.z) + w[3][1],
                          ((w[0][2] * p.x + w[1][2] * p.y) + w[2][2] * p.z) + w[3][2]};
    const Vec3Lanes n = load_vectors(input.mesh->normals, index);
    const glm::mat3& r = input.normal_to_world;
    Vec3Lanes normal = normalize({(r[0][0] * n.x + r[1][0] * n.y) + r[2][0] * n.z,
                                  (r[0][1] * n.x + r[1][1] * n.y) + r[2][1] * n.z,
                                  (r[0][2] * n.x + r[1][2] * n.y) + r[2][2] * n.z});
    const Vec3Lanes towards_eye = normalize(splat(input.eye) - world);
    // The front, and then perhaps the back.
    for (std::size_t at = SurfaceLayout::kFront; at < layout.texture; at += layout.side_size) {
      const LitLanes lit = input.material->lit
                               ? light_points(*input.material, input.ambient_light, input.lights,
                                              variant.specular, world, normal, towards_eye)
                               : LitLanes{splat(input.material->diffuse), splat(glm::vec3{0.0f})};
      varyings[at] = lit.base.x;
      varyings[at + 1] = lit.base.y;
      varyings[at + 2] = lit.base.z;
      if (variant.specular) {
        varyings[at + 3] = lit.specular.x;
        varyings[at + 4] = lit.specular.y;
        varyings[at + 5] = lit.specular.z;
      }
      normal = {-normal.x, -normal.y, -normal.z};
    }
    if (has_uvs(variant)) {
      const float* first = &input.mesh->uvs[0].x;
      varyings[layout.texture] = gather(first, index * 2, ~Mask{});
      varyings[layout.texture + 1] = gather(first + 1, index * 2, ~Mask{});
    }
  }
};

// --- fragments ---

template <SurfaceVariant variant>
struct SurfaceFragmentLanes {
  static constexpr SurfaceLayout kLayout = surface_layout(variant);
  static constexpr std::array<Interpolation, kLayout.count> kInterpolation{};  // perspective
  // The colour that a texture is multiplied with, depth; and with a texture the place where it
  // is sampled, and the highlights, which are else in the colour.
  static constexpr std::size_t kRed = 0, kGreen = 1, kBlue = 2, kDepth = 3, kU = 4, kV = 5,
                               kLod = 6, kHighlight = 7;
  static constexpr std::size_t kInputs = !variant.textured ? 4 : variant.specular ? 10 : 7;
  const DecodedTexture* texture;
  const Sampler& sampler;
  const Profile& profile;
  const SurfaceOpacity& opacity;
  const DecodedTexture* decoded_opacity;

  template <class Quads, class Put>
  SOFTFOCUS_INLINE void inputs(const Quads& in, const Put& put) const {
    Vec3Lanes colour = side(in, 0);
    if constexpr (variant.textured) {
      const std::size_t u = kLayout.texture;
      const std::size_t v = kLayout.texture + 1;
      put(kU, in.varying(u));
      put(kV, in.varying(v));
      put(kLod,
          level_of_detail_lanes(*texture, profile, in.ddx(u), in.ddx(v), in.ddy(u), in.ddy(v)));
    }
    if constexpr (variant.specular) {
      const Vec3Lanes highlight = side(in, 3);
      if constexpr (variant.textured) {
        put(kHighlight, highlight.x);
        put(kHighlight + 1, highlight.y);
        put(kHighlight + 2, highlight.z);
      } else {
        colour = colour + highlight;
      }
    }
    put(kRed, colour.x);
    put(kGreen, colour.y);
    put(kBlue, colour.z);
    if (opacity.blends) {
      put(kDepth, hides(in));
    } else {
      put(kDepth, smaller(in.varying(SurfaceLayout::kDepth), splat(65504.0f)));
    }
  }

  SOFTFOCUS_INLINE void shade(const FragmentBatch<kInputs>& batch,
                              std::array<Floats, 4>* colours) const {
    const int count = batch.vectors();
    for (int i = 0; i < count; ++i) {
      colours[i] = {batch.input(kRed, i), batch.input(kGreen, i), batch.input(kBlue, i),
                    batch.input(kDepth, i)};
    }
    if constexpr (variant.textured) multiply_by_texture(batch, colours);
    if (!opacity.blends) return;
    for (int i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 3; ++c) colours[i][c] *= colours[i][3];
    }
  }

  SOFTFOCUS_INLINE void multiply_by_texture(const FragmentBatch<kInputs>& batch,
                                            std::array<Floats, 4>* colours) const {
    const int count = batch.vectors();
    std::array<RgbLanes, kMostSampled> texels;
    sample_lanes(*texture, sampler, profile,
                 {batch.inputs[kU].data(), batch.inputs[kV].data(), batch.inputs[kLod].data()},
                 count, texels.data());
    for (int i = 0; i < count; ++i) {
      const RgbLanes& texel = texels[static_cast<std::size_t>(i)];
      colours[i][0] *= texel.r;
      colours[i][1] *= texel.g;
      colours[i][2] *= texel.b;
      if constexpr (!variant.specular) continue;
      for (std::size_t c = 0; c < 3; ++c) colours[i][c] += batch.input(kHighlight + c, i);
    }
  }

  // The opacity.
  template <class Quads>
  SOFTFOCUS_INLINE Floats hides(const Quads& in) const {
    const Floats value = splat(opacity.value);
    if constexpr (!variant.holed) return value;
    return value * opacity_texels(in, kLayout.texture, *decoded_opacity, opacity.sampler, profile);
  }

  // Three varyings of the side that is seen.
  template <class Quads>
  SOFTFOCUS_INLINE Vec3Lanes side(const Quads& in, std::size_t at) const {
    const std::size_t front = SurfaceLayout::kFront + at;
    const Vec3Lanes seen{in.varying(front), in.varying(front + 1), in.varying(front + 2)};
    if constexpr (!variant.two_sided) return seen;
    const std::size_t back = kLayout.back + at;
    const Mask front_facing = in.front_facing();
    if (all(front_facing)) return seen;
    return select(front_facing, seen,
                  Vec3Lanes{in.varying(back), in.varying(back + 1), in.varying(back + 2)});
  }
};

template <SurfaceVariant variant>
struct SurfaceHoles {
  static constexpr SurfaceLayout kLayout = surface_layout(variant);
  static constexpr std::array<Interpolation, kLayout.count> kInterpolation{};  // perspective
  const SurfaceOpacity& opacity;
  const DecodedTexture& decoded_opacity;
  const Profile& profile;

  template <class Quads>
  SOFTFOCUS_INLINE Mask keeps(const Quads& in) const {
    return ~(opacity_texels(in, kLayout.texture, decoded_opacity, opacity.sampler, profile) <
             least_texel(opacity));
  }
};

}  // namespace

template <SurfaceVariant variant>
unsigned place_surface_vertices(const SurfaceVertexStage<variant>& stage, const VertexJob& job) {
  return place_vertices(SurfaceVertexLanes{stage.input, variant}, job);
}

template <SurfaceVariant variant>
void shade_surface_vertices(const SurfaceVertexStage<variant>& stage, const VertexJob& job) {
  shade_vertices(SurfaceVertexLanes{stage.input, variant}, job);
}

template <SurfaceVariant variant, SurfaceVariant of>
void shade_surface(const SurfaceFragmentStage<of>& stage, const FragmentJob& job,
                   const VisibilityTile& tile, const VisibleRun& run) {
  shade_fragments(SurfaceFragmentLanes<variant>{stage.decoded, stage.sampler, stage.profile,
                                                stage.opacity, stage.decoded_opacity},
                  job, tile, run);
}

// A cut-out has the varyings and colours of the surface without holes, and perhaps u and v after
// them: both share their code.
template <SurfaceVariant variant>
void shade_surface_fragments(const SurfaceFragmentStage<variant>& stage, const FragmentJob& job,
                             const VisibilityTile& tile, const VisibleRun& run) {
  constexpr SurfaceVariant kWhole{variant.textured, variant.specular, variant.two_sided};
  if constexpr (variant.holed) {
    if (!stage.opacity.cuts_out) return shade_surface<variant>(stage, job, tile, run);
  }
  shade_surface<kWhole>(stage, job, tile, run);
}

template <SurfaceVariant variant>
unsigned keep_surface_fragments(const SurfaceFragmentStage<variant>& stage, const FragmentJob& job,
                                const LaneTriangle& triangle, int x, int y, unsigned pixels) {
  return keep_fragments(SurfaceHoles<variant>{stage.opacity, *stage.decoded_opacity, stage.profile},
                        job, triangle, x, y, pixels);
}

#endif
