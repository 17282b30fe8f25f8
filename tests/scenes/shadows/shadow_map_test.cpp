// Shadow maps: texels against rays, and each of a map's failures where it must be and nowhere else.

#include "scenes/shadows/maps/shadow_map.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "raster/pipeline/setup.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/load/load_scene.h"
#include "scenes/shadows/light_grid.h"
#include "scenes/shadows/maps/draw_map_side.h"
#include "scenes/shadows/maps/map_lookup.h"
#include "tests/support/random.h"
#include "tests/support/shadow_facets.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

Facets square_over_floor(double height) {
  std::vector<Facet> facets;
  add_floor(facets, 4);
  add_quad(facets, {-1, height, 1}, {1, height, 1}, {1, height, -1}, {-1, height, -1});
  return make_facets(std::move(facets));
}

const ShadowLight kSun{normalize(glm::dvec3{0.5, 1.0, 0.3}), 0.0};
const ShadowLight kLamp{{0.5, 4.0, 0.25}, 1.0};

// Looks along -z from (0, 1, 6), 90 degrees wide and high, y downwards.
MapCamera camera_ahead() {
  glm::dmat4 to_clip{0.0};
  to_clip[0][0] = 1.0, to_clip[1][1] = -1.0;
  to_clip[3][1] = 1.0;
  to_clip[2][2] = -1.0, to_clip[2][3] = -1.0, to_clip[3][3] = 6.0;
  return {to_clip, {0, 1, 6}, 0.1, 50.0};
}

ShadowMapSettings of_scene(int size, double bias, double slope_bias, int kernel = 1) {
  return {size, bias, slope_bias, kernel, 1, false};
}

ShadowMap drawn(const Facets& facets, const ShadowLight& light, const ShadowMapSettings& settings,
                int threads = 1) {
  ThreadPool pool{threads};
  return draw_shadow_map(facets, light, settings, camera_ahead(), {}, pool);
}

// The definition of a texel: the ray of the light through (u, v) against every caster.
double nearest_caster(const Facets& facets, const ShadowMap& map, const MapSide& side, double u,
                      double v) {
  const double x = u / side.texels.x + side.low.x, y = v / side.texels.y + side.low.y;
  const glm::dvec3 across = side.axes[0] * x + side.axes[1] * y;
  const bool is_point = map.light.w != 0.0;
  const glm::dvec3 from = is_point ? side.origin : side.origin + across;
  const glm::dvec3 ray = is_point ? across + side.axes[2] : side.axes[2];
  double nearest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < facets.facets.size(); ++i) {
    if (!stops_light(facets.facets[i], facets.planes[i], map.light)) continue;
    const auto& [a, b, c] = facets.facets[i].corners;
    const glm::dvec3 p = cross(ray, c - a), q = cross(from - a, b - a);
    const double determinant = dot(b - a, p);
    if (determinant == 0.0) continue;
    const double s = dot(from - a, p) / determinant, t = dot(ray, q) / determinant;
    if (s < 0.0 || t < 0.0 || s + t > 1.0) continue;
    const double z = dot(c - a, q) / determinant;
    if (is_point && !(z > facets.epsilon_m)) continue;
    nearest = std::max(nearest, is_point ? 1.0 / z : -z);
  }
  return nearest;
}

// A texel may hold what a ray meets 1/256 texel from its centre: corners are snapped to that.
bool is_as_rays_say(const Facets& facets, const ShadowMap& map, const MapSide& side, int i, int j) {
  const auto size = static_cast<std::size_t>(map.settings.size);
  const double stored =
      side.nearness[static_cast<std::size_t>(j) * size + static_cast<std::size_t>(i)];
  for (const double du : {0.0, -1.0, 1.0}) {
    for (const double dv : {0.0, -1.0, 1.0}) {
      const double truth =
          nearest_caster(facets, map, side, i + 0.5 + du / 256.0, j + 0.5 + dv / 256.0);
      if (truth == stored || std::fabs(truth - stored) < 1e-3 * (1.0 + std::fabs(truth))) {
        return true;
      }
    }
  }
  return false;
}

