// Pictures while the shutter is open: what turns fast, crosses, is thin, or is out of focus as
// well.

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kShutter = 1.0;

constexpr std::array<double, 6> kTurns{5, 10, 20, 40, 80, 160};
constexpr std::array<double, 6> kWays{2, 4, 8, 16, 32, 64};
constexpr std::array<double, 5> kThicknesses{16, 8, 4, 2, 1};

/// The object goes to the right by so many pixels of its depth while the shutter is open: a part of
/// so long a sway that it is even to 1e-7.
void move_right(Object& object, double way_px, double metres_per_px) {
  object.sway_period_frames = 1e4;
  object.sway.x = way_px * metres_per_px * object.sway_period_frames / (2.0 * kPi);
}

StressTrial exposed(Scene scene, double radius_px, int size, ThreadPool& pool) {
  StressTrial trial = single(drawn_frame(std::move(scene), radius_px, radius_px, size, pool));
  trial.frames.front().scene->shutter_frames = kShutter;
  return trial;
}

/// Metres of a pixel at a depth, by the rectangle that was added last.
double pixel_m(const Scene& scene, double width_px) {
  return scene.objects.back().scale.x / width_px;
}

Scene walled_scene(int size) {
  Scene scene = flat_scene();
  const auto wall = add_pattern(scene, "checker", 16, {0.5f, 0.5f, 0.4f}, {0.1f, 0.1f, 0.2f});
  add_backdrop(scene, size, kStressFarM, glm::vec3{1.0f}, wall);
  return scene;
}

/// A striped bar about its middle: the ends go round, the middle stays.
StressTrial make_turn(double degrees, int size, ThreadPool& pool) {
  const double unit = size / 256.0;
  Scene scene = walled_scene(size);
  const auto stripes = add_pattern(scene, "checker", 8, {0.9f, 0.8f, 0.3f}, {0.5f, 0.1f, 0.1f});
  // Its mesh hangs from its corner: about the middle it is four quarters.
  for (int quarter = 0; quarter < 4; ++quarter) {
    add_rectangle(scene, size, {128 * unit, 128 * unit, 228 * unit, 140 * unit}, kStressFocusM,
                  glm::vec3{1.0f}, stripes, {6, 1});
    Object& object = scene.objects.back();
    object.position = {0.0, 0.0, -kStressFocusM};
    // Two on each side, above and below the line of the middle.
    object.scale.x *= quarter % 2 == 0 ? 1.0 : -1.0;
    object.scale.y *= quarter / 2 == 0 ? 1.0 : -1.0;
    object.spin_degrees_per_frame.z = degrees;
    scene.materials.back().two_sided = true;
  }
  return exposed(std::move(scene), 0.0, size, pool);
}

/// One thing to the right, one before it to the left, and a post between the two that stands.
StressTrial make_crossing(double way_px, int size, ThreadPool& pool) {
  const double unit = size / 256.0;
  Scene scene = walled_scene(size);
  const auto board = add_pattern(scene, "checker", 4, {0.7f, 0.4f, 0.2f}, {0.2f, 0.3f, 0.5f});
  add_rectangle(scene, size, {60 * unit, 70 * unit, 150 * unit, 150 * unit}, 2.4, glm::vec3{1.0f},
                board);
  move_right(scene.objects.back(), way_px, pixel_m(scene, 90 * unit));
  add_rectangle(scene, size, {120 * unit, 30 * unit, 132 * unit, 226 * unit}, kStressFocusM,
                {0.1f, 0.3f, 0.15f});
  add_rectangle(scene, size, {110 * unit, 120 * unit, 200 * unit, 190 * unit}, 1.6,
                {0.8f, 0.1f, 0.1f});
  move_right(scene.objects.back(), -way_px, pixel_m(scene, 90 * unit));
  return exposed(std::move(scene), 0.0, size, pool);
}

constexpr double kThinWayPx = 24.0;

/// A bright bar before black, whose way is known: so is the light of each column.
StressTrial make_thin(double width_px, int size, ThreadPool& pool) {
  const double centre = size / 2.0;
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFarM, glm::vec3{0.0f});
  add_rectangle(scene, size,
                {centre - width_px / 2.0, -1.0 * size, centre + width_px / 2.0, 2.0 * size},
                kStressFocusM, glm::vec3{1.0f});
  move_right(scene.objects.back(), kThinWayPx, pixel_m(scene, width_px));
  StressTrial trial = exposed(std::move(scene), 0.0, size, pool);
  StressFrame& frame = trial.frames.front();
  frame.truth = grey_picture_of(
      size,
      [&](int x, int) {
        const double from = x + 0.5 - centre - width_px / 2.0, to = from + width_px;
        return std::max(0.0, std::min(to, kThinWayPx / 2.0) - std::max(from, -kThinWayPx / 2.0)) /
               kThinWayPx;
      },
      [&](int, int) { return kStressFarM; });
  return trial;
}

