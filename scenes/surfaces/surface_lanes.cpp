// The stages of surface_stages.h for kLanes vertices or pixels at once: the same operations in
// the same order. A draw's variant is a choice at run time, but for highlights, u and v: kernels
// compiled for each variant take minutes to compile and run no faster.

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

SurfaceLaneStages surface_lane_stages(const SurfaceVariant& variant, Isa isa) {
  SurfaceLaneStages stages{SOFTFOCUS_KERNEL(isa, place_surface_vertices),
                           SOFTFOCUS_KERNEL(isa, shade_surface_vertices), nullptr};
  if (has_uvs(variant)) {
    stages.shade_fragments = variant.specular
                                 ? SOFTFOCUS_KERNEL(isa, shade_surface_fragments<true, true>)
                                 : SOFTFOCUS_KERNEL(isa, shade_surface_fragments<true, false>);
  } else {
    stages.shade_fragments = variant.specular
                                 ? SOFTFOCUS_KERNEL(isa, shade_surface_fragments<false, true>)
                                 : SOFTFOCUS_KERNEL(isa, shade_surface_fragments<false, false>);
  }
  if (variant.holed) stages.keep_fragments = SOFTFOCUS_KERNEL(isa, keep_surface_fragments);
  return stages;
}

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

using VertexStage = SurfaceVertexStage<kMostSurfaceVaryings>;
using FragmentStage = SurfaceFragmentStage<kMostSurfaceVaryings>;

// --- vertices ---

struct SurfaceVertexLanes {
  static constexpr std::size_t kVaryings = kMostSurfaceVaryings;
  const SurfaceVertexInput& input;
  SurfaceVariant variant;
  SurfaceLayout layout;

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
    const auto& colours = input.mesh->colours;
    for (int side = 0; side < (variant.two_sided ? 2 : 1); ++side) {
      LitLanes lit = input.material->lit
                         ? light_points(*input.material, input.ambient_light, input.lights,
                                        variant.specular, world, normal, towards_eye)
                         : LitLanes{splat(input.material->diffuse), splat(glm::vec3{0.0f})};
      if (!colours.empty()) {
        const Vec3Lanes colour = load_vectors(colours, index);
        lit.base = {lit.base.x * colour.x, lit.base.y * colour.y, lit.base.z * colour.z};
      }
      const std::size_t at = side == 0 ? SurfaceLayout::kFront : layout.back;
      varyings[at] = lit.base.x;
      varyings[at + 1] = lit.base.y;
      varyings[at + 2] = lit.base.z;
      if (variant.specular) {
        const std::size_t highlight = side == 0 ? layout.highlight : layout.back_highlight;
        varyings[highlight] = lit.specular.x;
        varyings[highlight + 1] = lit.specular.y;
        varyings[highlight + 2] = lit.specular.z;
      }
      normal = {-normal.x, -normal.y, -normal.z};
    }
    if (has_uvs(variant)) {
      const float* first = &input.mesh->uvs[0].x;
      varyings[SurfaceLayout::kTexture] = gather(first, index * 2, ~Mask{});
      varyings[SurfaceLayout::kTexture + 1] = gather(first + 1, index * 2, ~Mask{});
    }
  }
};

// --- fragments ---

// Numbers of varyings are known when compiling, so that the compiler can keep these in registers.
template <bool uvs, bool specular>
struct SurfaceFragmentLanes {
  static constexpr auto& kInterpolation = FragmentStage::kInterpolation;
  // As surface_layout() has them.
  static constexpr std::size_t kTextureU = SurfaceLayout::kTexture;
  static constexpr std::size_t kAfterBase = kTextureU + (uvs ? 2 : 0);
  static constexpr std::size_t kUsualVaryings = kAfterBase + (specular ? 3 : 0);  // of one side
  // The colour that a texture is multiplied with, depth; and with a texture the place where it
  // is sampled, and the highlights, which are else in the colour.
  static constexpr std::size_t kRed = 0, kGreen = 1, kBlue = 2, kDepth = 3, kU = 4, kV = 5,
                               kLod = 6, kHighlight = 7;
  // Differences of u and v along x, then along y, if there is more than one read of the texture.
  static constexpr std::size_t kDifferences = specular ? 10 : 7;
  static constexpr std::size_t kInputs = uvs ? kDifferences + 4 : 4;
  const FragmentStage& stage;
  const SurfaceVariant variant = stage.variant;

  SOFTFOCUS_INLINE std::size_t varying_count() const { return stage.layout.count; }

