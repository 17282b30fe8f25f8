#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include "raster/effects/motion/motion_blur.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <vector>

#include "raster/effects/motion/motion_samples.h"
#include "raster/passes/fullscreen_pass.h"

namespace softfocus {

struct BlurRow {
  const MotionBlurPass& pass;
  BlurSource picture, spread;
  int width, height;  ///< of the picture
  const MotionTiles& tiles;
  int y;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "raster/effects/motion/motion_blur.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

/// How much of a point's spread reaches `q` of its length, McGuire et al. 2012.
float cone(float q) { return cut_to_1(1.0f - q); }
float cylinder(float q) {
  const float s = cut_to_1((q - 0.95f) * 10.0f);
  return 1.0f - s * s * (3.0f - 2.0f * s);
}
/// Whether a motion reaches that far, with an edge a tenth of it wide.
float reached(float q) { return cut_to_1((1.05f - q) * 10.0f); }

/// The pixel's tile, or the next one by chance near its border, so that borders do not show.
glm::vec2 neighbourhood_motion(const MotionBlurPass& pass, const MotionTiles& tiles,
                               const ConstImageView& picture, int x, int y) {
  int at_x = x, at_y = y;
  if (pass.filter == MotionFilter::two_ways) {
    // A quarter of a tile to either side.
    const int i = static_cast<int>(jitter_bits(y, x) >> 16) - 128;
    const int j = static_cast<int>(jitter_bits(y + 1, x) >> 16) - 128;
    at_x = std::clamp(x + (i * pass.radius_px >> 9), 0, picture.width - 1);
    at_y = std::clamp(y + (j * pass.radius_px >> 9), 0, picture.height - 1);
  }
  return tiles
      .v[static_cast<std::size_t>(at_y / pass.radius_px * tiles.columns + at_x / pass.radius_px)];
}

struct BlurInput {
  const MotionBlurPass& pass;
  const ConstImageView& picture;
  const ConstImageView& spread;
  const MotionTiles& tiles;
};

/// What a pixel and a sample have to do with each other.
struct Pair {
  float of_there, of_own;  ///< the distance in lengths of either's motion
  float gap;               ///< how much farther the sample is (MotionBlurPass::inverse_depth)
};

struct BlurredPixel {
  glm::vec4 own;
  glm::vec3 v;  ///< its motion, and in z 1 / its length
  float per_depth;
};

BlurredPixel blurred_pixel(const BlurInput& input, int x, int y) {
  const glm::vec4 own = load_texel<Format::rgba16f>(input.picture, x, y);
  const glm::vec4 v = load_texel<Format::rgba16f>(input.spread, x, y);
  return {own, glm::vec3{v}, own.w > 0.0f ? input.pass.inverse_depth / own.w : 0.0f};
}

Pair pair_of(const BlurredPixel& pixel, const glm::vec4& there, const glm::vec4& w,
             float distance) {
  return {distance * w.z, distance * pixel.v.z, (there.w - pixel.own.w) * pixel.per_depth};
}

/// McGuire et al. 2012, along the longest motion.
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

/// What samples along a way show through the pixel: their sum, and how many they are.
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

/// After Guertin et al. 2014, along the longest motion and along the pixel's own.
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

/// None where nothing near moves: the pixel stays.
std::optional<glm::vec3> blurred(const BlurInput& input, int x, int y) {
  const glm::vec2 n = neighbourhood_motion(input.pass, input.tiles, input.picture, x, y);
  const float square = n.x * n.x + n.y * n.y;
  if (!(square > kLeastMotion2)) return {};
  const float length = std::sqrt(square);
  return input.pass.filter == MotionFilter::two_ways ? blurred_two_ways(input, x, y, n, length)
                                                     : blurred_one_way(input, x, y, n, length);
}

/// Tiles in which a pixel may read a motion that counts.
std::vector<bool> moving_tiles(const MotionTiles& tiles, MotionFilter filter) {
  std::vector<bool> moves(tiles.v.size());
  const int reach = filter == MotionFilter::two_ways ? 1 : 0;
  for (int y = 0; y < tiles.rows; ++y) {
    for (int x = 0; x < tiles.columns; ++x) {
      const glm::vec2 v = tiles.v[static_cast<std::size_t>(y * tiles.columns + x)];
      if (!(v.x * v.x + v.y * v.y > kLeastMotion2)) continue;
      for (int j = std::max(y - reach, 0); j <= std::min(y + reach, tiles.rows - 1); ++j) {
        for (int i = std::max(x - reach, 0); i <= std::min(x + reach, tiles.columns - 1); ++i) {
          moves[static_cast<std::size_t>(j * tiles.columns + i)] = true;
        }
      }
    }
  }
  return moves;
}

}  // namespace

void motion_blur(const MotionBlurSettings& settings, const ConstImageView& picture,
                 const ConstImageView& velocity, const ImageView& result, const Profile& profile,
                 ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && result.format == Format::rgba16f);
  assert(velocity.format == Format::rg16f);
  if (!has_whole_strides(picture)) {
    return motion_blur(settings, copy_of(picture), velocity, result, profile, pool);
  }
  const MotionBlurPass pass = pass_of(settings);
  const int width = picture.width, size = pass.radius_px;
  // All of it is written, and zeros before would take a tenth of the time.
  const std::ptrdiff_t stride = (width + 7) / 8 * 8;
  const RowMemory<std::uint64_t> memory =
      make_row_memory<std::uint64_t>(static_cast<std::size_t>(stride * picture.height));
  const ImageView spread =
      view_of(Format::rgba16f, memory.get(), width, picture.height, 8 * stride);
  motion_to_either_side(pass, velocity, spread, profile, pool);
  const MotionTiles tiles =
      longest_of_neighbours(longest_of_tiles(pass, spread, pool), pass.filter);
  const std::vector<bool> moves = moving_tiles(tiles, pass.filter);
  const ConstImageView spread_view = spread;
  const BlurInput input{pass, picture, spread_view, tiles};
  pool.for_each((picture.height + kPassRows - 1) / kPassRows, [&](int band) {
    const int end_y = std::min((band + 1) * kPassRows, picture.height);
    for (int y = band * kPassRows; y < end_y; ++y) {
      const BlurRow job{pass, source_of(picture), source_of(spread), width, picture.height, tiles,
                        y};
      const auto moves_at = [&](int tile) {
        return moves[static_cast<std::size_t>(y / size * tiles.columns + tile)];
      };
      for (int tile = 0; tile < tiles.columns;) {
        const int first = tile;
        const bool is_moving = moves_at(first);
        while (tile < tiles.columns && moves_at(tile) == is_moving) ++tile;
        const int end = std::min(tile * size, width);
        int x = first * size;
        if (!is_moving) {
          copy_texels(picture, result, y, x, end);
          continue;
        }
        if (pool.isa() != Isa::scalar) {
          x = SOFTFOCUS_KERNEL(pool.isa(), blur_row)(
              job, x, end, row<std::uint16_t>(result, y).data(), profile.half_store);
        }
        for (; x < end; ++x) {
          store_colour(picture, result, x, y, blurred(input, x, y), profile);
        }
      }
    }
  });
}

}  // namespace softfocus

