// The stages of surface_stages.h for kLanes vertices or pixels at once: the same operations
// in the same order.

#include "raster/images/sample_lanes.inl"
#include "raster/lanes/vector_math_lanes.inl"
#include "raster/pipeline/lanes/block_lanes.inl"
#include "raster/pipeline/lanes/edge_lanes.inl"
#include "raster/pipeline/lanes/interpolate_lanes.inl"
#include "raster/pipeline/lanes/shade_lanes.inl"
#include "raster/pipeline/lanes/vertex_lanes.inl"

namespace {

SOFTFOCUS_INLINE Floats whole_power(Floats x, int n) {
  Floats power = splat(1.0f);
  for (Floats square = x;; square *= square) {
    if ((n & 1) != 0) power *= square;
    n >>= 1;
    if (n == 0) return power;
  }
}

SOFTFOCUS_INLINE Vec3Lanes load_vectors(const std::vector<glm::vec3>& vectors, Ints index) {
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  const float* first = &vectors[0].x;
  const Ints at = index * 3;
  const Mask every = ~Mask{};
  return {gather(first, at, every), gather(first + 1, at, every), gather(first + 2, at, every)};
}

struct LitLanes {
  Vec3Lanes base, specular;
};

// As light_point().
template <bool kSpecular>
SOFTFOCUS_INLINE LitLanes light_points(const SurfaceVertexInput& input, const Vec3Lanes& point,
                                       const Vec3Lanes& normal, const Vec3Lanes& towards_eye) {
  const Material& material = *input.material;
  const float least = least_highlight(material.shininess);
  LitLanes lit{splat(input.ambient_light * material.ambient), splat(glm::vec3{0.0f})};
  for (const Light& light : input.lights) {
    const Vec3Lanes towards_light =
        light.kind == LightKind::point ? normalize(splat(light.position_or_direction) - point)
                                       : splat(::softfocus::normalize(light.position_or_direction));
    const Floats facing = dot(normal, towards_light);
    const Mask lights = facing > 0.0f;
    lit.base = select(lights, lit.base + light.colour * (material.diffuse * facing), lit.base);
    if constexpr (kSpecular) {
      const Floats highlight = dot(normal, normalize(towards_light + towards_eye));
      const Mask shines = lights & (highlight >= least);
      // Lanes that do not shine have no part in the time either: see least_highlight().
      const Floats power = whole_power(select(shines, highlight, splat(1.0f)), material.shininess);
      lit.specular =
          select(shines, lit.specular + light.colour * (material.specular * power), lit.specular);
    }
  }
  return lit;
}

template <SurfaceVariant variant>
struct SurfaceVertexLanes {
  using Layout = SurfaceLayout<variant>;
  static constexpr std::size_t kVaryings = Layout::kCount;
  const SurfaceVertexInput& input;

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
    varyings[Layout::kDepth] = in_clip_space[3];

    const Vec3Lanes p = load_vectors(input.mesh->positions, index);
    const glm::mat4& w = input.to_world;
    const Vec3Lanes world{((w[0][0] * p.x + w[1][0] * p.y) + w[2][0] * p.z) + w[3][0],
                          ((w[0][1] * p.x + w[1][1] * p.y) + w[2][1] * p.z) + w[3][1],
                          ((w[0][2] * p.x + w[1][2] * p.y) + w[2][2] * p.z) + w[3][2]};
    const Vec3Lanes n = load_vectors(input.mesh->normals, index);
    const glm::mat3& r = input.normal_to_world;
    const Vec3Lanes normal = normalize({(r[0][0] * n.x + r[1][0] * n.y) + r[2][0] * n.z,
                                        (r[0][1] * n.x + r[1][1] * n.y) + r[2][1] * n.z,
                                        (r[0][2] * n.x + r[1][2] * n.y) + r[2][2] * n.z});
    const Vec3Lanes towards_eye = normalize(splat(input.eye) - world);
    light_side(normal, world, towards_eye, Layout::kFront, varyings);
    if constexpr (variant.two_sided) {
      light_side({-normal.x, -normal.y, -normal.z}, world, towards_eye, Layout::kBack, varyings);
    }
    if constexpr (variant.textured) {
      const float* first = &input.mesh->uvs[0].x;
      varyings[Layout::kTexture] = gather(first, index * 2, ~Mask{});
      varyings[Layout::kTexture + 1] = gather(first + 1, index * 2, ~Mask{});
    }
  }

  SOFTFOCUS_INLINE void light_side(const Vec3Lanes& normal, const Vec3Lanes& world,
                                   const Vec3Lanes& towards_eye, std::size_t at,
                                   std::array<Floats, kVaryings>& varyings) const {
    const LitLanes lit = input.material->lit
                             ? light_points<variant.specular>(input, world, normal, towards_eye)
                             : LitLanes{splat(input.material->diffuse), splat(glm::vec3{0.0f})};
    varyings[at] = lit.base.x;
    varyings[at + 1] = lit.base.y;
    varyings[at + 2] = lit.base.z;
    if constexpr (variant.specular) {
      varyings[at + 3] = lit.specular.x;
      varyings[at + 4] = lit.specular.y;
      varyings[at + 5] = lit.specular.z;
    }
  }
};