  template <class Quads, class Put>
  SOFTFOCUS_INLINE void inputs(const Quads& in, const Put& put) const {
    Vec3Lanes colour = base(in);
    if (uvs && variant.textured) {
      const Floats u = in.varying(kTextureU), v = in.varying(kTextureU + 1);
      put(kU, u);
      put(kV, v);
      put(kLod, level_of_detail_of_quads(*stage.decoded, stage.profile, u, v));
      if (stage.texture_reads > 1) {
        put(kDifferences, spread<1>(u) - spread<0>(u));
        put(kDifferences + 1, spread<1>(v) - spread<0>(v));
        put(kDifferences + 2, spread<2>(u) - spread<0>(u));
        put(kDifferences + 3, spread<2>(v) - spread<0>(v));
      }
    }
    if constexpr (specular) {
      const Vec3Lanes highlight = highlights(in);
      if (uvs && variant.textured) {
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
    if (stage.opacity.blends) {
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
    if constexpr (uvs) {
      if (variant.textured) multiply_by_texture(batch, colours);
    }
    if (!stage.opacity.blends) return;
    for (int i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 3; ++c) colours[i][c] *= colours[i][3];
    }
  }

  SOFTFOCUS_INLINE void multiply_by_texture(const FragmentBatch<kInputs>& batch,
                                            std::array<Floats, 4>* colours) const {
    const int count = batch.vectors();
    std::array<RgbaLanes, kMostSampled> texels;
    if (stage.texture_reads > 1) {
      read_texture(batch, texels.data());
    } else {
      sample_lanes(*stage.decoded, stage.sampler, stage.profile,
                   {batch.inputs[kU].data(), batch.inputs[kV].data(), batch.inputs[kLod].data()},
                   count, texels.data());
    }
    for (int i = 0; i < count; ++i) {
      const RgbaLanes& texel = texels[static_cast<std::size_t>(i)];
      colours[i][0] *= texel.r;
      colours[i][1] *= texel.g;
      colours[i][2] *= texel.b;
      if constexpr (!specular) continue;
      for (std::size_t c = 0; c < 3; ++c) colours[i][c] += batch.input(kHighlight + c, i);
    }
  }

  // The mean of several reads. Not inlined: draws of one read a pixel would be slower.
  [[gnu::noinline]] void read_texture(const FragmentBatch<kInputs>& batch,
                                      RgbaLanes* texels) const {
    const int count = batch.vectors();
    alignas(64) std::array<float, FragmentBatch<kInputs>::kMost> u, v;
    std::array<RgbaLanes, kMostSampled> read;
    std::fill_n(texels, count, RgbaLanes{});
    for (const glm::ivec2 place : texture_read_places(stage.texture_reads)) {
      const Floats x = splat(static_cast<float>(place.x) * (1.0f / 256.0f));
      const Floats y = splat(static_cast<float>(place.y) * (1.0f / 256.0f));
      for (int i = 0; i < count; ++i) {
        const auto to = static_cast<std::size_t>(i * kLanes);
        store(&u[to], batch.input(kU, i) + (batch.input(kDifferences, i) * x +
                                            batch.input(kDifferences + 2, i) * y));
        store(&v[to], batch.input(kV, i) + (batch.input(kDifferences + 1, i) * x +
                                            batch.input(kDifferences + 3, i) * y));
      }
      sample_lanes(*stage.decoded, stage.sampler, stage.profile,
                   {u.data(), v.data(), batch.inputs[kLod].data()}, count, read.data());
      for (int i = 0; i < count; ++i) {
        const RgbaLanes& texel = read[static_cast<std::size_t>(i)];
        texels[i].r += texel.r;
        texels[i].g += texel.g;
        texels[i].b += texel.b;
      }
    }
    const float share = 1.0f / static_cast<float>(stage.texture_reads);
    for (int i = 0; i < count; ++i) {
      texels[i].r *= share;
      texels[i].g *= share;
      texels[i].b *= share;
    }
  }

  // The opacity. A texture that cuts out has done so before.
  template <class Quads>
  SOFTFOCUS_INLINE Floats hides(const Quads& in) const {
    const SurfaceOpacity& opacity = stage.opacity;
    const Floats value = splat(opacity.value);
    if constexpr (uvs) {
      if (variant.holed && !opacity.cuts_out) {
        return value * opacity_texels(in, kTextureU, *stage.decoded_opacity, opacity.sampler,
                                      stage.profile);
      }
    }
    return value;
  }

  // The base colour of the seen side.
  template <class Quads>
  SOFTFOCUS_INLINE Vec3Lanes base(const Quads& in) const {
    const Vec3Lanes front = three<SurfaceLayout::kFront>(in);
    if (!variant.two_sided) return front;
    const Mask front_facing = in.front_facing();
    if (all(front_facing)) return front;
    return select(front_facing, front, three<kAfterBase + (specular ? 3 : 0)>(in));
  }
  template <class Quads>
  SOFTFOCUS_INLINE Vec3Lanes highlights(const Quads& in) const {
    const Vec3Lanes front = three<kAfterBase>(in);
    if (!variant.two_sided) return front;
    return select(in.front_facing(), front, three<kAfterBase + 6>(in));
  }

  template <std::size_t at, class Quads>
  SOFTFOCUS_INLINE Vec3Lanes three(const Quads& in) const {
    return {in.varying(at), in.varying(at + 1), in.varying(at + 2)};
  }
};

struct SurfaceHoles {
  static constexpr auto& kInterpolation = FragmentStage::kInterpolation;
  const FragmentStage& stage;

  SOFTFOCUS_INLINE std::size_t varying_count() const { return stage.layout.count; }

  template <class Quads>
  SOFTFOCUS_INLINE Mask keeps(const Quads& in) const {
    return ~(opacity_texels(in, SurfaceLayout::kTexture, *stage.decoded_opacity,
                            stage.opacity.sampler, stage.profile) < least_texel(stage.opacity));
  }
};

}  // namespace

unsigned place_surface_vertices(const VertexStage& stage, const VertexJob& job) {
  return place_vertices(SurfaceVertexLanes{stage.input, stage.variant, stage.layout}, job);
}

void shade_surface_vertices(const VertexStage& stage, const VertexJob& job) {
  shade_vertices(SurfaceVertexLanes{stage.input, stage.variant, stage.layout}, job);
}

template <bool uvs, bool specular>
void shade_surface_fragments(const FragmentStage& stage, const FragmentJob& job,
                             const VisibilityTile& tile, const VisibleRun& run) {
  shade_fragments(SurfaceFragmentLanes<uvs, specular>{stage}, job, tile, run);
}

unsigned keep_surface_fragments(const FragmentStage& stage, const FragmentJob& job,
                                const LaneTriangle& triangle, int x, int y, unsigned pixels) {
  return keep_fragments(SurfaceHoles{stage}, job, triangle, x, y, pixels);
}

#endif