/// The largest error of a column, of the brightest there should be.
double thin_error(const StressAnswer& answer) {
  const PixelRange rows = middle_half(answer.truth[0].height);
  const std::vector<double> truth = column_means(answer.truth[0], rows);
  const std::vector<double> found = column_means(answer.result[0], rows);
  const double brightest = *std::max_element(truth.begin(), truth.end());
  return largest_difference(truth, found, {0, answer.truth[0].width}) / brightest;
}

/// Something near and out of focus crosses something that is in focus and crosses, too.
StressTrial make_defocus(double way_px, int size, ThreadPool& pool) {
  const double unit = size / 256.0;
  Scene scene = walled_scene(size);
  const auto board = add_pattern(scene, "checker", 4, {0.7f, 0.4f, 0.2f}, {0.2f, 0.3f, 0.5f});
  add_rectangle(scene, size, {50 * unit, 60 * unit, 150 * unit, 160 * unit}, kStressFocusM,
                glm::vec3{1.0f}, board);
  move_right(scene.objects.back(), way_px, pixel_m(scene, 100 * unit));
  add_rectangle(scene, size, {120 * unit, 90 * unit, 180 * unit, 210 * unit}, kStressNearM,
                {0.1f, 0.5f, 0.2f});
  move_right(scene.objects.back(), -way_px, pixel_m(scene, 60 * unit));
  add_rectangle(scene, size, {200 * unit, 40 * unit, 206 * unit, 46 * unit}, kStressFarM - 0.1,
                {20.0f, 18.0f, 12.0f});
  move_right(scene.objects.back(), way_px, pixel_m(scene, 6 * unit));
  return exposed(std::move(scene), size / 32.0, size, pool);
}

double shutter_error(const StressAnswer& answer) {
  return answer_flip(answer.truth[0], answer.result[0], answer.pool);
}

constexpr std::string_view kMotionFlip = "mean FLIP";
constexpr std::string_view kOfMotionFlip = "0 to 1";
constexpr double kMotionFlipLimit = 0.02;
constexpr std::string_view kWhyMotionFlip =
    "a fifth of the picture moves: there it is a tenth, which shows at a glance";

constexpr double kDefocusLimit = 0.05;
constexpr std::string_view kWhyDefocus =
    "all of the picture is blurred; differences show at a glance when the pictures alternate";

constexpr std::array kShutterCases{
    StressCase{"shutter-turn",
               "A bar turns fast",
               "Its ends are arcs, not lines: each place is as often covered as the bar is there.",
               {"turn", "degrees"},
               kMotionFlip,
               kOfMotionFlip,
               kMotionFlipLimit,
               kWhyMotionFlip,
               kTurns,
               40,
               1024,
               make_turn,
               shutter_error},
    StressCase{"shutter-crossing",
               "Two things cross behind and before a post",
               "Where they meet, both and what is behind are seen, each for its part of the time.",
               {"way", "px"},
               kMotionFlip,
               kOfMotionFlip,
               kMotionFlipLimit,
               kWhyMotionFlip,
               kWays,
               16,
               1024,
               make_crossing,
               shutter_error},
    StressCase{"shutter-thin",
               "A thin bar goes far",
               "A column is lit for the part of the time that the bar is before it.",
               {"width", "pixel"},
               "largest error of a column",
               "of the brightest",
               0.1,
               "a step of a tenth shows as a line",
               kThicknesses,
               2,
               0,
               make_thin,
               thin_error},
    StressCase{"shutter-defocus",
               "Things cross in and out of focus",
               "Each thing is blurred by its circle and its way.",
               {"way", "px"},
               kMotionFlip,
               kOfMotionFlip,
               kDefocusLimit,
               kWhyDefocus,
               kWays,
               16,
               1024,
               make_defocus,
               shutter_error},
};

}  // namespace

std::span<const StressCase> shutter_cases() { return kShutterCases; }

}  // namespace softfocus
