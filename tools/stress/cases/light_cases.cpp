// Small bright lights: how much of them is left, and in which shape.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dof/measure/point_image.h"
#include "raster/numbers/random_bits.h"
#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr std::array<double, 40> kPointRadii{
    1,  1.25, 1.5, 1.75, 2,  2.5, 3,  3.5, 4,  4.5, 5,  5.5, 6,  6.5, 7,  7.5, 8,  8.5, 9,  10,
    11, 12,   13,  14,   15, 16,  17, 18,  20, 22,  24, 26,  28, 32,  36, 40,  44, 48,  56, 64};
constexpr std::array<double, 10> kBrightnesses{1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};

/// One bright pixel on black, all at one depth. Its circle is half as bright as white.
StressTrial make_point(double radius, int size, ThreadPool& /*pool*/) {
  const double light = 0.5 * std::numbers::pi * radius * radius;
  const int middle = size / 2;
  StressFrame frame;
  frame.settings = uncut_settings(2.0 * radius, kStressFocusM, radius);
  frame.sharp = grey_picture_of(
      size, [&](int x, int y) { return x == middle && y == middle ? light : 0.0; },
      [](int, int) { return kStressFarM; });
  frame.truth = grey_picture_of(
      size,
      [&](int x, int y) { return light * disc_light(x, y, middle + 0.5, middle + 0.5, radius); },
      [](int, int) { return kStressFarM; });
  return single(std::move(frame));
}

double point_light_lost(const StressAnswer& answer) {
  return std::fabs(energy(answer.result[0]) / energy(answer.truth[0]) - 1.0);
}

double point_radius_error(const StressAnswer& answer) {
  return std::fabs(
      point_shape(answer.result[0]).radius_px / point_shape(answer.truth[0]).radius_px - 1.0);
}

double point_deviation(const StressAnswer& answer) {
  return disc_deviation(answer.result[0], answer.severity);
}

/// Within four fifths of the radius: the rim has a case of its own.
double point_unevenness(const StressAnswer& answer) {
  const int pixel = answer.truth[0].width / 2;
  const double middle = pixel + 0.5;
  return unevenness(answer.result[0], middle, middle, 0.8 * answer.severity);
}

constexpr int kHighlightPx = 5;
constexpr double kHighlightGround = 0.1;

/// A lamp of 5x5 pixels before grey, both blurred alike.
StressTrial make_highlight(double brightness, int size, ThreadPool& pool) {
  const double radius = size / 16.0;
  const int left = size / 2 - kHighlightPx / 2;
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFarM, glm::vec3{static_cast<float>(kHighlightGround)});
  add_rectangle(scene, size, pixel_square(left, left, kHighlightPx), kStressFarM - 0.01,
                glm::vec3{static_cast<float>(brightness)});
  StressFrame frame = drawn_frame(std::move(scene), 2.0 * radius, radius, size, pool);
  frame.truth = grey_picture_of(
      size,
      [&](int x, int y) {
        const double light = square_light(x, y, left, left, kHighlightPx, radius);
        return kHighlightGround + light * (brightness - kHighlightGround);
      },
      [](int, int) { return kStressFarM; });
  return single(std::move(frame));
}

double above_ground(const Image& picture) {
  double sum = 0.0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) sum += light_at(picture, x, y) - kHighlightGround;
  }
  return sum;
}

/// Not energy(), which takes NaN for black. The shape counts too: a lamp left as it is has all of
/// its light, but where it should not be.
double highlight_error(const StressAnswer& answer) {
  const double lamp = kHighlightPx * kHighlightPx * (answer.severity - kHighlightGround);
  return std::fabs(above_ground(answer.result[0]) - above_ground(answer.truth[0])) / lamp;
}

