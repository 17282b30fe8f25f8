// Slanted planes, on which the circle grows from row to row: bands, and depths that are rounded.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr std::array<double, 7> kSlopes{1 / 64.0, 1 / 32.0, 1 / 16.0, 1 / 8.0,
                                        3 / 16.0, 1 / 4.0,  3 / 8.0};
constexpr std::array<double, 6> kDistances{2, 20, 200, 2000, 10000, 40000};
constexpr std::array<double, 8> kDepthBits{16, 12, 10, 9, 8, 7, 6, 5};

/// The signed radius grows by `slope` a row and is 0 in the middle.
struct Slope {
  double slope;
  int size;

  double radius_px(double row) const { return slope * (row - size / 2.0); }
  double largest_px() const { return slope * size / 2.0; }
  double at_infinity_px() const { return 4.0 * largest_px(); }
  double depth_m(double row, double focus_m) const {
    return depth_of_radius(radius_px(row), at_infinity_px(), focus_m);
  }
};

/// The mean over the lens of `seen(x, row)`, an offset and a row. A ray of the lens's point u
/// meets the plane where t' = t + r(t') u_y, t and t' counted from the row in focus.
template <class Seen>
double mean_over_lens(const Slope& plane, double row, const Seen& seen) {
  constexpr int kAcross = 48;
  const double middle = plane.size / 2.0;
  double sum = 0.0;
  int count = 0;
  for (int j = 0; j < kAcross; ++j) {
    for (int i = 0; i < kAcross; ++i) {
      const double u = (2 * i + 1.0) / kAcross - 1.0, v = (2 * j + 1.0) / kAcross - 1.0;
      if (u * u + v * v > 1.0) continue;
      const double met = middle + (row - middle) / (1.0 - plane.slope * v);
      sum += seen(plane.radius_px(met) * u, met);
      ++count;
    }
  }
  return sum / count;
}

double wave_period(int size) { return size / 16.0; }
constexpr double kWaveMean = 0.5, kWaveHeight = 0.4;

double wave_at(double x, int size) {
  return std::cos(2.0 * std::numbers::pi * x / wave_period(size));
}

/// Waves from left to right on a slope.
StressFrame wave_frame(const Slope& plane, double focus_m, double levels_per_m) {
  const int size = plane.size;
  StressFrame frame;
  frame.settings = uncut_settings(plane.at_infinity_px(), focus_m, plane.largest_px());
  const auto depth = [&](int, int y) {
    const double exact = plane.depth_m(y + 0.5, focus_m);
    return levels_per_m > 0.0 ? std::round(exact * levels_per_m) / levels_per_m : exact;
  };
  frame.sharp = grey_picture_of(
      size, [&](int x, int) { return kWaveMean + kWaveHeight * wave_at(x + 0.5, size); }, depth);
  std::vector<double> heights;
  heights.reserve(static_cast<std::size_t>(size));
  for (int y = 0; y < size; ++y) {
    heights.push_back(mean_over_lens(plane, y + 0.5,
                                     [&](double offset, double) { return wave_at(offset, size); }));
  }
  frame.truth = grey_picture_of(
      size,
      [&](int x, int y) {
        return kWaveMean +
               kWaveHeight * heights[static_cast<std::size_t>(y)] * wave_at(x + 0.5, size);
      },
      depth);
  return frame;
}

constexpr double kGentle = 1 / 8.0;

StressTrial make_grazing(double slope, int size, ThreadPool& /*pool*/) {
  return single(wave_frame({slope, size}, kStressFocusM, 0.0));
}

/// The gentle slope near by with all that halves tell, and the same slope otherwise.
StressTrial beside_the_best(StressFrame other, int size) {
  StressTrial trial = single(wave_frame({kGentle, size}, kStressFocusM, 0.0));
  trial.frames.push_back(std::move(other));
  return trial;
}

StressTrial make_distant(double distance_m, int size, ThreadPool& /*pool*/) {
  return beside_the_best(wave_frame({kGentle, size}, distance_m, 0.0), size);
}

/// Depths of so many bits, evenly from 0 to 4 m.
StressTrial make_few_bits(double bits, int size, ThreadPool& /*pool*/) {
  constexpr double kRangeM = 4.0;
  const double levels_per_m = (std::exp2(bits) - 1.0) / kRangeM;
  return beside_the_best(wave_frame({kGentle, size}, kStressFocusM, levels_per_m), size);
}

