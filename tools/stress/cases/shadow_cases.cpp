// Scenes whose shadows are hard to find: against each pixel's ray to the light.

#include <array>
#include <cmath>

#include "raster/numbers/exact_math.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/make/shapes.h"
#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr std::array<double, 8> kElevations{45, 20, 8, 3, 1, 0.3, 0.1, 0.01};
constexpr std::array<double, 6> kSunk{0, 0.1, 0.3, 0.5, 0.8, 1};
constexpr std::array<double, 7> kShadowBarWidths{8, 4, 2, 1, 0.5, 0.25, 0.125};
constexpr std::array<double, 7> kShadowGaps{0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0001};
constexpr std::array<double, 6> kFins{1, 2, 3, 4, 7, 16};
constexpr std::array<double, 6> kCellCounts{1, 2, 4, 8, 16, 32};
constexpr std::array<double, 5> kFloorSizes{8, 80, 800, 8000, 80000};
constexpr std::array<double, 6> kRoofs{1, 2, 4, 8, 16, 32};
constexpr std::array<double, 7> kLampHeights{1, 0.5, 0.25, 0.1, 0.03, 0.01, 0.001};

constexpr double kCubeSize = 0.6;

std::uint32_t add_material(Scene& scene, glm::vec3 colour, bool two_sided) {
  Material material;
  material.diffuse = colour;
  material.two_sided = two_sided;
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

Object& add_object(Scene& scene, Mesh mesh, std::uint32_t material, glm::dvec3 position) {
  scene.meshes.push_back(std::move(mesh));
  Object object;
  object.mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
  object.material = material;
  object.position = position;
  scene.objects.push_back(object);
  return scene.objects.back();
}

constexpr std::uint32_t kFloorMaterial = 0, kThingMaterial = 1, kSheetMaterial = 2;

/// A camera that looks down at a floor in y = 0, and the three materials.
Scene floor_scene(double size_m = 8.0, int cells = 1) {
  Scene scene;
  scene.camera = {.position = {0.4, 2.2, 4.1},
                  .target = {0, 0.25, 0},
                  .fov_y_degrees = 40.0,
                  .near_m = 0.05,
                  .far_m = 200.0};
  add_material(scene, {0.8f, 0.8f, 0.8f}, false);
  add_material(scene, {0.9f, 0.5f, 0.2f}, false);
  add_material(scene, {0.3f, 0.6f, 0.9f}, true);
  add_object(scene, make_plane(size_m, size_m, cells, cells), kFloorMaterial, {});
  return scene;
}

void add_light(Scene& scene, LightKind kind, glm::vec3 place) {
  Light light;
  light.kind = kind;
  light.position_or_direction = place;
  light.shadows = ShadowKind::projected;
  scene.lights.push_back(light);
}

/// The sun, from behind on the left.
void add_usual_light(Scene& scene) {
  add_light(scene, LightKind::directional, {-0.7f, 1.1f, -0.5f});
}

/// A cube on the floor, turned.
Object& add_cube(Scene& scene, glm::dvec3 place) {
  Object& cube = add_object(scene, make_cube(kCubeSize, 1), kThingMaterial, place);
  cube.rotation_degrees = {0, 27, 0};
  return cube;
}

StressTrial trial_of(Scene scene, int size_px, ThreadPool& pool) {
  StressFrame frame;
  StressScene with{.scene = std::move(scene), .shadows = true};
  with.camera = camera_matrices(with.scene.camera, 0.0, size_px, size_px);
  PreparedScene prepared = prepare_scene(with.scene, Profile{}, pool);
  frame.sharp = make_image(Format::rgba16f, size_px, size_px);
  draw_scene(prepared, with.camera, 0.0, frame.sharp, pool);
  prepared.shadows->by_rays = true;
  forget(*prepared.shadows, true);
  frame.truth = make_image(Format::rgba16f, size_px, size_px);
  draw_scene(prepared, with.camera, 0.0, frame.truth, pool);
  frame.scene = std::move(with);
  return single(std::move(frame));
}

/// The sun sinks into the floor's plane: shadows without end, and a floor that is hardly lit.
StressTrial make_low_light(double elevation_degrees, int size, ThreadPool& pool) {
  Scene scene = floor_scene();
  add_cube(scene, {-0.4, kCubeSize / 2, 0.2});
  add_object(scene, make_sphere(0.25, 24, 12), kThingMaterial, {0.7, 0.25, -0.2});
  const double height = exact_math::tan_degrees(elevation_degrees);
  add_light(scene, LightKind::directional, {-0.8f, static_cast<float>(height), 0.6f});
  return trial_of(std::move(scene), size, pool);
}

/// A turned cube and a sphere sink through the floor, and a sheet cuts the cube.
StressTrial make_sunk(double share, int size, ThreadPool& pool) {
  Scene scene = floor_scene();
  add_cube(scene, {-0.3, (0.5 - share) * kCubeSize, 0.1});
  add_object(scene, make_sphere(0.3, 24, 12), kThingMaterial, {0.6, 0.3 - 0.6 * share, 0.3});
  add_object(scene, make_plane(1.2, 0.5, 1, 1), kSheetMaterial, {-0.3, 0.2, 0.1})
      .rotation_degrees = {20, 0, 35};
  add_usual_light(scene);
  return trial_of(std::move(scene), size, pool);
}

/// Upright bars, so many pixels wide in the middle of the picture.
StressTrial make_bars(double width_px, int size, ThreadPool& pool) {
  constexpr int kBars = 9;
  constexpr double kPixelsAcross = 3.4;  // metres that the picture is wide there
  Scene scene = floor_scene();
  const double width = width_px * kPixelsAcross / size;
  scene.meshes.push_back(make_cube(1.0, 1));
  Object bar;
  bar.mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
  bar.material = kThingMaterial;
  bar.scale = {width, 0.9, width};
  for (int i = 0; i < kBars; ++i) {
    const int from_middle = i - kBars / 2;
    bar.position = {0.27 * from_middle, 0.45, 0.11 * i - 0.6};
    scene.objects.push_back(bar);
  }
  add_usual_light(scene);
  return trial_of(std::move(scene), size, pool);
}

/// A plate hovers over the floor, a cube over the plate, and a sphere beside them.
StressTrial make_gap(double gap_m, int size, ThreadPool& pool) {
  Scene scene = floor_scene();
  add_object(scene, make_cube(1.0, 1), kThingMaterial, {-0.3, 0.05 + gap_m, 0.2}).scale = {0.9, 0.1,
                                                                                           0.7};
  add_cube(scene, {-0.3, 0.1 + 2 * gap_m + kCubeSize / 4, 0.2}).scale = glm::dvec3{0.5};
  add_object(scene, make_sphere(0.25, 32, 16), kThingMaterial, {0.7, 0.25 + gap_m, 0.1});
  add_usual_light(scene);
  return trial_of(std::move(scene), size, pool);
}

/// So many sheets share one upright edge, like the pages of a book: not a closed mesh, and from
/// three on not a manifold.
StressTrial make_fins(double fins, int size, ThreadPool& pool) {
  Scene scene = floor_scene();
  Mesh mesh;
  const int count = static_cast<int>(fins);
  mesh.positions = {{0, 0.02f, 0}, {0, 0.9f, 0}};
  mesh.normals = {{0, 0, 1}, {0, 0, 1}};
  for (int i = 0; i < count; ++i) {
    const double turn = 10.0 + 300.0 * i / count;
    const glm::dvec2 way{exact_math::cos_degrees(turn), exact_math::sin_degrees(turn)};
    const glm::vec3 normal{-way.y, 0, way.x};
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {glm::vec3{0.5 * way.x, 0.02, 0.5 * way.y},
                                                 glm::vec3{0.3 * way.x, 0.8, 0.3 * way.y}});
    mesh.normals.insert(mesh.normals.end(), {normal, normal});
    mesh.indices.insert(mesh.indices.end(), {0, first, first + 1, 0, first + 1, 1});
  }
  add_object(scene, std::move(mesh), kSheetMaterial, {0, 0, 0.2});
  add_usual_light(scene);
  return trial_of(std::move(scene), size, pool);
}

