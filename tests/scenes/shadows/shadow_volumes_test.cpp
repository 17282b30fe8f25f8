// Shadow volumes: silhouettes of known meshes, and masks against rays and against projection.

#include "scenes/shadows/volumes/shadow_volumes.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <vector>

#include "scenes/draw/frame_matrices.h"
#include "scenes/shadows/shadow_truth.h"
#include "scenes/shadows/volumes/volume_mask.h"
#include "tests/support/random.h"
#include "tests/support/shadow_facets.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

constexpr int kWidth = 61, kHeight = 47;

// Seen from outside, counter-clockwise. An open box has no top.
void add_box(std::vector<Facet>& facets, glm::dvec3 low, glm::dvec3 high, bool two_sided,
             bool open = false) {
  const auto p = [&](int x, int y, int z) {
    return glm::dvec3{x != 0 ? high.x : low.x, y != 0 ? high.y : low.y, z != 0 ? high.z : low.z};
  };
  add_quad(facets, p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1), two_sided);
  add_quad(facets, p(1, 0, 0), p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), two_sided);
  add_quad(facets, p(1, 0, 1), p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), two_sided);
  add_quad(facets, p(0, 0, 0), p(0, 0, 1), p(0, 1, 1), p(0, 1, 0), two_sided);
  add_quad(facets, p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1), two_sided);
  if (!open) add_quad(facets, p(0, 1, 1), p(1, 1, 1), p(1, 1, 0), p(0, 1, 0), two_sided);
}

Camera camera_at(glm::dvec3 position, glm::dvec3 target) {
  Camera camera;
  camera.position = position;
  camera.target = target;
  camera.fov_y_degrees = 50.0;
  camera.near_m = 0.05;
  camera.far_m = 100.0;
  return camera;
}

const Camera kCamera = camera_at({2.1, 2.9, 5.3}, {0.1, 0.4, 0});

ShadowView view_of(const CameraMatrices& camera) {
  return {multiply(camera.eye_to_clip, camera.world_to_eye), kWidth, kHeight, {}};
}

// The nearest facet on the ray through each pixel's centre.
std::vector<SeenFacet> seen_by_rays(const Facets& facets, const CameraMatrices& camera) {
  const ShadowView view = view_of(camera);
  std::vector<SeenFacet> seen(std::size_t{kWidth} * kHeight, 0);
  for (std::size_t pixel = 0; pixel < seen.size(); ++pixel) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < facets.facets.size(); ++i) {
      const FacetPlane& plane = facets.planes[i];
      const double of_eye = height_over(plane, camera.eye);
      if (!has_plane(plane) || (of_eye < 0.0 && !facets.facets[i].two_sided)) continue;
      const auto column = pixel % kWidth, line = pixel / kWidth;
      const glm::dvec3 p = seen_point(
          plane, view.world_to_clip, camera.eye,
          {static_cast<double>(column) + 0.5, static_cast<double>(line) + 0.5}, kWidth, kHeight);
      const auto& c = facets.facets[i].corners;
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k) {
        inside &= dot(plane.normal, cross(c[(k + 1) % 3] - c[k], p - c[k])) >= 0.0;
      }
      const glm::dmat4& m = camera.world_to_eye;
      const double depth = -(m[0][2] * p.x + m[1][2] * p.y + m[2][2] * p.z + m[3][2]);
      if (!inside || depth < 0.05 || depth >= nearest) continue;
      nearest = depth;
      seen[pixel] = 1 + 2 * i + (of_eye < 0.0 ? 1 : 0);
    }
  }
  return seen;
}

std::vector<std::uint8_t> volume_mask(const Facets& facets, const ShadowLight& light,
                                      std::span<const SeenFacet> seen, const CameraMatrices& camera,
                                      VolumeCount count, ThreadPool& pool) {
  const ProjectedShadows sides{
      lit_sides(facets, light), std::vector<std::size_t>(facets.receivers.size() + 1), {}};
  const ProjectedShadows* const of_light = &sides;
  std::vector<std::uint8_t> mask(seen.size());
  draw_shadow_mask(cut_shadows(facets, {&of_light, 1}, seen, view_of(camera), pool),
                   view_of(camera), mask, pool);
  const JoinedFacets joined = join_facets(facets);
  ShadowVolumes volumes = make_shadow_volumes(facets, joined, light);
  draw_volume_mask(facets, joined, volumes, sides.lit, 1, seen, view_of(camera), camera.eye, count,
                   mask, pool);
  return mask;
}