/// Rows whose circles lie within the picture.
PixelRange whole_rows(const Slope& plane) {
  const int margin = static_cast<int>(std::ceil(plane.largest_px())) + 2;
  return {margin, plane.size - margin};
}

/// The largest step of the waves' height from one row to the next that the other has not.
double band_height(const Image& picture, const Image& other, const Slope& plane) {
  const int size = plane.size;
  const auto steps = [&](const Image& of) {
    std::vector<double> heights = wave_amplitudes(of, wave_period(size), middle_half(size));
    for (std::size_t y = heights.size() - 1; y > 0; --y) heights[y] -= heights[y - 1];
    return heights;
  };
  const auto [begin, end] = whole_rows(plane);
  return largest_difference(steps(picture), steps(other), {begin + 1, end}) / kWaveHeight;
}

double grazing_bands(const StressAnswer& answer) {
  return band_height(answer.result[0], answer.truth[0], {answer.severity, answer.truth[0].height});
}

/// Bands of the second picture that the method's own first one has not.
double rounding_bands(const StressAnswer& answer) {
  return band_height(answer.result[1], answer.result[0], {kGentle, answer.truth[0].height});
}

/// A ramp of grey from corner to corner on a slope: it stays a ramp.
StressTrial make_ramp(double slope, int size, ThreadPool& /*pool*/) {
  const Slope plane{slope, size};
  StressFrame frame;
  frame.settings = uncut_settings(plane.at_infinity_px(), kStressFocusM, plane.largest_px());
  const auto ramp = [&](double x, double y) { return 0.1 + 0.4 * (x + y) / size; };
  const auto depth = [&](int, int y) { return plane.depth_m(y + 0.5, kStressFocusM); };
  frame.sharp = grey_picture_of(
      size, [&](int x, int y) { return ramp(x + 0.5, y + 0.5); }, depth);
  std::vector<double> rows;
  rows.reserve(static_cast<std::size_t>(size));
  for (int y = 0; y < size; ++y) {
    rows.push_back(mean_over_lens(plane, y + 0.5, [](double, double met) { return met; }));
  }
  frame.truth = grey_picture_of(
      size, [&](int x, int y) { return ramp(x + 0.5, rows[static_cast<std::size_t>(y)]); }, depth);
  return single(std::move(frame));
}

double ramp_error(const StressAnswer& answer) {
  const auto [begin, end] = whole_rows({answer.severity, answer.truth[0].height});
  double largest = 0.0;
  for (int y = begin; y < end; ++y) {
    for (int x = begin; x < end; ++x) {
      const double error =
          std::fabs(light_at(answer.result[0], x, y) - light_at(answer.truth[0], x, y));
      if (std::isnan(error)) return error;
      largest = std::max(largest, error);
    }
  }
  return largest;
}

constexpr StressParameter kSlope{"slope", "px a row"};
constexpr std::string_view kBands = "largest false step from row to row";
constexpr std::string_view kBandUnit = "of the waves' height";
constexpr double kBandLimit = 0.03;
constexpr std::string_view kWhyBands = "a line across the picture that an eye finds";

constexpr std::array kPlaneCases{
    StressCase{"grazing-plane", "Waves on a plane whose circle grows from row to row",
               "The waves fade smoothly: no bands where layers, tiles or radii meet.", kSlope,
               kBands, kBandUnit, kBandLimit, kWhyBands, kSlopes, 1 / 4.0, 0, make_grazing,
               grazing_bands},
    StressCase{"plane", "A ramp of grey on a plane whose circle grows from row to row",
               "It stays a ramp.", kSlope, "largest error", "of white", 0.01,
               "two and a half of 255 levels", kSlopes, 1 / 4.0, 0, make_ramp, ramp_error},
    StressCase{"depth-far",
               "The waves at a great distance, where halves have coarse steps",
               "No bands that there are not at 2 m.",
               {"distance", "m"},
               kBands,
               kBandUnit,
               kBandLimit,
               kWhyBands,
               kDistances,
               2000,
               0,
               make_distant,
               rounding_bands},
    StressCase{"depth-bits",
               "The waves with depths of few bits",
               "The waves fade smoothly.",
               {"depth", "bits"},
               kBands,
               kBandUnit,
               kBandLimit,
               kWhyBands,
               kDepthBits,
               8,
               0,
               make_few_bits,
               rounding_bands},
};

}  // namespace

std::span<const StressCase> plane_cases() { return kPlaneCases; }

}  // namespace softfocus
