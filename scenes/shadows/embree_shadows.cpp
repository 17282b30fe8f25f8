#include "scenes/shadows/embree_shadows.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/shadows/projected_shadows.h"

namespace softfocus {

// Three corners a facet, which no other has.
struct EmbreeShadows::Tree {
  const Facets& facets;
  std::vector<float> corners;
  std::vector<unsigned> indices;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Tree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

namespace {

#if RTC_VERSION_MAJOR >= 4
using ShadowContext = RTCRayQueryContext;
#else
using ShadowContext = RTCIntersectContext;
#endif

void throw_if_failed(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw std::runtime_error("shadows by Embree: it failed with error " + std::to_string(error) +
                           (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory" : ""));
}

// A ray on its way. The context comes first: filters get a pointer to it.
struct ShadowQuery {
  ShadowContext context;
  const Facets& facets;
  std::uint32_t receiver;
  double side;  // 1, or -1 on a receiver's back
  glm::dvec3 from, direction;
};

// Lets the ray through what does not stop light on its way.
void pass_light(const RTCFilterFunctionNArguments* arguments) {
  if (arguments->N != 1 || arguments->valid[0] == 0) return;
  const auto& query = *reinterpret_cast<const ShadowQuery*>(arguments->context);
  RTCHitN* const hit = arguments->hit;
  const std::uint32_t number = RTCHitN_primID(hit, 1, 0);
  const Facet& facet = query.facets.facets[number];
  const glm::dvec3 normal{static_cast<double>(RTCHitN_Ng_x(hit, 1, 0)),
                          static_cast<double>(RTCHitN_Ng_y(hit, 1, 0)),
                          static_cast<double>(RTCHitN_Ng_z(hit, 1, 0))};
  const bool comes_to_front = dot(normal, query.direction) > 0.0;
  const double t = static_cast<double>(RTCRayN_tfar(arguments->ray, 1, 0));
  const double height =
      height_over(query.facets.receivers[query.receiver].plane, query.from + query.direction * t) *
      query.side;
  const bool stops = facet.casts && (facet.two_sided || comes_to_front) &&
                     query.facets.receiver_of[number] != query.receiver &&
                     height > query.facets.epsilon_m;
  if (!stops) arguments->valid[0] = 0;
}

}  // namespace

std::string_view embree_shadows_missing() { return {}; }

EmbreeShadows::EmbreeShadows(const Facets& facets) : tree_(new Tree{facets, {}, {}}) {
  for (const Facet& facet : facets.facets) {
    for (const glm::dvec3& corner : facet.corners) {
      for (int i = 0; i < 3; ++i) tree_->corners.push_back(static_cast<float>(corner[i]));
      tree_->indices.push_back(static_cast<unsigned>(tree_->indices.size()));
    }
  }
  const std::size_t corners = tree_->indices.size();
  tree_->corners.push_back(0.0f);  // Embree reads 16 bytes of the last corner
  // No threads of its own: rays are traced on the pool's.
  tree_->device = rtcNewDevice("threads=1");
  throw_if_failed(tree_->device);
  tree_->scene = rtcNewScene(tree_->device);
  rtcSetSceneFlags(tree_->scene, RTC_SCENE_FLAG_ROBUST);  // no ray between two triangles
  const RTCGeometry geometry = rtcNewGeometry(tree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             tree_->corners.data(), 0, 3 * sizeof(float), corners);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             tree_->indices.data(), 0, 3 * sizeof(unsigned), corners / 3);
  rtcSetGeometryOccludedFilterFunction(geometry, pass_light);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(tree_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(tree_->scene);
  throw_if_failed(tree_->device);
}

EmbreeShadows::~EmbreeShadows() = default;

bool EmbreeShadows::is_dark(std::uint32_t facet, bool seen_from_back, glm::dvec3 point,
                            const ShadowLight& light) const {
  const Facets& facets = tree_->facets;
  const std::uint32_t number = facets.receiver_of[facet];
  const LitSide lit = lit_side(facets.receivers[number], light, facets.epsilon_m);
  if (lit == LitSide::both) return false;
  if (lit != (seen_from_back ? LitSide::back : LitSide::front)) return true;
  ShadowQuery query{
      {}, facets, number, lit == LitSide::front ? 1.0 : -1.0, point, light.place - point * light.w};
  RTCRay ray{};
  ray.org_x = static_cast<float>(point.x);
  ray.org_y = static_cast<float>(point.y);
  ray.org_z = static_cast<float>(point.z);
  ray.dir_x = static_cast<float>(query.direction.x);
  ray.dir_y = static_cast<float>(query.direction.y);
  ray.dir_z = static_cast<float>(query.direction.z);
  ray.tfar = light.w != 0.0 ? 1.0f : std::numeric_limits<float>::infinity();
  ray.mask = std::numeric_limits<unsigned>::max();
#if RTC_VERSION_MAJOR >= 4
  rtcInitRayQueryContext(&query.context);
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &query.context;
  rtcOccluded1(tree_->scene, &ray, &arguments);
#else
  rtcInitIntersectContext(&query.context);
  rtcOccluded1(tree_->scene, &query.context, &ray);
#endif
  return ray.tfar < 0.0f;  // as Embree says that something is hit
}

}  // namespace softfocus
