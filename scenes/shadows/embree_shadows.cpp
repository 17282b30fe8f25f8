#include "scenes/shadows/embree_shadows.h"

#include <string_view>
#include <vector>

#include "scenes/embree/embree.h"
#include "scenes/shadows/projected_shadows.h"

namespace softfocus {

// Three corners a facet, which no other has.
struct EmbreeShadows::Tree {
  const Facets& facets;
  std::vector<float> corners;
  std::vector<unsigned> indices;
  EmbreeDevice device;
  EmbreeTree tree;
};

namespace {

constexpr std::string_view kShadows = "shadows by Embree";

// A ray on its way. The context comes first: filters get a pointer to it.
struct ShadowQuery {
  EmbreeContext context;
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

EmbreeShadows::EmbreeShadows(const Facets& facets) : tree_(new Tree{facets, {}, {}, {}, {}}) {
  for (const Facet& facet : facets.facets) {
    for (const glm::dvec3& corner : facet.corners) {
      for (int i = 0; i < 3; ++i) tree_->corners.push_back(static_cast<float>(corner[i]));
      tree_->indices.push_back(static_cast<unsigned>(tree_->indices.size()));
    }
  }
  const std::size_t corners = tree_->indices.size();
  tree_->corners.push_back(0.0f);  // Embree reads 16 bytes of the last corner
  tree_->device = embree_device(kShadows);
  tree_->tree = embree_tree(tree_->device);
  const EmbreeGeometry geometry =
      embree_triangles(tree_->device, tree_->corners.data(), corners, tree_->indices);
  rtcSetGeometryOccludedFilterFunction(geometry.get(), pass_light);
  attach(tree_->tree, geometry);
  rtcCommitScene(tree_->tree.get());
  throw_if_failed(tree_->device, kShadows);
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
  RTCRay ray = embree_ray(point, query.direction);
  if (light.w != 0.0) ray.tfar = 1.0f;
  return is_stopped(tree_->tree, ray, query.context);
}

}  // namespace softfocus