std::size_t differences(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i] ? 1 : 0;
  return count;
}

// Both counts against rays, and against projection: these differ at edges alone, but where facets
// lie off their receiver's plane, onto which shadows are projected. Returns the pixels in shadow.
std::size_t check_masks(const std::vector<Facet>& corners, const ShadowLight& light,
                        const Camera& of = kCamera, bool is_flat = true) {
  const Facets facets = make_facets(corners);
  const CameraMatrices camera = camera_matrices(of, 0.0, kWidth, kHeight);
  const std::vector<SeenFacet> seen = seen_by_rays(facets, camera);
  ThreadPool pool{2};
  const ProjectedShadows projected = project_in_sequence(facets, light);
  const ProjectedShadows* const of_light = &projected;
  std::vector<std::uint8_t> mask(seen.size());
  draw_shadow_mask(cut_shadows(facets, {&of_light, 1}, seen, view_of(camera), pool),
                   view_of(camera), mask, pool);
  const auto errors_of = [&](std::span<const std::uint8_t> in) {
    return shadow_errors(facets, {&light, 1}, seen, in, view_of(camera), camera.eye, false, pool);
  };
  const ShadowErrors of_projected = errors_of(mask);
  if (is_flat) CHECK(of_projected.wrong == 0);
  for (const VolumeCount count : {VolumeCount::z_fail, VolumeCount::z_pass}) {
    CAPTURE(static_cast<int>(count));
    const std::vector<std::uint8_t> counted = volume_mask(facets, light, seen, camera, count, pool);
    const ShadowErrors errors = errors_of(counted);
    CHECK(errors.seen > 300);
    CHECK(errors.wrong == 0);
    CHECK(errors.near_edge <= 1);
    if (!is_flat) continue;
    CHECK(differences(counted, mask) <= errors.near_edge + of_projected.near_edge);
  }
  return of_projected.in_shadow;
}

const ShadowLight kSun{normalize(glm::dvec3{-0.7, 1, 0.4}), 0.0};
const ShadowLight kLamp{{-1.3, 2.6, 1.1}, 1.0};

}  // namespace

