// A row of pixels, scalar and in lanes.

#ifndef SOFTFOCUS_ISA

#include "scenes/relief/warp/map_relief.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "raster/images/integer_bilinear.h"
#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"
#include "raster/numbers/vector_math.h"

namespace softfocus {

/// A row's three planes in binary32, and what its pixels read.
struct MappedRow {
  float u, v, q;                 ///< at pixel 0
  float step_u, step_v, step_q;  ///< a pixel
  float height_m, k3, source_per_m, behind_m;
  const std::uint32_t* colours;
  const float* depths_m;
  int width, height;                 ///< of the texels; 2 or more
  const std::int32_t* half_of_code;  ///< linear light, as a half
  int least_alpha;                   ///< of a pixel that is written
  float* shares;                     ///< the row's, if they are wanted
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/relief/warp/map_relief.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kMostAlpha = 255 << 16;  // bilinear_sum_unorm8() of four opaque texels
constexpr int kLeastShare = kMostAlpha / 16;

int channel(std::uint32_t colour, int number) {
  return static_cast<int>(colour >> (8 * number) & 255u);
}

void map_pixel(const MappedRow& row, int x, std::uint16_t* pixel) {
  const auto at_x = static_cast<float>(x);
  const float q = row.q + at_x * row.step_q;
  const float inverse = 1.0f / q;
  const float u = (row.u + at_x * row.step_u) * inverse;
  const float v = (row.v + at_x * row.step_v) * inverse;
  if (!(q > 0.0f && u >= 0.0f && v >= 0.0f && u < static_cast<float>(row.width - 1) &&
        v < static_cast<float>(row.height - 1))) {
    return;
  }
  // 24.8; rounded up to the last texel, the texel before it has no weight left.
  const int place_u = std::min(static_cast<int>(u * 256.0f + 0.5f), (row.width - 1) * 256 - 1);
  const int place_v = std::min(static_cast<int>(v * 256.0f + 0.5f), (row.height - 1) * 256 - 1);
  const int weight_u = place_u & 255, weight_v = place_v & 255;
  const int first = (place_v >> 8) * row.width + (place_u >> 8);
  const std::array<int, 4> at{first, first + 1, first + row.width, first + row.width + 1};
  std::array<std::uint32_t, 4> colours{};
  for (std::size_t i = 0; i < 4; ++i) colours[i] = row.colours[at[i]];
  const auto sum = [&](int number) {
    return bilinear_sum_unorm8(channel(colours[0], number), channel(colours[1], number),
                               channel(colours[2], number), channel(colours[3], number), weight_u,
                               weight_v);
  };
  const int alpha = sum(3);
  if (alpha < row.least_alpha) return;

  // The depth of the texel that has most of the weight, of those that show something.
  const std::array<int, 4> weights{(256 - weight_u) * (256 - weight_v), weight_u * (256 - weight_v),
                                   (256 - weight_u) * weight_v, weight_u * weight_v};
  int most = -1;
  float depth = 0.0f;
  for (std::size_t i = 0; i < 4; ++i) {
    const int weight = colours[i] != 0 ? weights[i] : -1;
    if (weight <= most) continue;
    most = weight;
    depth = row.depths_m[at[i]];
  }
  const float far =
      row.height_m * inverse * (1.0f + row.k3 * depth) / (1.0f - row.source_per_m * depth);
  const float cut = far < 65504.0f ? far : 65504.0f;
  if (!(cut + row.behind_m < half_to_float(pixel[3]))) return;
  for (int i = 0; i < 3; ++i) {
    const float share = static_cast<float>(sum(i)) / static_cast<float>(alpha);
    pixel[i] =
        static_cast<std::uint16_t>(row.half_of_code[static_cast<int>(share * 255.0f + 0.5f)]);
  }
  pixel[3] = float_to_half(cut, HalfRounding::nearest_even);
  if (row.shares != nullptr) row.shares[x] = static_cast<float>(alpha) / kMostAlpha;
}

std::array<std::int32_t, 256> halves_of_codes() {
  std::array<std::int32_t, 256> halves{};
  for (std::size_t code = 0; code < halves.size(); ++code) {
    halves[code] =
        float_to_half(srgb8_to_linear(static_cast<std::uint8_t>(code)), HalfRounding::nearest_even);
  }
  return halves;
}

/// The area of the picture in which the plane's rectangle is seen.
Rectangle place_area(const ReliefCamera& relief, const CameraMatrices& camera,
                     const PlaneRectangle& place, int width, int height) {
  std::array<glm::dvec3, 4> corners{};
  for (std::size_t corner = 0; corner < 4; ++corner) {
    const double u = place.x_begin + ((corner & 1) != 0 ? place.width - 1 : 0);
    const double v = place.y_begin + ((corner & 2) != 0 ? place.height - 1 : 0);
    corners[corner] = (relief.origin + relief.a * u) + relief.b * v;
  }
  return seen_area(corners, camera, width, height);
}

}  // namespace

Rectangle seen_area(std::span<const glm::dvec3> points, const CameraMatrices& camera, int width,
                    int height) {
  const glm::dmat4 to_clip = multiply(camera.eye_to_clip, camera.world_to_eye);
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  for (const glm::dvec3& p : points) {
    const glm::dvec4 clip = ((to_clip[0] * p.x + to_clip[1] * p.y) + to_clip[2] * p.z) + to_clip[3];
    if (!(clip.w > 0.0)) return {0, 0, width, height};
    const double window[2] = {(clip.x / clip.w + 1.0) * 0.5 * width,
                              (clip.y / clip.w + 1.0) * 0.5 * height};
    for (int i = 0; i < 2; ++i) {
      low[i] = std::fmin(low[i], window[i]);
      high[i] = std::fmax(high[i], window[i]);
    }
  }
  const auto whole = [](double place_px, int most) {
    return static_cast<int>(std::fmin(std::fmax(place_px, 0.0), static_cast<double>(most)));
  };
  return {whole(std::floor(low[0]), width), whole(std::floor(low[1]), height),
          whole(std::ceil(high[0]), width), whole(std::ceil(high[1]), height)};
}

PlaneMapping plane_mapping(const ReliefTexture& relief, const CameraMatrices& camera,
                           const PlaneRectangle& place, int width, int height) {
  const ReliefCamera& plane = relief.camera;
  const PreWarp warp = pre_warp(relief, camera.eye);
  const auto axis = [&](int i) { return eye_axis(camera, i); };
  // The ray through a pixel's centre goes as far along the axis as a metre.
  const glm::dvec3 step_x = axis(0) * (2.0 / (width * camera.eye_to_clip[0][0]));
  const glm::dvec3 step_y = axis(1) * (2.0 / (height * camera.eye_to_clip[1][1]));
  // A view of the lens looks past the picture's middle.
  const glm::dvec3 aside = axis(0) * (camera.eye_to_clip[2][0] / camera.eye_to_clip[0][0]) +
                           axis(1) * (camera.eye_to_clip[2][1] / camera.eye_to_clip[1][1]);
  const glm::dvec3 ray =
      ((step_x * (0.5 - 0.5 * width) + step_y * (0.5 - 0.5 * height)) - axis(2)) + aside;
  const auto planar = [&](const auto& of_ray) {
    return PlaneMapping::Planar{of_ray(ray), of_ray(step_x), of_ray(step_y)};
  };
  PlaneMapping mapping{};
  mapping.q = planar([&](glm::dvec3 d) { return dot(d, plane.f); });
  mapping.u = planar([&](glm::dvec3 d) {
    return (warp.foot_u - place.x_begin) * dot(d, plane.f) +
           warp.height_m * (dot(d, plane.a) / dot(plane.a, plane.a));
  });
  mapping.v = planar([&](glm::dvec3 d) {
    return (warp.foot_v - place.y_begin) * dot(d, plane.f) +
           warp.height_m * (dot(d, plane.b) / dot(plane.b, plane.b));
  });
  mapping.height_m = warp.height_m;
  mapping.k3 = warp.k3;
  mapping.source_per_m = static_cast<float>(warp.source_per_m);
  mapping.area = place_area(plane, camera, place, width, height);
  return mapping;
}

void map_relief(const WarpedRelief& warped, const PlaneMapping& mapping, Image& picture,
                ThreadPool& pool, Image* shares) {
  assert(picture.format == Format::rgba16f);
  const int least_alpha = shares != nullptr ? kLeastShare : kMostAlpha / 2;
  const std::array<std::int32_t, 256> halves = halves_of_codes();
  const Rectangle& area = mapping.area;
  constexpr int kRows = 8;
  const int rows = area.y_end - area.y_begin;
  pool.for_each((rows + kRows - 1) / kRows, [&](int band) {
    const int begin = area.y_begin + kRows * band;
    for (int y = begin; y < std::min(begin + kRows, area.y_end); ++y) {
      const MappedRow row{static_cast<float>(mapping.u.at(0.0, y)),
                          static_cast<float>(mapping.v.at(0.0, y)),
                          static_cast<float>(mapping.q.at(0.0, y)),
                          static_cast<float>(mapping.u.step_x),
                          static_cast<float>(mapping.v.step_x),
                          static_cast<float>(mapping.q.step_x),
                          static_cast<float>(mapping.height_m),
                          mapping.k3,
                          mapping.source_per_m,
                          mapping.behind_m,
                          warped.colours.data(),
                          warped.depths_m.data(),
                          warped.place.width,
                          warped.place.height,
                          halves.data(),
                          least_alpha,
                          shares != nullptr ? softfocus::row<float>(*shares, y).data() : nullptr};
      std::uint16_t* pixels = softfocus::row<std::uint16_t>(picture, y).data();
      int x = area.x_begin;
      if (pool.isa() != Isa::scalar) {
        x = SOFTFOCUS_KERNEL(pool.isa(), map_vectors)(row, x, area.x_end, pixels);
      }
      for (; x < area.x_end; ++x) map_pixel(row, x, pixels + 4 * x);
    }
  });
}

}  // namespace softfocus

