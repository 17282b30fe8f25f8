#pragma once
// Bilinear filtering of 8-bit texels in integers, for the emulation and for use by itself:
// this header needs nothing but <stdint.h>, and no memory.
//
// A coordinate is in texels, 24.8 fixed point: 256 is a texel's width, and texel i's centre
// lies at 256 i + 128 (D3D11.3 7.18.8). The weight of the second of two texels has 8 bits,
// 0 to 255 of 256.
//
// Two roundings. lerp_unorm8() rounds to 8 bits after each row and between rows, as llvmpipe
// does. bilinear_unorm8() keeps products of 8 + 8 + 8 bits and rounds once: with it the result
// never moves against the weights either (D3D11.3 7.18.16.3). Both stay between the least and
// the greatest texel, and give four equal texels unchanged.

#include <stdint.h>

namespace softfocus {

/// a + weight / 256 (b - a), rounded to nearest, ties up. Needs 0 <= weight, a, b <= 255;
/// lies between a and b.
constexpr int lerp_unorm8(int a, int b, int weight) { return a + ((weight * (b - a) + 128) >> 8); }

/// The mean of four texels, rounded once to nearest, ties up: c00 at the upper left, c10 to
/// its right. Weights 0 to 255. Below 2^24 255 + 2^15 < 2^31.
constexpr int bilinear_unorm8(int c00, int c10, int c01, int c11, int weight_u, int weight_v) {
  const int upper = c00 * (256 - weight_u) + c10 * weight_u;
  const int lower = c01 * (256 - weight_u) + c11 * weight_u;
  return (upper * (256 - weight_v) + lower * weight_v + (1 << 15)) >> 16;
}

/// The two texels that a coordinate lies between, along one axis, and the second's weight.
struct FixedTaps {
  int first, second, weight;
};

/// A coordinate less half a texel: from centre to centre.
constexpr int32_t from_centre(int32_t coordinate_256) {
  // Wraps round at the least integer, which is what processors give for what no integer holds.
  return static_cast<int32_t>(static_cast<uint32_t>(coordinate_256) - 128u);
}

/// Taps of a position from centre to centre, the edge repeated outwards: left of the first
/// texel's centre both are the first texel. Needs size >= 1.
constexpr FixedTaps clamped_taps(int32_t position_256, int size) {
  const int index = position_256 >> 8;
  const int first = index < 0 ? 0 : index < size ? index : size - 1;
  return {first, index >= 0 && index < size - 1 ? index + 1 : first, position_256 & 255};
}

/// The same, the texture repeated; `size` a power of two.
constexpr FixedTaps repeated_taps(int32_t position_256, int size) {
  const int index = position_256 >> 8;
  return {index & (size - 1), (index + 1) & (size - 1), position_256 & 255};
}

/// A bilinear fetch of `channels` bytes a texel from `texels`, whose rows are `stride_bytes`
/// apart, at a coordinate in texels of 24.8 bits; the edges are repeated outwards.
constexpr void fetch_unorm8(const uint8_t* texels, int stride_bytes, int width, int height,
                            int channels, int32_t u_256, int32_t v_256, uint8_t* result) {
  const FixedTaps u = clamped_taps(from_centre(u_256), width);
  const FixedTaps v = clamped_taps(from_centre(v_256), height);
  const uint8_t* upper = texels + static_cast<int64_t>(v.first) * stride_bytes;
  const uint8_t* lower = texels + static_cast<int64_t>(v.second) * stride_bytes;
  for (int i = 0; i < channels; ++i) {
    const int left = u.first * channels + i, right = u.second * channels + i;
    result[i] = static_cast<uint8_t>(
        bilinear_unorm8(upper[left], upper[right], lower[left], lower[right], u.weight, v.weight));
  }
}

}  // namespace softfocus
