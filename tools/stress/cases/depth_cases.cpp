// Depths that are no surface's: rounded about the focus, 0, infinite, NaN, and blended at edges.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "raster/numbers/random_bits.h"
#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr std::array<double, 6> kSmallRadii{0.1, 0.2, 0.3, 0.4, 0.45, 0.5};
constexpr std::array<double, 7> kPatchSides{1, 2, 4, 8, 16, 32, 64};
constexpr std::array<double, 6> kBlends{0, 1, 2, 3, 4, 8};

/// Grey that differs from pixel to pixel, 0.1 to 0.9.
double noise_at(int x, int y) {
  return 0.1 + 0.8 * unit_interval(mix_bits(hash_of_place(x, y) + 1));
}

/// Noise whose depths lie by chance a little before or behind the focus.
StressTrial make_rough_focus(double radius, int size, ThreadPool& /*pool*/) {
  const double at_infinity = size / 4.0;
  StressFrame frame;
  frame.settings = uncut_settings(at_infinity, kStressFocusM, size / 16.0);
  frame.sharp = grey_picture_of(size, noise_at, [&](int x, int y) {
    const double sign = (hash_of_place(y, x) >> 7) % 2 == 0 ? 1.0 : -1.0;
    return depth_of_radius(sign * radius, at_infinity, kStressFocusM);
  });
  frame.truth = frame.sharp;
  return single(std::move(frame));
}

double mean_change(const StressAnswer& answer) {
  double sum = 0.0;
  const Image& truth = answer.truth[0];
  for (int y = 0; y < truth.height; ++y) {
    for (int x = 0; x < truth.width; ++x) {
      sum += std::fabs(light_at(answer.result[0], x, y) - light_at(truth, x, y));
    }
  }
  return sum / (truth.width * truth.height);
}

double patch_reach(int size) { return size / 16.0; }

bool is_in_patch(int x, int y, double side, int size) {
  const int middle = size / 2;
  const double left = middle - std::floor(side / 2.0);
  return x >= left && y >= left && x < left + side && y < left + side;
}

/// Sharp noise with a white patch of a depth that no surface has.
StressTrial patch_trial(double side, int size, double depth_m) {
  const double reach = patch_reach(size);
  StressFrame frame;
  frame.settings = uncut_settings(reach, kStressFocusM, reach);
  frame.sharp = grey_picture_of(
      size, [&](int x, int y) { return is_in_patch(x, y, side, size) ? 1.0 : noise_at(x, y); },
      [&](int x, int y) { return is_in_patch(x, y, side, size) ? depth_m : kStressFocusM; });
  frame.truth = frame.sharp;
  return single(std::move(frame));
}

StressTrial make_zero(double side, int size, ThreadPool& /*pool*/) {
  return patch_trial(side, size, 0.0);
}
StressTrial make_infinite(double side, int size, ThreadPool& /*pool*/) {
  return patch_trial(side, size, std::numeric_limits<double>::infinity());
}
StressTrial make_nan(double side, int size, ThreadPool& /*pool*/) {
  return patch_trial(side, size, std::numeric_limits<double>::quiet_NaN());
}

/// Pixels that are no number, and pixels out of the largest circle's reach that changed.
double wrong_pixels(const StressAnswer& answer) {
  const Image& truth = answer.truth[0];
  const int size = truth.width;
  // Filters at a fraction of the resolution round a tile's reach up.
  const double reach = 2.0 * patch_reach(size) + answer.severity / 2.0;
  int wrong = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double light = light_at(answer.result[0], x, y);
      const bool is_out = std::max(std::abs(x - size / 2), std::abs(y - size / 2)) > reach;
      const bool changed = std::fabs(light - light_at(truth, x, y)) > 0.002;
      wrong += !std::isfinite(light) || (is_out && changed) ? 1 : 0;
    }
  }
  return wrong;
}

double fringe_radius(int size) { return size / 21.0; }

