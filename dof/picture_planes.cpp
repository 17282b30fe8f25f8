#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/picture_planes.h"

#include <algorithm>
#include <cmath>

#include "dof/weights.h"
#include "raster/images/texel.h"

#define SOFTFOCUS_KERNELS "dof/picture_planes.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

float finite_colour(float value) {
  const float cut = clamp_to_half(value);
  return cut == cut ? cut : 0.0f;
}

}  // namespace

std::ptrdiff_t plane_stride(int width) {
  const std::ptrdiff_t stride = (width + kMostLanes - 1) / kMostLanes * kMostLanes;
  // Rows a multiple of 1 KiB apart would meet in a few sets of a cache.
  return stride % 256 == 0 ? stride + kMostLanes : stride;
}

Planes make_planes(int count, int width, int height, ThreadPool& pool) {
  Planes planes;
  planes.width = width;
  planes.height = height;
  planes.stride = plane_stride(width);
  planes.plane = planes.stride * height;
  planes.values =
      make_row_memory<float>(static_cast<std::size_t>(count * planes.plane), &pool.memory());
  return planes;
}

SplitTexel split_texel(const DofInput& input, int x, int y) {
  const glm::vec4 texel = load_texel<Format::rgba16f>(input.scene, x, y);
  const float magnitude = filter_radius(input.settings, texel.w);
  const bool near = coc_radius_px(input.settings.coc, texel.w) < 0.0f;
  return {finite_colour(texel.x), finite_colour(texel.y), finite_colour(texel.z),
          near ? -magnitude : magnitude};
}

void split_picture_row(const DofInput& input, int y, float* to, std::ptrdiff_t plane, int padded,
                       Isa isa) {
  const ConstImageView& scene = input.scene;
  if (isa != Isa::scalar) {
    SOFTFOCUS_KERNEL(isa, split_row)
    (input.settings, row<std::uint16_t>(scene, y).data(), scene.width, padded, to, plane);
    return;
  }
  for (int x = 0; x < padded; ++x) {
    const SplitTexel texel = split_texel(input, std::min(x, scene.width - 1), y);
    to[x] = texel.r;
    to[plane + x] = texel.g;
    to[2 * plane + x] = texel.b;
    to[3 * plane + x] = texel.radius_px;
  }
}

Planes split_picture(const DofInput& input, ThreadPool& pool) {
  Planes planes = make_planes(4, input.scene.width, input.scene.height, pool);
  pool.for_each(planes.height, [&](int y) {
    split_picture_row(input, y, plane_row(planes, 0, y), planes.plane,
                      static_cast<int>(planes.stride), pool.isa());
  });
  return planes;
}

void store_span(const DofInput& input, const ImageView& result, int x, int y, int count,
                const float* r, const float* g, const float* b, Isa isa) {
  if (isa != Isa::scalar) {
    SOFTFOCUS_KERNEL(isa, merge_row)
    (row<std::uint16_t>(input.scene, y).data() + 4 * x, r, g, b, count, input.profile.half_store,
     row<std::uint16_t>(result, y).data() + 4 * x);
    return;
  }
  for (int i = 0; i < count; ++i) {
    const float depth = load_texel<Format::rgba16f>(input.scene, x + i, y).w;
    store_texel<Format::rgba16f>(
        result, x + i, y, {clamp_to_half(r[i]), clamp_to_half(g[i]), clamp_to_half(b[i]), depth},
        input.profile);
  }
}

void store_row(const DofInput& input, const ImageView& result, int y, const float* r,
               const float* g, const float* b, Isa isa) {
  store_span(input, result, 0, y, result.width, r, g, b, isa);
}

std::vector<float> largest_of_rows(const Planes& planes, int plane, ThreadPool& pool) {
  std::vector<float> largest(static_cast<std::size_t>(planes.height));
  pool.for_each(planes.height, [&](int y) {
    const float* values = plane_row(planes, plane, y);
    float most = 0.0f;
    for (int x = 0; x < planes.width; ++x) most = std::max(most, std::fabs(values[x]));
    largest[static_cast<std::size_t>(y)] = most;
  });
  return largest;
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

template <HalfRounding rounding>
SOFTFOCUS_INLINE void merge_rows(const std::uint16_t* scene, const float* r, const float* g,
                                 const float* b, int width, std::uint16_t* to) {
  for (int x = 0; x < width; x += kLanes) {
    const HalfTexels texels{float_to_half<rounding>(clamp_to_half(load(r + x))),
                            float_to_half<rounding>(clamp_to_half(load(g + x))),
                            float_to_half<rounding>(clamp_to_half(load(b + x))),
                            stored_depth(load_repeating(scene, x, width).a, rounding)};
    store_within(to, x, width, texels);
  }
}

}  // namespace

/// The planes of a row of RGBA16F, `plane` floats apart; `padded` pixels are written.
void split_row(const DofSettings& settings, const std::uint16_t* from, int width, int padded,
               float* to, std::ptrdiff_t plane) {
  for (int x = 0; x < padded; x += kLanes) {
    const HalfTexels texels = load_repeating(from, x, width);
    store(to + x, finite_colour(texels.r));
    store(to + plane + x, finite_colour(texels.g));
    store(to + 2 * plane + x, finite_colour(texels.b));
    store(to + 3 * plane + x, split_radius(settings, half_to_float(texels.a)));
  }
}

/// A row of RGBA16F from its planes and the scene's depth.
void merge_row(const std::uint16_t* scene, const float* r, const float* g, const float* b,
               int width, HalfRounding rounding, std::uint16_t* to) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return merge_rows<nearest_even>(scene, r, g, b, width, to);
    case toward_zero: return merge_rows<toward_zero>(scene, r, g, b, width, to);
    case swiftshader: return merge_rows<swiftshader>(scene, r, g, b, width, to);
  }
}

#endif
