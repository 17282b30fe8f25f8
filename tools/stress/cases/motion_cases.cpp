// Two pictures that belong together: before and after a small motion, and at two sizes.

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/numbers/random_bits.h"
#include "tools/report/worst_crop.h"
#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr std::array<double, 6> kSteps{1 / 16.0, 1 / 8.0, 1 / 4.0, 1 / 2.0, 1, 2};
constexpr std::array<double, 6> kFocusSteps{0.1, 0.2, 0.5, 1, 2, 5};
constexpr std::array<double, 7> kSizeRadii{2, 4, 8, 16, 24, 32, 64};

/// Something before, in and behind the focus, with lamps.
Scene moving_scene(int size) {
  const double unit = size / 256.0;
  Scene scene = flat_scene();
  const auto wall = add_pattern(scene, "checker", 16, {0.5f, 0.5f, 0.4f}, {0.1f, 0.1f, 0.2f});
  const auto board = add_pattern(scene, "checker", 4, {0.7f, 0.4f, 0.2f}, {0.2f, 0.3f, 0.5f});
  add_backdrop(scene, size, kStressFarM, glm::vec3{1.0f}, wall);
  add_rectangle(scene, size, {60 * unit, 90 * unit, 200 * unit, 170 * unit}, kStressFocusM,
                glm::vec3{1.0f}, board);
  RandomSequence random{5};
  for (int i = 0; i < 12; ++i) {
    const double x = next_between(random, 10.0, 240.0) * unit;
    const double y = next_between(random, 10.0, 240.0) * unit;
    const double side = std::max(4.0, 5.0 * unit);
    add_rectangle(scene, size, {x, y, x + side, y + side}, i % 3 == 0 ? 1.2 : kStressFarM - 0.1,
                  glm::vec3{30.0f, 25.0f, 18.0f});
  }
  add_rectangle(scene, size, {20 * unit, -1.0 * size, 36 * unit, 2.0 * size}, 1.1,
                glm::vec3{0.05f});
  return scene;
}

double moving_radius(int size) { return size / 16.0; }

/// The camera goes to the right by so many pixels of the plane in focus.
StressTrial make_camera_motion(double step_px, int size, ThreadPool& pool) {
  const double radius = moving_radius(size);
  StressTrial trial;
  for (const double moved_px : {0.0, step_px}) {
    Scene scene = moving_scene(size);
    // The picture's height at the focus, by a rectangle that has it.
    const double metres =
        scene.objects.front().scale.y / (3.0 * size) * (kStressFocusM / kStressFarM) * moved_px;
    scene.camera.position.x += metres;
    scene.camera.target.x += metres;
    trial.frames.push_back(drawn_frame(std::move(scene), radius, radius, size, pool));
  }
  return trial;
}

/// The focus goes away by so many per cent. The aperture stays as it is.
StressTrial make_focus_motion(double per_cent, int size, ThreadPool& pool) {
  const double radius = moving_radius(size);
  StressTrial trial;
  for (const double factor : {1.0, 1.0 + per_cent / 100.0}) {
    trial.frames.push_back(drawn_frame(moving_scene(size), radius / factor, 1.1 * radius, size,
                                       pool, kStressFocusM * factor));
  }
  return trial;
}

double motion_error(const StressAnswer& answer) {
  return false_change(answer.truth, answer.result);
}

/// A scene with nothing in focus at the size and at half of it.
StressTrial make_two_sizes(double radius, int size, ThreadPool& pool) {
  StressTrial trial;
  for (const int divisor : {1, 2}) {
    const int side = size / divisor;
    const double unit = side / 256.0;
    Scene scene = flat_scene();
    const auto wall = add_pattern(scene, "checker", 8, {0.9f, 0.9f, 0.7f}, {0.1f, 0.2f, 0.5f});
    add_backdrop(scene, side, kStressFarM, glm::vec3{1.0f}, wall);
    add_rectangle(scene, side, {96 * unit, 64 * unit, 160 * unit, 192 * unit}, 4.0 / 3.0,
                  {0.8f, 0.1f, 0.1f});
    add_rectangle(scene, side, {192 * unit, 48 * unit, 208 * unit, 64 * unit}, kStressFarM - 0.01,
                  glm::vec3{10.0f});
    // The radius is the far wall's and the near thing's.
    trial.frames.push_back(
        drawn_frame(std::move(scene), 2.0 * radius / divisor, radius / divisor, side, pool));
  }
  return trial;
}

double size_error(const StressAnswer& answer) {
  if (spoilt_pixels(answer.result[0]) > 0) return INFINITY;
  return answer_flip(reduced(answer.result[0], 2), answer.result[1], answer.pool);
}

constexpr std::string_view kFalseChange = "mean false change";
constexpr std::string_view kOfTrue = "of the true change";
constexpr std::string_view kWhyChange = "as much changes falsely as should change at all";

constexpr std::array kMotionCases{
    StressCase{"motion-camera",
               "The camera moves by less than a pixel",
               "The picture changes as the lens's views do.",
               {"step", "pixel"},
               kFalseChange,
               kOfTrue,
               1.0,
               kWhyChange,
               kSteps,
               0.5,
               512,
               make_camera_motion,
               motion_error},
    StressCase{"motion-focus",
               "The focus moves a little",
               "The picture changes as the lens's views do.",
               {"step", "%"},
               kFalseChange,
               kOfTrue,
               1.0,
               kWhyChange,
               kFocusSteps,
               1,
               512,
               make_focus_motion,
               motion_error},
    StressCase{"resolution",
               "One scene at two sizes",
               "The small picture is the large one, reduced: blur scales with height.",
               {"radius", "px"},
               "mean FLIP between the two",
               "0 to 1",
               0.05,
               "differences show at a glance when the pictures alternate",
               kSizeRadii,
               16,
               256,
               make_two_sizes,
               size_error},
};

}  // namespace

std::span<const StressCase> motion_cases() { return kMotionCases; }

}  // namespace softfocus
