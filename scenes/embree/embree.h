#pragma once
// Embree, version 4 or 3, as rooms that trace rays use it. Only what is compiled with Embree may
// include it.

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace softfocus {

#if RTC_VERSION_MAJOR >= 4
using EmbreeContext = RTCRayQueryContext;
#else
using EmbreeContext = RTCIntersectContext;
#endif

template <auto release>
struct ReleaseEmbree {
  template <class Handle>
  void operator()(Handle* handle) const {
    release(handle);
  }
};
using EmbreeDevice =
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseEmbree<rtcReleaseDevice>>;
using EmbreeTree = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseEmbree<rtcReleaseScene>>;
using EmbreeGeometry =
    std::unique_ptr<std::remove_pointer_t<RTCGeometry>, ReleaseEmbree<rtcReleaseGeometry>>;

/// Throws std::runtime_error that begins with `who` if the device has failed.
inline void throw_if_failed(const EmbreeDevice& device, std::string_view who) {
  const RTCError error = rtcGetDeviceError(device.get());
  if (error == RTC_ERROR_NONE) return;
  throw std::runtime_error(std::string{who} + ": Embree failed with error " +
                           std::to_string(error) +
                           (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory" : ""));
}

/// Without threads of its own: rays are traced on the pool's.
inline EmbreeDevice embree_device(std::string_view who) {
  EmbreeDevice device{rtcNewDevice("threads=1")};
  throw_if_failed(device, who);
  return device;
}

/// Empty; no ray will go between two triangles that share an edge.
inline EmbreeTree embree_tree(const EmbreeDevice& device) {
  EmbreeTree tree{rtcNewScene(device.get())};
  rtcSetSceneFlags(tree.get(), RTC_SCENE_FLAG_ROBUST);
  return tree;
}

/// Triangles that refer to the caller's numbers, which must live as long as the tree. `coordinates`
/// are x, y, z of each vertex, and one number more: Embree reads 16 bytes of the last vertex.
inline EmbreeGeometry embree_triangles(const EmbreeDevice& device, const float* coordinates,
                                       std::size_t vertices,
                                       std::span<const std::uint32_t> indices) {
  EmbreeGeometry geometry{rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE)};
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             coordinates, 0, 3 * sizeof(float), vertices);
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             indices.data(), 0, 3 * sizeof(std::uint32_t), indices.size() / 3);
  return geometry;
}

inline void attach(const EmbreeTree& tree, const EmbreeGeometry& geometry) {
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(tree.get(), geometry.get());
}

/// Without an end, and not yet traced.
inline RTCRay embree_ray(const glm::dvec3& origin, const glm::dvec3& direction) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x);
  ray.org_y = static_cast<float>(origin.y);
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(direction.x);
  ray.dir_y = static_cast<float>(direction.y);
  ray.dir_z = static_cast<float>(direction.z);
  ray.tfar = std::numeric_limits<float>::infinity();
  ray.mask = std::numeric_limits<unsigned>::max();
  return ray;
}

/// The first hit; its geomID is RTC_INVALID_GEOMETRY_ID if there is none. Filters get a pointer to
/// the context.
inline RTCRayHit first_hit(const EmbreeTree& tree, const RTCRay& ray, EmbreeContext& context) {
  RTCRayHit hit{};
  hit.ray = ray;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
  rtcInitRayQueryContext(&context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  rtcIntersect1(tree.get(), &hit, &arguments);
#else
  rtcInitIntersectContext(&context);
  rtcIntersect1(tree.get(), &context, &hit);
#endif
  return hit;
}

/// Whether anything stops the ray.
inline bool is_stopped(const EmbreeTree& tree, RTCRay ray, EmbreeContext& context) {
#if RTC_VERSION_MAJOR >= 4
  rtcInitRayQueryContext(&context);
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &context;
  rtcOccluded1(tree.get(), &ray, &arguments);
#else
  rtcInitIntersectContext(&context);
  rtcOccluded1(tree.get(), &context, &ray);
#endif
  return ray.tfar < 0.0f;  // as Embree says that something is hit
}

/// The place that a filter is asked about.
inline glm::dvec3 origin_of(const RTCFilterFunctionNArguments* arguments) {
  RTCRayN* const ray = arguments->ray;
  return {RTCRayN_org_x(ray, 1, 0), RTCRayN_org_y(ray, 1, 0), RTCRayN_org_z(ray, 1, 0)};
}
inline glm::dvec3 direction_of(const RTCFilterFunctionNArguments* arguments) {
  RTCRayN* const ray = arguments->ray;
  return {RTCRayN_dir_x(ray, 1, 0), RTCRayN_dir_y(ray, 1, 0), RTCRayN_dir_z(ray, 1, 0)};
}

}  // namespace softfocus