// Calls use(point, blocked_texels()) for a grid on the floor, which facet 0 is of.
template <class Use>
void for_each_point(const Facets& facets, const ShadowMap& map, const Use& use) {
  for (int x_step = 0; - 2.91 + 0.0253 * x_step < 3.0; ++x_step) {
    const double x = -2.91 + 0.0253 * x_step;
    for (int z_step = 0; - 2.93 + 0.0257 * z_step < 3.0; ++z_step) {
      const double z = -2.93 + 0.0257 * z_step;
      const glm::dvec3 point{x, 0, z};
      use(point, blocked_texels(map, map_place(map, facets.receivers[0], point)));
    }
  }
}

bool is_under_square(glm::dvec3 point, const ShadowLight& light, double height) {
  const glm::dvec3 towards = light.place - point * light.w;
  const glm::dvec3 at = point + towards * (height / towards.y);
  return std::fabs(at.x) < 1.0 && std::fabs(at.z) < 1.0;
}

int wrong_points(const ShadowLight& light, const ShadowMapSettings& settings) {
  const Facets facets = square_over_floor(1.0);
  const ShadowMap map = drawn(facets, light, settings);
  int wrong = 0;
  for_each_point(facets, map, [&](glm::dvec3 point, int blocked) {
    wrong += (blocked > 0) != is_under_square(point, light, 1.0) ? 1 : 0;
  });
  return wrong;
}

}  // namespace

TEST_CASE("a texel holds the nearest caster that a ray of the light meets") {
  const Facets facets = facet_soup(3, 150, 0.4);
  for (const ShadowLight& light : {kSun, ShadowLight{{0.2, 0.1, -0.3}, 1.0}, kLamp}) {
    for (const bool fits_camera : {false, true}) {
      ShadowMapSettings settings = of_scene(48, 0.0, 0.0);
      settings.fits_camera = fits_camera;
      settings.cascades = fits_camera ? 3 : 1;
      const ShadowMap map = drawn(facets, light, settings);
      int beside = 0, texels = 0, covered = 0;
      for (const MapSide& side : map.sides) {
        if (side.nearness.empty()) continue;
        for (int j = 0; j < 48; ++j) {
          for (int i = 0; i < 48; ++i) {
            ++texels;
            covered += side.nearness[static_cast<std::size_t>(48 * j + i)] > -1e30f ? 1 : 0;
            beside += is_as_rays_say(facets, map, side, i, j) ? 0 : 1;
          }
        }
      }
      CHECK(covered > 100);
      // Several snapped edges meet there, or a caster is nearly edge-on.
      CHECK(beside * 500 <= texels);
    }
  }
}

TEST_CASE("a side drawn in bands has the bits of its casters drawn one by one") {
  const Facets facets = facet_soup(4, 300, 0.4);
  ThreadPool pool{2};
  const int size = 150;
  const Rectangle whole{0, 0, size, size};
  for (const ShadowLight& light : {kSun, ShadowLight{{0.2, 0.1, -0.3}, 1.0}}) {
    for (const MapSide& side : drawn(facets, light, of_scene(size, 0.0, 0.0)).sides) {
      if (side.nearness.empty()) continue;
      std::vector<float> expected(side.nearness.size(), -std::numeric_limits<float>::infinity());
      for (const CutCasters& part : cut_casters(facets, light, size, side, pool)) {
        for (const MapTriangle& triangle : part.triangles) {
          const auto setup =
              set_up_triangle(triangle.window, Cull::none, FrontFace::counter_clockwise, whole, {});
          if (!setup) continue;
          for (int y = setup->bounds.y_begin; y < setup->bounds.y_end; ++y) {
            const Span span = covered_span(*setup, y, setup->bounds.x_begin, setup->bounds.x_end);
            for (int x = span.x_begin; x < span.x_end; ++x) {
              const double plain =
                  triangle.over_u * (x + 0.5) + (triangle.over_v * (y + 0.5) + triangle.at_origin);
              float& texel = expected[static_cast<std::size_t>(size * y + x)];
              texel = std::max(
                  texel, static_cast<float>(std::clamp(plain, triangle.least, triangle.most)));
            }
          }
        }
      }
      CHECK(side.nearness == expected);
    }
  }
}