/// A floor and a leaning wall of so many cells a side: neighbours in one plane must throw no lines
/// on each other.
StressTrial make_cells(double cells, int size, ThreadPool& pool) {
  const int count = static_cast<int>(cells);
  Scene scene = floor_scene(8.0, count);
  add_object(scene, make_plane(1.7, 1.1, count, count), kSheetMaterial, {-0.1, 0.5, -0.3})
      .rotation_degrees = {61, 13, 7};
  add_object(scene, make_cube(kCubeSize, count), kThingMaterial, {0.6, 0.34, 0.5})
      .rotation_degrees = {11, 31, 7};
  add_usual_light(scene);
  return trial_of(std::move(scene), size, pool);
}

/// Two triangles of a floor as wide as that beside a sphere of 6,000 small ones.
StressTrial make_sizes(double floor_m, int size, ThreadPool& pool) {
  Scene scene = floor_scene(floor_m);
  add_cube(scene, {-0.5, kCubeSize / 2, 0.1});
  add_object(scene, make_sphere(0.3, 96, 32), kThingMaterial, {0.5, 0.3, 0.2});
  add_usual_light(scene);
  return trial_of(std::move(scene), size, pool);
}

/// The eye is in the shadow of so many roofs, one over the other, and looks into the light.
StressTrial make_roofs(double roofs, int size, ThreadPool& pool) {
  Scene scene = floor_scene();
  for (int i = 0; i < static_cast<int>(roofs); ++i) {
    const double height = 2.6 + 0.1 * i;
    add_object(scene, make_plane(2.5, 2.5, 1, 1), kSheetMaterial, {0.1 * i, height, 3.6})
        .rotation_degrees = {0, 3.0 * i, 0};
  }
  add_cube(scene, {-0.3, kCubeSize / 2, 0.1});
  add_light(scene, LightKind::directional, {0.1f, 1.0f, -0.15f});
  return trial_of(std::move(scene), size, pool);
}