/// Lamps behind the focus and some before it, a dark wall, and three sharp things.
StressTrial make_night(double brightness, int size, ThreadPool& pool) {
  const double unit = size / 256.0, radius = size / 16.0;
  Scene scene = flat_scene();
  const auto wall = add_pattern(scene, "checker", 16, glm::vec3{0.02f}, glm::vec3{0.05f});
  const auto board = add_pattern(scene, "checker", 8, {0.6f, 0.3f, 0.1f}, {0.1f, 0.15f, 0.3f});
  add_backdrop(scene, size, 8.0, glm::vec3{1.0f}, wall);
  RandomSequence random{7};
  const auto lamp = [&](double depth_m) {
    const double x = next_between(random, 0.0, 250.0) * unit;
    const double y = next_between(random, 0.0, 250.0) * unit;
    const double side = std::max(4.0, std::round(next_between(random, 4.0, 7.0) * unit));
    const auto light = static_cast<float>(brightness * next_between(random, 0.3, 1.0));
    const glm::vec3 tint{1.0, next_between(random, 0.5, 1.0), next_between(random, 0.2, 1.0)};
    add_rectangle(scene, size, {x, y, x + side, y + side}, depth_m, light * tint);
  };
  for (int i = 0; i < 20; ++i) lamp(next_between(random, 3.0, 7.5));
  for (int i = 0; i < 3; ++i) lamp(next_between(random, 1.2, 1.5));
  for (int i = 0; i < 3; ++i) {
    const double left = (20.0 + 80.0 * i) * unit;
    add_rectangle(scene, size, {left, (90.0 + 30.0 * i) * unit, left + 48.0 * unit, 2.0 * size},
                  kStressFocusM, glm::vec3{1.0f}, board);
  }
  return single(drawn_frame(std::move(scene), radius, radius, size, pool));
}

double night_error(const StressAnswer& answer) {
  return answer_hdr_flip(answer.truth[0], answer.result[0], answer.pool);
}

constexpr StressParameter kPointRadius{"radius", "px"};
constexpr StressParameter kBrightness{"brightness", "of white"};
constexpr std::string_view kPoint = "One bright pixel, blurred";

constexpr std::array kLightCases{
    StressCase{"point-light", kPoint, "All of its light is left.", kPointRadius,
               "light gained or lost", "of the light", 0.05, "a fourteenth of a stop", kPointRadii,
               16, 0, make_point, point_light_lost},
    StressCase{"point-radius", kPoint, "The circle has the lens's radius, by second moment.",
               kPointRadius, "error of the radius", "of the radius", 0.05,
               "a circle of 20 pixels is a pixel off", kPointRadii, 16, 0, make_point,
               point_radius_error},
    StressCase{"point-roundness", kPoint, "Its image is a disc.", kPointRadius,
               "RMS deviation from the disc", "of the disc", 0.27,
               "a regular hexagon of the same area deviates as much", kPointRadii, 16, 0,
               make_point, point_deviation},
    StressCase{"point-evenness", kPoint,
               "The disc is even: no rings, dots or peaks within four fifths of its radius.",
               kPointRadius, "standard deviation within the disc", "of the mean", 0.1,
               "rings of a tenth show on every highlight", kPointRadii, 16, 0, make_point,
               point_unevenness},
    StressCase{"highlight", "A lamp of 5x5 pixels on grey, blurred",
               "Its light is kept however bright it is. The radius is a 16th of the height.",
               kBrightness, "light gained or lost", "of the lamp's light", 0.05,
               "a fourteenth of a stop", kBrightnesses, 100, 0, make_highlight, highlight_error},
    StressCase{"night-lamps", "A dark wall, lamps behind the focus and before it, sharp boards",
               "As the lens sees it, at every exposure. The radius at infinity is a 16th of the "
               "height.",
               kBrightness, "mean HDR-FLIP", "0 to 1", 0.1,
               "the FLIP that clutter is allowed, at the worst of all exposures", kBrightnesses,
               100, 1024, make_night, night_error},
};

}  // namespace

std::span<const StressCase> light_cases() { return kLightCases; }

}  // namespace softfocus
