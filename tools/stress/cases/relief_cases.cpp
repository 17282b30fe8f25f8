// Objects that are hard to show from a relief: drawn from one eye, shown to another, against the
// object redrawn.

#include <array>

#include "raster/numbers/exact_math.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/make/shapes.h"
#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr std::array<double, 7> kGrazingAngles{60, 30, 15, 8, 4, 2, 1};
constexpr std::array<double, 6> kReliefBarWidths{8, 4, 2, 1, 0.5, 0.25};
constexpr std::array<double, 6> kHoleDepths{0.05, 0.1, 0.2, 0.4, 0.8, 1.6};
constexpr std::array<double, 6> kPostTurns{1, 2, 5, 10, 20, 40};
constexpr std::array<double, 6> kLightTurns{1, 5, 15, 45, 90, 180};
constexpr std::array<double, 7> kEyeDistances{3, 2, 1.5, 1.2, 1.05, 0.9, 0.7};
constexpr std::array<double, 6> kBehindTurns{15, 45, 80, 100, 140, 180};

/// The eye for which a relief was drawn stands so far beside the one that sees it.
constexpr double kBesideDegrees = 10.0;
constexpr double kUsualDistance = 3.2;
constexpr double kReliefFov = 40.0;

glm::dvec3 eye_at(double yaw_degrees, double pitch_degrees, double distance_m) {
  const double along = exact_math::cos_degrees(pitch_degrees);
  return glm::dvec3{along * exact_math::sin_degrees(yaw_degrees),
                    exact_math::sin_degrees(pitch_degrees),
                    along * exact_math::cos_degrees(yaw_degrees)} *
         distance_m;
}

Light sun_at(double yaw_degrees) {
  Light light;
  light.kind = LightKind::directional;
  light.position_or_direction = glm::vec3{eye_at(yaw_degrees, 40.0, 1.0)};
  return light;
}

/// Nothing yet, in front of grey, with four materials and the sun from the left.
Scene relief_scene_of(glm::dvec3 eye) {
  Scene scene;
  scene.camera = {.position = eye,
                  .target = {0, 0, 0},
                  .fov_y_degrees = kReliefFov,
                  .near_m = 0.02,
                  .far_m = 40.0};
  scene.background = {0.1f, 0.1f, 0.12f};
  for (const glm::vec3 colour : {glm::vec3{0.8f, 0.8f, 0.8f}, glm::vec3{0.9f, 0.4f, 0.15f},
                                 glm::vec3{0.2f, 0.5f, 0.9f}, glm::vec3{0.3f, 0.75f, 0.25f}}) {
    Material material;
    material.diffuse = colour;
    scene.materials.push_back(material);
  }
  scene.lights.push_back(sun_at(-30.0));
  scene.meshes = {make_cube(1.0, 1), make_sphere(0.5, 48, 24), make_torus(0.75, 0.22, 72, 36)};
  return scene;
}

constexpr std::uint32_t kCubeMesh = 0, kBallMesh = 1, kRingMesh = 2;

Object& add_part(Scene& scene, std::uint32_t mesh, std::uint32_t material, glm::dvec3 position,
                 glm::dvec3 size) {
  Object object;
  object.mesh = mesh;
  object.material = material;
  object.position = position;
  object.scale = size;
  scene.objects.push_back(object);
  return scene.objects.back();
}

StressTrial relief_trial(Scene scene, StressRelief relief, int size_px, ThreadPool& pool) {
  StressFrame frame;
  StressScene with{.scene = std::move(scene), .relief = std::move(relief)};
  with.camera = camera_matrices(with.scene.camera, 0.0, size_px, size_px);
  frame.truth = draw_scene(with.scene, with.camera, 0.0, size_px, size_px, Profile{}, pool);
  frame.sharp = frame.truth;
  frame.scene = std::move(with);
  return single(std::move(frame));
}

/// Drawn from the eye that stands beside, lit as it is seen.
StressTrial seen_from_beside(Scene scene, glm::dvec3 drawn_from, int size_px, ThreadPool& pool) {
  StressRelief relief{drawn_from, scene.lights};
  return relief_trial(std::move(scene), std::move(relief), size_px, pool);
}

/// A plate with a ball and a cube on it, seen ever more along the plate.
StressTrial make_plate_along(double elevation_degrees, int size, ThreadPool& pool) {
  Scene scene = relief_scene_of(eye_at(20, elevation_degrees, kUsualDistance));
  add_part(scene, kCubeMesh, 0, {0, -0.05, 0}, {1.5, 0.1, 1.5});
  add_part(scene, kBallMesh, 1, {-0.35, 0.2, 0.2}, glm::dvec3{0.4});
  add_part(scene, kCubeMesh, 2, {0.35, 0.1, -0.3}, glm::dvec3{0.2});
  return seen_from_beside(
      std::move(scene), eye_at(20, elevation_degrees + kBesideDegrees, kUsualDistance), size, pool);
}

/// Upright bars, so many pixels wide.
StressTrial make_relief_bars(double width_px, int size, ThreadPool& pool) {
  constexpr int kBars = 7;
  Scene scene = relief_scene_of(eye_at(15, 10, kUsualDistance));
  const double pixel_m = 2.0 * kUsualDistance * exact_math::tan_degrees(0.5 * kReliefFov) / size;
  for (int i = 0; i < kBars; ++i) {
    const double from_middle = i - 0.5 * (kBars - 1);
    add_part(scene, kCubeMesh, 1, {0.2 * from_middle, 0, 0.15 * from_middle},
             {width_px * pixel_m, 1.3, width_px * pixel_m});
  }
  return seen_from_beside(std::move(scene), eye_at(15 - kBesideDegrees, 10, kUsualDistance), size,
                          pool);
}