TEST_CASE("a box before the sun has six silhouette edges, a square four") {
  std::vector<Facet> corners;
  add_box(corners, {-1, -1, -1}, {1, 1, 1}, false);
  const Facets box = make_facets(corners);
  const ShadowVolumes of_box = make_shadow_volumes(box, join_facets(box), kSun);
  CHECK(of_box.casters.size() == 6);
  CHECK(of_box.silhouette_edges == 6);
  CHECK(of_box.faces.size() == 6 + 6);

  corners.clear();
  add_quad(corners, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  const Facets square = make_facets(corners);
  CHECK(make_shadow_volumes(square, join_facets(square), kLamp).silhouette_edges == 4);
}

TEST_CASE("an edge at 0 and one at -0 are one edge") {
  std::vector<Facet> corners;
  add_triangle(corners, {0.0, 0, 0}, {1, 0, 0}, {1, 1, 0});
  add_triangle(corners, {-0.0, 0, 0}, {1, 1, -0.0}, {0, 1, 0});
  const Facets square = make_facets(corners);
  CHECK(make_shadow_volumes(square, join_facets(square), kLamp).silhouette_edges == 4);
}

TEST_CASE("three triangles on an edge count it once or three times") {
  const ShadowLight above{{0, 1, 0}, 0.0};
  const auto volumes_with = [&](double third_x) {
    std::vector<Facet> corners;
    for (const glm::dvec3& c :
         {glm::dvec3{1, 0.1, 0}, glm::dvec3{1, 0.2, 0}, glm::dvec3{third_x, 0.3, 0}}) {
      add_triangle(corners, {0, 0, 0}, {0, 0, 1}, c);
    }
    const Facets facets = make_facets(corners);
    return make_shadow_volumes(facets, join_facets(facets), above);
  };
  const auto most_times = [](const ShadowVolumes& volumes) {
    std::int32_t most = 0;
    for (const VolumeFace& face : volumes.faces) most = std::max(most, std::abs(face.times));
    return most;
  };
  CHECK(volumes_with(-1.0).silhouette_edges == 7);
  CHECK(most_times(volumes_with(-1.0)) == 1);
  CHECK(most_times(volumes_with(1.0)) == 3);
}

TEST_CASE("volumes of boxes on a floor are right") {
  for (const bool two_sided : {false, true}) {
    CAPTURE(two_sided);
    std::vector<Facet> corners;
    add_floor(corners, 4);
    add_box(corners, {-0.5, 0, -0.5}, {0.5, 1, 0.5}, two_sided);
    CHECK(check_masks(corners, kSun) > 40);
    CHECK(check_masks(corners, kLamp) > 40);
    // A second box touches the first, a third stands on it: coplanar sides, common edges.
    add_box(corners, {0.5, 0, -0.5}, {1.25, 1, 0.5}, two_sided);
    add_box(corners, {-0.5, 1, -0.5}, {0.5, 1.5, 0.5}, two_sided);
    CHECK(check_masks(corners, kSun) > 40);
    CHECK(check_masks(corners, kLamp) > 40);
  }
}

TEST_CASE("volumes of an open mesh, of a mesh with three triangles on an edge are right") {
  std::vector<Facet> corners;
  add_floor(corners, 4);
  add_box(corners, {-0.5, 0.2, -0.5}, {0.5, 1, 0.5}, true, true);
  const glm::dvec3 a{1, 0.3, -0.5}, b{1, 0.9, 0.5};
  for (const glm::dvec3& c : {glm::dvec3{0.6, 0.8, 0}, {1.6, 0.5, 0.2}, {1.2, 1.3, -0.4}}) {
    add_triangle(corners, a, b, c);
  }
  CHECK(check_masks(corners, kSun) > 40);
  CHECK(check_masks(corners, kLamp) > 40);
}

TEST_CASE("volumes are right for a camera inside one") {
  std::vector<Facet> corners;
  add_floor(corners, 4);
  add_box(corners, {-0.5, 1, -0.5}, {0.5, 1.5, 0.5}, false);
  add_quad(corners, {1, 0, 1}, {1, 0, -1}, {1, 1, -1}, {1, 1, 1});
  const ShadowLight above{{0.1, 4, 0.05}, 1.0};
  const Camera below = camera_at({0.05, 0.6, 0.1}, {1, 0.2, -0.3});
  CHECK(check_masks(corners, above, below) > 40);
  CHECK(check_masks(corners, {normalize(glm::dvec3{0.02, 1, 0.01}), 0.0}, below) > 40);
  // Faces of the volume run behind the camera, and through it.
  CHECK(check_masks(corners, {{0.05, 4, 0.5}, 1.0}, below) > 50);
  CHECK(check_masks(corners, kLamp, camera_at({0.5, 0.4, 1.0}, {-1, 0.1, -2})) > 20);
}

TEST_CASE("volumes are right for lights at corners, in planes and inside objects") {
  std::vector<Facet> corners;
  add_floor(corners, 4);
  add_box(corners, {-0.5, 0.3, -0.5}, {0.5, 1, 0.5}, true);
  add_quad(corners, {1, 0.2, 1}, {1, 0.2, -1}, {1, 1, -1}, {1, 1, 1});
  check_masks(corners, {{0.5, 1, 0.5}, 1.0});    // a corner
  check_masks(corners, {{0.5, 1, 0.1}, 1.0});    // an edge
  check_masks(corners, {{0.1, 1, 0.1}, 1.0});    // a side
  check_masks(corners, {{-0.5, 2, 0.3}, 1.0});   // a side's plane
  check_masks(corners, {{1.7, 0, 0.2}, 1.0});    // the floor's plane
  check_masks(corners, {{0.1, 0.6, 0.2}, 1.0});  // inside
  check_masks(corners, {{0.3, -2, 0.1}, 1.0});   // below all
  check_masks(corners, {glm::dvec3{0, 1, 0}, 0.0});
  check_masks(corners, {glm::dvec3{1, 0, 0}, 0.0});
  check_masks(corners, {normalize(glm::dvec3{1, 1e-6, 0.3}), 0.0});  // along the floor, nearly
  const Camera at_light = camera_at({-1.3, 2.6, 1.1}, {0, 0, 0});
  check_masks(corners, {at_light.position, 1.0}, at_light);
}

TEST_CASE("a caster with a corner at the light throws no volume, even if its plane is rounded") {
  test::Random random{11};
  const auto place = [&] {
    const double x = random.between(-1.0, 1.0), y = random.between(-1.0, 1.0);
    return glm::dvec3{x, y, random.between(-1.0, 1.0)};
  };
  int rounded = 0;
  for (int i = 0; i < 40; ++i) {
    std::vector<Facet> corners;
    add_triangle(corners, place(), place(), place());
    const Facets facets = make_facets(corners);
    for (const glm::dvec3& corner : corners[0].corners) {
      const ShadowLight light{corner, 1.0};
      // The corner that gave the plane its offset lies in it exactly, others may not.
      rounded += stops_light(facets.facets[0], facets.planes[0], light) ? 1 : 0;
      const ShadowVolumes volumes = make_shadow_volumes(facets, join_facets(facets), light);
      CHECK(volumes.casters.empty());
      CHECK(volumes.faces.empty());
    }
  }
  CHECK(rounded > 10);
}

TEST_CASE("volumes of thin casters, and of casters through their receivers, are right") {
  std::vector<Facet> corners;
  add_floor(corners, 4);
  add_quad(corners, {-1, -0.5, 0.1}, {1, -0.7, 0.3}, {1.1, 0.8, 0.2}, {-0.9, 1.1, -0.1});
  add_triangle(corners, {-1.5, 0, 1}, {-1.5, 1e-4, 1}, {1.2, 0.9, 1.1});
  add_triangle(corners, {-1, 1.2, 0}, {1, 1.2, 0.001}, {1, 1.2, 0});
  add_triangle(corners, {0, 1, 0}, {1, 1, 0}, {2, 1, 0});  // no area
  add_triangle(corners, {0, 1, 0}, {0, 1, 0}, {0, 1, 0});
  CHECK(check_masks(corners, kSun) > 4);
  CHECK(check_masks(corners, kLamp) > 10);
}

TEST_CASE("what is a little more than epsilon over a receiver casts, what is less does not") {
  // The scene is 283 m across, so that epsilon is a sixth of a pixel of a close look. The look is
  // at a corner of the receiver's second facet, which may lie off its plane by less than half of
  // epsilon.
  const glm::dvec3 bent{-0.1, 0, -0.1}, middle{-0.08, 0, -0.08};
  for (const double height : {0.6, 1.2, 3.0, 20.0}) {
    for (const double bend : {0.0, 0.4}) {
      CAPTURE(height);
      CAPTURE(bend);
      std::vector<Facet> corners;
      add_triangle(corners, {-100, 0, 100}, {100, 0, 100}, {100, 0, -100});
      const double epsilon = 0x1p-21 * 200.0 * std::sqrt(2.0);
      add_triangle(corners, {-100, 0, 100}, {100, 0, -100},
                   bent + glm::dvec3{0, bend * epsilon, 0});
      const auto plate = [&](double x, double z, double rise) {
        return middle + glm::dvec3{x, (height + rise) * epsilon, z};
      };
      const double rise = bend == 0.0 ? 30.0 : 0.0;
      add_quad(corners, plate(-0.011, 0.008, 0.0), plate(0.012, 0.01, rise),
               plate(0.009, -0.011, rise), plate(-0.013, -0.009, 0.0));
      const Facets facets = make_facets(corners);
      REQUIRE(facets.receiver_of[0] == facets.receiver_of[1]);
      REQUIRE(std::fabs(facets.epsilon_m - epsilon) < 1e-3 * epsilon);
      Camera camera = camera_at(middle + glm::dvec3{0.015, 0.1, 0.06}, middle);
      camera.fov_y_degrees = 26.0;
      for (const ShadowLight& light : {ShadowLight{normalize(glm::dvec3{1.0, 0.5, 0.13}), 0.0},
                                       ShadowLight{normalize(glm::dvec3{-1.0, 0.5, 0.13}), 0.0},
                                       // Its samples leave their pixels.
                                       ShadowLight{normalize(glm::dvec3{1.0, 0.05, 0.13}), 0.0},
                                       ShadowLight{middle + glm::dvec3{0.4, 0.2, 0.1}, 1.0}}) {
        check_masks(corners, light, camera, bend == 0.0);
      }
    }
  }
}

TEST_CASE("volumes of random triangles are right from random places") {
  for (std::uint32_t seed = 1; seed < 9; ++seed) {
    CAPTURE(seed);
    test::Random random{seed};
    const auto place = [&] {
      const double x = random.between(-1.0, 1.0), y = random.between(-1.0, 1.0);
      return glm::dvec3{x, y, random.between(-1.0, 1.0)};
    };
    std::vector<Facet> corners;
    add_floor(corners, 4);
    for (int i = 0; i < 40; ++i) {
      const glm::dvec3 at = place() * 2.0;
      const glm::dvec3 a = at + place() * 0.6, b = at + place() * 0.6, c = at + place() * 0.6;
      corners.push_back({{a, b, c}, i % 3 != 0, i % 7 != 0});
    }
    const glm::dvec3 eye = place() * 2.0 + glm::dvec3{0, 2.5, 0};
    const Camera camera = camera_at(eye, place());
    const glm::dvec3 light = place() * 2.0;
    check_masks(corners, {light, 1.0}, camera);
    check_masks(corners, {normalize(light), 0.0}, camera);
    check_masks(corners, {corners[10].corners[0], 1.0}, camera);
  }
}

TEST_CASE("volumes hold the points that rays to the light find dark") {
  std::vector<Facet> corners;
  add_box(corners, {-0.5, 0, -0.5}, {0.5, 1, 0.5}, false);
  const Facets facets = make_facets(corners);
  const JoinedFacets joined = join_facets(facets);
  std::vector<std::uint32_t> all(facets.facets.size());
  std::iota(all.begin(), all.end(), 0u);
  const ShadowLight above{{0, 5, 0}, 1.0};
  const auto held = [&](glm::dvec3 p) { return volumes_that_hold(facets, joined, above, all, p); };
  CHECK(held({0, -1, 0}) == 1);  // its ray runs through the diagonal of the top
  CHECK(held({0.1, -1, 0.3}) == 1);
  CHECK(held({0.1, 1.1, 0.3}) == 0);
  CHECK(held({2, 0.5, 0}) == 0);
}

TEST_CASE("a pixel with a sample is dark exactly if its count and the eye's are more than none") {
  std::vector<Facet> corners;
  add_floor(corners, 4);
  add_box(corners, {-0.5, 0, -0.5}, {0.5, 1, 0.5}, false);
  const Facets facets = make_facets(corners);
  const JoinedFacets joined = join_facets(facets);
  const CameraMatrices camera = camera_matrices(kCamera, 0.0, kWidth, kHeight);
  const std::vector<SeenFacet> seen = seen_by_rays(facets, camera);
  const ShadowVolumes volumes = make_shadow_volumes(facets, joined, kLamp);
  const std::vector<LitSide> lit = lit_sides(facets, kLamp);
  ThreadPool pool{2};
  const int of_eye = volumes_that_hold(facets, joined, kLamp, volumes.casters, camera.eye);
  for (const VolumeCount count : {VolumeCount::z_fail, VolumeCount::z_pass}) {
    const std::vector<std::uint8_t> mask = volume_mask(facets, kLamp, seen, camera, count, pool);
    std::vector<std::uint8_t> none(seen.size());
    const VolumeCounts counted = count_volumes(facets, joined, volumes, lit, 1, seen,
                                               view_of(camera), camera.eye, count, none, pool);
    int samples = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (counted.samples[i].z == 0.0) continue;
      ++samples;
      const std::int64_t held = counted.counts[i] + (count == VolumeCount::z_pass ? of_eye : 0);
      REQUIRE(held >= 0);
      REQUIRE((held > 0) == (mask[i] == 1));
    }
    CHECK(samples > 500);
  }
}

