#include "scenes/draw/surface_draws.h"

#include <algorithm>

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

bool has_opacity_texture(const Material& material, const Mesh& mesh) {
  return material.opacity_texture && !mesh.uvs.empty();
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
  draw.opacity = {.value = material.opacity,
                  .texture = has_opacity_texture(material, mesh)
                                 ? &scene.textures[*material.opacity_texture]
                                 : nullptr,
                  .sampler = material.opacity_sampler,
                  .cuts_out = material.cut_out,
                  .blends = is_transparent(material, mesh)};
  draw.variant = {.textured = draw.texture != nullptr,
                  .specular = material.lit && material.specular != glm::vec3{0.0f},
                  .two_sided = material.two_sided,
                  .holed = draw.opacity.texture != nullptr};
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

bool is_transparent(const Material& material, const Mesh& mesh) {
  return material.opacity < 1.0f || (has_opacity_texture(material, mesh) && !material.cut_out);
}

bool has_transparent(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
    return is_transparent(scene.materials[object.material], scene.meshes[object.mesh]);
  });
}

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