#else  // the kernels, once a vector unit

namespace {

struct FetchedTexels {
  Ints c00, c10, c01, c11;
};

/// bilinear_sum_unorm8() of a channel.
template <int number>
SOFTFOCUS_INLINE Ints channel_sum(const FetchedTexels& texels, Ints weight_u, Ints weight_v) {
  constexpr int kShift = 8 * number;
  const Ints c00 = as_ints(as_bits(texels.c00) >> kShift & 255u);
  const Ints c10 = as_ints(as_bits(texels.c10) >> kShift & 255u);
  const Ints c01 = as_ints(as_bits(texels.c01) >> kShift & 255u);
  const Ints c11 = as_ints(as_bits(texels.c11) >> kShift & 255u);
  const Ints upper = c00 * (256 - weight_u) + c10 * weight_u;
  const Ints lower = c01 * (256 - weight_u) + c11 * weight_u;
  return upper * (256 - weight_v) + lower * weight_v;
}

template <int number>
SOFTFOCUS_INLINE Bits mapped_channel(const MappedRow& row, const FetchedTexels& texels,
                                     Ints weight_u, Ints weight_v, Floats alpha, Mask shown) {
  const Floats share = to_floats(channel_sum<number>(texels, weight_u, weight_v)) / alpha;
  const Ints code = truncate(select(shown, share, splat(0.0f)) * 255.0f + 0.5f);
  return as_bits(gather(row.half_of_code, code, shown));
}

/// Takes the depth of a texel that has more weight.
SOFTFOCUS_INLINE void take_depth(const MappedRow& row, Ints colour, Ints at, Ints weight,
                                 Mask shown, Ints& most, Floats& depth) {
  const Ints own = select(colour != 0, weight, splat(-1));
  const Mask is_more = own > most;
  depth = select(is_more, gather(row.depths_m, at, shown & is_more), depth);
  most = select(is_more, own, most);
}

}  // namespace

