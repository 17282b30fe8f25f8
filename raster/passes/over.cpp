#ifndef SOFTFOCUS_ISA

#include "raster/passes/over.h"

#include <cstring>

#define SOFTFOCUS_KERNELS "raster/passes/over.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

std::uint16_t over(std::uint16_t colour, std::uint16_t opacity, std::uint16_t below,
                   HalfRounding rounding) {
  const float hidden = half_to_float(opacity);
  const float share = hidden > 0.0f ? (hidden < 1.0f ? hidden : 1.0f) : 0.0f;
  const float light = half_to_float(colour);
  if (share == 0.0f && light == 0.0f) return below;
  return float_to_half(light + (1.0f - share) * half_to_float(below), rounding);
}

}  // namespace

void lay_over(const OverRow& row, HalfRounding rounding, std::uint16_t* below, Isa isa) {
  int x = 0;
  if (isa != Isa::scalar) x = SOFTFOCUS_KERNEL(isa, lay_vectors_over)(row, rounding, below);
  for (; x < row.width; ++x) {
    for (int i = 4 * x; i < 4 * x + 3; ++i) {
      below[i] = over(row.colour[i], row.opacity[i], below[i], rounding);
    }
  }
}

void take_depths(const std::uint16_t* opacity, int width, std::uint16_t* below, Isa isa) {
  int x = 0;
  if (isa != Isa::scalar) x = SOFTFOCUS_KERNEL(isa, take_vectors_of_depths)(opacity, width, below);
  for (int i = 4 * x; i < 4 * width; i += 4) {
    if (half_to_float(opacity[i]) >= 0.5f) below[i + 3] = opacity[i + 3];
  }
}

}  // namespace softfocus

#else  // the kernels

namespace {

template <HalfRounding rounding>
SOFTFOCUS_INLINE Bits over_lanes(Bits colour, Bits opacity, Bits below) {
  const Floats hidden = half_to_float(opacity);
  const Floats share =
      select(hidden > 0.0f, select(hidden < 1.0f, hidden, splat(1.0f)), splat(0.0f));
  const Floats light = half_to_float(colour);
  const Bits laid = float_to_half<rounding>(light + (1.0f - share) * half_to_float(below));
  return select((share == 0.0f) & (light == 0.0f), below, laid);
}

template <HalfRounding rounding>
int lay_whole_vectors(const OverRow& row, std::uint16_t* below) {
  int x = 0;
  for (; x + kLanes <= row.width; x += kLanes) {
    const HalfTexels colour = load_half_texels(row.colour + 4 * x);
    const HalfTexels opacity = load_half_texels(row.opacity + 4 * x);
    HalfTexels texels = load_half_texels(below + 4 * x);
    texels.r = over_lanes<rounding>(colour.r, opacity.r, texels.r);
    texels.g = over_lanes<rounding>(colour.g, opacity.g, texels.g);
    texels.b = over_lanes<rounding>(colour.b, opacity.b, texels.b);
    store_half_texels(below + 4 * x, texels);
  }
  return x;
}

}  // namespace

/// Returns how many pixels are done.
int lay_vectors_over(const OverRow& row, HalfRounding rounding, std::uint16_t* below) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return lay_whole_vectors<nearest_even>(row, below);
    case toward_zero: return lay_whole_vectors<toward_zero>(row, below);
    case swiftshader: break;
  }
  return lay_whole_vectors<swiftshader>(row, below);
}

/// Likewise.
int take_vectors_of_depths(const std::uint16_t* opacity, int width, std::uint16_t* below) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const HalfTexels layer = load_half_texels(opacity + 4 * x);
    HalfTexels texels = load_half_texels(below + 4 * x);
    texels.a = select(half_to_float(layer.r) >= 0.5f, layer.a, texels.a);
    store_half_texels(below + 4 * x, texels);
  }
  return x;
}

#endif
