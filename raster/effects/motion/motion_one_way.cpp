#ifndef SOFTFOCUS_ISA
// Motion blur after McGuire et al. 2012: along the longest motion of the tiles around.
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include <cmath>
#include <cstring>

#include "raster/effects/motion/motion_filters.h"
#include "raster/images/texel.h"

#define SOFTFOCUS_KERNELS "raster/effects/motion/motion_one_way.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

/// How much of a point's spread reaches `q` of its length, McGuire et al. 2012.
float cone(float q) { return cut_to_1(1.0f - q); }
float cylinder(float q) {
  const float s = cut_to_1((q - 0.95f) * 10.0f);
  return 1.0f - s * s * (3.0f - 2.0f * s);
}

}  // namespace

glm::vec3 blurred_one_way(const BlurInput& input, int x, int y, glm::vec2 n, float length) {
  const MotionBlurPass& pass = input.pass;
  const BlurredPixel pixel = blurred_pixel(input, x, y);
  const float j = jitter(x, y);
  float total = pixel.v.z;
  glm::vec3 sum{pixel.own.x * total, pixel.own.y * total, pixel.own.z * total};
  for (int i = 0; i < pass.samples; ++i) {
    const float t = way_at(i, j, pass.step);
    const glm::ivec2 at = pixel_at(input.picture, x, y, {t * n.x, t * n.y});
    const glm::vec4 there = load_texel<Format::rgba16f>(input.picture, at.x, at.y);
    const glm::vec4 w = load_texel<Format::rgba16f>(input.spread, at.x, at.y);
    const Pair of = pair_of(pixel, there, w, std::fabs(t) * length);
    const float weight =
        (cut_to_1(1.0f - of.gap) * cone(of.of_there) + cut_to_1(1.0f + of.gap) * cone(of.of_own)) +
        (cylinder(of.of_there) * cylinder(of.of_own)) * 2.0f;
    if (!(weight > 0.0f)) continue;  // a light without end must not count 0 times
    total += weight;
    sum.x += there.x * weight;
    sum.y += there.y * weight;
    sum.z += there.z * weight;
  }
  return {sum.x / total, sum.y / total, sum.z / total};
}

int blur_row_one_way(Isa isa, const BlurRow& row, int begin, int end, std::uint16_t* to,
                     HalfRounding rounding) {
  return SOFTFOCUS_KERNEL(isa, one_way_row)(row, begin, end, to, rounding);
}

}  // namespace softfocus

#else  // the kernel

namespace {

#include "raster/effects/motion/motion_filters_lanes.inl"

struct OneWay {};

SOFTFOCUS_INLINE Floats cylinder_lanes(Floats q) {
  const Floats s = unit_lanes((q - 0.95f) * 10.0f);
  return 1.0f - s * s * (3.0f - 2.0f * s);
}

SOFTFOCUS_INLINE ColourLanes filtered_lanes(OneWay, const BlurRow& row, const PixelLanes& pixel,
                                            Ints x, Vec2Lanes n, Floats length) {
  const MotionBlurPass& pass = row.pass;
  const Floats j = jitter_lanes(x, row.y);
  Floats total = pixel.v_z;
  ColourLanes sum{pixel.own.r * total, pixel.own.g * total, pixel.own.b * total};
  for (int i = 0; i < pass.samples; ++i) {
    const Floats t = (static_cast<float>(i) + j) * pass.step - 1.0f;
    const SampleLanes of = sample_lanes(row, pixel, t, n);
    const Floats distance = absolute(t) * length;
    const Floats of_there = distance * gather_texels(row.spread, of.x, of.y).b;
    const Floats of_own = distance * pixel.v_z;
    const Floats weight = (unit_lanes(1.0f - of.gap) * unit_lanes(1.0f - of_there) +
                           unit_lanes(1.0f + of.gap) * unit_lanes(1.0f - of_own)) +
                          (cylinder_lanes(of_there) * cylinder_lanes(of_own)) * 2.0f;
    const Mask counts = weight > 0.0f;
    total += weight;  // never below 0
    sum.r = select(counts, sum.r + of.there.r * weight, sum.r);
    sum.g = select(counts, sum.g + of.there.g * weight, sum.g);
    sum.b = select(counts, sum.b + of.there.b * weight, sum.b);
  }
  return {sum.r / total, sum.g / total, sum.b / total};
}

}  // namespace

int one_way_row(const BlurRow& row, int begin, int end, std::uint16_t* to, HalfRounding rounding) {
  return blur_by<OneWay>(row, begin, end, to, rounding);
}

#endif