/// Returns the first pixel that is left.
int map_vectors(const MappedRow& row, int x, int end, std::uint16_t* pixels) {
  const Floats right = splat(static_cast<float>(row.width - 1));
  const Floats bottom = splat(static_cast<float>(row.height - 1));
  const std::int32_t* colours = reinterpret_cast<const std::int32_t*>(row.colours);
  for (; x + kLanes <= end; x += kLanes) {
    const Floats at_x = to_floats(x + lane_numbers());
    const Floats q = row.q + at_x * row.step_q;
    const Floats inverse = 1.0f / q;
    const Floats u = (row.u + at_x * row.step_u) * inverse;
    const Floats v = (row.v + at_x * row.step_v) * inverse;
    Mask shown = (q > 0.0f) & (u >= 0.0f) & (v >= 0.0f) & (u < right) & (v < bottom);
    if (!any(shown)) continue;
    const Ints place_u = smaller(truncate(select(shown, u, splat(0.0f)) * 256.0f + 0.5f),
                                 splat((row.width - 1) * 256 - 1));
    const Ints place_v = smaller(truncate(select(shown, v, splat(0.0f)) * 256.0f + 0.5f),
                                 splat((row.height - 1) * 256 - 1));
    const Ints weight_u = place_u & 255, weight_v = place_v & 255;
    const Ints first = (place_v >> 8) * row.width + (place_u >> 8);
    const FetchedTexels texels{gather(colours, first, shown), gather(colours, first + 1, shown),
                               gather(colours, first + row.width, shown),
                               gather(colours, first + row.width + 1, shown)};
    const Ints alpha = channel_sum<3>(texels, weight_u, weight_v);
    shown &= ~(alpha < row.least_alpha);
    if (!any(shown)) continue;

    Ints most = splat(-1);
    Floats depth = splat(0.0f);
    take_depth(row, texels.c00, first, (256 - weight_u) * (256 - weight_v), shown, most, depth);
    take_depth(row, texels.c10, first + 1, weight_u * (256 - weight_v), shown, most, depth);
    take_depth(row, texels.c01, first + row.width, (256 - weight_u) * weight_v, shown, most, depth);
    take_depth(row, texels.c11, first + row.width + 1, weight_u * weight_v, shown, most, depth);
    const Floats far =
        row.height_m * inverse * (1.0f + row.k3 * depth) / (1.0f - row.source_per_m * depth);
    const Floats cut = select(far < 65504.0f, far, splat(65504.0f));
    HalfTexels pixel = load_half_texels(pixels + 4 * x);
    shown &= cut + row.behind_m < half_to_float(pixel.a);
    if (!any(shown)) continue;
    const Floats sum = select(shown, to_floats(alpha), splat(1.0f));
    pixel.r =
        select(shown, mapped_channel<0>(row, texels, weight_u, weight_v, sum, shown), pixel.r);
    pixel.g =
        select(shown, mapped_channel<1>(row, texels, weight_u, weight_v, sum, shown), pixel.g);
    pixel.b =
        select(shown, mapped_channel<2>(row, texels, weight_u, weight_v, sum, shown), pixel.b);
    pixel.a = select(
        shown, float_to_half<HalfRounding::nearest_even>(select(shown, cut, splat(0.0f))), pixel.a);
    store_half_texels(pixels + 4 * x, pixel);
    if (row.shares == nullptr) continue;
    const Floats share = to_floats(alpha) / static_cast<float>(255 << 16);
    store(row.shares + x, select(shown, share, load(row.shares + x)));
  }
  return x;
}

#endif