TEST_CASE("casters that the light sees edge-on are no nearer than their corners") {
  const glm::dvec3 towards = normalize(glm::dvec3{0.3, 1.0, 0.2});
  const glm::dvec3 along = normalize(cross(towards, {0, 0, 1})), across = cross(along, towards);
  std::vector<Facet> corners;
  // Walls of 1/30 to 1/3000 texel. The map is so wide because of the things below them.
  add_quad(corners, {-4, -6, 4}, {4, -6, 4}, {4, -6, -4}, {-4, -6, -4});
  test::Random random{5};
  for (int i = 0; i < 200; ++i) {
    const double leans = i % 3 == 0 ? 1e-3 : i % 3 == 1 ? 1e-4 : 1e-5;
    const glm::dvec3 a = along * -2.0 + across * random.between(-2.0, 2.0);
    const glm::dvec3 b = a + along * 4.0 + across * random.between(-0.5, 0.5);
    const glm::dvec3 up = towards * 1.5 + across * leans;
    add_quad(corners, a, b, b + up, a + up);
  }
  const Facets facets = make_facets(std::move(corners));
  const ShadowMap map = drawn(facets, {towards, 0.0}, of_scene(256, 0.0, 0.0));
  const double least = -dot(map.sides[0].origin, towards);
  int on_walls = 0;
  for (const float texel : map.sides[0].nearness) {
    if (texel < least - 1.0) continue;  // the floor's, or none
    ++on_walls;
    REQUIRE(texel > least - 1e-6);
    REQUIRE(texel < least + 1.5 + 1e-6);
  }
  CHECK(on_walls > 20);
}

TEST_CASE("a common edge of two casters is cut at the same point of both, to the bit") {
  test::Random random{3};
  const auto place = [&] {
    const double x = random.between(-2.0, 2.0), y = random.between(-2.0, 2.0);
    return glm::dvec3{x, y, random.between(0.1, 2.0)};
  };
  int cut = 0;
  for (int i = 0; i < 300; ++i) {
    // One side alone cuts, so that each has one new corner on the edge.
    const SideCuts cuts{{-0.5, -9.0}, {9.0, 9.0}, 0.0, i % 2 == 0};
    const glm::dvec3 a = place(), b = place();
    MapPolygon one{{a, b, {3, 0, 1}}, 3}, other{{b, a, {-3, 0, 1}}, 3};
    cut_to_side(one, cuts);
    cut_to_side(other, cuts);
    for (std::size_t k = 0; k < one.count; ++k) {
      const glm::dvec3& corner = one.corners[k];
      const bool is_on_edge = std::fabs(dot(cross(b - a, corner - a), cross(b - a, corner - a))) <
                              1e-24 * dot(b - a, b - a);
      if (!is_on_edge || corner == a || corner == b) continue;
      ++cut;
      REQUIRE(std::find(other.corners.begin(), other.corners.begin() + 9, corner) !=
              other.corners.begin() + 9);
    }
  }
  CHECK(cut > 100);
}

TEST_CASE("a larger map is less wrong") {
  for (const ShadowLight& light : {kSun, kLamp}) {
    const int at_32 = wrong_points(light, of_scene(32, 0.1, 0.75));
    const int at_128 = wrong_points(light, of_scene(128, 0.1, 0.75));
    const int at_1024 = wrong_points(light, of_scene(1024, 0.1, 0.75));
    CHECK(at_32 > 2 * at_128);
    CHECK(at_128 > 3 * at_1024);
  }
}

TEST_CASE(
    "without bias a plane shades itself, with a slope's bias of half the diagonal it does not") {
  std::vector<Facet> corners;
  add_floor(corners, 4);
  const Facets facets = make_facets(std::move(corners));
  // The lamp is low, so that sides look along the floor.
  for (const ShadowLight& light : {kSun, ShadowLight{{-3.9, 0.8, 0.1}, 1.0}}) {
    for (const int kernel : {1, 3, 5}) {
      const auto dark_points = [&](double slope_bias) {
        const ShadowMap map = drawn(facets, light, of_scene(64, 0.0, slope_bias, kernel));
        int dark = 0;
        for_each_point(facets, map, [&](glm::dvec3, int blocked) { dark += blocked > 0 ? 1 : 0; });
        return dark;
      };
      CHECK(dark_points(0.0) > 1000);
      // sqrt(1/2), and the 1/256 texel that corners are snapped to. Perspective is not linear in z.
      CHECK(dark_points(0.75) == 0);
    }
  }
}

