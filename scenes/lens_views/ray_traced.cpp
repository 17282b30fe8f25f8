#include "scenes/lens_views/ray_traced.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "raster/numbers/random_bits.h"
#include "raster/numbers/vector_math.h"
#include "scenes/draw/transparent_layers.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/lens_views/embree_mesh.h"
#include "scenes/lens_views/ray_geometry.h"

namespace softfocus {
namespace {

constexpr std::string_view kWho = "ray-traced";

/// Where a ray goes through a transparent surface.
struct PassedHit {
  float distance;
  unsigned surface;
  RayHit place;
  float opacity;
};

/// The nearest of them, sorted; surfaces at one distance in the order of drawing.
struct PassedHits {
  std::array<PassedHit, kTransparentLayers> hits;
  std::size_t count = 0;
};

bool is_before(const PassedHit& a, const PassedHit& b) {
  if (a.distance != b.distance) return a.distance < b.distance;
  if (a.surface != b.surface) return a.surface < b.surface;
  return a.place.triangle < b.place.triangle;
}

void insert(const PassedHit& hit, PassedHits& passed) {
  const auto begin = passed.hits.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(passed.count);
  // A tree may hold a triangle several times.
  const bool is_known = std::any_of(begin, end, [&](const PassedHit& known) {
    return known.surface == hit.surface && known.place.triangle == hit.place.triangle;
  });
  if (is_known) return;
  const auto place =
      std::find_if(begin, end, [&](const PassedHit& known) { return is_before(hit, known); });
  if (place == passed.hits.end()) return;
  if (passed.count < passed.hits.size()) ++passed.count;
  std::move_backward(place, begin + static_cast<std::ptrdiff_t>(passed.count) - 1,
                     begin + static_cast<std::ptrdiff_t>(passed.count));
  *place = hit;
}

/// A ray on its way. The context comes first: filters get a pointer to it.
struct Query {
  EmbreeContext context;
  const BlockRays& block;
  const Profile& profile;
  PassedHits& passed;
};

/// Lets rays through holes, through the backs of surfaces that are drawn from the front only, and
/// through transparent surfaces, which it notes.
void skip_unseen(const RTCFilterFunctionNArguments* arguments) {
  if (arguments->N != 1 || arguments->valid[0] == 0) return;
  const auto& mesh = *static_cast<const RayMesh*>(arguments->geometryUserPtr);
  const auto& query = *reinterpret_cast<const Query*>(arguments->context);
  RTCHitN* const hit = arguments->hit;
  const RayHit place{RTCHitN_primID(hit, 1, 0), RTCHitN_u(hit, 1, 0), RTCHitN_v(hit, 1, 0)};
  RTCRayN* const ray = arguments->ray;
  if (mesh.draw.state.cull == Cull::back) {
    const LensRay lens_ray{origin_of(arguments), direction_of(arguments)};
    if (!meets_front(mesh, place.triangle, lens_ray)) {
      arguments->valid[0] = 0;
      return;
    }
  }
  const float opacity = opacity_at(mesh, place, query.block, query.profile);
  if (opacity > 0.0f && !mesh.draw.opacity.blends) return;
  arguments->valid[0] = 0;
  if (opacity == 0.0f) return;
  insert({RTCRayN_tfar(ray, 1, 0), RTCHitN_geomID(hit, 1, 0), place, opacity}, query.passed);
}

struct TracedScene {
  std::vector<RayMesh> meshes;  // which the tree refers to
  EmbreeDevice device;
  EmbreeTree tree;
};

TracedScene traced_scene(const LensViewInput& input) {
  TracedScene traced{ray_meshes(input.scene, input.camera, input.frame), embree_device(kWho), {}};
  traced.tree = embree_tree(traced.device);
  rtcSetSceneBuildQuality(traced.tree.get(), RTC_BUILD_QUALITY_HIGH);
  for (RayMesh& mesh : traced.meshes) {
    const EmbreeGeometry geometry = embree_mesh(traced.device, mesh);
    if (mesh.draw.state.cull == Cull::back || mesh.draw.variant.holed || mesh.draw.opacity.blends) {
      rtcSetGeometryIntersectFilterFunction(geometry.get(), skip_unseen);
    }
    attach(traced.tree, geometry);
  }
  rtcCommitScene(traced.tree.get());
  throw_if_failed(traced.device, kWho);
  return traced;
}

RTCRayHit intersect(const TracedScene& traced, const LensRay& lens_ray, const BlockRays& block,
                    const Camera& camera, const Profile& profile, PassedHits& passed) {
  RTCRay ray = embree_ray(lens_ray.origin, lens_ray.direction);
  ray.tnear = static_cast<float>(camera.near_m);
  ray.tfar = static_cast<float>(camera.far_m);
  Query query{{}, block, profile, passed};
  return first_hit(traced.tree, ray, query.context);
}

/// The pixel's block of the sequence. An exclusive or with it maps every aligned block of 2^k
/// points to another.
std::uint32_t block_of_pixel(int x, int y) { return hash_of_place(x, y) % kMostSamples; }

/// Everything that a ray needs to know.
struct Tracer {
  const LensViewInput& input;
  TracedScene traced;
  RayCamera camera;
  std::vector<glm::dvec2> points;   // of the lens, in metres
  std::vector<glm::dvec2> offsets;  // in the pixel
  std::vector<glm::vec3> eyes;      // the lens's points in the world
};

glm::vec3 trace(const Tracer& tracer, int x, int y, std::uint32_t sample) {
  const LensViewInput& input = tracer.input;
  const glm::dvec2 point = tracer.points[sample];
  const glm::dvec2 offset = tracer.offsets[sample] + 0.5;
  const auto ray_through = [&](int pixel_x, int pixel_y) {
    return lens_ray(tracer.camera, point, pixel_x + offset.x, pixel_y + offset.y);
  };
  const LensRay ray = ray_through(x, y);
  const int left = x & ~1, top = y & ~1;
  const BlockRays block{ray_through(left, top), ray_through(left + 1, top),
                        ray_through(left, top + 1)};
  PassedHits passed;
  const RTCRayHit hit =
      intersect(tracer.traced, ray, block, input.scene.camera, input.profile, passed);
  const auto colour_of = [&](unsigned surface, const RayHit& place) {
    return shade_hit(tracer.traced.meshes[surface], place, tracer.eyes[sample], ray, block,
                     input.profile);
  };
  glm::vec3 colour = hit.hit.geomID == RTC_INVALID_GEOMETRY_ID
                         ? input.scene.background
                         : colour_of(hit.hit.geomID, {hit.hit.primID, hit.hit.u, hit.hit.v});
  for (std::size_t i = passed.count; i-- > 0;) {
    const PassedHit& at = passed.hits[i];
    if (!(at.distance < hit.ray.tfar)) continue;
    colour = colour_of(at.surface, at.place) * at.opacity + (1.0f - at.opacity) * colour;
  }
  return colour;
}

}  // namespace

std::string_view ray_traced_missing() { return {}; }

SampledPicture ray_traced(const LensViewInput& input, ThreadPool& pool) {
  const int width = input.pinhole.width;
  Tracer tracer{input,
                traced_scene(input),
                ray_camera(input.camera, input.focus_m, width, input.pinhole.height),
                lens_points(input.sampling.aperture, kMostSamples),
                pixel_offsets(input.sampling.jitter, kMostSamples),
                {}};
  for (glm::dvec2& point : tracer.points) {
    point *= input.aperture_radius_m;
    tracer.eyes.emplace_back(lens_camera(input.camera, point, input.focus_m, glm::dvec2{0.0}, width,
                                         input.pinhole.height)
                                 .eye);
  }
  const auto add_samples = [&](int begin, int end, SampleSums& sums) {
    pool.for_each(sums.height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        const std::uint32_t block = block_of_pixel(x, y);
        glm::vec3 sum{0.0f};
        for (int i = begin; i < end; ++i) {
          sum += trace(tracer, x, y, static_cast<std::uint32_t>(i) ^ block);
        }
        double* total = sums_at(sums, x, y);
        for (int channel = 0; channel < 3; ++channel) {
          total[channel] += static_cast<double>(sum[channel]);
        }
      }
    });
    sums.count += end - begin;
  };
  return take_samples(input, add_samples, kSampleGroup, pool);
}

}  // namespace softfocus
