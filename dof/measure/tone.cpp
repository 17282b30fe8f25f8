#include "dof/measure/tone.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "raster/numbers/half.h"

namespace softfocus {
namespace {

constexpr double kFilmExposure = 0.6;
constexpr double kNumerator2 = 2.51 * kFilmExposure * kFilmExposure;
constexpr double kNumerator1 = 0.03 * kFilmExposure;
constexpr double kDenominator2 = 2.43 * kFilmExposure * kFilmExposure;
constexpr double kDenominator1 = 0.59 * kFilmExposure;
constexpr double kDenominator0 = 0.14;

template <class Curve>
ToneTable tabulated(const Curve& curve) {
  ToneTable table(0x10000);
  for (std::size_t bits = 0; bits < table.size(); ++bits) {
    const double light = half_light(static_cast<std::uint16_t>(bits));
    table[bits] = light > 0.0 ? std::clamp(curve(light), 0.0, 1.0) : 0.0;
  }
  return table;
}

}  // namespace

double half_light(std::uint16_t half) {
  const auto light = static_cast<double>(half_to_float(half));
  return light > 0.0 ? std::min(light, 65504.0) : 0.0;  // NaN compares as false
}

ToneTable clamped_tone() {
  return tabulated([](double light) { return light; });
}

ToneTable filmic_tone(double exposure_stops) {
  const double factor = std::exp2(exposure_stops);
  return tabulated([&](double light) {
    const double x = factor * light;
    return x * (kNumerator2 * x + kNumerator1) /
           (x * (kDenominator2 * x + kDenominator1) + kDenominator0);
  });
}

double filmic_inverse(double value) {
  assert(value > 0.0 && value < 1.0);
  const double square = kNumerator2 - kDenominator2 * value;
  const double half_linear = 0.5 * (kNumerator1 - kDenominator1 * value) / square;
  const double constant = -kDenominator0 * value / square;
  return -half_linear + std::sqrt(half_linear * half_linear - constant);
}

ToneTable srgb_encoded(ToneTable table) {
  for (double& value : table) {
    value = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
  }
  return table;
}

}  // namespace softfocus