TEST_CASE("a long plane does not shade itself along its texels' longer side") {
  for (const bool is_along_x : {false, true}) {
    std::vector<Facet> corners;
    const double x = is_along_x ? 40.0 : 1.0, z = is_along_x ? 1.0 : 40.0;
    add_quad(corners, {-x, 0, z}, {x, 0, z}, {x, 0, -z}, {-x, 0, -z});
    const Facets facets = make_facets(std::move(corners));
    for (const glm::dvec3& towards : {glm::dvec3{1, 0.4, 0}, {0, 0.4, 1}, {0.7, 0.4, 0.7}}) {
      const ShadowMap map = drawn(facets, {normalize(towards), 0.0}, of_scene(64, 0.0, 0.75));
      int dark = 0;
      for (int across_step = 0; - 0.99 + 0.023 * across_step < 1.0; ++across_step) {
        const double across = -0.99 + 0.023 * across_step;
        for (int along_step = 0; - 0.99 + 0.0047 * along_step < 1.0; ++along_step) {
          const double along = -0.99 + 0.0047 * along_step;
          const glm::dvec3 point{x * (is_along_x ? along : across), 0,
                                 z * (is_along_x ? across : along)};
          dark += blocked_texels(map, map_place(map, facets.receivers[0], point));
        }
      }
      CHECK(dark == 0);
    }
  }
}

TEST_CASE("a plane that the light sees almost edge-on does not shade itself") {
  std::vector<Facet> corners;
  add_floor(corners, 4);
  const Facets facets = make_facets(std::move(corners));
  for (const double rise : {1e-1, 1e-2, 1e-3}) {
    const ShadowLight light{normalize(glm::dvec3{1.0, rise, 0.3}), 0.0};
    const ShadowMap map = drawn(facets, light, of_scene(512, 0.5, 0.75));
    for_each_point(facets, map, [&](glm::dvec3, int blocked) { REQUIRE(blocked == 0); });
  }
}

TEST_CASE("much bias lights the floor at a caster's foot") {
  const Facets facets = square_over_floor(0.05);
  const auto lit_under = [&](double bias) {
    const ShadowMap map = drawn(facets, kSun, of_scene(512, bias, 0.75));
    int lit = 0;
    for_each_point(facets, map, [&](glm::dvec3 point, int blocked) {
      const bool is_well_under = std::max(std::fabs(point.x), std::fabs(point.z)) < 0.8;
      lit += is_well_under && blocked == 0 ? 1 : 0;
    });
    return lit;
  };
  CHECK(lit_under(0.5) == 0);
  CHECK(lit_under(8.0) > 500);
}

TEST_CASE("a share is the part of the kernel's texels that are nearer than the biased point") {
  const Facets facets = square_over_floor(1.0);
  for (const ShadowLight& light : {kSun, kLamp}) {
    for (const int kernel : {3, 5}) {
      const ShadowMap map = drawn(facets, light, of_scene(64, 0.25, 0.75, kernel));
      int partly = 0;
      for (int x_step = 0; - 2.9 + 0.11 * x_step < 3.0; ++x_step) {
        const double x = -2.9 + 0.11 * x_step;
        for (int z_step = 0; - 2.9 + 0.13 * z_step < 3.0; ++z_step) {
          const double z = -2.9 + 0.13 * z_step;
          const MapPlace place = map_place(map, facets.receivers[0], {x, 0, z});
          const double at = place.z - place.reach_m * (0.25 + 0.75 * place.slope);
          int nearer = 0;
          for (int k = 0; k < kernel * kernel; ++k) {
            const int i = static_cast<int>(place.u) + k % kernel - kernel / 2;
            const int j = static_cast<int>(place.v) + k / kernel - kernel / 2;
            const float texel = place.side->nearness[static_cast<std::size_t>(64 * j + i)];
            nearer += texel > (light.w != 0.0 ? 1.0 / at : -at) ? 1 : 0;
          }
          REQUIRE(blocked_texels(map, place) == nearer);
          partly += nearer > 0 && nearer < kernel * kernel ? 1 : 0;
        }
      }
      CHECK(partly > 50);
    }
  }
}

