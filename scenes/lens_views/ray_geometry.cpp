#include "scenes/lens_views/ray_geometry.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "raster/images/sampler.h"
#include "raster/numbers/vector_math.h"
#include "scenes/surfaces/lighting.h"

namespace softfocus {
namespace {

RayMesh ray_mesh(const SurfaceDraw& draw, const glm::dmat4& world_to_eye, const Object& object,
                 double frame) {
  RayMesh mesh{draw, {}, {}, {}, {}};
  const SurfaceVertexInput& input = draw.input;
  const Material& material = *input.material;
  const glm::mat4 to_eye{multiply(world_to_eye, object_matrix(object, frame))};
  for (std::size_t i = 0; i < input.mesh->positions.size(); ++i) {
    const glm::vec3 position = input.mesh->positions[i];
    const glm::vec3 world{transform_point(input.to_world, position)};
    const glm::vec3 normal =
        normalize(transform_direction(input.normal_to_world, input.mesh->normals[i]));
    mesh.positions.emplace_back(transform_point(to_eye, position));
    mesh.world.push_back(world);
    mesh.normals.push_back(normal);
    const glm::vec3 anywhere{0.0f, 0.0f, 1.0f};
    for (int side = 0; side < 2; ++side) {
      glm::vec3 base = material.diffuse;
      if (material.lit) {
        base = light_point(material, input.ambient_light, input.lights, world,
                           side == 0 ? normal : -normal, anywhere)
                   .base;
      }
      if (!input.mesh->colours.empty()) base *= input.mesh->colours[i];
      mesh.base[side].push_back(base);
    }
  }
  return mesh;
}

using Corners = std::array<std::uint32_t, 3>;

Corners corners_of(const RayMesh& mesh, std::uint32_t triangle) {
  const auto& indices = mesh.draw.input.mesh->indices;
  const std::size_t at = std::size_t{3} * triangle;
  return {indices[at], indices[at + 1], indices[at + 2]};
}

/// The rasterizer's sum (interpolate.h).
template <class Value>
Value blend(const std::array<Value, 3>& values, float weight_1, float weight_2) {
  return (values[0] + (values[1] - values[0]) * weight_1) + (values[2] - values[0]) * weight_2;
}

/// Weights of the second and third vertex where a ray meets the triangle's plane, inside
/// it or not (Moeller and Trumbore 1997).
glm::dvec2 weights_on_plane(const std::array<glm::dvec3, 3>& v, const LensRay& ray) {
  const glm::dvec3 along_1 = v[1] - v[0];
  const glm::dvec3 along_2 = v[2] - v[0];
  const glm::dvec3 to_origin = ray.origin - v[0];
  const glm::dvec3 p = cross(ray.direction, along_2);
  const glm::dvec3 q = cross(to_origin, along_1);
  const double scale = 1.0 / dot(along_1, p);
  return {dot(to_origin, p) * scale, dot(ray.direction, q) * scale};
}

glm::vec3 texel_at(const RayMesh& mesh, const Texture& texture, const Sampler& sampler,
                   const RayHit& hit, const BlockRays& block, const Profile& profile) {
  const Corners corners = corners_of(mesh, hit.triangle);
  const auto& all = mesh.draw.input.mesh->uvs;
  const std::array<glm::vec2, 3> uvs{all[corners[0]], all[corners[1]], all[corners[2]]};
  std::array<glm::dvec3, 3> positions;
  for (std::size_t i = 0; i < 3; ++i) positions[i] = glm::dvec3{mesh.positions[corners[i]]};
  const auto uv_on_plane = [&](const LensRay& ray) {
    const glm::dvec2 weights = weights_on_plane(positions, ray);
    return blend(uvs, static_cast<float>(weights.x), static_cast<float>(weights.y));
  };
  const glm::vec2 corner = uv_on_plane(block.corner);
  const float lod = level_of_detail(texture, uv_on_plane(block.right) - corner,
                                    uv_on_plane(block.below) - corner, profile);
  const glm::vec2 uv = blend(uvs, hit.weight_1, hit.weight_2);
  return glm::vec3{sample(texture, sampler, uv, lod, profile)};
}

}  // namespace

std::vector<RayMesh> ray_meshes(const Scene& scene, const CameraMatrices& camera, double frame,
                                std::span<const Material> materials) {
  std::vector<RayMesh> meshes;
  std::vector<SurfaceDraw> draws = surface_draws(scene, camera, frame);
  for (std::size_t i = 0; i < draws.size(); ++i) {
    if (draws[i].shaders != nullptr) {
      throw std::runtime_error("rays cannot shade material '" + draws[i].input.material->name +
                               "', which has shaders of its own; accumulation draws it");
    }
    if (!materials.empty()) draws[i].input.material = &materials[scene.objects[i].material];
    meshes.push_back(ray_mesh(draws[i], camera.world_to_eye, scene.objects[i], frame));
  }
  return meshes;
}

RayCamera ray_camera(const CameraMatrices& camera, double focus_m, int width_px, int height_px) {
  const double width = width_px, height = height_px;
  return {2.0 / (width * camera.eye_to_clip[0][0]), 2.0 / (height * camera.eye_to_clip[1][1]),
          width / 2.0, height / 2.0, focus_m};
}

LensRay lens_ray(const RayCamera& camera, glm::dvec2 lens_point_m, double x_px, double y_px) {
  const double x = (x_px - camera.centre_x) * camera.pixel_x;
  const double y = (y_px - camera.centre_y) * camera.pixel_y;
  return {{lens_point_m.x, lens_point_m.y, 0.0},
          {x - lens_point_m.x / camera.focus_m, y - lens_point_m.y / camera.focus_m, -1.0}};
}

bool meets_front(const RayMesh& mesh, std::uint32_t triangle, const LensRay& ray) {
  const Corners corners = corners_of(mesh, triangle);
  const glm::dvec3 v0{mesh.positions[corners[0]]};
  const glm::dvec3 v1{mesh.positions[corners[1]]};
  const glm::dvec3 v2{mesh.positions[corners[2]]};
  const bool counter_clockwise = dot(cross(v1 - v0, v2 - v0), ray.origin - v0) > 0.0;
  return counter_clockwise == (mesh.draw.state.front_face == FrontFace::counter_clockwise);
}

namespace {

glm::vec3 highlight_at(const RayMesh& mesh, std::uint32_t vertex, bool back, glm::vec3 eye) {
  const glm::vec3 normal = back ? -mesh.normals[vertex] : mesh.normals[vertex];
  const SurfaceVertexInput& input = mesh.draw.input;
  return light_point(*input.material, input.ambient_light, input.lights, mesh.world[vertex], normal,
                     normalize(eye - mesh.world[vertex]))
      .specular;
}

/// `highlight` gives a vertex's.
template <class Highlight>
glm::vec3 shade(const RayMesh& mesh, const RayHit& hit, bool back, const BlockRays& block,
                const Profile& profile, const Highlight& highlight) {
  const Corners corners = corners_of(mesh, hit.triangle);
  const auto& base = mesh.base[back ? 1 : 0];
  glm::vec3 colour = blend<glm::vec3>({base[corners[0]], base[corners[1]], base[corners[2]]},
                                      hit.weight_1, hit.weight_2);
  if (mesh.draw.variant.textured) {
    colour *=
        texel_at(mesh, *mesh.draw.texture, mesh.draw.input.material->sampler, hit, block, profile);
  }
  if (mesh.draw.variant.specular) {
    colour +=
        blend<glm::vec3>({highlight(corners[0]), highlight(corners[1]), highlight(corners[2])},
                         hit.weight_1, hit.weight_2);
  }
  return colour;
}

}  // namespace

glm::vec3 shade_hit(const RayMesh& mesh, const RayHit& hit, glm::vec3 eye, const LensRay& ray,
                    const BlockRays& block, const Profile& profile) {
  const bool back = mesh.draw.variant.two_sided && !meets_front(mesh, hit.triangle, ray);
  return shade(mesh, hit, back, block, profile,
               [&](std::uint32_t vertex) { return highlight_at(mesh, vertex, back, eye); });
}

SpecularLight highlights_from(const RayMesh& mesh, glm::vec3 eye) {
  SpecularLight highlights;
  if (!mesh.draw.variant.specular) return highlights;
  const auto vertices = static_cast<std::uint32_t>(mesh.world.size());
  for (int side = 0; side < (mesh.draw.variant.two_sided ? 2 : 1); ++side) {
    for (std::uint32_t i = 0; i < vertices; ++i) {
      highlights.side[side].push_back(highlight_at(mesh, i, side == 1, eye));
    }
  }
  return highlights;
}

glm::vec3 shade_hit(const RayMesh& mesh, const RayHit& hit, bool back,
                    const SpecularLight& highlights, const BlockRays& block,
                    const Profile& profile) {
  const auto& side = highlights.side[back ? 1 : 0];
  return shade(mesh, hit, back, block, profile, [&](std::uint32_t vertex) { return side[vertex]; });
}

float opacity_at(const RayMesh& mesh, const RayHit& hit, const BlockRays& block,
                 const Profile& profile) {
  const SurfaceOpacity& opacity = mesh.draw.opacity;
  if (!mesh.draw.variant.holed) return opacity.value;
  const float red = texel_at(mesh, *opacity.texture, opacity.sampler, hit, block, profile).x;
  if (red < least_texel(opacity)) return 0.0f;
  return opacity.cuts_out ? opacity.value : opacity.value * red;
}

RayHit hit_in_triangle(const RayMesh& mesh, std::uint32_t triangle, const LensRay& ray) {
  const glm::dvec2 on_plane = weights_on_plane(corner_positions(mesh, triangle), ray);
  const double weight_1 = on_plane.x > 0.0 ? std::min(on_plane.x, 1.0) : 0.0;
  const double weight_2 = on_plane.y > 0.0 ? std::min(on_plane.y, 1.0 - weight_1) : 0.0;
  return {triangle, static_cast<float>(weight_1), static_cast<float>(weight_2)};
}

std::array<glm::dvec3, 3> corner_positions(const RayMesh& mesh, std::uint32_t triangle) {
  const Corners corners = corners_of(mesh, triangle);
  return {glm::dvec3{mesh.positions[corners[0]]}, glm::dvec3{mesh.positions[corners[1]]},
          glm::dvec3{mesh.positions[corners[2]]}};
}

}  // namespace softfocus
