#include "tools/info/shadow_measures.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "dof/measure/flip.h"
#include "dof/measure/tone.h"
#include "raster/numbers/vector_math.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/make/shapes.h"
#include "scenes/make/teapot.h"
#include "scenes/shadows/terminators.h"

namespace softfocus {
namespace {

struct CurvedShape {
  std::string_view name;
  Mesh (*make)(int facets);
  std::array<int, 3> few;
  int many;
};

constexpr std::array kCurvedShapes{
    CurvedShape{"sphere", [](int n) { return make_sphere(0.5, 2 * n, n); }, {6, 12, 24}, 256},
    CurvedShape{"torus", [](int n) { return make_torus(0.4, 0.18, 2 * n, n); }, {6, 12, 24}, 256},
    CurvedShape{"teapot", [](int n) { return make_teapot(0.8, n); }, {2, 4, 8}, 48}};

struct RuleName {
  std::string_view name;
  ShadowKind shadows;
  Terminator rule;
};
constexpr std::array kRules{RuleName{"no shadows", ShadowKind::none, Terminator::facets},
                            RuleName{"facets", ShadowKind::projected, Terminator::facets},
                            RuleName{"fade", ShadowKind::projected, Terminator::fade},
                            RuleName{"normals", ShadowKind::projected, Terminator::normals}};

// The shape is object 0, over a floor, lit from the side and above.
Scene shape_scene(const CurvedShape& shape, int facets) {
  Scene scene;
  scene.name = shape.name;
  scene.camera.position = {0.4, 1.1, 2.2};
  scene.camera.target = {0.0, 0.35, 0.0};
  scene.camera.fov_y_degrees = 36.0;
  scene.ambient_light = glm::vec3{0.25f};
  scene.background = glm::vec3{0.1f};
  Light sun;
  sun.position_or_direction = {-0.9f, 0.75f, 0.15f};
  sun.colour = glm::vec3{0.9f};
  scene.lights = {sun};
  Material skin, floor;
  skin.ambient = skin.diffuse = {0.7f, 0.5f, 0.35f};
  skin.two_sided = shape.name == "teapot";
  floor.ambient = floor.diffuse = glm::vec3{0.6f};
  scene.materials = {skin, floor};
  scene.meshes = {shape.make(facets), make_plane(6.0, 6.0, 8, 8)};
  Object object, ground;
  object.position = {0.0, shape.name == "teapot" ? 0.0 : 0.5, 0.0};
  ground.mesh = ground.material = 1;
  scene.objects = {object, ground};
  return scene;
}

struct ShapePicture {
  Image picture;
  std::vector<SeenFacet> seen;
  Facets facets;
};

ShapePicture draw_shape(Scene scene, const RuleName& rule, PictureSize size, ThreadPool& pool) {
  scene.lights[0].shadows = rule.shadows;
  scene.lights[0].terminator = rule.rule;
  PreparedScene prepared = prepare_scene(scene, Profile{}, pool);
  ShapePicture drawn{make_image(Format::rgba16f, size.width, size.height), {}, {}};
  draw_scene(prepared, camera_matrices(scene.camera, 0.0, size.width, size.height), 0.0,
             drawn.picture, pool);
  if (!prepared.shadows) return drawn;
  drawn.seen = prepared.shadows->seen[0];
  drawn.facets = std::move(prepared.shadows->facets);
  return drawn;
}

enum ShapeRegion : std::uint8_t { elsewhere, on_floor, on_shape, in_band };
constexpr std::size_t kShapeRegions = 4;

// The band is where facets and their corners' normals disagree about the light.
std::vector<ShapeRegion> regions_of(const ShapePicture& drawn, const Scene& scene) {
  const CurvedSurfaces surfaces = curved_surfaces(scene, 0.0);
  const ShadowLight light = shadow_light(scene.lights[0]);
  std::vector<ShapeRegion> regions;
  for (const SeenFacet seen : drawn.seen) {
    regions.push_back(elsewhere);
    if (!shows_facet(seen)) continue;
    const std::uint32_t facet = facet_of(seen);
    const bool back = seen_from_back(seen);
    regions.back() = surfaces.object_of[facet] == 1 ? on_floor : on_shape;
    if (regions.back() == on_floor) continue;
    const std::array<double, 3> cosines =
        corner_cosines(drawn.facets, surfaces, facet, back, light);
    const auto [least, most] = std::minmax({cosines[0], cosines[1], cosines[2]});
    const double faces = (back ? -1.0 : 1.0) * height_over(drawn.facets.planes[facet], light);
    if (faces > 0.0 ? least <= 0.0 : most > 0.0) {
      regions.back() = in_band;
    }
  }
  return regions;
}

/// FLIP of the picture and of each region; how many pixels the band has.
Json record_of(const PixelMap& flip, const std::vector<ShapeRegion>& regions) {
  std::array<double, kShapeRegions> sums{};
  std::array<std::size_t, kShapeRegions> counts{};
  for (std::size_t i = 0; i < regions.size(); ++i) {
    sums[regions[i]] += flip.values[i];
    ++counts[regions[i]];
  }
  const auto of = [&](ShapeRegion region) {
    return counts[region] == 0 ? 0.0 : sums[region] / static_cast<double>(counts[region]);
  };
  return {{"flip", mean(flip)},
          {"flip_band", of(in_band)},
          {"flip_shape", of(on_shape)},
          {"flip_floor", of(on_floor)},
          {"band_pixels", counts[in_band]}};
}

}  // namespace

void find_terminator_table(PictureSize size, Findings& found, ThreadPool& pool) {
  found.begin_table("terminators", {{"shape", 8},
                                    {"triangles", 10},
                                    {"against", 8},
                                    {"rule", 12},
                                    {"flip", 9, 4},
                                    {"flip_band", 10, 4},
                                    {"flip_shape", 10, 4},
                                    {"flip_floor", 10, 4},
                                    {"band_pixels", 11}});
  for (const CurvedShape& shape : kCurvedShapes) {
    const Image truth = draw_shape(shape_scene(shape, shape.many), kRules[1], size, pool).picture;
    for (const int few : shape.few) {
      const Scene scene = shape_scene(shape, few);
      const std::vector<ShapeRegion> regions =
          regions_of(draw_shape(scene, kRules[1], size, pool), scene);
      for (const RuleName& rule : kRules) {
        const Image picture = draw_shape(scene, rule, size, pool).picture;
        Json record = record_of(flip_map(truth, picture, clamped_tone(), pool), regions);
        record["shape"] = shape.name;
        record["triangles"] = scene.meshes[0].indices.size() / 3;
        record["against"] = shape.make(shape.many).indices.size() / 3;
        record["rule"] = rule.name;
        found.add_row(record);
      }
    }
  }
}

}  // namespace softfocus