TEST_CASE("cascades end where the practical scheme says, the last at the far distance") {
  const std::vector<double> ends = cascade_ends_m(1.0, 16.0, 4);
  REQUIRE(ends.size() == 4);
  CHECK(std::fabs(ends[0] - (2.0 + 4.75) / 2.0) < 1e-12);
  CHECK(std::fabs(ends[1] - (4.0 + 8.5) / 2.0) < 1e-12);
  CHECK(std::fabs(ends[2] - (8.0 + 12.25) / 2.0) < 1e-12);
  CHECK(ends[3] == 16.0);
}

TEST_CASE("what the camera sees of a shadow lies inside its cascade, with room for the kernel") {
  const Facets facets = facet_soup(5, 200, 0.4);
  const MapCamera camera = camera_ahead();
  for (const ShadowLight& light : {kSun, ShadowLight{{0.2, 0.1, -0.3}, 1.0}}) {
    for (int cascades = 1; cascades <= kMostCascades; ++cascades) {
      ShadowMapSettings settings = of_scene(64, 0.0, 0.0, 5);
      settings.fits_camera = true;
      settings.cascades = cascades;
      const ShadowMap map = fit_shadow_map(facets, light, settings, camera);
      CHECK(map.sides.size() == (light.w != 0.0 ? 6u : static_cast<std::size_t>(cascades)));
      test::Random random{7};
      int seen = 0;
      std::vector<const MapSide*> used;
      for (int i = 0; i < 3000; ++i) {
        const Facet& facet = facets.facets[static_cast<std::size_t>(i) % 200];
        const double s = random.between(0.0, 1.0), t = random.between(0.0, 1.0 - s);
        const glm::dvec3 p =
            facet.corners[0] * (1.0 - s - t) + facet.corners[1] * s + facet.corners[2] * t;
        const double depth = camera.eye.z - p.z;
        if (std::max(std::fabs(p.x), std::fabs(p.y - 1.0)) > depth) continue;
        // Places outside the casters' box are lit, and there is no need to hold them.
        const std::size_t number = static_cast<std::size_t>(i) % 200;
        if (!stops_light(facet, facets.planes[number], light)) continue;
        ++seen;
        const MapPlace place = map_place(map, facets.receivers[facets.receiver_of[number]], p);
        if (std::find(used.begin(), used.end(), place.side) == used.end()) {
          used.push_back(place.side);
        }
        REQUIRE(std::min(place.u, place.v) >= 3.0 - 1e-6);
        REQUIRE(std::max(place.u, place.v) <= 61.0 + 1e-6);
      }
      CHECK(seen > 500);
      CHECK(used.size() == map.sides.size());
    }
  }
}

TEST_CASE("a map has the same bits on any number of threads") {
  const Facets facets = facet_soup(2, 3000, 0.4);
  for (const ShadowLight& light : {kSun, ShadowLight{{0.2, 0.1, -0.3}, 1.0}}) {
    ShadowMapSettings settings = of_scene(200, 0.0, 0.0);
    settings.fits_camera = true;
    settings.cascades = 2;
    const ShadowMap expected = drawn(facets, light, settings, 1);
    for (const int threads : {2, 3}) {
      const ShadowMap map = drawn(facets, light, settings, threads);
      REQUIRE(map.sides.size() == expected.sides.size());
      for (std::size_t i = 0; i < map.sides.size(); ++i) {
        CHECK(map.sides[i].nearness == expected.sides[i].nearness);
      }
    }
  }
}