/// A blurred bright half before a blurred dark wall, the depths and colours of `blend` pixels at
/// the edge mixed, as anti-aliasing does.
StressFrame blended_edge(double blend, int size) {
  const double radius = fringe_radius(size), at_infinity = 2.0 * radius;
  StressFrame frame;
  frame.settings = uncut_settings(at_infinity, kStressFocusM, radius);
  const auto of_wall = [&](int x) {
    const double from_edge = x + 0.5 - size / 2.0;
    if (blend == 0.0) return from_edge > 0.0 ? 1.0 : 0.0;
    return std::clamp(from_edge / blend + 0.5, 0.0, 1.0);
  };
  const double near_m = depth_of_radius(-radius, at_infinity, kStressFocusM);
  const double far_m = depth_of_radius(radius, at_infinity, kStressFocusM);
  frame.sharp = grey_picture_of(
      size, [&](int x, int) { return 1.0 - 0.9 * of_wall(x); },
      [&](int x, int) { return near_m + (far_m - near_m) * of_wall(x); });
  frame.truth = grey_picture_of(
      size, [&](int x, int) { return 0.1 + 0.9 * disc_left_of((size / 2.0 - x - 0.5) / radius); },
      [&](int, int) { return near_m; });
  return frame;
}

/// The edge with and without the mixing.
StressTrial make_blended(double blend, int size, ThreadPool& /*pool*/) {
  StressTrial trial;
  trial.frames.push_back(blended_edge(0.0, size));
  trial.frames.push_back(blended_edge(blend, size));
  return trial;
}

double blend_change(const StressAnswer& answer) {
  const PixelRange rows = middle_half(answer.truth[0].height);
  const int size = answer.truth[0].width;
  return largest_difference(column_means(answer.result[1], rows),
                            column_means(answer.result[0], rows), middle_half(size)) /
         0.9;
}

constexpr StressParameter kPatch{"patch's side", "px"};
constexpr std::string_view kPatchHolds =
    "Every pixel is a number, and nothing changes past twice the reach of the largest circle.";
constexpr std::string_view kPatchMeasure = "wrong pixels", kPatchUnit = "pixels";
constexpr std::string_view kPatchWhy = "there is no reason for a single one";

constexpr std::array kDepthCases{
    StressCase{"focus-surface",
               "Noise whose depths are a little off the focus",
               "Circles within a pixel leave the picture as it is.",
               {"radius", "px"},
               "mean change",
               "of white",
               0.01,
               "two and a half of 255 levels",
               kSmallRadii,
               0.4,
               0,
               make_rough_focus,
               mean_change},
    StressCase{"depth-zero", "A patch of depth 0 in sharp noise", kPatchHolds, kPatch,
               kPatchMeasure, kPatchUnit, 0.0, kPatchWhy, kPatchSides, 16, 0, make_zero,
               wrong_pixels},
    StressCase{"depth-infinite", "A patch of infinite depth in sharp noise", kPatchHolds, kPatch,
               kPatchMeasure, kPatchUnit, 0.0, kPatchWhy, kPatchSides, 16, 0, make_infinite,
               wrong_pixels},
    StressCase{"depth-nan", "A patch whose depth is NaN in sharp noise", kPatchHolds, kPatch,
               kPatchMeasure, kPatchUnit, 0.0, kPatchWhy, kPatchSides, 16, 0, make_nan,
               wrong_pixels},
    StressCase{"depth-blended",
               "An edge whose depths are anti-aliased, from before to behind the "
               "focus",
               "Mixed depths change nothing: no sharp line within the soft edge. The radius is a "
               "21st of the height on both sides.",
               {"mixed", "px"},
               "largest change of the edge's profile",
               "of the contrast",
               0.05,
               "a line of that contrast shows",
               kBlends,
               2,
               0,
               make_blended,
               blend_change},
};

}  // namespace

std::span<const StressCase> depth_cases() { return kDepthCases; }

}  // namespace softfocus
