#include "scenes/draw_scene.h"

#include "raster/images/texel.h"
#include "raster/pipeline/draw.h"
#include "scenes/surface_draws.h"
#include "scenes/surface_stages.h"

namespace softfocus {
namespace {

template <SurfaceVariant variant>
void draw_surface(RenderPass& pass, const SurfaceDraw& surface) {
  const SurfaceVertexInput& input = surface.input;
  draw(pass, surface.state, input.mesh->indices,
       static_cast<std::uint32_t>(input.mesh->positions.size()), SurfaceVertexStage<variant>{input},
       SurfaceFragmentStage<variant>{surface.texture, input.material->sampler, pass.profile});
}

void draw_surface(RenderPass& pass, const SurfaceDraw& surface) {
  using DrawSurface = void (*)(RenderPass&, const SurfaceDraw&);
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
  kVariants[variant.textured][variant.specular][variant.two_sided](pass, surface);
}

}  // namespace

glm::vec4 clear_colour(const Scene& scene) {
  return {scene.background, alpha_depth(static_cast<float>(scene.camera.far_m))};
}

Image draw_scene(const Scene& scene, const View& view, double frame, int width, int height,
                 const Profile& profile, ThreadPool& pool) {
  Image picture = make_image(Format::rgba16f, width, height);
  Image depth = make_image(Format::r32f, width, height);
  clear_image(picture, clear_colour(scene), profile);
  clear_image(depth, glm::vec4{1.0f}, profile);

  RenderPass pass;
  pass.targets.colour[0] = &picture;
  pass.targets.depth = &depth;
  pass.profile = profile;
  for (const SurfaceDraw& surface : surface_draws(scene, view, frame)) draw_surface(pass, surface);
  finish(pass, pool);
  return picture;
}

}  // namespace softfocus