// One copy for all variants.
[[gnu::noinline]] void sample_surface(const DecodedTexture& texture, const Sampler& sampler,
                                      const Profile& profile, SamplePoints points, int count,
                                      RgbLanes* texels) {
  sample_lanes(texture, sampler, profile, points, count, texels);
}

template <SurfaceVariant variant>
struct SurfaceFragmentLanes {
  using Layout = SurfaceLayout<variant>;
  static constexpr auto kInterpolation = SurfaceFragmentStage<variant>::kInterpolation;
  // The colour that a texture is multiplied with, depth; and with a texture where it is
  // sampled, and the highlights, which are else in the colour.
  static constexpr std::size_t kRed = 0, kGreen = 1, kBlue = 2, kDepth = 3, kU = 4, kV = 5,
                               kLod = 6, kHighlight = 7;
  static constexpr std::size_t kInputs = !variant.textured ? 4 : variant.specular ? 10 : 7;
  const SurfaceFragmentStage<variant>& stage;

  template <class Quads>
  SOFTFOCUS_INLINE std::array<Floats, kInputs> inputs(const Quads& in) const {
    std::array<Floats, kInputs> values;
    Vec3Lanes colour = side(in, 0);
    if constexpr (variant.textured) {
      constexpr std::size_t u = Layout::kTexture;
      constexpr std::size_t v = Layout::kTexture + 1;
      values[kU] = in.varying(u);
      values[kV] = in.varying(v);
      values[kLod] =
          level_of_detail_lanes(*stage.decoded, in.ddx(u), in.ddx(v), in.ddy(u), in.ddy(v));
    }
    if constexpr (variant.specular) {
      const Vec3Lanes highlight = side(in, 3);
      if constexpr (variant.textured) {
        values[kHighlight] = highlight.x;
        values[kHighlight + 1] = highlight.y;
        values[kHighlight + 2] = highlight.z;
      } else {
        colour = colour + highlight;
      }
    }
    values[kRed] = colour.x;
    values[kGreen] = colour.y;
    values[kBlue] = colour.z;
    values[kDepth] = smaller(in.varying(Layout::kDepth), splat(65504.0f));
    return values;
  }

  SOFTFOCUS_INLINE void shade(const FragmentBatch<kInputs>& batch,
                              std::array<Floats, 4>* colours) const {
    const int count = batch.vectors();
    std::array<RgbLanes, kMostSampled> texels;
    if constexpr (variant.textured) {
      sample_surface(*stage.decoded, stage.sampler, stage.profile,
                     {batch.inputs[kU].data(), batch.inputs[kV].data(), batch.inputs[kLod].data()},
                     count, texels.data());
    }
    for (int i = 0; i < count; ++i) {
      Vec3Lanes colour{batch.input(kRed, i), batch.input(kGreen, i), batch.input(kBlue, i)};
      if constexpr (variant.textured) {
        const RgbLanes& texel = texels[static_cast<std::size_t>(i)];
        colour = {colour.x * texel.r, colour.y * texel.g, colour.z * texel.b};
        if constexpr (variant.specular) {
          colour = colour + Vec3Lanes{batch.input(kHighlight, i), batch.input(kHighlight + 1, i),
                                      batch.input(kHighlight + 2, i)};
        }
      }
      colours[i] = {colour.x, colour.y, colour.z, batch.input(kDepth, i)};
    }
  }

  // Three varyings of the side that is seen.
  template <class Quads>
  SOFTFOCUS_INLINE Vec3Lanes side(const Quads& in, std::size_t at) const {
    const std::size_t front = Layout::kFront + at;
    const Vec3Lanes seen{in.varying(front), in.varying(front + 1), in.varying(front + 2)};
    if constexpr (!variant.two_sided) return seen;
    const std::size_t back = Layout::kBack + at;
    const Mask front_facing = in.front_facing();
    if (all(front_facing)) return seen;
    return select(front_facing, seen,
                  Vec3Lanes{in.varying(back), in.varying(back + 1), in.varying(back + 2)});
  }
};

}  // namespace

template <SurfaceVariant variant>
unsigned place_surface_vertices(const SurfaceVertexStage<variant>& stage, const VertexJob& job) {
  return place_vertices(SurfaceVertexLanes<variant>{stage.input}, job);
}

template <SurfaceVariant variant>
void shade_surface_vertices(const SurfaceVertexStage<variant>& stage, const VertexJob& job) {
  shade_vertices(SurfaceVertexLanes<variant>{stage.input}, job);
}

template <SurfaceVariant variant>
void shade_surface_fragments(const SurfaceFragmentStage<variant>& stage, const FragmentJob& job,
                             const VisibilityTile& tile, const VisibleRun& run) {
  shade_fragments(SurfaceFragmentLanes<variant>{stage}, job, tile, run);
}
