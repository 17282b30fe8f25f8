#include <array>

#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"
#include "raster/pipeline/draw.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/relief/make_relief.h"

namespace softfocus {
namespace {

/// Where each varying lies: the normal, then u and v.
inline constexpr std::size_t kNormalUv = 3;

template <bool holed>
struct NormalVertexStage {
  static constexpr std::size_t kVaryings = holed ? 5 : 3;
  SurfaceVertexInput input;

  VertexOutput<kVaryings> operator()(std::uint32_t index) const {
    VertexOutput<kVaryings> output{transform_point(input.to_clip, input.mesh->positions[index]),
                                   {}};
    const glm::vec3 normal =
        normalize(transform_direction(input.normal_to_world, input.mesh->normals[index]));
    for (std::size_t i = 0; i < 3; ++i) output.varyings[i] = normal[static_cast<int>(i)];
    if constexpr (holed) {
      output.varyings[kNormalUv] = input.mesh->uvs[index].x;
      output.varyings[kNormalUv + 1] = input.mesh->uvs[index].y;
    }
    return output;
  }
};

template <bool holed>
struct NormalFragmentStage {
  static constexpr std::size_t kVaryings = NormalVertexStage<holed>::kVaryings;
  static constexpr bool kDiscards = holed;
  static constexpr bool kNeedsDerivatives = holed;
  static constexpr std::array<Interpolation, kVaryings> kInterpolation{};  // perspective

  SurfaceOpacity opacity;
  Profile profile;
  float mark;

  FragmentOutput<1> operator()(const Fragment<kVaryings>& in) const {
    if constexpr (holed) {
      const std::size_t u = kNormalUv, v = kNormalUv + 1;
      const float lod = level_of_detail(*opacity.texture, {in.ddx[u], in.ddx[v]},
                                        {in.ddy[u], in.ddy[v]}, profile);
      const glm::vec4 texel =
          sample(*opacity.texture, opacity.sampler, {in.varyings[u], in.varyings[v]}, lod, profile);
      if (texel.x < least_texel(opacity)) return {{}, true};
    }
    // A two-sided surface is lit on the side that is seen.
    const float side = in.front_facing ? 1.0f : -1.0f;
    return {{glm::vec4{side * in.varyings[0], side * in.varyings[1], side * in.varyings[2], mark}},
            false};
  }
};

template <bool holed>
void record_normals(const SurfaceDraw& surface, float mark, RenderPass& pass) {
  const Mesh& mesh = *surface.input.mesh;
  draw(pass, surface.state, mesh.indices, static_cast<std::uint32_t>(mesh.positions.size()),
       NormalVertexStage<holed>{surface.input},
       NormalFragmentStage<holed>{surface.opacity, pass.profile, mark});
}

}  // namespace

Image draw_normals(const Scene& scene, const CameraMatrices& camera, double frame, int width,
                   int height, ThreadPool& pool) {
  Image normals = make_image(Format::rgba16f, width, height);
  Image depth = make_image(Format::r32f, width, height);
  RenderPass pass;
  pass.isa = pool.isa();
  pass.targets.colour[0] = &normals;
  pass.targets.depth = &depth;
  pass.clear_colour = glm::vec4{0.0f};
  pass.clear_depth = 1.0f;
  pass.keep_depth = false;
  const std::vector<SurfaceDraw> surfaces = surface_draws(scene, camera, frame);
  for (const SurfaceDraw& surface : surfaces) {
    if (surface.opacity.blends) continue;
    const auto material = surface.input.material - scene.materials.data();
    (surface.opacity.texture != nullptr
         ? record_normals<true>
         : record_normals<false>)(surface, static_cast<float>(1 + material), pass);
  }
  finish(pass, pool);
  return normals;
}

}  // namespace softfocus
