#include "raster/numbers/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/lerp.h"

namespace softfocus {
namespace {

double decode(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : exact_math::pow((encoded + 0.055) / 1.055, 2.4);
}

std::array<float, 256> decoding_table() {
  std::array<float, 256> values{};
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = static_cast<float>(decode(static_cast<double>(k) / 255.0));
  }
  return values;
}

// To 8 significant decimal digits.
double to_8_digits(double value) {
  if (value == 0.0) return 0.0;
  double scale = 1.0;
  while (value * scale < 1e7) scale *= 10.0;
  return std::nearbyint(value * scale) / scale;
}

std::array<float, 256> decimal_decoding_table() {
  std::array<float, 256> values{};
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = static_cast<float>(to_8_digits(decode(static_cast<double>(k) / 255.0)));
  }
  return values;
}

std::array<std::uint16_t, 256> table_of_65280ths() {
  std::array<std::uint16_t, 256> values{};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const float code = static_cast<float>(k) / 255.0f;
    const float base = (code + 0.055f) / 1.055f;
    const float linear = code <= 0.04045f
                             ? code / 12.92f
                             : static_cast<float>(exact_math::pow(static_cast<double>(base),
                                                                  static_cast<double>(2.4f)));
    values[k] = static_cast<std::uint16_t>(linear * 65280.0f + 0.5f);
  }
  return values;
}

// Where one code gives way to the next, half-way between codes: the least floats that are not
// below the curve.
std::array<float, 255> encoding_thresholds() {
  std::array<float, 255> values{};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double exact = decode((static_cast<double>(k) + 0.5) / 255.0);
    values[k] = static_cast<float>(exact);
    if (static_cast<double>(values[k]) < exact) values[k] = std::nextafter(values[k], 2.0f);
  }
  return values;
}

}  // namespace

float srgb8_to_linear(std::uint8_t encoded) {
  static const std::array<float, 256> table = decoding_table();
  return table[encoded];
}

float srgb8_to_linear_decimal(std::uint8_t encoded) {
  static const std::array<float, 256> table = decimal_decoding_table();
  return table[encoded];
}

std::uint16_t srgb8_in_65280ths(std::uint8_t encoded) {
  static const std::array<std::uint16_t, 256> table = table_of_65280ths();
  return table[encoded];
}

float srgb8_to_linear_by_cubic(std::uint8_t encoded, Contraction contraction) {
  const auto x = static_cast<float>(encoded);
  if (encoded <= 15) return x * (1.0f / (12.6f * 255.0f));
  // c0 + c1 s + c2 s^2 + c3 s^3 of s = x / 255, its powers of 255 taken into constants.
  constexpr float k0 = 0.0023f;
  constexpr float k1 = 0.0030f / 255.0f;
  constexpr float k2 = 0.6935f / (255.0f * 255.0f);
  constexpr float k3 = 0.3012f / (255.0f * 255.0f * 255.0f);
  const float square = x * x;
  const float odd = multiply_add(square, k3, k1, contraction);
  const float even = multiply_add(square, k2, k0, contraction);
  return multiply_add(odd, x, even, contraction);
}

std::uint8_t linear_to_srgb8(float linear) {
  static const std::array<float, 255> thresholds = encoding_thresholds();
  if (!(linear > 0.0f)) return 0;
  return static_cast<std::uint8_t>(std::upper_bound(thresholds.begin(), thresholds.end(), linear) -
                                   thresholds.begin());
}

}  // namespace softfocus
