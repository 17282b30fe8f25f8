#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "raster/temporal/split_texels.h"

#include <cassert>

#define SOFTFOCUS_KERNELS "raster/temporal/split_texels.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void split_texels(const ConstImageView& image, int y, int channels, float* to, Isa isa) {
  assert(channels == channel_count(image.format) && (channels == 2 || channels == 4));
  const std::uint16_t* from = row<std::uint16_t>(image, y).data();
  const std::ptrdiff_t plane = plane_floats(image.width);
  if (channels == 4) {
    SOFTFOCUS_KERNEL(isa, split_fours)(from, image.width, plane, to + 1);
  } else {
    SOFTFOCUS_KERNEL(isa, split_pairs)(from, image.width, plane, to + 1);
  }
  for (int c = 0; c < channels; ++c) {
    float* first = to + c * plane + 1;
    first[-1] = first[0];
    first[image.width] = first[image.width - 1];
  }
}

void join_texels(const float* const* planes, int width, HalfRounding rounding, std::uint16_t* to,
                 Isa isa) {
  const int whole = width - width % kMostLanes;
  SOFTFOCUS_KERNEL(isa, join_fours)(planes, whole, rounding, to);
  for (int x = whole; x < width; ++x) {
    for (int c = 0; c < 4; ++c) to[4 * x + c] = float_to_half(planes[c][x], rounding);
  }
}

}  // namespace softfocus

#else  // the kernels

void split_fours(const std::uint16_t* from, int width, std::ptrdiff_t plane, float* to) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const HalfTexels texels = load_half_texels(from + 4 * x);
    store(to + x, half_to_float(texels.r));
    store(to + plane + x, half_to_float(texels.g));
    store(to + 2 * plane + x, half_to_float(texels.b));
    store(to + 3 * plane + x, half_to_float(texels.a));
  }
  for (; x < width; ++x) {
    for (int c = 0; c < 4; ++c) to[c * plane + x] = ::softfocus::half_to_float(from[4 * x + c]);
  }
}

void split_pairs(const std::uint16_t* from, int width, std::ptrdiff_t plane, float* to) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const HalfPairs texels = load_half_pairs(from + 2 * x);
    store(to + x, half_to_float(texels.r));
    store(to + plane + x, half_to_float(texels.g));
  }
  for (; x < width; ++x) {
    for (int c = 0; c < 2; ++c) to[c * plane + x] = ::softfocus::half_to_float(from[2 * x + c]);
  }
}

namespace {

template <HalfRounding rounding>
SOFTFOCUS_INLINE void join_rounded(const float* const* planes, int width, std::uint16_t* to) {
  for (int x = 0; x < width; x += kLanes) {
    store_half_texels(to + 4 * x, {float_to_half<rounding>(load(planes[0] + x)),
                                   float_to_half<rounding>(load(planes[1] + x)),
                                   float_to_half<rounding>(load(planes[2] + x)),
                                   float_to_half<rounding>(load(planes[3] + x))});
  }
}

}  // namespace

void join_fours(const float* const* planes, int width, HalfRounding rounding, std::uint16_t* to) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return join_rounded<nearest_even>(planes, width, to);
    case toward_zero: return join_rounded<toward_zero>(planes, width, to);
    case swiftshader: return join_rounded<swiftshader>(planes, width, to);
  }
}

#endif
