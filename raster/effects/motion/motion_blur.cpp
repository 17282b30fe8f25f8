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

/// None where nothing near moves: the pixel stays.
std::optional<glm::vec3> blurred(const BlurInput& input, int x, int y) {
  const MotionBlurPass& pass = input.pass;
  const glm::vec4 own = load_texel<Format::rgba16f>(input.picture, x, y);
  const glm::vec2 n = neighbourhood_motion(pass, input.tiles, input.picture, x, y);
  const float square = n.x * n.x + n.y * n.y;
  if (!(square > kLeastMotion2)) return {};
  const float length = std::sqrt(square);
  const glm::vec2 along{n.x / length, n.y / length};
  const glm::vec4 v = load_texel<Format::rgba16f>(input.spread, x, y);

  glm::vec2 across = along;  // the other way to sample
  float facing = 1.0f;       // |along . across|
  if (pass.filter == MotionFilter::two_ways) {
    // The pixel's own motion, or at a right angle to `along` if it hardly moves.
    const bool turned = v.y * along.x - v.x * along.y < 0.0f;
    const glm::vec2 right{turned ? along.y : -along.y, turned ? -along.x : along.x};
    const float share = cut_to_1((std::sqrt(v.x * v.x + v.y * v.y) - 0.5f) * (1.0f / 1.5f));
    const glm::vec2 mixed{right.x + (v.x * v.z - right.x) * share,
                          right.y + (v.y * v.z - right.y) * share};
    const float mixed_length = std::sqrt(mixed.x * mixed.x + mixed.y * mixed.y);
    across = {mixed.x / mixed_length, mixed.y / mixed_length};
    facing = std::fabs(across.x * along.x + across.y * along.y);
  }

  const float per_depth = own.w > 0.0f ? pass.inverse_depth / own.w : 0.0f;
  const float j = jitter(x, y);
  float total = v.z * pass.own_weight;
  glm::vec3 sum{own.x * total, own.y * total, own.z * total};
  for (int i = 0; i < pass.samples; ++i) {
    const bool is_across = i % 2 != 0;
    const glm::vec2 way = is_across ? across : along;
    const float moved = way_at(i, j, pass.step) * length;
    const glm::ivec2 at = pixel_at(input.picture, x, y, {moved * way.x, moved * way.y});
    const glm::vec4 there = load_texel<Format::rgba16f>(input.picture, at.x, at.y);
    const glm::vec4 w = load_texel<Format::rgba16f>(input.spread, at.x, at.y);
    const float distance = std::fabs(moved);
    const float of_there = distance * w.z, of_own = distance * v.z;
    const float nearer = cut_to_1(1.0f - (there.w - own.w) * per_depth);
    const float farther = cut_to_1(1.0f - (own.w - there.w) * per_depth);
    float weight;
    if (pass.filter == MotionFilter::two_ways) {
      const float own_way = is_across ? 1.0f : facing;
      const float there_way = std::fabs(w.x * way.x + w.y * way.y) * w.z;
      const float of_both = of_there > of_own ? of_there : of_own;
      const float either_way = there_way > own_way ? there_way : own_way;
      weight = ((nearer * cone(of_there)) * there_way + (farther * cone(of_own)) * own_way) +
               (cylinder(of_both) * either_way) * 2.0f;
    } else {
      weight = (nearer * cone(of_there) + farther * cone(of_own)) +
               (cylinder(of_there) * cylinder(of_own)) * 2.0f;
    }
    if (!(weight > 0.0f)) continue;  // a light without end must not count 0 times
    total += weight;
    sum.x += there.x * weight;
    sum.y += there.y * weight;
    sum.z += there.z * weight;
  }
  return glm::vec3{sum.x / total, sum.y / total, sum.z / total};
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
  Image spread = make_image(Format::rgba16f, width, picture.height);
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

template <MotionFilter filter, HalfRounding rounding>
SOFTFOCUS_INLINE int blur_vectors(const BlurRow& row, int begin, int end, std::uint16_t* to) {
  const MotionBlurPass& pass = row.pass;
  const Floats zero = splat(0.0f), one = splat(1.0f);
  const Floats at_y = splat(static_cast<float>(row.y));
  const std::uint16_t* picture = reinterpret_cast<const std::uint16_t*>(
      row.picture.texels + 2 * static_cast<std::ptrdiff_t>(row.picture.stride) * row.y);
  const std::uint16_t* spread = reinterpret_cast<const std::uint16_t*>(
      row.spread.texels + 2 * static_cast<std::ptrdiff_t>(row.spread.stride) * row.y);
  int at = begin;
  for (; at + kLanes <= end; at += kLanes) {
    const Ints x = at + lane_numbers();
    const HalfTexels own_halves = load_half_texels(picture + 4 * at);
    const Vec2Lanes n = neighbourhood_lanes(row, x);
    const Floats square = n.x * n.x + n.y * n.y;
    const Mask moves = square > 0.25f;
    if (!any(moves)) {
      std::memcpy(to + 4 * at, picture + 4 * at, 4 * sizeof(std::uint16_t) * kLanes);
      continue;
    }
    const Floats length = square_root(square);
    const Vec2Lanes along{select(moves, n.x / length, zero), select(moves, n.y / length, zero)};
    const HalfTexels v_halves = load_half_texels(spread + 4 * at);
    const Floats v_x = half_to_float(v_halves.r), v_y = half_to_float(v_halves.g);
    const Floats v_z = half_to_float(v_halves.b);
    Vec2Lanes across = along;
    Floats facing = one;
    if constexpr (filter == MotionFilter::two_ways) {
      const Mask turned = v_y * along.x - v_x * along.y < 0.0f;
      const Floats right_x = select(turned, along.y, -along.y);
      const Floats right_y = select(turned, -along.x, along.x);
      const Floats share = unit_lanes((square_root(v_x * v_x + v_y * v_y) - 0.5f) * (1.0f / 1.5f));
      const Floats mixed_x = right_x + (v_x * v_z - right_x) * share;
      const Floats mixed_y = right_y + (v_y * v_z - right_y) * share;
      const Floats mixed = square_root(mixed_x * mixed_x + mixed_y * mixed_y);
      across = {select(moves, mixed_x / mixed, zero), select(moves, mixed_y / mixed, zero)};
      facing = absolute(across.x * along.x + across.y * along.y);
    }
    const Floats own_r = half_to_float(own_halves.r), own_g = half_to_float(own_halves.g);
    const Floats own_b = half_to_float(own_halves.b), own_a = half_to_float(own_halves.a);
    const Floats per_depth = select(own_a > 0.0f, pass.inverse_depth / own_a, zero);
    const Floats j = jitter_lanes(x, row.y);
    const Floats at_x = to_floats(x);
    Floats total = v_z * pass.own_weight;
    Floats sum_r = own_r * total, sum_g = own_g * total, sum_b = own_b * total;
    for (int i = 0; i < pass.samples; ++i) {
      const bool is_across = filter == MotionFilter::two_ways && i % 2 != 0;
      const Vec2Lanes way = is_across ? across : along;
      const Floats moved = ((static_cast<float>(i) + j) * pass.step - 1.0f) * length;
      const Ints there_x = place_lanes(at_x, moved * way.x, row.width);
      const Ints there_y = place_lanes(at_y, moved * way.y, row.height);
      const FourFloats there = gather_texels(row.picture, there_x, there_y);
      const FourFloats w = gather_texels(row.spread, there_x, there_y);
      const Floats distance = absolute(moved);
      const Floats of_there = distance * w.b, of_own = distance * v_z;
      const Floats nearer = unit_lanes(1.0f - (there.a - own_a) * per_depth);
      const Floats farther = unit_lanes(1.0f - (own_a - there.a) * per_depth);
      const Floats cone_there = unit_lanes(1.0f - of_there), cone_own = unit_lanes(1.0f - of_own);
      Floats weight;
      if constexpr (filter == MotionFilter::two_ways) {
        const Floats own_way = is_across ? one : facing;
        const Floats there_way = absolute(w.r * way.x + w.g * way.y) * w.b;
        const Floats of_both = larger(of_there, of_own);
        const Floats either_way = larger(there_way, own_way);
        weight = ((nearer * cone_there) * there_way + (farther * cone_own) * own_way) +
                 (cylinder_lanes(of_both) * either_way) * 2.0f;
      } else {
        weight = (nearer * cone_there + farther * cone_own) +
                 (cylinder_lanes(of_there) * cylinder_lanes(of_own)) * 2.0f;
      }
      const Mask counts = weight > 0.0f;
      total += weight;  // never below 0
      sum_r = select(counts, sum_r + there.r * weight, sum_r);
      sum_g = select(counts, sum_g + there.g * weight, sum_g);
      sum_b = select(counts, sum_b + there.b * weight, sum_b);
    }
    store_half_texels(
        to + 4 * at,
        {select(moves, float_to_half<rounding>(sum_r / total), own_halves.r),
         select(moves, float_to_half<rounding>(sum_g / total), own_halves.g),
         select(moves, float_to_half<rounding>(sum_b / total), own_halves.b), own_halves.a});
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
