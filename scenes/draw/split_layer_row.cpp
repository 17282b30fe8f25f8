#ifndef SOFTFOCUS_ISA

#include "scenes/draw/split_layer_row.h"

#include <algorithm>
#include <cstring>

#include "scenes/surfaces/surface_stages.h"

#define SOFTFOCUS_KERNELS "scenes/draw/split_layer_row.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

float metres_of(const DepthsInMetres& in_metres, float depth) {
  const float left = 1.0f - depth;
  // softpipe's slivers have depths beyond 1.
  return 1.0f /
         (in_metres.inverse_far + (left > 0.0f ? left : 0.0f) * in_metres.inverse_near_less_far);
}

}  // namespace

void split_layer_row(const DrawnLayerRow& row, const DepthsInMetres& in_metres,
                     HalfRounding rounding, const std::uint16_t* elsewhere, std::uint16_t* colour,
                     std::uint16_t* opacity, Isa isa) {
  int done = 0;
  if (isa != Isa::scalar) {
    done = SOFTFOCUS_KERNEL(isa, split_layer_vectors)(row, in_metres, rounding, elsewhere, colour,
                                                      opacity);
  }
  for (int i = 4 * done; i < 4 * row.width; i += 4) {
    const std::uint16_t hides = row.texels[i + 3];
    const float depth_m = alpha_depth(metres_of(in_metres, row.depths[i / 4]));
    std::copy_n(row.texels + i, 3, colour + i);
    std::fill_n(opacity + i, 3, hides);
    colour[i + 3] = opacity[i + 3] =
        hides != 0 ? float_to_half(depth_m, rounding) : elsewhere[i + 3];
  }
}

}  // namespace softfocus

#else  // the kernels

namespace {

template <HalfRounding rounding>
int split_whole_vectors(const DrawnLayerRow& row, const DepthsInMetres& in_metres,
                        const std::uint16_t* elsewhere, std::uint16_t* colour,
                        std::uint16_t* opacity) {
  int x = 0;
  for (; x + kLanes <= row.width; x += kLanes) {
    HalfTexels texels = load_half_texels(row.texels + 4 * x);
    const Bits hides = texels.a;
    const Floats left = 1.0f - load(row.depths + x);
    const Floats depth_m = 1.0f / (in_metres.inverse_far + select(left > 0.0f, left, splat(0.0f)) *
                                                               in_metres.inverse_near_less_far);
    const Bits own = float_to_half<rounding>(select(depth_m < 65504.0f, depth_m, splat(65504.0f)));
    texels.a = select(hides != 0, own, load_half_texels(elsewhere + 4 * x).a);
    store_half_texels(colour + 4 * x, texels);
    store_half_texels(opacity + 4 * x, {hides, hides, hides, texels.a});
  }
  return x;
}

}  // namespace

/// Returns how many pixels are done.
int split_layer_vectors(const DrawnLayerRow& row, const DepthsInMetres& in_metres,
                        HalfRounding rounding, const std::uint16_t* elsewhere,
                        std::uint16_t* colour, std::uint16_t* opacity) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even:
      return split_whole_vectors<nearest_even>(row, in_metres, elsewhere, colour, opacity);
    case toward_zero:
      return split_whole_vectors<toward_zero>(row, in_metres, elsewhere, colour, opacity);
    case swiftshader: break;
  }
  return split_whole_vectors<swiftshader>(row, in_metres, elsewhere, colour, opacity);
}

#endif
