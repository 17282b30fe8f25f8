// Pictures with hardly anything on them: one colour, a border, a line.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "raster/numbers/random_bits.h"
#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr std::array<double, 9> kPlainRadii{1, 2, 4, 8, 12, 16, 24, 32, 64};

double largest_error(const StressAnswer& answer, PixelRange columns) {
  const Image& truth = answer.truth[0];
  double largest = 0.0;
  for (int y = 0; y < truth.height; ++y) {
    for (int x = columns.begin; x < columns.end; ++x) {
      const double error = std::fabs(light_at(answer.result[0], x, y) - light_at(truth, x, y));
      if (std::isnan(error)) return error;
      largest = std::max(largest, error);
    }
  }
  return largest;
}

double anywhere(const StressAnswer& answer) {
  return largest_error(answer, {0, answer.truth[0].width});
}

/// One colour at depths of all circles up to that radius, in patches of 8x8 pixels.
StressTrial make_constant(double radius, int size, ThreadPool& /*pool*/) {
  constexpr int kPatchPx = 8;
  StressFrame frame;
  frame.settings = uncut_settings(2.0 * radius, kStressFocusM, radius);
  frame.sharp = grey_picture_of(
      size, [](int, int) { return 0.5; },
      [&](int x, int y) {
        const auto bits = mix_bits(hash_of_place(x / kPatchPx, y / kPatchPx) + 1);
        return depth_of_radius(radius * (2.0 * unit_interval(bits) - 1.0), 2.0 * radius,
                               kStressFocusM);
      });
  frame.truth = frame.sharp;
  return single(std::move(frame));
}

/// One colour at one depth: only the borders can go wrong.
StressTrial make_border(double radius, int size, ThreadPool& /*pool*/) {
  StressFrame frame;
  frame.settings = uncut_settings(2.0 * radius, kStressFocusM, radius);
  frame.sharp = grey_picture_of(
      size, [](int, int) { return 0.5; }, [](int, int) { return kStressFarM; });
  frame.truth = frame.sharp;
  return single(std::move(frame));
}

constexpr double kStripLight = 10.0, kStripGround = 0.1;

/// A bright strip along the left border. How it goes on outside is open, so that the truth is
/// right for the other half alone, which it does not reach.
StressTrial make_strip(double radius, int size, ThreadPool& /*pool*/) {
  constexpr int kStripPx = 4;
  StressFrame frame;
  frame.settings = uncut_settings(2.0 * radius, kStressFocusM, radius);
  frame.sharp = grey_picture_of(
      size, [](int x, int) { return x < kStripPx ? kStripLight : kStripGround; },
      [](int, int) { return kStressFarM; });
  frame.truth = grey_picture_of(
      size,
      [&](int x, int) {
        const double from_left = disc_left_of((kStripPx - x - 0.5) / radius);
        return kStripGround + (kStripLight - kStripGround) * from_left;
      },
      [](int, int) { return kStressFarM; });
  return single(std::move(frame));
}

double repeated(const StressAnswer& answer) {
  const int width = answer.truth[0].width;
  return largest_error(answer, {width - width / 4, width}) / (kStripLight - kStripGround);
}

/// A line in the upper half, dots in the lower one.
bool is_thin(int x, int y, int size) {
  constexpr int kApartPx = 8;
  return x == size / 2 && (y < size / 2 || y % kApartPx == 0);
}

/// A sharp white line and dots of one pixel before blurred black.
StressTrial make_sharp_line(double radius, int size, ThreadPool& /*pool*/) {
  StressFrame frame;
  frame.settings = uncut_settings(2.0 * radius, kStressFocusM, radius);
  frame.sharp = grey_picture_of(
      size, [&](int x, int y) { return is_thin(x, y, size) ? 1.0 : 0.0; },
      [&](int x, int y) { return is_thin(x, y, size) ? kStressFocusM : kStressFarM; });
  frame.truth = frame.sharp;
  return single(std::move(frame));
}

double largest_thin_loss(const StressAnswer& answer) {
  const int size = answer.truth[0].width;
  double largest = 0.0;
  for (int y = 0; y < size; ++y) {
    if (!is_thin(size / 2, y, size)) continue;
    const double lost = std::fabs(light_at(answer.result[0], size / 2, y) - 1.0);
    if (std::isnan(lost)) return lost;
    largest = std::max(largest, lost);
  }
  return largest;
}

/// A white line of one pixel on black, blurred alike: its profile is that of a disc's chords.
StressTrial make_blurred_line(double radius, int size, ThreadPool& /*pool*/) {
  const double light = radius * std::numbers::pi / 4.0;  // the profile's peak is one half
  StressFrame frame;
  frame.settings = uncut_settings(2.0 * radius, kStressFocusM, radius);
  frame.sharp = grey_picture_of(
      size, [&](int x, int) { return x == size / 2 ? light : 0.0; },
      [](int, int) { return kStressFarM; });
  frame.truth = grey_picture_of(
      size,
      [&](int x, int) {
        const int from_line = x - size / 2;
        const double from = (from_line - 0.5) / radius, to = (from_line + 0.5) / radius;
        return light * (disc_left_of(to) - disc_left_of(from));
      },
      [](int, int) { return kStressFarM; });
  return single(std::move(frame));
}

double line_profile_error(const StressAnswer& answer) {
  const int size = answer.truth[0].width;
  const PixelRange rows = middle_half(size);
  const std::vector<double> truth = column_means(answer.truth[0], rows);
  const std::vector<double> black(truth.size());
  return rms_difference(column_means(answer.result[0], rows), truth, {0, size}) /
         rms_difference(truth, black, {0, size});
}

constexpr StressParameter kPlainRadius{"radius", "px"};

constexpr std::array kPlainCases{
    StressCase{"constant", "One colour at all depths", "It stays that colour.", kPlainRadius,
               "largest error", "of white", 0.004, "a level of 255", kPlainRadii, 16, 0,
               make_constant, anywhere},
    StressCase{"borders", "One colour at one depth, blurred",
               "Nothing darkens at the picture's border.", kPlainRadius, "largest error",
               "of white", 0.004, "a level of 255", kPlainRadii, 16, 0, make_border, anywhere},
    StressCase{"repeats", "A bright strip along the left border, blurred",
               "It does not come back on the other side.", kPlainRadius,
               "largest error of the right quarter", "of the strip's light", 0.001,
               "a level of 255 for a light of 4", kPlainRadii, 16, 0, make_strip, repeated},
    StressCase{"thin-sharp", "A sharp white line and dots of one pixel before blurred black",
               "They keep their light.", kPlainRadius, "largest gain or loss", "of their light",
               0.05, "a fourteenth of a stop", kPlainRadii, 16, 0, make_sharp_line,
               largest_thin_loss},
    StressCase{"thin-blurred", "A white line of one pixel on black, blurred",
               "Its profile is that of a disc's chords.", kPlainRadius, "RMS error of the profile",
               "of the profile", 0.14, "half the error of a box as wide as the circle", kPlainRadii,
               16, 0, make_blurred_line, line_profile_error},
};

}  // namespace

std::span<const StressCase> plain_cases() { return kPlainCases; }

}  // namespace softfocus
