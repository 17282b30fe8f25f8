#include "scenes/draw/draw_scene.h"

#include "raster/images/texel.h"
#include "raster/pipeline/draw.h"
#include "scenes/draw/surface_draws.h"
#include "scenes/draw/surface_lanes.h"
#include "scenes/draw/surface_stages.h"

namespace softfocus {
namespace {

template <SurfaceVariant variant>
void draw_surface(const PreparedScene& prepared, const SurfaceDraw& surface, RenderPass& pass) {
  const SurfaceVertexInput& input = surface.input;
  const auto vertices = static_cast<std::uint32_t>(input.mesh->positions.size());
  const SurfaceVertexStage<variant> vertex_stage{input};
  SurfaceFragmentStage<variant> fragment_stage{surface.texture, input.material->sampler,
                                               pass.profile};
  if (!can_draw_in_lanes(pass, surface.state)) {
    draw(pass, surface.state, input.mesh->indices, vertices, vertex_stage, fragment_stage);
    return;
  }
  if (surface.texture != nullptr) {
    const auto number = surface.texture - prepared.scene->textures.data();
    fragment_stage.decoded = &prepared.textures[static_cast<std::size_t>(number)];
  }
  draw_in_lanes(pass, surface.state, input.mesh->indices, vertices, vertex_stage, fragment_stage,
                surface_lane_stages<variant>(pass.isa));
}

void draw_surface(const PreparedScene& prepared, const SurfaceDraw& surface, RenderPass& pass) {
  using DrawSurface = void (*)(const PreparedScene&, const SurfaceDraw&, RenderPass&);
  static constexpr DrawSurface kVariants[2][2][2] = {
      {{draw_surface<SurfaceVariant{false, false, false}>,
        draw_surface<SurfaceVariant{false, false, true}>},
       {draw_surface<SurfaceVariant{false, true, false}>,
        draw_surface<SurfaceVariant{false, true, true}>}},
      {{draw_surface<SurfaceVariant{true, false, false}>,
        draw_surface<SurfaceVariant{true, false, true}>},
       {draw_surface<SurfaceVariant{true, true, false}>,
        draw_surface<SurfaceVariant{true, true, true}>}}};
  const SurfaceVariant variant = surface.variant;
  kVariants[variant.textured][variant.specular][variant.two_sided](prepared, surface, pass);
}

}  // namespace

glm::vec4 clear_colour(const Scene& scene) {
  return {scene.background, alpha_depth(static_cast<float>(scene.camera.far_m))};
}

PreparedScene prepare_scene(const Scene& scene, const Profile& profile, ThreadPool& pool) {
  PreparedScene prepared{&scene, {}, {}, {}};
  prepared.pass.profile = profile;
  prepared.pass.isa = pool.isa();
  if (pool.isa() == Isa::scalar) return prepared;
  prepared.textures.resize(scene.textures.size());
  pool.for_each(static_cast<int>(scene.textures.size()), [&](int i) {
    const auto number = static_cast<std::size_t>(i);
    prepared.textures[number] = decode_texture(scene.textures[number], profile);
  });
  return prepared;
}

void record_scene(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                  RenderPass& pass) {
  pass.clear_colour = clear_colour(*prepared.scene);
  pass.clear_depth = 1.0f;
  pass.keep_depth = false;
  for (const SurfaceDraw& surface : surface_draws(*prepared.scene, camera, frame)) {
    draw_surface(prepared, surface, pass);
  }
}

void draw_scene(PreparedScene& prepared, const CameraMatrices& camera, double frame, Image& picture,
                ThreadPool& pool) {
  if (prepared.depth.width != picture.width || prepared.depth.height != picture.height) {
    prepared.depth = make_image(Format::r32f, picture.width, picture.height);
  }
  prepared.pass.targets.colour[0] = &picture;
  prepared.pass.targets.depth = &prepared.depth;
  record_scene(prepared, camera, frame, prepared.pass);
  finish(prepared.pass, pool);
}

Image draw_scene(const Scene& scene, const CameraMatrices& camera, double frame, int width,
                 int height, const Profile& profile, ThreadPool& pool) {
  Image picture = make_image(Format::rgba16f, width, height);
  PreparedScene prepared = prepare_scene(scene, profile, pool);
  draw_scene(prepared, camera, frame, picture, pool);
  return picture;
}

}  // namespace softfocus
