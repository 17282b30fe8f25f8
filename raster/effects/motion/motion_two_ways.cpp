#ifndef SOFTFOCUS_ISA
// Motion blur after Guertin et al. 2014: along the longest motion of the tiles around and along the
// pixel's own. The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include <cmath>
#include <cstring>

#include "raster/effects/motion/motion_filters.h"
#include "raster/images/texel.h"

#define SOFTFOCUS_KERNELS "raster/effects/motion/motion_two_ways.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

/// Whether a motion reaches that far, with an edge a tenth of it wide.
float reached(float q) { return cut_to_1((1.05f - q) * 10.0f); }

/// Samples along a way that show through the pixel: their sum, and how many they are.
struct Shown {
  glm::vec3 sum;
  float count;
};

struct SampledWay {
  glm::vec2 px;
  float length_px;
  glm::vec2 way;    ///< px over its length
  float own_part;   ///< of the pixel's own motion that goes this way
  float own_reach;  ///< what of its motion reaches all of the samples
  int samples;
  float step, jitter;
};

Shown shown_along(const BlurInput& input, int x, int y, const BlurredPixel& pixel,
                  const SampledWay& on) {
  Shown shown{glm::vec3{0.0f}, 0.0f};
  for (int i = 0; i < on.samples; ++i) {
    const float t = way_at(i, on.jitter, on.step);
    const glm::ivec2 at = pixel_at(input.picture, x, y, {t * on.px.x, t * on.px.y});
    const glm::vec4 there = load_texel<Format::rgba16f>(input.picture, at.x, at.y);
    const glm::vec4 w = load_texel<Format::rgba16f>(input.spread, at.x, at.y);
    const Pair of = pair_of(pixel, there, w, std::fabs(t) * on.length_px);
    const float there_part = std::fabs(w.x * on.way.x + w.y * on.way.y) * w.z;
    const float in_reach = reached(of.of_own);
    const float reach = in_reach > on.own_reach ? in_reach : on.own_reach;
    const float nearer = cut_to_1(2.0f - of.gap);
    const float farther = cut_to_1(2.0f + of.gap);
    const float weight =
        cut_to_1((nearer * reached(of.of_there)) * there_part + (farther * reach) * on.own_part);
    if (!(weight > 0.0f)) continue;  // a light without end must not count 0 times
    shown.count += weight;
    shown.sum.x += there.x * weight;
    shown.sum.y += there.y * weight;
    shown.sum.z += there.z * weight;
  }
  return shown;
}

}  // namespace

glm::vec3 blurred_two_ways(const BlurInput& input, int x, int y, glm::vec2 n, float length) {
  const MotionBlurPass& pass = input.pass;
  const float per_length = 1.0f / length;
  const glm::vec2 along{n.x * per_length, n.y * per_length};
  const BlurredPixel pixel = blurred_pixel(input, x, y);
  const glm::vec3 v = pixel.v;
  // A pixel that hardly moves has no way of its own: both are n.
  const float moving = cut_to_1((std::sqrt(v.x * v.x + v.y * v.y) - 0.5f) * (1.0f / 1.5f));
  const bool turned = v.x * n.x + v.y * n.y < 0.0f;
  const glm::vec2 ahead{turned ? -v.x : v.x, turned ? -v.y : v.y};
  const glm::vec2 mixed{n.x + (ahead.x - n.x) * moving, n.y + (ahead.y - n.y) * moving};
  const float own_length = std::sqrt(mixed.x * mixed.x + mixed.y * mixed.y);
  const float per_own_length = 1.0f / own_length;
  const glm::vec2 across{mixed.x * per_own_length, mixed.y * per_own_length};
  const float facing = std::fabs(across.x * along.x + across.y * along.y);

  const float j = jitter(x, y);
  const float between = j < 0.5f ? j + 0.5f : j - 0.5f;
  const Shown a =
      shown_along(input, x, y, pixel,
                  {n, length, along, cut_to_1(facing * kFacing), 0.0f, pass.samples, pass.step, j});
  const Shown b = shown_along(
      input, x, y, pixel,
      {mixed, own_length, across, 1.0f, moving, pass.across_samples, pass.across_step, between});

  // Two equal ways are halves of one; else what the longest motion does not cover is the other's.
  const float shorter = own_length < length ? own_length * per_length : 1.0f;
  const float half = (facing * shorter) * 0.5f;
  const float a_part = 1.0f - half;
  const float rest = a_part * (1.0f - a.count * pass.sample_part);
  const float b_part = half + rest * moving;
  const float own_part = rest * (1.0f - moving) + b_part * (1.0f - b.count * pass.across_part);
  const float of_a = a_part * pass.sample_part, of_b = b_part * pass.across_part;
  glm::vec3 colour{a.sum.x * of_a, a.sum.y * of_a, a.sum.z * of_a};
  if (of_b > 0.0f) {
    colour = {colour.x + b.sum.x * of_b, colour.y + b.sum.y * of_b, colour.z + b.sum.z * of_b};
  }
  if (own_part > 0.0f) {
    colour = {colour.x + pixel.own.x * own_part, colour.y + pixel.own.y * own_part,
              colour.z + pixel.own.z * own_part};
  }
  return colour;
}

int blur_row_two_ways(Isa isa, const BlurRow& row, int begin, int end, std::uint16_t* to,
                      HalfRounding rounding) {
  return SOFTFOCUS_KERNEL(isa, two_ways_row)(row, begin, end, to, rounding);
}

}  // namespace softfocus

#else  // the kernel

