#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include "raster/temporal/refresh.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <glm/vec4.hpp>
#include <numeric>
#include <vector>

#include "raster/images/texel.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/threads/loops.h"

namespace softfocus {

/// A row of the result, whole vectors of it: `anew` has bits where a pixel is drawn.
struct RefreshRow {
  const std::uint16_t* drawn;
  const std::uint16_t* found;
  const std::int32_t* anew;
  int width;
  HalfRounding rounding;
  std::uint16_t* result;
  float* frames;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "raster/temporal/refresh.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

struct Refreshed {
  glm::vec4 texel;
  float frames;
};

Refreshed refreshed(bool is_turn, glm::vec4 fresh, glm::vec4 old) {
  if (is_turn || !(old.w > 0.0f)) return {fresh, 1.0f};
  return {{old.x, old.y, old.z, fresh.w}, old.w + 1.0f};
}

}  // namespace

std::int64_t refresh(int groups, int turn, const ConstImageView& drawn, const ConstImageView& found,
                     const ImageView& result, const ImageView& frames, const Profile& profile,
                     ThreadPool& pool) {
  assert(drawn.format == Format::rgba16f && found.format == Format::rgba16f);
  assert(groups >= 1 && groups <= kMostGroups && turn >= -1 && turn < groups);
  std::vector<std::int64_t> counts(static_cast<std::size_t>(drawn.height));
  for_each_band(pool, drawn.height, kPassRows, [&](int first, int end) {
    const int width = drawn.width, whole = width - width % kMostLanes;
    std::vector<std::int32_t> anew(static_cast<std::size_t>(width));
    for (int y = first; y < end; ++y) {
      if (y % 2 == 0 || y == first) {
        for (int x = 0; x < width; ++x) {
          anew[static_cast<std::size_t>(x)] = refresh_group(x, y, groups) == turn ? -1 : 0;
        }
      }
      float* ages = row<float>(frames, y).data();
      SOFTFOCUS_KERNEL(pool.isa(), refresh_row)
      ({row<std::uint16_t>(drawn, y).data(), row<std::uint16_t>(found, y).data(), anew.data(),
        whole, profile.half_store, row<std::uint16_t>(result, y).data(), ages});
      for (int x = whole; x < width; ++x) {
        const Refreshed pixel = refreshed(anew[static_cast<std::size_t>(x)] != 0,
                                          load_texel<Format::rgba16f>(drawn, x, y),
                                          load_texel<Format::rgba16f>(found, x, y));
        store_texel<Format::rgba16f>(result, x, y, pixel.texel, profile);
        ages[x] = pixel.frames;
      }
      counts[static_cast<std::size_t>(y)] = std::count(ages, ages + width, 1.0f);
    }
  });
  return std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
}

}  // namespace softfocus

#else  // the kernel

namespace {

template <HalfRounding rounding>
SOFTFOCUS_INLINE Bits stored_half(Bits half) {
  return float_to_half<rounding>(half_to_float(half));
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE void refresh_rounded(const RefreshRow& row) {
  for (int x = 0; x < row.width; x += kLanes) {
    const HalfTexels fresh = load_half_texels(row.drawn + 4 * x);
    const HalfTexels old = load_half_texels(row.found + 4 * x);
    const Floats count = half_to_float(old.a);
    const Mask is_old = (load(row.anew + x) == 0) & (count > 0.0f);
    store_half_texels(row.result + 4 * x, {stored_half<rounding>(select(is_old, old.r, fresh.r)),
                                           stored_half<rounding>(select(is_old, old.g, fresh.g)),
                                           stored_half<rounding>(select(is_old, old.b, fresh.b)),
                                           stored_half<rounding>(fresh.a)});
    store(row.frames + x, select(is_old, count + 1.0f, splat(1.0f)));
  }
}

}  // namespace

void refresh_row(const RefreshRow& row) {
  using enum HalfRounding;
  switch (row.rounding) {
    case nearest_even: return refresh_rounded<nearest_even>(row);
    case toward_zero: return refresh_rounded<toward_zero>(row);
    case swiftshader: return refresh_rounded<swiftshader>(row);
  }
}

#endif
