#include "scenes/traced_relief/traced_relief.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "raster/numbers/half.h"
#include "raster/numbers/vector_math.h"
#include "scenes/lens_views/ray_geometry.h"
#include "scenes/relief/packed_texel.h"

namespace softfocus {
namespace {

#if RTC_VERSION_MAJOR >= 4
using ReliefContext = RTCRayQueryContext;
#else
using ReliefContext = RTCIntersectContext;
#endif

/// The meshes, and the tree that refers to them.
struct ReliefTree {
  std::vector<RayMesh> meshes;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ReliefTree() = default;
  ReliefTree(const ReliefTree&) = delete;
  ReliefTree& operator=(const ReliefTree&) = delete;
  ~ReliefTree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

/// A ray on its way. The context comes first: filters get a pointer to it.
struct ReliefQuery {
  ReliefContext context;
  const BlockRays& block;
};

void throw_if_failed(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw std::runtime_error("traced relief: Embree failed with error " + std::to_string(error) +
                           (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory" : ""));
}

/// Lets rays through the backs of surfaces that are drawn from the front only, through holes, and
/// through transparent surfaces, which reliefs leave out.
void pass_unseen(const RTCFilterFunctionNArguments* arguments) {
  if (arguments->N != 1 || arguments->valid[0] == 0) return;
  const auto& mesh = *static_cast<const RayMesh*>(arguments->geometryUserPtr);
  const auto& query = *reinterpret_cast<const ReliefQuery*>(arguments->context);
  RTCHitN* const hit = arguments->hit;
  const RayHit place{RTCHitN_primID(hit, 1, 0), RTCHitN_u(hit, 1, 0), RTCHitN_v(hit, 1, 0)};
  RTCRayN* const ray = arguments->ray;
  const LensRay own{{RTCRayN_org_x(ray, 1, 0), RTCRayN_org_y(ray, 1, 0), RTCRayN_org_z(ray, 1, 0)},
                    {RTCRayN_dir_x(ray, 1, 0), RTCRayN_dir_y(ray, 1, 0), RTCRayN_dir_z(ray, 1, 0)}};
  const bool is_culled =
      mesh.draw.state.cull == Cull::back && !meets_front(mesh, place.triangle, own);
  if (is_culled || mesh.draw.opacity.blends ||
      opacity_at(mesh, place, query.block, Profile{}) == 0.0f) {
    arguments->valid[0] = 0;
  }
}

void grow_tree(ReliefTree& tree) {
  // No threads of its own: rays are traced on the pool's.
  tree.device = rtcNewDevice("threads=1");
  throw_if_failed(tree.device);
  tree.scene = rtcNewScene(tree.device);
  rtcSetSceneFlags(tree.scene, RTC_SCENE_FLAG_ROBUST);  // no ray between two triangles
  for (RayMesh& mesh : tree.meshes) {
    const auto& indices = mesh.draw.input.mesh->indices;
    const RTCGeometry geometry = rtcNewGeometry(tree.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t vertices = mesh.positions.size();
    mesh.positions.emplace_back(0.0f);  // Embree reads 16 bytes of the last vertex
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh.positions.data(), 0, sizeof(glm::vec3), vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(),
                               0, 3 * sizeof(std::uint32_t), indices.size() / 3);
    rtcSetGeometryUserData(geometry, &mesh);
    rtcSetGeometryIntersectFilterFunction(geometry, pass_unseen);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tree.scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(tree.scene);
  throw_if_failed(tree.device);
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

RTCRayHit first_hit(const ReliefTree& tree, const LensRay& ray, const BlockRays& block) {
  RTCRayHit hit{};
  hit.ray.org_x = static_cast<float>(ray.origin.x);
  hit.ray.org_y = static_cast<float>(ray.origin.y);
  hit.ray.org_z = static_cast<float>(ray.origin.z);
  hit.ray.dir_x = static_cast<float>(ray.direction.x);
  hit.ray.dir_y = static_cast<float>(ray.direction.y);
  hit.ray.dir_z = static_cast<float>(ray.direction.z);
  hit.ray.tfar = std::numeric_limits<float>::infinity();
  hit.ray.mask = std::numeric_limits<unsigned>::max();
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ReliefQuery query{{}, block};
#if RTC_VERSION_MAJOR >= 4
  rtcInitRayQueryContext(&query.context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &query.context;
  rtcIntersect1(tree.scene, &hit, &arguments);
#else
  rtcInitIntersectContext(&query.context);
  rtcIntersect1(tree.scene, &query.context, &hit);
#endif
  return hit;
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
  ReliefTree tree;
  tree.meshes = ray_meshes(
      *maker.scene, relief_matrices(relief.camera, form.width, form.height, view.eye), maker.frame);
  grow_tree(tree);
  pool.for_each(form.height, [&](int y) {
    for (int x = 0; x < form.width; ++x) {
      const LensRay ray = relief_ray(relief.camera, x, y);
      const int left = x & ~1, top = y & ~1;
      const BlockRays block{relief_ray(relief.camera, left, top),
                            relief_ray(relief.camera, left + 1, top),
                            relief_ray(relief.camera, left, top + 1)};
      const RTCRayHit hit = first_hit(tree, ray, block);
      if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
      const RayMesh& mesh = tree.meshes[hit.hit.geomID];
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
      }
    }
  });
  return relief;
}

}  // namespace softfocus
