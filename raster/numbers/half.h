#pragma once
// binary16, the storage format of RGBA16F textures (IEEE 754-2008, 3.6):
//
//   bit   15    14..10     9..0
//        sign  exponent  mantissa
//
//   exponent 0        (-1)^sign * 2^-24 * mantissa             zero, subnormals
//   exponent 1..30    (-1)^sign * 2^(exponent-15) * (1 + mantissa/1024)
//   exponent 31       infinity (mantissa 0) or NaN
//
//   0x3C00 = 1    0x0001 = 2^-24    0x0400 = 2^-14    0x7BFF = 65504 (largest)

#include <bit>
#include <cstdint>

namespace softfocus {

/// How a float that lies between two halves is stored.
enum class HalfRounding : std::uint8_t {
  /// To the nearer, ties to the even mantissa; past 65520 to infinity (IEEE 754).
  nearest_even,
  /// To the one nearer zero; past 65504 to 65504, infinity stays (D3D11.3 3.2.2).
  toward_zero,
  /// As SwiftShader: to nearest even, but see swiftshader_half().
  swiftshader,
};

inline constexpr std::uint16_t kHalfLargest = 0x7BFF;
inline constexpr float kLargestHalf = 65504.0f;  ///< kHalfLargest's value

/// Passes compare depths by this one: infinity is as far as a half can be.
inline constexpr float kFarthestDepth = 65504.0f;
inline float compared_depth(float depth) { return depth > kFarthestDepth ? kFarthestDepth : depth; }
inline constexpr std::uint16_t kHalfInfinity = 0x7C00;
inline constexpr std::uint16_t kHalfNan = 0x7E00;
inline constexpr std::uint16_t kHalfOne = 0x3C00;

/// Value of a half; exact. A NaN keeps its sign and payload and comes out quiet.
constexpr float half_to_float(std::uint16_t half) {
  const std::uint32_t sign = (half & 0x8000u) << 16;
  const std::uint32_t magnitude = half & 0x7FFFu;
  if (magnitude >= kHalfInfinity) {
    const std::uint32_t quiet = magnitude > kHalfInfinity ? 0x00400000u : 0u;
    return std::bit_cast<float>(sign | 0x7F800000u | quiet | (magnitude & 0x3FFu) << 13);
  }
  // Shifted into place, a half's exponent is read with the wrong bias (127 for
  // 15): 2^112 mends it, and turns subnormals into normal floats on the way.
  const float scaled = std::bit_cast<float>(magnitude << 13) * 0x1p112f;
  return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(scaled));
}

/// HalfRounding::swiftshader of a float's bits. It differs from nearest_even in two ways:
///
/// - A subnormal half comes from a multiple of 2^-37, to which the float is cut first. So what
///   lies just above the middle of two halves counts as the middle.
/// - Past 65568 the sum runs beyond infinity's bits: a NaN. So does infinity.
constexpr std::uint16_t swiftshader_half(std::uint32_t bits) {
  const std::uint32_t magnitude = bits & 0x7FFFFFFFu;
  // 13 bits more than the half has, 10 of them the mantissa's first.
  std::uint32_t base = magnitude - (112u << 23);
  if (magnitude < 0x38800000u) {
    const std::uint32_t significand = (magnitude & 0x7FFFFFu) | 0x800000u;
    const std::uint32_t cut = 113 - (magnitude >> 23);
    base = cut < 24 ? significand >> cut : 0;
  }
  const std::uint32_t half = (base + 0xFFFu + (base >> 13 & 1u)) >> 13;
  return static_cast<std::uint16_t>(half > kHalfInfinity ? kHalfNan
                                                         : (bits >> 16 & 0x8000u) | half);
}

/// The largest half that float_to_half() gives back of what half_to_float() made of it.
constexpr std::uint16_t largest_kept_half(HalfRounding rounding) {
  return rounding == HalfRounding::swiftshader ? kHalfLargest : kHalfInfinity;
}

/// The half that stores `value`. Any NaN becomes 0x7E00: processors differ in the sign
/// and the payload of the NaN that, say, infinity minus infinity gives.
constexpr std::uint16_t float_to_half(float value, HalfRounding rounding) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  if (rounding == HalfRounding::swiftshader) return swiftshader_half(bits);
  const auto sign = static_cast<std::uint16_t>(bits >> 16 & 0x8000u);
  const std::uint32_t magnitude = bits & 0x7FFFFFFFu;
  if (magnitude > 0x7F800000u) return kHalfNan;
  if (magnitude == 0x7F800000u) return static_cast<std::uint16_t>(sign | kHalfInfinity);

  const int exponent = static_cast<int>(magnitude >> 23) - 127;
  if (exponent > 15) {
    const bool to_infinity = rounding == HalfRounding::nearest_even;
    return static_cast<std::uint16_t>(sign | (to_infinity ? kHalfInfinity : kHalfLargest));
  }
  if (exponent < -25) return sign;  // below half of the smallest subnormal

  // The kept bits and the cut ones, with the implicit one made explicit: a
  // normal half keeps 11 of the 24 significant bits, a subnormal one fewer.
  const std::uint32_t significand = (magnitude & 0x7FFFFFu) | 0x800000u;
  const int cut = exponent >= -14 ? 13 : -1 - exponent;
  std::uint32_t kept = significand >> cut;
  if (exponent >= -14) kept += static_cast<std::uint32_t>(exponent + 14) << 10;
  if (rounding == HalfRounding::nearest_even) {
    const std::uint32_t rest = significand & ((1u << cut) - 1);
    const std::uint32_t tie = 1u << (cut - 1);
    // A carry runs from the mantissa into the exponent, and from 65504 to infinity.
    if (rest > tie || (rest == tie && (kept & 1u) != 0)) ++kept;
  }
  return static_cast<std::uint16_t>(sign | kept);
}

/// How far apart two halves lie, counted in representable values: 0 for equal
/// bits and for +0 against -0. Two NaNs are 0 apart; a NaN and a number 65535.
constexpr int half_ulps_between(std::uint16_t a, std::uint16_t b) {
  const auto is_nan = [](std::uint16_t half) { return (half & 0x7FFFu) > kHalfInfinity; };
  if (is_nan(a) || is_nan(b)) return is_nan(a) && is_nan(b) ? 0 : 65535;
  // Sign and magnitude to a number line.
  const auto place = [](std::uint16_t half) {
    const int magnitude = half & 0x7FFF;
    return (half & 0x8000) != 0 ? -magnitude : magnitude;
  };
  const int distance = place(a) - place(b);
  return distance < 0 ? -distance : distance;
}

}  // namespace softfocus