/// A lattice before a plate: the deeper the plate, the more of it was hidden.
StressTrial make_holes(double depth_m, int size, ThreadPool& pool) {
  constexpr int kLattice = 4;
  Scene scene = relief_scene_of(eye_at(15, 10, kUsualDistance));
  for (int i = 0; i < kLattice; ++i) {
    const double place = 0.36 * (i - 0.5 * (kLattice - 1));
    add_part(scene, kCubeMesh, 2, {place, 0, 0}, {0.07, 1.3, 0.05});
    add_part(scene, kCubeMesh, 2, {0, place, 0}, {1.3, 0.07, 0.05});
  }
  add_part(scene, kCubeMesh, 1, {0, 0, -depth_m}, {1.0, 1.0, 0.04});
  return seen_from_beside(std::move(scene), eye_at(15 - kBesideDegrees, 10, kUsualDistance), size,
                          pool);
}

/// Posts one behind the other, seen from that many degrees beside.
StressTrial make_posts(double turn_degrees, int size, ThreadPool& pool) {
  Scene scene = relief_scene_of(eye_at(turn_degrees, 12, kUsualDistance));
  for (std::uint32_t i = 0; i < 4; ++i) {
    const double behind = 0.45 * (i - 1.5);
    add_part(scene, i % 2 == 0 ? kCubeMesh : kBallMesh, i, {0.06 * (i - 1.5), 0, -behind},
             {0.3, 1.1, 0.3});
  }
  return seen_from_beside(std::move(scene), eye_at(0, 12, kUsualDistance), size, pool);
}

/// A ring and a ball, seen from where they were drawn; but the sun went round.
StressTrial make_moved_light(double turn_degrees, int size, ThreadPool& pool) {
  const glm::dvec3 eye = eye_at(20, 35, kUsualDistance);
  Scene scene = relief_scene_of(eye);
  add_part(scene, kRingMesh, 0, {0, 0, 0}, glm::dvec3{0.9});
  add_part(scene, kBallMesh, 1, {0, 0.05, 0}, glm::dvec3{0.7});
  StressRelief relief{eye, scene.lights};
  scene.lights = {sun_at(-30.0 + turn_degrees)};
  return relief_trial(std::move(scene), std::move(relief), size, pool);
}

/// A ring comes nearer, until the eye is within the sphere that holds it.
StressTrial make_near_eye(double radii, int size, ThreadPool& pool) {
  constexpr double kRingRadius = 0.97;
  Scene scene = relief_scene_of(eye_at(10, 30, radii * kRingRadius));
  add_part(scene, kRingMesh, 1, {0, 0, 0}, glm::dvec3{1.0});
  add_part(scene, kBallMesh, 2, {0, 0, 0}, glm::dvec3{0.5});
  return seen_from_beside(std::move(scene), eye_at(10 - kBesideDegrees, 30, radii * kRingRadius),
                          size, pool);
}

/// Seen from that many degrees round: from behind, in the end.
StressTrial make_behind(double turn_degrees, int size, ThreadPool& pool) {
  Scene scene = relief_scene_of(eye_at(turn_degrees, 15, kUsualDistance));
  add_part(scene, kCubeMesh, 0, {0, 0, 0}, {0.9, 0.6, 0.6});
  add_part(scene, kBallMesh, 1, {0.2, 0.2, 0.35}, glm::dvec3{0.5});
  add_part(scene, kBallMesh, 3, {-0.2, 0.25, -0.35}, glm::dvec3{0.6});
  return seen_from_beside(std::move(scene), eye_at(0, 15, kUsualDistance), size, pool);
}

double relief_flip(const StressAnswer& answer) {
  return answer_flip(answer.truth[0], answer.result[0], answer.pool);
}

constexpr StressCase relief_case(std::string_view name, std::string_view title,
                                 std::string_view must_hold, StressParameter parameter,
                                 std::span<const double> severities, double telling,
                                 StressTrial (*make)(double, int, ThreadPool&)) {
  return {name,       title,
          must_hold,  parameter,
          "FLIP",     "",
          0.03,       "twice what an impostor has in its own view, of edges and filtering",
          severities, telling,
          0,          make,
          relief_flip};
}

constexpr std::array kReliefCases{
    relief_case("relief-grazing", "A plate seen along its surface, drawn from 10 degrees above",
                "The plate is as thin as it is.", {"elevation", "degrees"}, kGrazingAngles, 8,
                make_plate_along),
    relief_case("relief-thin", "Thin bars, drawn from 10 degrees beside",
                "They stay whole and as thin.", {"width", "pixels"}, kReliefBarWidths, 2,
                make_relief_bars),
    relief_case("relief-holes", "A lattice before a plate, drawn from 10 degrees beside",
                "The plate is seen through the holes.", {"depth", "m"}, kHoleDepths, 0.4,
                make_holes),
    relief_case("relief-hidden", "Posts one behind the other, drawn from in front",
                "What was hidden is seen from beside.", {"turn", "degrees"}, kPostTurns, 10,
                make_posts),
    relief_case("relief-light", "A sun that went round since the relief was drawn",
                "The lit side goes round.", {"turn", "degrees"}, kLightTurns, 45, make_moved_light),
    relief_case("relief-inside", "An eye that comes into the bounding sphere",
                "What is near is seen as near.", {"distance", "radii"}, kEyeDistances, 1.2,
                make_near_eye),
    relief_case("relief-behind", "A view from behind", "The other side is seen.",
                {"turn", "degrees"}, kBehindTurns, 80, make_behind),
};

}  // namespace

std::span<const StressCase> relief_cases() { return kReliefCases; }

}  // namespace softfocus
