#include "scenes/traced_relief/traced_relief.h"

#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "raster/numbers/half.h"
#include "raster/numbers/vector_math.h"
#include "scenes/lens_views/embree_mesh.h"
#include "scenes/relief/relief_texture.h"

namespace softfocus {
namespace {

constexpr std::string_view kTracer = "traced relief";

/// A ray on its way. The context comes first: filters get a pointer to it.
struct ReliefQuery {
  EmbreeContext context;
  const BlockRays& block;
};

/// Lets rays through the backs of surfaces that are drawn from the front only, through holes, and
/// through transparent surfaces, which reliefs leave out.
void pass_unseen(const RTCFilterFunctionNArguments* arguments) {
  if (arguments->N != 1 || arguments->valid[0] == 0) return;
  const auto& mesh = *static_cast<const RayMesh*>(arguments->geometryUserPtr);
  const auto& query = *reinterpret_cast<const ReliefQuery*>(arguments->context);
  RTCHitN* const hit = arguments->hit;
  const RayHit place{RTCHitN_primID(hit, 1, 0), RTCHitN_u(hit, 1, 0), RTCHitN_v(hit, 1, 0)};
  const LensRay own{origin_of(arguments), direction_of(arguments)};
  const bool is_culled =
      mesh.draw.state.cull == Cull::back && !meets_front(mesh, place.triangle, own);
  if (is_culled || mesh.draw.opacity.blends ||
      opacity_at(mesh, place, query.block, Profile{}) == 0.0f) {
    arguments->valid[0] = 0;
  }
}

/// Through a place of the texture, in the space of relief_matrices(). z of the direction is -1.
LensRay relief_ray(const ReliefCamera& camera, double u, double v) {
  const double across = std::sqrt(dot(camera.a, camera.a));
  const double along = std::sqrt(dot(camera.b, camera.b));
  if (!camera.eye) return {{u * across, -v * along, 0.0}, {0.0, 0.0, -1.0}};
  const glm::dvec3 corner = camera.origin - *camera.eye;
  const double n = source_distance(camera);
  return {glm::dvec3{0.0},
          {(dot(corner, camera.a) / across + u * across) / n,
           -(dot(corner, camera.b) / along + v * along) / n, -1.0}};
}

/// How far along the ray the triangle's plane lies, in binary64; Embree's own if it lies along it.
double distance_to(const RayMesh& mesh, std::uint32_t triangle, const LensRay& ray,
                   double otherwise) {
  const auto corners = corner_positions(mesh, triangle);
  const glm::dvec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double along = dot(normal, ray.direction);
  return along != 0.0 ? dot(normal, corners[0] - ray.origin) / along : otherwise;
}

std::uint16_t code_of(const ReliefCamera& camera, double along_m, int last) {
  double depth = along_m;
  if (camera.eye) {
    const double n = source_distance(camera);
    depth = n - n * n / along_m;
  }
  const double share = std::fmin(std::fmax(depth / camera.depth_m, 0.0), 1.0);
  return static_cast<std::uint16_t>(std::lrint(share * last));
}

glm::vec3 normal_of(const RayMesh& mesh, const RayHit& at, bool back) {
  const auto& indices = mesh.draw.input.mesh->indices;
  const std::size_t first = std::size_t{3} * at.triangle;
  const glm::vec3 n0 = mesh.normals[indices[first]], n1 = mesh.normals[indices[first + 1]];
  const glm::vec3 n2 = mesh.normals[indices[first + 2]];
  const glm::vec3 normal = (n0 + (n1 - n0) * at.weight_1) + (n2 - n0) * at.weight_2;
  return back ? -normal : normal;
}

}  // namespace

std::string_view traced_relief_missing() { return {}; }

ReliefTexture trace_relief(const ReliefMaker& maker, const ReliefView& view, const ReliefForm& form,
                           ThreadPool& pool) {
  ReliefTexture relief;
  relief.width = form.width;
  relief.height = form.height;
  relief.depth_bits = form.depth_bits;
  relief.camera = relief_camera(maker, view, form.width, form.height);
  const std::size_t texels =
      static_cast<std::size_t>(form.width) * static_cast<std::size_t>(form.height);
  relief.depths.assign(texels, empty_depth(form.depth_bits));
  relief.colours.assign(texels, 0);
  if (form.with_normals) relief.normals.assign(texels, 0);
  std::vector<RayMesh> meshes = ray_meshes(
      *maker.scene, relief_matrices(relief.camera, form.width, form.height, view.eye), maker.frame,
      form.unlit ? std::span<const Material>{maker.unlit} : std::span<const Material>{});
  const EmbreeDevice device = embree_device(kTracer);
  const EmbreeTree tree = embree_tree(device);
  for (RayMesh& mesh : meshes) {
    const EmbreeGeometry geometry = embree_mesh(device, mesh);
    rtcSetGeometryIntersectFilterFunction(geometry.get(), pass_unseen);
    attach(tree, geometry);
  }
  rtcCommitScene(tree.get());
  throw_if_failed(device, kTracer);
  pool.for_each(form.height, [&](int y) {
    for (int x = 0; x < form.width; ++x) {
      const LensRay ray = relief_ray(relief.camera, x, y);
      const int left = x & ~1, top = y & ~1;
      const BlockRays block{relief_ray(relief.camera, left, top),
                            relief_ray(relief.camera, left + 1, top),
                            relief_ray(relief.camera, left, top + 1)};
      ReliefQuery query{{}, block};
      const RTCRayHit hit = first_hit(tree, embree_ray(ray.origin, ray.direction), query.context);
      if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
      const RayMesh& mesh = meshes[hit.hit.geomID];
      const RayHit place{hit.hit.primID, hit.hit.u, hit.hit.v};
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(form.width) +
                             static_cast<std::size_t>(x);
      const double along_m =
          distance_to(mesh, place.triangle, ray, static_cast<double>(hit.ray.tfar));
      relief.depths[at] = code_of(relief.camera, along_m, last_depth(form.depth_bits));
      const glm::vec3 colour = shade_hit(mesh, place, glm::vec3{view.eye}, ray, block, Profile{});
      std::uint16_t halves[3];
      for (int i = 0; i < 3; ++i) halves[i] = float_to_half(colour[i], HalfRounding::nearest_even);
      relief.colours[at] = packed_colour(halves, maker.code_of_half);
      if (form.with_normals) {
        relief.normals[at] =
            packed_normal(normal_of(mesh, place, !meets_front(mesh, place.triangle, ray)));
        const std::uint32_t material = maker.scene->objects[hit.hit.geomID].material;
        if (form.unlit) relief.normals[at] |= material << 24;
      }
    }
  });
  if (form.unlit) keep_unlit(relief, *maker.scene);
  return relief;
}

}  // namespace softfocus
