#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include <algorithm>
#include <cassert>

#include "raster/effects/motion/motion_samples.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/threads/loops.h"

namespace softfocus {

struct OwnRow {
  int samples;
  float step, to_half;
  BlurSource picture;
  int width, height, y;
  const std::uint16_t* velocity;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "raster/effects/motion/motion_own.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

std::optional<glm::vec3> blurred_along_own(const OwnRow& row, const ConstImageView& picture, int x,
                                           glm::vec2 velocity) {
  const auto finite = [](float px) { return std::fabs(px) <= 65504.0f ? px : 0.0f; };
  const glm::vec2 v{finite(velocity.x) * row.to_half, finite(velocity.y) * row.to_half};
  if (!(v.x * v.x + v.y * v.y > kLeastMotion2)) return {};
  const float j = jitter(x, row.y);
  glm::vec3 sum{0.0f};
  for (int i = 0; i < row.samples; ++i) {
    const float way = way_at(i, j, row.step);
    const glm::ivec2 at = pixel_at(picture, x, row.y, {way * v.x, way * v.y});
    const glm::vec4 there = load_texel<Format::rgba16f>(picture, at.x, at.y);
    sum.x += there.x;
    sum.y += there.y;
    sum.z += there.z;
  }
  const float part = 0.5f * row.step;
  return glm::vec3{sum.x * part, sum.y * part, sum.z * part};
}

}  // namespace

void motion_blur_along_own(float shutter, int samples, const ConstImageView& picture,
                           const ConstImageView& velocity, const ImageView& result,
                           const Profile& profile, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && result.format == Format::rgba16f);
  assert(velocity.format == Format::rg16f);
  if (!has_whole_strides(picture)) {
    return motion_blur_along_own(shutter, samples, copy_of(picture), velocity, result, profile,
                                 pool);
  }
  for_each_row(pool, picture.height, kPassRows, [&](int y) {
    const OwnRow job{samples,
                     2.0f / static_cast<float>(samples),
                     0.5f * shutter,
                     source_of(picture),
                     picture.width,
                     picture.height,
                     y,
                     row<std::uint16_t>(velocity, y).data()};
    int x = 0;
    if (pool.isa() != Isa::scalar) {
      x = SOFTFOCUS_KERNEL(pool.isa(), own_row)(job, row<std::uint16_t>(result, y).data(),
                                                profile.half_store);
    }
    for (; x < picture.width; ++x) {
      const glm::vec2 v{load_texel<Format::rg16f>(velocity, x, y)};
      store_colour(picture, result, x, y, blurred_along_own(job, picture, x, v), profile);
    }
  });
}

}  // namespace softfocus

#else  // the kernel

#include "raster/effects/motion/motion_samples_lanes.inl"

namespace {

template <HalfRounding rounding>
SOFTFOCUS_INLINE int own_vectors(const OwnRow& row, std::uint16_t* to) {
  const std::uint16_t* picture = reinterpret_cast<const std::uint16_t*>(
      row.picture.texels + 2 * static_cast<std::ptrdiff_t>(row.picture.stride) * row.y);
  const Floats at_y = splat(static_cast<float>(row.y));
  const Floats zero = splat(0.0f);
  int at = 0;
  for (; at + kLanes <= row.width; at += kLanes) {
    const HalfPairs velocity = load_half_pairs(row.velocity + 2 * at);
    const Floats of_x = half_to_float(velocity.r), of_y = half_to_float(velocity.g);
    const Floats v_x = select(absolute(of_x) <= 65504.0f, of_x, zero) * row.to_half;
    const Floats v_y = select(absolute(of_y) <= 65504.0f, of_y, zero) * row.to_half;
    const Mask moves = v_x * v_x + v_y * v_y > 0.25f;
    const HalfTexels own = load_half_texels(picture + 4 * at);
    if (!any(moves)) {
      store_half_texels(to + 4 * at, own);
      continue;
    }
    const Ints x = at + lane_numbers();
    const Floats j = jitter_lanes(x, row.y), at_x = to_floats(x);
    Floats r = zero, g = zero, b = zero;
    for (int i = 0; i < row.samples; ++i) {
      const Floats way = (static_cast<float>(i) + j) * row.step - 1.0f;
      const FourFloats there = gather_texels(row.picture, place_lanes(at_x, way * v_x, row.width),
                                             place_lanes(at_y, way * v_y, row.height));
      r += there.r;
      g += there.g;
      b += there.b;
    }
    const float part = 0.5f * row.step;
    store_half_texels(to + 4 * at,
                      {select(moves, float_to_half<rounding>(r * part), own.r),
                       select(moves, float_to_half<rounding>(g * part), own.g),
                       select(moves, float_to_half<rounding>(b * part), own.b), own.a});
  }
  return at;
}

}  // namespace

/// Returns the first pixel that is not done.
int own_row(const OwnRow& row, std::uint16_t* to, HalfRounding rounding) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return own_vectors<nearest_even>(row, to);
    case toward_zero: return own_vectors<toward_zero>(row, to);
    case swiftshader: break;
  }
  return own_vectors<swiftshader>(row, to);
}

#endif