TEST_CASE("bands, blocks and outlines leave out no face that counts") {
  // The scene is 100 km across, so that samples lie up to half a pixel beside their centres.
  std::vector<Facet> corners;
  add_floor(corners, 4);
  test::Random random{21};
  const auto place = [&] {
    const double x = random.between(-1.0, 1.0), y = random.between(-1.0, 1.0);
    return glm::dvec3{x, y, random.between(-1.0, 1.0)};
  };
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 at = place() * 2.0 + glm::dvec3{0, 1, 0};
    add_triangle(corners, at + place() * 0.3, at + place() * 0.3, at + place() * 0.3);
  }
  add_triangle(corners, {1e5, 0, 0}, {1e5, 1, 0}, {1e5, 0, 1});
  const Facets facets = make_facets(corners);
  const JoinedFacets joined = join_facets(facets);
  const CameraMatrices camera = camera_matrices(kCamera, 0.0, kWidth, kHeight);
  const std::vector<SeenFacet> seen = seen_by_rays(facets, camera);
  std::vector<std::uint8_t> mask(seen.size());
  ThreadPool pool{2};
  int beside = 0;
  for (const ShadowLight& light : {kSun, kLamp, ShadowLight{{0.3, 0.5, 2.0}, 1.0}}) {
    const ShadowVolumes volumes = make_shadow_volumes(facets, joined, light);
    const auto first_far = static_cast<std::uint32_t>(joined.corners.size());
    const VolumeCounts counted =
        count_volumes(facets, joined, volumes, lit_sides(facets, light), 1, seen, view_of(camera),
                      camera.eye, VolumeCount::z_fail, mask, pool);
    const double facing = pixel_space(view_of(camera), camera.eye).facing;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const glm::dvec3 sample = counted.samples[i];
      if (sample.z == 0.0) continue;
      beside += std::fabs(sample.x - std::floor(sample.x) - 0.5) > 0.1 ? 1 : 0;
      std::int64_t sum = 0;
      for (const VolumeFace& face : volumes.faces) {
        double of_w = 0.0, finite = 0.0;
        int positive = 0, negative = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const glm::dvec3 e = cross(counted.corners[face.corners[(k + 1) % 3]],
                                     counted.corners[face.corners[(k + 2) % 3]]);
          const double at = (e.x * sample.x + e.y * sample.y) + e.z;
          positive += at > 0.0 ? 1 : 0;
          negative += at < 0.0 ? 1 : 0;
          of_w += at * counted.corners[face.corners[k]].z;
          finite += face.corners[k] < first_far ? at : 0.0;
        }
        const double beyond = sample.z * of_w - finite;
        const int times = facing > 0.0 ? -face.times : face.times;
        if (positive == 3 && beyond > 0.0) sum += times;
        if (negative == 3 && beyond < 0.0) sum -= times;
      }
      REQUIRE(counted.counts[i] == sum);
    }
  }
  CHECK(beside > 1000);
}