/// A lamp comes down to the floor between a cube and a sphere, past the height of their tops.
StressTrial make_lamp(double height_m, int size, ThreadPool& pool) {
  Scene scene = floor_scene();
  add_cube(scene, {-0.6, kCubeSize / 2, 0.0});
  add_object(scene, make_sphere(0.25, 24, 12), kThingMaterial, {0.6, 0.25, 0.1});
  add_light(scene, LightKind::point, {0.05f, static_cast<float>(height_m), 0.2f});
  return trial_of(std::move(scene), size, pool);
}

/// Pixels of a thousand whose light is not the truth's: a shadow takes much more away than that.
double wrong_share(const StressAnswer& answer) {
  constexpr double kSeen = 1.0 / 255.0;
  const Image& truth = answer.truth[0];
  int wrong = 0;
  for (int y = 0; y < truth.height; ++y) {
    for (int x = 0; x < truth.width; ++x) {
      const bool is_right =
          std::fabs(light_at(answer.result[0], x, y) - light_at(truth, x, y)) <= kSeen;
      wrong += is_right ? 0 : 1;
    }
  }
  return 1000.0 * wrong / (1.0 * truth.width * truth.height);
}

constexpr std::string_view kWrong = "pixels in the wrong light", kWrongUnit = "of a thousand";
constexpr double kWrongLimit = 0.5;
constexpr std::string_view kWhyWrong = "a line of 33 pixels in a picture of 256x256";

constexpr StressCase shadow_case(std::string_view name, std::string_view title,
                                 std::string_view must_hold, StressParameter parameter,
                                 std::span<const double> severities, double telling,
                                 StressTrial (*make)(double, int, ThreadPool&)) {
  return {name,      title,      must_hold, parameter, kWrong, kWrongUnit, kWrongLimit,
          kWhyWrong, severities, telling,   0,         make,   wrong_share};
}

constexpr std::array kShadowCases{
    shadow_case("shadow-low-light", "A light that sinks into the floor's plane",
                "Shadows lengthen; the floor does not shade itself.", {"elevation", "degrees"},
                kElevations, 3, make_low_light),
    shadow_case(
        "shadow-through", "A cube and a sphere sunk into the floor, a sheet through the cube",
        "Shadows begin where surfaces meet.", {"sunk", "of the height"}, kSunk, 0.3, make_sunk),
    shadow_case("shadow-thin", "Thin bars", "Their shadows are as wide and whole.",
                {"width", "pixels"}, kShadowBarWidths, 1, make_bars),
    shadow_case("shadow-gap", "A plate, a cube and a sphere that hardly touch",
                "Shadows hang at what throws them, and no light comes through.", {"gap", "m"},
                kShadowGaps, 0.01, make_gap),
    shadow_case("shadow-fins", "Sheets that share one edge",
                "Each throws its shadow, on the others too.", {"sheets", ""}, kFins, 4, make_fins),
    shadow_case("shadow-cells", "A floor, a wall and a cube cut into cells",
                "Neighbours in one plane throw no lines on each other.", {"cells", "a side"},
                kCellCounts, 8, make_cells),
    shadow_case("shadow-sizes", "A huge floor under a sphere of small triangles",
                "The shadow is the same.", {"floor", "m"}, kFloorSizes, 800, make_sizes),
    shadow_case("shadow-roofs", "An eye in the shadow of roofs over it",
                "What it sees is lit all the same.", {"roofs", ""}, kRoofs, 4, make_roofs),
    shadow_case("shadow-lamp", "A lamp that comes down to the floor between two things",
                "Their shadows run to infinity, then up the other.", {"height", "m"}, kLampHeights,
                0.1, make_lamp),
};

}  // namespace

std::span<const StressCase> shadow_cases() { return kShadowCases; }

}  // namespace softfocus