namespace {

#include "raster/effects/motion/motion_filters_lanes.inl"

struct TwoWays {};

SOFTFOCUS_INLINE Floats reached_lanes(Floats q) { return unit_lanes((1.05f - q) * 10.0f); }

struct ShownLanes {
  ColourLanes sum;
  Floats count;
};

struct SampledWayLanes {
  Vec2Lanes px;
  Floats length_px;
  Vec2Lanes way;
  Floats own_part, own_reach;
  int samples;
  float step;
  Floats jitter;
};

SOFTFOCUS_INLINE ShownLanes shown_lanes(const BlurRow& row, const PixelLanes& pixel,
                                        const SampledWayLanes& on) {
  const Floats zero = splat(0.0f);
  ShownLanes shown{{zero, zero, zero}, zero};
  const bool reaches_all = !any(smaller(on.own_part, on.own_reach) < 1.0f);
  for (int i = 0; i < on.samples; ++i) {
    const Floats t = (static_cast<float>(i) + on.jitter) * on.step - 1.0f;
    const SampleLanes of = sample_lanes(row, pixel, t, on.px);
    const Floats distance = absolute(t) * on.length_px;
    Floats own = unit_lanes(2.0f + of.gap);
    if (!reaches_all) {
      own = (own * larger(reached_lanes(distance * pixel.v_z), on.own_reach)) * on.own_part;
    }
    if (!any(own < 1.0f)) {  // where all moves alike, whatever the sample's motion
      shown.count += 1.0f;
      shown.sum.r += of.there.r;
      shown.sum.g += of.there.g;
      shown.sum.b += of.there.b;
      continue;
    }
    const FourFloats w = gather_texels(row.spread, of.x, of.y);
    const Floats there_part = absolute(w.r * on.way.x + w.g * on.way.y) * w.b;
    const Floats nearer = unit_lanes(2.0f - of.gap);
    const Floats weight = unit_lanes((nearer * reached_lanes(distance * w.b)) * there_part + own);
    const Mask counts = weight > 0.0f;
    shown.count += weight;
    shown.sum.r = select(counts, shown.sum.r + of.there.r * weight, shown.sum.r);
    shown.sum.g = select(counts, shown.sum.g + of.there.g * weight, shown.sum.g);
    shown.sum.b = select(counts, shown.sum.b + of.there.b * weight, shown.sum.b);
  }
  return shown;
}

/// Parts of both ways and of the pixel itself.
struct Parts {
  Floats along, across, own;
};

SOFTFOCUS_INLINE Floats mixed_lanes(const Parts& parts, Floats along, Floats across, Floats own) {
  const Floats first = along * parts.along;
  const Floats second = select(parts.across > 0.0f, first + across * parts.across, first);
  return select(parts.own > 0.0f, second + own * parts.own, second);
}

SOFTFOCUS_INLINE ColourLanes filtered_lanes(TwoWays, const BlurRow& row, const PixelLanes& pixel,
                                            Ints x, Vec2Lanes n, Floats length) {
  const MotionBlurPass& pass = row.pass;
  const Floats per_length = 1.0f / length;
  const Vec2Lanes along{n.x * per_length, n.y * per_length};
  const Floats one = splat(1.0f), v_x = pixel.v_x, v_y = pixel.v_y;
  const Floats moving = unit_lanes((square_root(v_x * v_x + v_y * v_y) - 0.5f) * (1.0f / 1.5f));
  const Mask turned = v_x * n.x + v_y * n.y < 0.0f;
  const Floats mixed_x = n.x + (select(turned, -v_x, v_x) - n.x) * moving;
  const Floats mixed_y = n.y + (select(turned, -v_y, v_y) - n.y) * moving;
  const Floats own_length = square_root(mixed_x * mixed_x + mixed_y * mixed_y);
  const Floats per_own_length = 1.0f / own_length;
  const Vec2Lanes across{mixed_x * per_own_length, mixed_y * per_own_length};
  const Floats facing = absolute(across.x * along.x + across.y * along.y);

  const Floats j = jitter_lanes(x, row.y);
  const Floats between = select(j < 0.5f, j + 0.5f, j - 0.5f);
  const ShownLanes a = shown_lanes(
      row, pixel,
      {n, length, along, unit_lanes(facing * kFacing), splat(0.0f), pass.samples, pass.step, j});
  const ShownLanes b = shown_lanes(row, pixel,
                                   {{mixed_x, mixed_y},
                                    own_length,
                                    across,
                                    one,
                                    moving,
                                    pass.across_samples,
                                    pass.across_step,
                                    between});

  const Floats shorter = select(own_length < length, own_length * per_length, one);
  const Floats half = (facing * shorter) * 0.5f;
  const Floats a_part = 1.0f - half;
  const Floats rest = a_part * (1.0f - a.count * pass.sample_part);
  const Floats b_part = half + rest * moving;
  const Floats own_part = rest * (1.0f - moving) + b_part * (1.0f - b.count * pass.across_part);
  const Floats of_a = a_part * pass.sample_part, of_b = b_part * pass.across_part;
  const Parts parts{of_a, of_b, own_part};
  return {mixed_lanes(parts, a.sum.r, b.sum.r, pixel.own.r),
          mixed_lanes(parts, a.sum.g, b.sum.g, pixel.own.g),
          mixed_lanes(parts, a.sum.b, b.sum.b, pixel.own.b)};
}

}  // namespace

int two_ways_row(const BlurRow& row, int begin, int end, std::uint16_t* to, HalfRounding rounding) {
  return blur_by<TwoWays>(row, begin, end, to, rounding);
}

#endif