TEST_CASE("a sample on a common edge of two casters is in the volume of one") {
  // A picture of one column, whose centres lie in the plane of the edge and of the sun.
  std::vector<Facet> corners;
  add_triangle(corners, {-40, 0, 20}, {40, 0, 20}, {0, 0, -60});
  add_triangle(corners, {0, 1, 1}, {1, 1, 0}, {0, 1, -1});
  add_triangle(corners, {0, 1, 1}, {0, 1, -1}, {-1, 1, 0});
  const Facets facets = make_facets(corners);
  const JoinedFacets joined = join_facets(facets);
  const ShadowLight sun{normalize(glm::dvec3{0, 1, 0.5}), 0.0};
  const ShadowVolumes volumes = make_shadow_volumes(facets, joined, sun);
  const CameraMatrices camera =
      camera_matrices(camera_at({0, 6, 3}, {0, 0, -0.5}), 0.0, 1, kHeight);
  const ShadowView view{multiply(camera.eye_to_clip, camera.world_to_eye), 1, kHeight, {}};
  const std::vector<SeenFacet> seen(kHeight, 1);
  std::vector<std::uint8_t> mask(kHeight);
  ThreadPool pool{1};
  for (const VolumeCount count : {VolumeCount::z_fail, VolumeCount::z_pass}) {
    const VolumeCounts counted = count_volumes(facets, joined, volumes, lit_sides(facets, sun), 1,
                                               seen, view, camera.eye, count, mask, pool);
    int on_edge = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const glm::dvec3 at = seen_point(facets.planes[0], view.world_to_clip, camera.eye,
                                       {0.5, static_cast<double>(i) + 0.5}, 1, kHeight);
      const double from_middle = std::fabs(at.z + 0.5);  // of the shadow
      if (std::fabs(from_middle - 1.0) < 1e-3) continue;
      REQUIRE(counted.counts[i] == (from_middle < 1.0 ? 1 : 0));
      on_edge += counted.samples[i].x == 0.5 && from_middle < 1.0 ? 1 : 0;
    }
    CHECK(on_edge > 5);
  }
}