#else  // the kernel

#include "raster/effects/motion/motion_samples_lanes.inl"

namespace {

SOFTFOCUS_INLINE Floats unit_lanes(Floats x) {
  return smaller(larger(x, splat(0.0f)), splat(1.0f));
}
SOFTFOCUS_INLINE Floats cylinder_lanes(Floats q) {
  const Floats s = unit_lanes((q - 0.95f) * 10.0f);
  return 1.0f - s * s * (3.0f - 2.0f * s);
}

/// The tile of a pixel: x / size, as (x + 1/2) (1 / size) cut, which is right below 2^14.
SOFTFOCUS_INLINE Ints tile_of(Ints x, int size) {
  return truncate((to_floats(x) + 0.5f) * (1.0f / static_cast<float>(size)));
}

SOFTFOCUS_INLINE Ints by_chance(Ints x, Bits a, Bits b, int size, int most) {
  const Ints i = as_ints(jitter_bit_lanes(a, b) >> 16) - 128;
  return smaller(larger(x + (i * size >> 9), splat(0)), splat(most - 1));
}

struct Vec2Lanes {
  Floats x, y;
};

SOFTFOCUS_INLINE Vec2Lanes neighbourhood_lanes(const BlurRow& row, Ints x) {
  const int size = row.pass.radius_px;
  Ints at_x = x, at_y = splat(row.y);
  if (row.pass.filter == MotionFilter::two_ways) {
    const Bits y = splat(static_cast<std::uint32_t>(row.y));
    at_x = by_chance(x, y, as_bits(x), size, row.width);
    at_y = by_chance(at_y, y + 1u, as_bits(x), size, row.height);
  }
  const Ints tile = tile_of(at_y, size) * row.tiles.columns + tile_of(at_x, size);
  const IntPairs v = gather_pairs(reinterpret_cast<const std::int32_t*>(row.tiles.v.data()), tile);
  return {as_floats(as_bits(v.first)), as_floats(as_bits(v.second))};
}

SOFTFOCUS_INLINE Floats reached_lanes(Floats q) { return unit_lanes((1.05f - q) * 10.0f); }

struct ColourLanes {
  Floats r, g, b;
};

struct PixelLanes {
  Floats at_x, at_y;
  FourFloats own;
  Floats v_x, v_y, v_z;
  Floats per_depth;
};

/// A sample's place, and its texel of the picture.
struct SampleLanes {
  Ints x, y;
  FourFloats there;
  Floats gap;  ///< how much farther it is (MotionBlurPass::inverse_depth)
};

SOFTFOCUS_INLINE SampleLanes sample_lanes(const BlurRow& row, const PixelLanes& pixel, Floats t,
                                          Vec2Lanes px) {
  const Ints x = place_lanes(pixel.at_x, t * px.x, row.width);
  const Ints y = place_lanes(pixel.at_y, t * px.y, row.height);
  const FourFloats there = gather_texels(row.picture, x, y);
  return {x, y, there, (there.a - pixel.own.a) * pixel.per_depth};
}

SOFTFOCUS_INLINE ColourLanes one_way_lanes(const BlurRow& row, const PixelLanes& pixel, Ints x,
                                           Vec2Lanes n, Floats length) {
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

SOFTFOCUS_INLINE ColourLanes two_ways_lanes(const BlurRow& row, const PixelLanes& pixel, Ints x,
                                            Vec2Lanes n, Floats length) {
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
  const auto mix = [&](Floats of_along, Floats of_across, Floats own) {
    const Floats first = of_along * of_a;
    const Floats second = select(of_b > 0.0f, first + of_across * of_b, first);
    return select(own_part > 0.0f, second + own * own_part, second);
  };
  return {mix(a.sum.r, b.sum.r, pixel.own.r), mix(a.sum.g, b.sum.g, pixel.own.g),
          mix(a.sum.b, b.sum.b, pixel.own.b)};
}

template <MotionFilter filter, HalfRounding rounding>
SOFTFOCUS_INLINE int blur_vectors(const BlurRow& row, int begin, int end, std::uint16_t* to) {
  const Floats zero = splat(0.0f), one = splat(1.0f);
  const std::uint16_t* picture = reinterpret_cast<const std::uint16_t*>(
      row.picture.texels + 2 * static_cast<std::ptrdiff_t>(row.picture.stride) * row.y);
  const std::uint16_t* spread = reinterpret_cast<const std::uint16_t*>(
      row.spread.texels + 2 * static_cast<std::ptrdiff_t>(row.spread.stride) * row.y);
  int at = begin;
  for (; at + kLanes <= end; at += kLanes) {
    const Ints x = at + lane_numbers();
    const HalfTexels own = load_half_texels(picture + 4 * at);
    const Vec2Lanes near = neighbourhood_lanes(row, x);
    const Floats square = near.x * near.x + near.y * near.y;
    const Mask moves = square > 0.25f;
    if (!any(moves)) {
      std::memcpy(to + 4 * at, picture + 4 * at, 4 * sizeof(std::uint16_t) * kLanes);
      continue;
    }
    // What stays has a motion too, which no result is taken of.
    const Vec2Lanes n{select(moves, near.x, one), select(moves, near.y, zero)};
    const Floats length = square_root(select(moves, square, one));
    const HalfTexels v = load_half_texels(spread + 4 * at);
    const Floats own_a = half_to_float(own.a);
    const PixelLanes pixel{
        to_floats(x),
        splat(static_cast<float>(row.y)),
        {half_to_float(own.r), half_to_float(own.g), half_to_float(own.b), own_a},
        half_to_float(v.r),
        half_to_float(v.g),
        half_to_float(v.b),
        select(own_a > 0.0f, row.pass.inverse_depth / own_a, zero)};
    const ColourLanes colour = filter == MotionFilter::two_ways
                                   ? two_ways_lanes(row, pixel, x, n, length)
                                   : one_way_lanes(row, pixel, x, n, length);
    store_half_texels(to + 4 * at,
                      {select(moves, float_to_half<rounding>(colour.r), own.r),
                       select(moves, float_to_half<rounding>(colour.g), own.g),
                       select(moves, float_to_half<rounding>(colour.b), own.b), own.a});
  }
  return at;
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE int blur_by(const BlurRow& row, int begin, int end, std::uint16_t* to) {
  return row.pass.filter == MotionFilter::two_ways
             ? blur_vectors<MotionFilter::two_ways, rounding>(row, begin, end, to)
             : blur_vectors<MotionFilter::one_way, rounding>(row, begin, end, to);
}

}  // namespace

/// Returns the first pixel that is not done.
int blur_row(const BlurRow& row, int begin, int end, std::uint16_t* to, HalfRounding rounding) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return blur_by<nearest_even>(row, begin, end, to);
    case toward_zero: return blur_by<toward_zero>(row, begin, end, to);
    case swiftshader: break;
  }
  return blur_by<swiftshader>(row, begin, end, to);
}

#endif
