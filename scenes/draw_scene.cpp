#include "scenes/draw_scene.h"

#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"
#include "raster/pipeline/draw.h"
#include "scenes/surface_stages.h"

namespace softfocus {
namespace {

double determinant(const glm::dmat4& m) {
  return dot(glm::dvec3{m[0]}, cross(glm::dvec3{m[1]}, glm::dvec3{m[2]}));
}

// The matrix of cofactors: the inverse transpose but for a positive factor, which the
// normal's normalisation takes out; a mirroring matrix needs its sign.
glm::mat3 normal_matrix(const glm::dmat4& to_world) {
  const glm::dvec3 x{to_world[0]};
  const glm::dvec3 y{to_world[1]};
  const glm::dvec3 z{to_world[2]};
  const double sign = determinant(to_world) < 0.0 ? -1.0 : 1.0;
  return glm::mat3{glm::vec3{cross(y, z) * sign}, glm::vec3{cross(z, x) * sign},
                   glm::vec3{cross(x, y) * sign}};
}

template <SurfaceVariant variant>
void draw_surface(RenderPass& pass, const DrawState& state, const SurfaceVertexInput& input,
                  const Texture* texture) {
  draw(pass, state, input.mesh->indices, static_cast<std::uint32_t>(input.mesh->positions.size()),
       SurfaceVertexStage<variant>{input},
       SurfaceFragmentStage<variant>{texture, input.material->sampler, pass.profile});
}

using DrawSurface = void (*)(RenderPass&, const DrawState&, const SurfaceVertexInput&,
                             const Texture*);

// The variant that has what the material has, and nothing more.
DrawSurface surface_variant(bool textured, bool specular, bool two_sided) {
  static constexpr DrawSurface kVariants[2][2][2] = {
      {{draw_surface<SurfaceVariant{false, false, false}>,
        draw_surface<SurfaceVariant{false, false, true}>},
       {draw_surface<SurfaceVariant{false, true, false}>,
        draw_surface<SurfaceVariant{false, true, true}>}},
      {{draw_surface<SurfaceVariant{true, false, false}>,
        draw_surface<SurfaceVariant{true, false, true}>},
       {draw_surface<SurfaceVariant{true, true, false}>,
        draw_surface<SurfaceVariant{true, true, true}>}}};
  return kVariants[textured][specular][two_sided];
}

void draw_object(RenderPass& pass, const Scene& scene, const Object& object, const View& view,
                 double frame) {
  const Mesh& mesh = scene.meshes[object.mesh];
  const Material& material = scene.materials[object.material];
  const glm::dmat4 to_world = object_matrix(object, frame);
  const glm::dmat4 to_clip = multiply(view.projection, multiply(view.view, to_world));

  DrawState state;
  state.cull = material.two_sided ? Cull::none : Cull::back;
  if (determinant(to_world) < 0.0) state.front_face = FrontFace::clockwise;

  const Texture* texture =
      material.texture && !mesh.uvs.empty() ? &scene.textures[*material.texture] : nullptr;
  const bool specular = material.lit && material.specular != glm::vec3{0.0f};
  const SurfaceVertexInput input{&mesh,
                                 &material,
                                 scene.lights,
                                 scene.ambient_light,
                                 glm::mat4{to_clip},
                                 glm::mat4{to_world},
                                 normal_matrix(to_world),
                                 glm::vec3{view.eye}};
  surface_variant(texture != nullptr, specular, material.two_sided)(pass, state, input, texture);
}

}  // namespace

Image draw_scene(const Scene& scene, const View& view, double frame, int width, int height,
                 const Profile& profile, ThreadPool& pool) {
  Image picture = make_image(Format::rgba16f, width, height);
  Image depth = make_image(Format::r32f, width, height);
  clear_image(picture,
              glm::vec4{scene.background, alpha_depth(static_cast<float>(scene.camera.far_m))},
              profile);
  clear_image(depth, glm::vec4{1.0f}, profile);

  RenderPass pass;
  pass.targets.colour[0] = &picture;
  pass.targets.depth = &depth;
  pass.profile = profile;
  for (const Object& object : scene.objects) draw_object(pass, scene, object, view, frame);
  finish(pass, pool);
  return picture;
}

}  // namespace softfocus
