#pragma once
// Bilinear filtering of bytes and of halves in integers. Stands alone: it needs only
// <stdint.h>, and no memory.
//
// Coordinates are in texels, 24.8 fixed point: a texel is 256 wide, and texel i's centre lies
// at 256 i + 128 (D3D11.3 7.18.8). Weights of the second of two texels have 8 bits, 0 to 255
// of 256.
//
// Bytes can be rounded in two ways. lerp_unorm8() rounds to 8 bits after each row and between
// rows, as llvmpipe does. bilinear_unorm8() keeps 8 + 8 + 8 bits and rounds once, so that the
// result also moves the way the weights do (D3D11.3 7.18.16.3). Sums of halves are exact and
// rounded once, to binary32. In all three the result lies between the least and the greatest
// texel, and four equal texels come out unchanged.

#include <stdint.h>

namespace softfocus {

/// a + weight / 256 (b - a), rounded to nearest, ties up. Needs 0 <= weight, a, b <= 255;
/// lies between a and b.
constexpr int lerp_unorm8(int a, int b, int weight) { return a + ((weight * (b - a) + 128) >> 8); }

/// The mean of four texels in 2^-16, exact: c00 at the upper left, c10 to its right. Weights
/// 0 to 255. At most 255 2^16 < 2^24.
constexpr int bilinear_sum_unorm8(int c00, int c10, int c01, int c11, int weight_u, int weight_v) {
  const int upper = c00 * (256 - weight_u) + c10 * weight_u;
  const int lower = c01 * (256 - weight_u) + c11 * weight_u;
  return upper * (256 - weight_v) + lower * weight_v;
}

/// That mean, rounded once to nearest, ties up.
constexpr int bilinear_unorm8(int c00, int c10, int c01, int c11, int weight_u, int weight_v) {
  return (bilinear_sum_unorm8(c00, c10, c01, c11, weight_u, weight_v) + (1 << 15)) >> 16;
}

/// Whether a half is neither infinite nor NaN. The functions below need finite halves.
constexpr bool is_finite_half(uint16_t half) { return (half & 0x7C00) != 0x7C00; }

/// A half as a count of 2^-24, exact: at most 2047 2^29 < 2^40 in magnitude. Both zeros are 0.
constexpr int64_t half_to_integer(uint16_t half) {
  const int exponent = half >> 10 & 31;
  const int64_t mantissa = half & 1023;
  const int64_t magnitude = exponent == 0 ? mantissa : (mantissa + 1024) << (exponent - 1);
  return (half & 0x8000) != 0 ? -magnitude : magnitude;
}

/// The mean of four halves in 2^-40, exact: at most 2047 2^45 < 2^56 in magnitude.
constexpr int64_t bilinear_sum_half(uint16_t c00, uint16_t c10, uint16_t c01, uint16_t c11,
                                    int weight_u, int weight_v) {
  const int64_t upper = half_to_integer(c00) * (256 - weight_u) + half_to_integer(c10) * weight_u;
  const int64_t lower = half_to_integer(c01) * (256 - weight_u) + half_to_integer(c11) * weight_u;
  return upper * (256 - weight_v) + lower * weight_v;
}

/// The bits of the binary32 nearest to magnitude 2^-48, ties to even: never subnormal. 0 is +0.
constexpr uint32_t round_to_binary32(bool is_negative, uint64_t magnitude) {
  if (magnitude == 0) return 0;
  // The highest bit to the top; with it there, the number is 2^15 to 2^16.
  uint32_t exponent = 127 + 15;
  for (int step = 32; step > 0; step /= 2) {
    if (magnitude >> (64 - step) != 0) continue;
    magnitude <<= step;
    exponent -= static_cast<uint32_t>(step);
  }
  const uint64_t cut = magnitude & 0xFFFFFFFFFFu, tie = uint64_t{1} << 39;
  uint32_t kept = static_cast<uint32_t>(magnitude >> 40);  // 24 bits, the implicit one too
  if (cut > tie || (cut == tie && (kept & 1) != 0)) ++kept;
  // The implicit bit adds 1 to the exponent, and so does a carry.
  return (is_negative ? 0x80000000u : 0u) | (((exponent - 1) << 23) + kept);
}

/// fine + weight / 256 (coarse - fine) of two sums in 2^-40, weight 0 to 256: the bits of a
/// binary32, rounded once. With weight 0 it rounds a single sum. Computed in sign and magnitude,
/// as the magnitude in 2^-48 needs 64 bits: it is up to 2047 2^53.
constexpr uint32_t mix_sums_half(int64_t fine, int64_t coarse, int weight) {
  const auto magnitude = [](int64_t sum) { return static_cast<uint64_t>(sum < 0 ? -sum : sum); };
  const uint64_t a = magnitude(fine) * static_cast<uint64_t>(256 - weight);
  const uint64_t b = magnitude(coarse) * static_cast<uint64_t>(weight);
  if ((fine < 0) == (coarse < 0)) return round_to_binary32(fine < 0, a + b);
  return a > b ? round_to_binary32(fine < 0, a - b) : round_to_binary32(coarse < 0, b - a);
}

/// The two texels that a coordinate lies between, along one axis, and the second's weight.
struct IntegerTaps {
  int first, second, weight;
};

/// A coordinate less half a texel, which puts texel i's centre at 256 i.
constexpr int32_t from_centre(int32_t coordinate_256) {
  // Wraps round at the least integer, which x86 gives for floats that no integer holds.
  return static_cast<int32_t>(static_cast<uint32_t>(coordinate_256) - 128u);
}

/// Taps of a from_centre() position, edges repeated outwards: left of the first texel's centre
/// both are the first texel. Needs size >= 1.
constexpr IntegerTaps clamped_taps(int32_t position_256, int size) {
  const int index = position_256 >> 8;
  const int first = index < 0 ? 0 : index < size ? index : size - 1;
  return {first, index >= 0 && index < size - 1 ? index + 1 : first, position_256 & 255};
}

/// Taps in a repeating texture; `size` a power of two.
constexpr IntegerTaps repeated_taps(int32_t position_256, int size) {
  const int index = position_256 >> 8;
  return {index & (size - 1), (index + 1) & (size - 1), position_256 & 255};
}

/// A bilinear fetch of `channels` bytes a texel from `texels`, whose rows are `stride_bytes`
/// apart, at a coordinate in texels of 24.8 bits; the edges are repeated outwards.
constexpr void fetch_unorm8(const uint8_t* texels, int stride_bytes, int width, int height,
                            int channels, int32_t u_256, int32_t v_256, uint8_t* result) {
  const IntegerTaps u = clamped_taps(from_centre(u_256), width);
  const IntegerTaps v = clamped_taps(from_centre(v_256), height);
  const uint8_t* upper = texels + static_cast<int64_t>(v.first) * stride_bytes;
  const uint8_t* lower = texels + static_cast<int64_t>(v.second) * stride_bytes;
  for (int i = 0; i < channels; ++i) {
    const int left = u.first * channels + i, right = u.second * channels + i;
    result[i] = static_cast<uint8_t>(
        bilinear_unorm8(upper[left], upper[right], lower[left], lower[right], u.weight, v.weight));
  }
}

/// A bilinear fetch of `channels` halves a texel, all finite, from rows that are `stride` halves
/// apart. Gives the bits of binary32 numbers.
constexpr void fetch_half(const uint16_t* texels, int stride, int width, int height, int channels,
                          int32_t u_256, int32_t v_256, uint32_t* result) {
  const IntegerTaps u = clamped_taps(from_centre(u_256), width);
  const IntegerTaps v = clamped_taps(from_centre(v_256), height);
  const uint16_t* upper = texels + static_cast<int64_t>(v.first) * stride;
  const uint16_t* lower = texels + static_cast<int64_t>(v.second) * stride;
  for (int i = 0; i < channels; ++i) {
    const int left = u.first * channels + i, right = u.second * channels + i;
    const int64_t sum =
        bilinear_sum_half(upper[left], upper[right], lower[left], lower[right], u.weight, v.weight);
    result[i] = mix_sums_half(sum, sum, 0);
  }
}

}  // namespace softfocus
