#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include "raster/effects/tone_map.h"

#include <algorithm>
#include <cassert>
#include <glm/vec4.hpp>
#include <vector>

#include "raster/images/texel.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/passes/row_sums.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "raster/effects/tone_map.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

float mapped(const ToneCurve& curve, float exposure, float light) {
  const float usable = light > 0.0f ? (light < 65504.0f ? light : 65504.0f) : 0.0f;
  const float x = exposure * usable;
  const float value =
      ((x * (curve.a * x + curve.b) + curve.c) / (x * (curve.d * x + curve.e) + curve.f) +
       curve.g) *
      curve.h;
  return value > 0.0f ? (value < 1.0f ? value : 1.0f) : 0.0f;
}

}  // namespace

const ToneCurve* find_tone_curve(std::string_view name) {
  for (const NamedToneCurve& named : kToneCurves) {
    if (named.name == name) return &named.curve;
  }
  return nullptr;
}

void tone_map(const ToneCurve& curve, float exposure, const ConstImageView& picture,
              const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && result.format == Format::rgba16f);
  assert(picture.width == result.width && picture.height == result.height);
  if (pool.isa() == Isa::scalar) {
    fullscreen_pass<Format::rgba16f>(result, profile, pool, [&](int x, int y) {
      const glm::vec4 texel = load_texel<Format::rgba16f>(picture, x, y);
      return glm::vec4{mapped(curve, exposure, texel.x), mapped(curve, exposure, texel.y),
                       mapped(curve, exposure, texel.z), texel.w};
    });
    return;
  }
  const int values = 4 * result.width;
  for_each_row_with<std::vector<float>>(pool, result.height, kPassRows, [&](int y, auto& rows) {
    const auto length = static_cast<std::size_t>(values + kMostLanes);
    rows.resize(2 * length);
    float* const mapped_row = rows.data() + length;
    decode_row(row<std::uint16_t>(picture, y), 0, result.width, rows.data(), pool.isa());
    SOFTFOCUS_KERNEL(pool.isa(), map_row)(curve, exposure, rows.data(), values, mapped_row);
    store_row(mapped_row, rows.data(), values, profile.half_store,
              row<std::uint16_t>(result, y).data(), pool.isa());
  });
}

}  // namespace softfocus

#else  // the kernel

/// mapped() of each value, up to a whole vector.
void map_row(const ToneCurve& curve, float exposure, const float* from, int values, float* to) {
  for (int i = 0; i < values; i += kLanes) {
    const Floats light = load(from + i);
    const Floats cut = select(light < 65504.0f, light, splat(65504.0f));
    const Floats x = exposure * select(light > 0.0f, cut, splat(0.0f));
    const Floats value =
        ((x * (curve.a * x + curve.b) + curve.c) / (x * (curve.d * x + curve.e) + curve.f) +
         curve.g) *
        curve.h;
    const Floats whole = select(value < 1.0f, value, splat(1.0f));
    store(to + i, select(value > 0.0f, whole, splat(0.0f)));
  }
}

#endif
