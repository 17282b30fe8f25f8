#include "scenes/draw/surface_draws.h"

#include "raster/numbers/vector_math.h"

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

SurfaceDraw surface_draw(const Scene& scene, const Object& object, const CameraMatrices& camera,
                         double frame) {
  const Mesh& mesh = scene.meshes[object.mesh];
  const Material& material = scene.materials[object.material];
  const glm::dmat4 to_world = object_matrix(object, frame);
  const glm::dmat4 to_clip = multiply(camera.eye_to_clip, multiply(camera.world_to_eye, to_world));

  SurfaceDraw draw{};
  draw.state.cull = material.two_sided ? Cull::none : Cull::back;
  if (determinant(to_world) < 0.0) draw.state.front_face = FrontFace::clockwise;
  if (material.texture && !mesh.uvs.empty()) draw.texture = &scene.textures[*material.texture];
  if (material.cut_out && material.opacity_texture && !mesh.uvs.empty()) {
    draw.opacity = &scene.textures[*material.opacity_texture];
    draw.opacity_sampler = material.opacity_sampler;
  }
  draw.variant = {.textured = draw.texture != nullptr,
                  .specular = material.lit && material.specular != glm::vec3{0.0f},
                  .two_sided = material.two_sided,
                  .cut_out = draw.opacity != nullptr};
  draw.input = {&mesh,
                &material,
                scene.lights,
                scene.ambient_light,
                glm::mat4{to_clip},
                glm::mat4{to_world},
                normal_matrix(to_world),
                glm::vec3{camera.eye}};
  return draw;
}

}  // namespace

std::vector<SurfaceDraw> surface_draws(const Scene& scene, const CameraMatrices& camera,
                                       double frame) {
  std::vector<SurfaceDraw> draws;
  draws.reserve(scene.objects.size());
  for (const Object& object : scene.objects) {
    draws.push_back(surface_draw(scene, object, camera, frame));
  }
  return draws;
}

}  // namespace softfocus