TEST_CASE("lights in awkward places give maps that can be looked up") {
  const Facets facets = facet_soup(9, 200, 0.4);
  const glm::dvec3 corner = facets.facets[5].corners[1];
  const glm::dvec3 in_plane = (facets.facets[3].corners[0] + facets.facets[3].corners[1]) * 0.5;
  for (const ShadowLight& light :
       {ShadowLight{corner, 1.0}, ShadowLight{in_plane, 1.0}, ShadowLight{{1e9, 0, 0}, 1.0},
        ShadowLight{{0, 0, 0}, 1.0}, ShadowLight{camera_ahead().eye, 1.0},
        ShadowLight{{0, 0, 1e6}, 1.0}, ShadowLight{facets.planes[2].normal, 0.0},
        ShadowLight{{0, 0, 1}, 0.0}, ShadowLight{{0, 0, -1}, 0.0}}) {
    for (const bool fits_camera : {false, true}) {
      ShadowMapSettings settings = of_scene(16, 0.5, 1.0, 9);
      settings.fits_camera = fits_camera;
      const ShadowMap map = drawn(facets, light, settings);
      for (std::size_t i = 0; i < facets.facets.size(); ++i) {
        for (const glm::dvec3& point : facets.facets[i].corners) {
          const int blocked =
              blocked_texels(map, map_place(map, facets.receivers[facets.receiver_of[i]], point));
          CHECK(blocked >= 0);
          CHECK(blocked <= 81);
        }
      }
    }
  }
}

TEST_CASE("a scene of nothing, or of what does not cast, has a map that darkens nothing") {
  for (const ShadowLight& light : {kSun, kLamp}) {
    for (const bool is_empty : {true, false}) {
      std::vector<Facet> corners;
      if (!is_empty) add_floor(corners, 4);
      for (Facet& facet : corners) facet.casts = false;
      const Facets facets = make_facets(std::move(corners));
      const ShadowMap map = drawn(facets, light, of_scene(32, 0.0, 0.0));
      CHECK(blocked_texels(
                map, map_place(map, Receiver{{{0, 1, 0}, 0.0}, true, {}, 0}, {0.1, 0, 0.2})) == 0);
    }
  }
}

TEST_CASE(
    "counted by hand, what pixels are compared with gives the bits and shares of the look-up") {
  Scene scene = load_scene("figures", scene_search_path({}));
  set_shadows(scene, ShadowKind::map);
  for (Light& light : scene.lights) light.map = {.size = 64, .kernel = 3};
  ThreadPool pool{2};
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, 61, 47);
  Image picture = make_image(Format::rgba16f, 61, 47);
  draw_scene(prepared, camera, 0.0, picture, pool);
  const SceneShadows& shadows = *prepared.shadows;
  const std::vector<std::uint8_t> dark = cut_shadows(shadows, camera, 61, 47, pool).dark;
  const ShadowView view{multiply(camera.eye_to_clip, camera.world_to_eye), 61, 47, {}};
  int compared = 0, partly = 0;
  for (std::size_t light = 0; light < shadows.lights.size(); ++light) {
    const ShadowMap& map = shadows.maps[light];
    const std::vector<PixelComparison> pixels =
        pixel_comparisons(shadows.facets, map, static_cast<int>(light), shadows.seen[0], view,
                          camera.eye, dark, pool);
    // Whatever was in the shares before.
    std::vector<std::uint8_t> mask = dark, shares(pixels.size(), 99);
    const MapLookup lookup{&map, static_cast<int>(light), shares};
    look_up_maps(shadows.facets, {&lookup, 1}, shadows.seen[0], view, camera.eye, mask, pool);
    CHECK(shares == shadows.shares[0][light]);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if ((dark[i] >> light & 1) != 0) {
        REQUIRE(pixels[i].side == 0);
        REQUIRE(shadows.shares[0][light][i] == 0);
        continue;
      }
      int nearer = 0;
      for (int k = 0; k < 9 && pixels[i].side != 0; ++k) {
        const int u = pixels[i].with.u + k % 3 - 1, v = pixels[i].with.v + k / 3 - 1;
        const std::vector<float>& nearness = map.sides[pixels[i].side - 1].nearness;
        const bool is_there = std::min(u, v) >= 0 && std::max(u, v) < 64;
        if (is_there) nearer += nearness[static_cast<std::size_t>(64 * v + u)] > pixels[i].with.own;
      }
      REQUIRE((shadows.masks[0][i] >> light & 1) == (nearer == 9 ? 1 : 0));
      REQUIRE(shadows.shares[0][light][i] == nearer % 9);
      compared += pixels[i].side != 0 ? 1 : 0;
      partly += nearer % 9 != 0 ? 1 : 0;
    }
  }
  CHECK(compared > 500);
  CHECK(partly > 10);
}
