#pragma once
// The oracle of the fixed-point filter (docs/fixed-point.md), on whole pictures: in wide integers,
// with a division for each quotient; and in binary64, without rounding between lens and result.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dof/fixed/fixed.h"

namespace softfocus::fixed {

/// A picture of three channels, in the unit that its maker chose.
template <class Value>
struct Picture3 {
  int width = 0, height = 0;
  std::vector<std::array<Value, 3>> pixels;

  const std::array<Value, 3>& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

/// floor(a / b), b > 0.
inline std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  const std::int64_t quotient = a / b;
  return quotient * b > a ? quotient - 1 : quotient;
}

/// One pass along (dx, dy): channels times weights summed in 64 bits; `quotient(sum, weight)`
/// makes a channel. Sums of the far side are cut by the leakage of the receiver in two
/// parts, for 64 bits do not hold sum times leakage of an RGBA16F picture.
template <class Quotient>
Picture3<std::int64_t> wide_pass(const Picture3<std::int64_t>& in,
                                 const std::vector<Weights>& weights, int dx, int dy,
                                 const Quotient& quotient) {
  Picture3<std::int64_t> out = in;
  const auto weights_at = [&](int x, int y) -> const Weights& {
    return weights[static_cast<std::size_t>(y) * static_cast<std::size_t>(in.width) +
                   static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x) {
      const Weights& centre = weights_at(x, y);
      std::array<std::array<std::int64_t, 4>, 2> sums{};
      for (int d = -SOFTFOCUS_FIXED_LARGEST_REACH; d <= SOFTFOCUS_FIXED_LARGEST_REACH; ++d) {
        const int px = std::clamp(x + d * dx, 0, in.width - 1);
        const int py = std::clamp(y + d * dy, 0, in.height - 1);
        const Weights& p = weights_at(px, py);
        const int distance = d < 0 ? -d : d;
        const std::int64_t weight = distance == 0         ? p.whole
                                    : distance < p.reach  ? p.whole
                                    : distance == p.reach ? p.edge
                                                          : 0;
        auto& side = sums[distance != 0 && p.beyond != 0 ? 1 : 0];
        for (std::size_t i = 0; i < 3; ++i) side[i] += weight * in.at(px, py)[i];
        side[3] += weight;
      }
      std::array<std::int64_t, 4> sum{};
      for (std::size_t i = 0; i < 4; ++i) {
        const std::int64_t high = floor_divide(sums[1][i], 1 << 15);
        const std::int64_t low = sums[1][i] - high * (1 << 15);
        sum[i] = sums[0][i] + high * centre.leak + floor_divide(low * centre.leak, 1 << 15);
      }
      auto& to = out.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(in.width) +
                            static_cast<std::size_t>(x)];
      for (std::size_t i = 0; i < 3; ++i) to[i] = quotient(sum[i], sum[3]);
    }
  }
  return out;
}

/// Both passes of an 8-bit picture.
inline Picture3<std::int64_t> wide_filter8(Picture3<std::int64_t> bytes,
                                           const std::vector<Weights>& weights) {
  for (auto& pixel : bytes.pixels) {
    for (auto& channel : pixel) channel *= 4;
  }
  const auto nearest = [](std::int64_t sum, std::int64_t weight) {
    return floor_divide(2 * sum + weight, 2 * weight);
  };
  const auto nearest_byte = [](std::int64_t sum, std::int64_t weight) {
    return floor_divide(sum + 2 * weight, 4 * weight);
  };
  return wide_pass(wide_pass(bytes, weights, 1, 0, nearest), weights, 0, 1, nearest_byte);
}

// Halves in units of 2^-24, by the definition of binary16.
inline std::int64_t half_units(std::uint32_t half) {
  const std::uint32_t exponent = half >> 10 & 31, mantissa = half & 1023;
  std::int64_t units = exponent == 0 ? mantissa : mantissa + 1024;
  for (std::uint32_t i = 1; i < exponent; ++i) units *= 2;
  if (exponent == 31) units = mantissa == 0 ? half_units(0x7BFF) : 0;
  return (half & 0x8000) != 0 ? -units : units;
}

/// The half nearest to sum / weight, by a search among all of them.
inline std::uint16_t nearest_half(std::int64_t sum, std::int64_t weight) {
  const std::int64_t magnitude = sum < 0 ? -sum : sum;
  std::uint32_t below = 0, above = 0x7BFF;  // below <= quotient, if above > below + 1
  while (above - below > 1) {
    const std::uint32_t middle = (below + above) / 2;
    (half_units(middle) * weight <= magnitude ? below : above) = middle;
  }
  const std::int64_t midway = (half_units(below) + half_units(above)) * weight;
  const bool up = 2 * magnitude > midway || (2 * magnitude == midway && below % 2 == 1);
  return static_cast<std::uint16_t>((up ? above : below) | (sum < 0 ? 0x8000u : 0u));
}

/// Both passes of an RGBA16F picture, from half_units() to the bits of halves.
inline Picture3<std::int64_t> wide_filter16(const Picture3<std::int64_t>& halves,
                                            const std::vector<Weights>& weights) {
  const auto as_units = [](std::int64_t sum, std::int64_t weight) {
    return half_units(nearest_half(sum, weight));
  };
  const auto as_bits = [](std::int64_t sum, std::int64_t weight) {
    return std::int64_t{nearest_half(sum, weight)};
  };
  return wide_pass(wide_pass(halves, weights, 1, 0, as_units), weights, 0, 1, as_bits);
}

/// A pixel for the equations themselves: its radius in pixels, cut to the largest, and its side.
struct ExactPixel {
  double radius;
  bool beyond;
};

inline Picture3<double> exact_pass(const Picture3<double>& in,
                                   const std::vector<ExactPixel>& circles, double leak, int reach,
                                   int dx, int dy) {
  Picture3<double> out = in;
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(in.width) +
           static_cast<std::size_t>(x);
  };
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x) {
      const ExactPixel& centre = circles[index(x, y)];
      const double leakage = std::min(leak * centre.radius, 1.0);
      std::array<double, 4> sum{};
      for (int d = -reach; d <= reach; ++d) {
        const std::size_t at = index(std::clamp(x + d * dx, 0, in.width - 1),
                                     std::clamp(y + d * dy, 0, in.height - 1));
        const ExactPixel& p = circles[at];
        const double overlap = d == 0 ? 1.0 : std::clamp(p.radius - std::abs(d), 0.0, 1.0);
        const double wide = std::max(p.radius, 1.0);
        const double weight = overlap / (wide * wide) * (d != 0 && p.beyond ? leakage : 1.0);
        for (std::size_t i = 0; i < 3; ++i) sum[i] += weight * in.pixels[at][i];
        sum[3] += weight;
      }
      for (std::size_t i = 0; i < 3; ++i) out.pixels[index(x, y)][i] = sum[i] / sum[3];
    }
  }
  return out;
}

inline Picture3<double> exact_filter(const Picture3<double>& picture,
                                     const std::vector<ExactPixel>& circles, double leak,
                                     int reach) {
  return exact_pass(exact_pass(picture, circles, leak, reach, 1, 0), circles, leak, reach, 0, 1);
}

}  // namespace softfocus::fixed
