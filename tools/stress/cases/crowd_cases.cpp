// Many things at once, held against the lens's views: bars, leaves, clutter, and circles larger
// than the filter.

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/numbers/random_bits.h"
#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr std::array<double, 8> kFenceWidths{1, 2, 4, 6, 8, 12, 16, 32};
constexpr std::array<double, 7> kCrowdRadii{1, 2, 4, 8, 16, 32, 64};
constexpr std::array<double, 8> kRatios{1, 1.25, 1.5, 2, 3, 4, 6, 8};

/// Dark blurred bars, as far apart as they are wide, before a sharp texture.
StressTrial make_fence(double width, int size, ThreadPool& pool) {
  const double radius = size / 16.0;
  Scene scene = flat_scene();
  const auto wall = add_pattern(scene, "checker", 32, {0.9f, 0.8f, 0.6f}, {0.3f, 0.4f, 0.5f});
  add_backdrop(scene, size, kStressFocusM, glm::vec3{1.0f}, wall);
  const int before = static_cast<int>(std::ceil(radius / width));
  const int after = static_cast<int>(std::ceil((size + radius) / (2.0 * width)));
  for (int bar = -before; bar < after; ++bar) {
    const double x = 2.0 * width * bar;
    add_rectangle(scene, size, {x, -1.0 * size, x + width, 2.0 * size}, kStressNearM,
                  glm::vec3{0.02f});
  }
  return single(drawn_frame(std::move(scene), radius, radius, size, pool));
}

/// A hundred leaves a little before and behind a depth, between a sharp board and a bright sky.
StressTrial make_foliage(double radius, int size, ThreadPool& pool) {
  const double unit = size / 256.0;
  Scene scene = flat_scene();
  const auto board = add_pattern(scene, "checker", 16, {0.7f, 0.5f, 0.4f}, {0.2f, 0.2f, 0.3f});
  add_backdrop(scene, size, 40.0, {0.8f, 0.9f, 1.0f});
  add_rectangle(scene, size, {-1.0 * size, 0.6 * size, 2.0 * size, 2.0 * size}, kStressFocusM,
                glm::vec3{1.0f}, board, {12, 6});
  RandomSequence random{11};
  for (int i = 0; i < 160; ++i) {
    const double x = next_between(random, -20.0, 260.0) * unit;
    const double y = next_between(random, -20.0, 190.0) * unit;
    const double side = next_between(random, 5.0, 18.0) * unit;
    const auto green = static_cast<float>(next_between(random, 0.1, 0.5));
    add_rectangle(scene, size, {x, y, x + side, y + side * next_between(random, 0.4, 1.6)},
                  next_between(random, 1.0, 1.3), {0.4f * green, green, 0.1f});
  }
  // At 1 m the circle is as large as at infinity.
  return single(drawn_frame(std::move(scene), radius, radius, size, pool));
}

/// Boards of all sizes at all depths.
StressTrial make_clutter(double radius, int size, ThreadPool& pool) {
  const double unit = size / 256.0;
  Scene scene = flat_scene();
  const auto board = add_pattern(scene, "checker", 4, glm::vec3{1.0f}, glm::vec3{0.4f});
  add_backdrop(scene, size, 60.0, glm::vec3{0.3f}, board, 24);
  RandomSequence random{23};
  for (int i = 0; i < 300; ++i) {
    // Even in 1 / depth: even in the circle's radius.
    const double depth_m = 1.0 / next_between(random, 0.02, 1.0);
    const double side = next_between(random, 4.0, 28.0) * unit;
    const double x = next_between(random, -20.0, 260.0) * unit;
    const double y = next_between(random, -20.0, 260.0) * unit;
    const glm::vec3 colour{next_between(random, 0.05, 1.0), next_between(random, 0.05, 1.0),
                           next_between(random, 0.05, 1.0)};
    add_rectangle(scene, size, {x, y, x + side, y + side}, depth_m, colour, board);
  }
  return single(drawn_frame(std::move(scene), radius, radius, size, pool));
}

/// Few large things before, in and behind the focus, with a filter that ends at a 32nd of the
/// height.
StressTrial make_cut_circles(double ratio, int size, ThreadPool& pool) {
  const double unit = size / 256.0, filter_px = size / 32.0;
  Scene scene = flat_scene();
  const auto wall = add_pattern(scene, "checker", 8, {0.9f, 0.9f, 0.7f}, {0.1f, 0.2f, 0.5f});
  add_backdrop(scene, size, kStressFarM, glm::vec3{1.0f}, wall);
  add_rectangle(scene, size, {90 * unit, 60 * unit, 170 * unit, 200 * unit}, kStressFocusM,
                {0.2f, 0.6f, 0.2f}, wall);
  add_rectangle(scene, size, {20 * unit, 120 * unit, 70 * unit, 2.0 * size}, 4.0 / 3.0,
                {0.8f, 0.1f, 0.1f});
  add_rectangle(scene, size, {200 * unit, 40 * unit, 208 * unit, 48 * unit}, kStressFarM - 0.01,
                glm::vec3{20.0f});
  // At both depths the circle is half the one at infinity.
  StressFrame frame =
      drawn_frame(std::move(scene), 2.0 * ratio * filter_px, ratio * filter_px, size, pool);
  frame.settings.max_coc_px = static_cast<float>(filter_px);
  return single(std::move(frame));
}

double crowd_error(const StressAnswer& answer) {
  return answer_flip(answer.truth[0], answer.result[0], answer.pool);
}

constexpr std::string_view kFlip = "mean FLIP", kFlipUnit = "0 to 1";
constexpr std::string_view kAsTheLens = "As the lens sees it.";
constexpr std::string_view kWhyFlip =
    "as far off as the sharp picture where a lens blurs by one or two pixels";
constexpr double kFlipLimit = 0.1;

constexpr std::array kCrowdCases{
    StressCase{"near-bars",
               "Dark blurred bars before a sharp checker",
               "As the lens sees it. The radius is a 16th of the height.",
               {"bar width", "px"},
               kFlip,
               kFlipUnit,
               kFlipLimit,
               kWhyFlip,
               kFenceWidths,
               8,
               512,
               make_fence,
               crowd_error},
    StressCase{"foliage",
               "Blurred leaves before sky and a sharp board",
               kAsTheLens,
               {"radius", "px"},
               kFlip,
               kFlipUnit,
               kFlipLimit,
               kWhyFlip,
               kCrowdRadii,
               8,
               512,
               make_foliage,
               crowd_error},
    StressCase{"clutter",
               "Three hundred boards at all depths",
               kAsTheLens,
               {"radius", "px"},
               kFlip,
               kFlipUnit,
               kFlipLimit,
               kWhyFlip,
               kCrowdRadii,
               8,
               512,
               make_clutter,
               crowd_error},
    StressCase{"largest-circle",
               "Circles larger than the filter",
               "As the lens sees it, though --max-coc, a 32nd of the height, cuts the circles.",
               {"radius", "of max-coc"},
               kFlip,
               kFlipUnit,
               kFlipLimit,
               kWhyFlip,
               kRatios,
               4,
               // 512 views have a noise as large as the better methods' error.
               4096,
               make_cut_circles,
               crowd_error},
};

}  // namespace

std::span<const StressCase> crowd_cases() { return kCrowdCases; }

}  // namespace softfocus
