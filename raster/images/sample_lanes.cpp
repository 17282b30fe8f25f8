// Sampling in lanes: which texels a sample reads (sample_taps.inl, sliced_lanes.inl), and how they
// are filtered (filter_lanes.inl).
//
// Addresses and weights have a lane a pixel. A texel is four floats, which one load brings, so a
// vector filters kLanes / 4 pixels; colours are transposed at the end. Gathering red, green and
// blue would take three loads a texel.

#ifndef SOFTFOCUS_ISA

#include <algorithm>
#include <array>

#include "raster/images/decoded_texture.h"
#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"
#include "raster/numbers/half.h"

#define SOFTFOCUS_KERNELS "raster/images/sample_lanes.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void sample_vectors(Isa isa, const DecodedTexture& texture, const Sampler& sampler,
                    const Profile& profile, const SamplePoints& points, int count, void* colours) {
  SOFTFOCUS_KERNEL(isa, sample_in_lanes)(texture, sampler, profile, points, count, colours);
}

void decode_halves(Isa isa, const std::uint16_t* from, std::size_t count, float* to) {
  SOFTFOCUS_KERNEL(isa, decode_halves_in_lanes)(from, count, to);
}

}  // namespace softfocus

#else  // once a vector unit

#include "raster/images/sample_lanes.inl"
#include "raster/lanes/vector_math_lanes.inl"

#include "raster/images/filter_lanes.inl"
#include "raster/images/sample_taps.inl"
#include "raster/images/sliced_lanes.inl"

namespace {

// The part of sampling that is common to all levels.
struct PlaceLanes {
  const DecodedTexture& texture;
  const Sampler& sampler;
  Floats u, v;
  Floats w;    ///< of a volume
  Ints slice;  ///< of an array or cube
};

SOFTFOCUS_INLINE AxisLanes axis_u(const PlaceLanes& place, Ints level) {
  const DecodedAxis& levels = place.texture.u;
  return {levels, place.sampler.wrap_u, place.u, level, look_up(levels.sizes, level)};
}

SOFTFOCUS_INLINE AxisLanes axis_v(const PlaceLanes& place, Ints level) {
  const DecodedAxis& levels = place.texture.v;
  return {levels, place.sampler.wrap_v, place.v, level, look_up(levels.sizes, level)};
}

SOFTFOCUS_INLINE AxisLanes axis_w(const PlaceLanes& place, Ints level) {
  const DecodedAxis& levels = place.texture.w;
  return {levels, place.sampler.wrap_w, place.w, level, look_up(levels.sizes, level)};
}

template <LaneArithmetic arithmetic, TextureShape shape = TextureShape::flat>
SOFTFOCUS_INLINE TapLanes taps(const AxisLanes& axis) {
  if constexpr (shape == TextureShape::cube) {
    return face_taps(axis.coordinate, axis.size, has_fixed_weights(arithmetic));
  } else if constexpr (arithmetic == LaneArithmetic::llvmpipe_integers) {
    return unorm8_taps(axis);
  } else if constexpr (arithmetic == LaneArithmetic::swiftshader) {
    return swiftshader_taps(axis);
  } else if constexpr (is_llvmpipe(arithmetic)) {
    return llvmpipe_taps(axis);
  } else {
    return standard_taps(axis, has_fixed_weights(arithmetic));
  }
}

template <LaneArithmetic arithmetic, TextureShape shape>
SOFTFOCUS_INLINE Ints nearest_texel(const AxisLanes& axis, bool of_bytes) {
  if constexpr (shape == TextureShape::cube) {
    return smaller(truncate(axis.coordinate * axis.size), truncate(axis.size) - 1);
  } else if constexpr (arithmetic == LaneArithmetic::swiftshader) {
    return of_bytes ? swiftshader_nearest_byte(axis) : swiftshader_nearest(axis);
  } else if constexpr (is_llvmpipe(arithmetic)) {
    return llvmpipe_nearest(axis);
  } else {
    return standard_nearest(axis);
  }
}

/// Where a slice's first row begins, and how far its rows lie apart: in floats, below 2^31, as all
/// of DecodedTexture is.
struct SliceLanes {
  Ints start, row;
};

template <TextureShape shape>
SOFTFOCUS_INLINE SliceLanes slice_at(const DecodedTexture& texture, Ints level, Floats width,
                                     Floats height, Ints slice) {
  constexpr int kBorders = shape == TextureShape::cube ? 2 : 0;
  SliceLanes at{look_up(texture.starts, level), (truncate(width) + kBorders) << 2};
  if constexpr (shape != TextureShape::flat) {
    at.start += slice * (at.row * (truncate(height) + kBorders));
  }
  return at;
}

SOFTFOCUS_INLINE void put_fetch(const SliceLanes& slice, const TapLanes& u, const TapLanes& v,
                                FetchLanes& fetch) {
  const Ints upper = slice.start + v.first * slice.row;
  const Ints lower = slice.start + v.second * slice.row;
  store(fetch.offsets[0], upper + (u.first << 2));
  store(fetch.offsets[1], upper + (u.second << 2));
  store(fetch.offsets[2], lower + (u.first << 2));
  store(fetch.offsets[3], lower + (u.second << 2));
  keep_in_memory(fetch.offsets);
  fetch.weight_u = u.weight;
  fetch.weight_v = v.weight;
  fetch.neighbours = all(u.second == u.first + 1);
  fetch.square_row = 0;
}

/// `behind`: of a volume, the next slice's.
template <LaneArithmetic arithmetic, TextureShape shape>
SOFTFOCUS_INLINE void find_fetch(const PlaceLanes& place, Ints level, FetchLanes& fetch,
                                 FetchLanes* behind) {
  const AxisLanes along_u = axis_u(place, level), along_v = axis_v(place, level);
  const TapLanes u = taps<arithmetic, shape>(along_u);
  const TapLanes v = taps<arithmetic, shape>(along_v);
  const DecodedTexture& texture = place.texture;
  if constexpr (shape == TextureShape::volume) {
    const TapLanes w = taps<arithmetic>(axis_w(place, level));
    put_fetch(slice_at<shape>(texture, level, along_u.size, along_v.size, w.first), u, v, fetch);
    put_fetch(slice_at<shape>(texture, level, along_u.size, along_v.size, w.second), u, v, *behind);
    fetch.weight_w = w.weight;
  } else {
    put_fetch(slice_at<shape>(texture, level, along_u.size, along_v.size, place.slice), u, v,
              fetch);
  }
}

template <LaneArithmetic arithmetic, TextureShape shape>
SOFTFOCUS_INLINE RgbaLanes sample_nearest(const PlaceLanes& place, Ints level) {
  const AxisLanes along_u = axis_u(place, level);
  const AxisLanes along_v = axis_v(place, level);
  const Ints x = nearest_texel<arithmetic, shape>(along_u, place.texture.are_whole);
  const Ints y = nearest_texel<arithmetic, shape>(along_v, place.texture.are_whole);
  Ints z = place.slice;
  if constexpr (shape == TextureShape::volume) {
    z = nearest_texel<arithmetic, shape>(axis_w(place, level), false);
  }
  const SliceLanes slice = slice_at<shape>(place.texture, level, along_u.size, along_v.size, z);
  alignas(64) std::int32_t offsets[kLanes];
  store(offsets, slice.start + y * slice.row + (x << 2));
  const float* texels = place.texture.texels.get();
  return transpose_groups(load_texels(texels, offsets), load_texels(texels, offsets + 1),
                          load_texels(texels, offsets + 2), load_texels(texels, offsets + 3));
}

/// A vector's reads. Found for many vectors before any is filtered.
struct SamplePlan {
  FetchLanes fine, coarse;
  Floats next_weight;
  bool two_levels;
  bool by_lane;  ///< sample() has to do it
};

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE LevelLanes choose_levels(Floats lod, int last, bool trilinear) {
  if constexpr (is_llvmpipe(arithmetic)) {
    LevelLanes levels = choose_llvmpipe_levels(lod, last, trilinear);
    if constexpr (arithmetic == LaneArithmetic::llvmpipe_integers) {
      levels.next_weight = floor(levels.next_weight * 256.0f) * (1.0f / 256.0f);
    }
    return levels;
  } else if constexpr (arithmetic == LaneArithmetic::swiftshader) {
    return choose_swiftshader_levels(lod, last, trilinear);
  } else {
    return choose_standard_levels(lod, last, trilinear, has_fixed_weights(arithmetic));
  }
}

/// `behind`: a volume's plan for the slices behind, of which only the fetches count.
template <LaneArithmetic arithmetic, TextureShape shape>
SOFTFOCUS_INLINE void plan_linear(const PlaceLanes& place, const LevelLanes& levels,
                                  SamplePlan& plan, SamplePlan* behind) {
  const Mask mixed = levels.next_weight > 0.0f;
  plan.next_weight = levels.next_weight;
  plan.two_levels = arithmetic == LaneArithmetic::swiftshader
                        ? place.sampler.filter == Filter::trilinear
                        : any(mixed) != 0;
  plan.by_lane = false;
  find_fetch<arithmetic, shape>(place, levels.first, plan.fine,
                                behind == nullptr ? nullptr : &behind->fine);
  // Neighbouring pixels mostly read the same texels: prefetching for every fourth is enough.
  for (int lane = 0; lane < kLanes; lane += 4) {
    __builtin_prefetch(place.texture.texels.get() + plan.fine.offsets[0][lane]);
    __builtin_prefetch(place.texture.texels.get() + plan.fine.offsets[2][lane]);
  }
  if (!plan.two_levels) return;
  if constexpr (flushes_floats(arithmetic)) {
    plan.by_lane = any((levels.next_weight < 0x1p-16f) & mixed);
  }
  const Ints next = smaller(levels.first + 1, splat(place.texture.level_count - 1));
  find_fetch<arithmetic, shape>(place, next, plan.coarse,
                                behind == nullptr ? nullptr : &behind->coarse);
}

// --- textures that repeat, of sizes that are powers of two ---

/// Whether plan_repeating() may plan.
template <LaneArithmetic arithmetic, TextureShape shape>
SOFTFOCUS_INLINE bool is_planned_quickly(const DecodedTexture& texture, const Sampler& sampler) {
  constexpr bool kIsStandard = arithmetic == LaneArithmetic::standard ||
                               arithmetic == LaneArithmetic::standard_fixed_8 ||
                               arithmetic == LaneArithmetic::standard_integers;
  return kIsStandard && shape == TextureShape::flat && sampler.filter != Filter::nearest &&
         sampler.wrap_u == Wrap::repeat && sampler.wrap_v == Wrap::repeat &&
         texture.u.are_powers_of_two && texture.v.are_powers_of_two;
}

/// Coordinates below this magnitude are finite, and standard_texels() clamps them at no level.
SOFTFOCUS_INLINE float most_usual(const DecodedTexture& texture) {
  return 0x1p22f / std::max(texture.u.sizes[0], texture.v.sizes[0]);
}

/// standard_taps() of usual coordinates, but for the second texel.
template <bool fixed_8>
SOFTFOCUS_INLINE TapLanes repeated_taps(Floats coordinate, Floats size, Ints last) {
  Floats position = coordinate * size - 0.5f;
  if (fixed_8) position = nearest(position * 256.0f) * (1.0f / 256.0f);
  const Floats base = floor(position);
  return {truncate(base) & last, splat(0), position - base};
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE void find_repeating(const PlaceLanes& place, std::size_t level,
                                     FetchLanes& fetch) {
  constexpr bool kFixed = has_fixed_weights(arithmetic);
  const DecodedTexture& texture = place.texture;
  const Floats width = splat(texture.u.sizes[level]), height = splat(texture.v.sizes[level]);
  const Ints columns = truncate(width), last_u = columns - 1, last_v = truncate(height) - 1;
  const TapLanes u = repeated_taps<kFixed>(place.u, width, last_u);
  const TapLanes v = repeated_taps<kFixed>(place.v, height, last_v);
  fetch.weight_u = u.weight;
  fetch.weight_v = v.weight;
  const Ints start = splat(texture.starts[level]), row = columns << 2;
  const Ints upper = start + v.first * row, first = upper + (u.first << 2);
  store(fetch.offsets[0], first);
  fetch.neighbours = true;
  fetch.square_row = row[0];
  if (any((u.first == last_u) | (v.first == last_v))) {
    fetch.neighbours = !any(u.first == last_u);
    fetch.square_row = 0;
    const Ints second_u = (u.first + 1) & last_u, second_v = (v.first + 1) & last_v;
    const Ints lower = start + second_v * row;
    store(fetch.offsets[1], upper + (second_u << 2));
    store(fetch.offsets[2], lower + (u.first << 2));
    store(fetch.offsets[3], lower + (second_u << 2));
  }
  keep_in_memory(fetch.offsets);
  const float* texels = texture.texels.get();
#pragma GCC unroll 8
  for (int lane = 0; lane < kLanes; lane += 2) {
    __builtin_prefetch(texels + fetch.offsets[0][lane]);
    __builtin_prefetch(texels + fetch.square_row + fetch.offsets[0][lane]);
  }
}

/// plan_linear() of a vector whose lanes read the same levels. False if they do not.
template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE bool plan_repeating(const PlaceLanes& place, const LevelLanes& levels,
                                     SamplePlan& plan) {
  if (equal_lane_bits(levels.first, splat(levels.first[0])) != kAllLaneBits) return false;
  const auto level = static_cast<std::size_t>(levels.first[0]);
  plan.next_weight = levels.next_weight;
  plan.by_lane = false;
  plan.two_levels = any(levels.next_weight > 0.0f);
  find_repeating<arithmetic>(place, level, plan.fine);
  // A level that is mixed with the next is not the last.
  if (plan.two_levels) find_repeating<arithmetic>(place, level + 1, plan.coarse);
  return true;
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE void filter_plan(const float* texels, SamplePlan& plan, RgbaLanes& colour) {
  using enum Footprint;
  FetchLanes& fine = plan.fine;
  FetchLanes& coarse = plan.coarse;
  const Floats& weight = plan.next_weight;
  if (!plan.two_levels) {
    if (fine.square_row != 0) {
      filter_lanes<arithmetic, squares, false>(texels, fine, fine, weight, colour);
    } else if (fine.neighbours) {
      filter_lanes<arithmetic, pairs, false>(texels, fine, fine, weight, colour);
    } else {
      filter_lanes<arithmetic, apart, false>(texels, fine, fine, weight, colour);
    }
  } else if (fine.square_row != 0 && coarse.square_row != 0) {
    filter_lanes<arithmetic, squares, true>(texels, fine, coarse, weight, colour);
  } else {
    complete_offsets(fine);
    complete_offsets(coarse);
    if (fine.neighbours && coarse.neighbours) {
      filter_lanes<arithmetic, pairs, true>(texels, fine, coarse, weight, colour);
    } else {
      filter_lanes<arithmetic, apart, true>(texels, fine, coarse, weight, colour);
    }
  }
}

/// A level of a volume: between two slices.
template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE void filter_slices(const float* texels, const FetchLanes& front,
                                    const FetchLanes& behind, RgbaLanes& colour) {
  RgbaLanes next;
  if (front.neighbours) {
    filter_lanes<arithmetic, Footprint::pairs, false>(texels, front, front, front.weight_w, colour);
    filter_lanes<arithmetic, Footprint::pairs, false>(texels, behind, behind, front.weight_w, next);
  } else {
    filter_lanes<arithmetic, Footprint::apart, false>(texels, front, front, front.weight_w, colour);
    filter_lanes<arithmetic, Footprint::apart, false>(texels, behind, behind, front.weight_w, next);
  }
  colour.r = mix<arithmetic>(colour.r, next.r, front.weight_w);
  colour.g = mix<arithmetic>(colour.g, next.g, front.weight_w);
  colour.b = mix<arithmetic>(colour.b, next.b, front.weight_w);
  colour.a = mix<arithmetic>(colour.a, next.a, front.weight_w);
}

template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE void filter_volume(const float* texels, const SamplePlan& front,
                                    const SamplePlan& behind, RgbaLanes& colour) {
  filter_slices<arithmetic>(texels, front.fine, behind.fine, colour);
  if (!front.two_levels) return;
  RgbaLanes next;
  filter_slices<arithmetic>(texels, front.coarse, behind.coarse, next);
  const Floats weight = front.next_weight;
  const Mask mixed = weight > 0.0f;
  colour.r = select(mixed, mix_levels<arithmetic>(colour.r, next.r, weight), colour.r);
  colour.g = select(mixed, mix_levels<arithmetic>(colour.g, next.g, weight), colour.g);
  colour.b = select(mixed, mix_levels<arithmetic>(colour.b, next.b, weight), colour.b);
  colour.a = select(mixed, mix_levels<arithmetic>(colour.a, next.a, weight), colour.a);
}

/// Subnormals become zeros of their signs.
SOFTFOCUS_INLINE Floats flushed(Floats v) {
  return select(absolute(v) < 0x1p-126f, as_floats(as_bits(v) & 0x80000000u), v);
}

/// What the sums of two levels of a volume or cube lack beside the scalar form.
SOFTFOCUS_INLINE void flush_sums(RgbaLanes& colour) {
  colour.r = flushed(colour.r);
  colour.g = flushed(colour.g);
  colour.b = flushed(colour.b);
  colour.a = flushed(colour.a);
}

/// sample() or sample_sliced() itself, lane by lane.
[[gnu::noinline]] inline void sample_by_lane(const DecodedTexture& texture, const Sampler& sampler,
                                             const Profile& profile, SamplePoints points,
                                             int vector, RgbaLanes& colour) {
  const bool is_flat = texture.source->shape == TextureShape::flat;
  for (int lane = 0; lane < kLanes; ++lane) {
    const int i = vector * kLanes + lane;
    const glm::vec2 at{points.u[i], points.v[i]};
    const glm::vec4 value = is_flat ? sample(*texture.source, sampler, at, points.lod[i], profile)
                                    : sample_sliced(*texture.source, sampler, {at, points.w[i]},
                                                    points.lod[i], profile);
    colour.r[lane] = value.x;
    colour.g[lane] = value.y;
    colour.b[lane] = value.z;
    colour.a[lane] = value.w;
  }
}

/// Decodes mixed texels that kept whole numbers, as fetch_texel() decodes texels.
template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE Floats to_linear(const DecodedTexture& texture, Floats value) {
  if constexpr (arithmetic == LaneArithmetic::standard_integers) {
    return value / 255.0f;
  } else if constexpr (arithmetic == LaneArithmetic::swiftshader) {
    return texture.are_whole ? value * (1.0f / 65280.0f) : value;
  } else if constexpr (is_llvmpipe(arithmetic)) {
    return texture.are_whole ? value * (1.0f / 255.0f) : value;
  } else {
    return value;
  }
}

/// A coordinate as the scalar form takes it.
template <LaneArithmetic arithmetic>
SOFTFOCUS_INLINE Floats usable(Floats coordinate) {
  if constexpr (is_llvmpipe(arithmetic) || arithmetic == LaneArithmetic::swiftshader) {
    return select(absolute(coordinate) < 0x1p-126f, splat(0.0f), coordinate);
  } else {
    const Floats finite = select(absolute(coordinate) < __builtin_inff(), coordinate, splat(0.0f));
    if constexpr (arithmetic != LaneArithmetic::standard_flushed) return finite;
    return select(absolute(finite) < 0x1p-126f, splat(0.0f), finite);
  }
}

template <LaneArithmetic arithmetic, TextureShape shape>
SOFTFOCUS_INLINE PlaceLanes find_place(const DecodedTexture& texture, const Sampler& sampler,
                                       const SamplePoints& points, int vector) {
  PlaceLanes place{.texture = texture,
                   .sampler = sampler,
                   .u = load(points.u + vector * kLanes),
                   .v = load(points.v + vector * kLanes),
                   .w = splat(0.0f),
                   .slice = splat(0)};
  if constexpr (shape != TextureShape::flat) place.w = load(points.w + vector * kLanes);
  if constexpr (shape == TextureShape::cube) {
    if constexpr (flushes_floats(arithmetic)) {
      place.u = flushed(place.u);
      place.v = flushed(place.v);
      place.w = flushed(place.w);
    }
    const CubePlaceLanes found = cube_place(place.u, place.v, place.w);
    place.slice = found.face;
    place.u = found.u;
    place.v = found.v;
    return place;
  }
  place.u = usable<arithmetic>(place.u);
  place.v = usable<arithmetic>(place.v);
  if constexpr (shape == TextureShape::volume) place.w = usable<arithmetic>(place.w);
  if constexpr (shape == TextureShape::array) {
    place.slice = nearest_layer<is_llvmpipe(arithmetic)>(slice_count(*texture.source), place.w);
  }
  return place;
}

/// A filter's sums where the format has no channels: weights that are NaN have spoilt them.
SOFTFOCUS_INLINE void put_missing_channels(int channels, RgbaLanes& colour) {
  if (channels == 4) return;
  if (channels == 1) colour.g = splat(0.0f);
  colour.b = splat(0.0f);
  colour.a = splat(1.0f);
}

template <LaneArithmetic arithmetic, TextureShape shape>
[[gnu::noinline]] void sample_batch(const DecodedTexture& texture, const Sampler& sampler,
                                    const Profile& profile, SamplePoints points, int count,
                                    RgbaLanes* colours) {
  constexpr bool kIsVolume = shape == TextureShape::volume;
  const int last = texture.level_count - 1;
  const bool trilinear = sampler.filter == Filter::trilinear;
  const bool is_quick = is_planned_quickly<arithmetic, shape>(texture, sampler);
  const float usual = most_usual(texture);
  std::array<SamplePlan, kIsVolume ? 2 * kMostSampled : kMostSampled> plans;
  for (int i = 0; i < count; ++i) {
    const LevelLanes levels =
        choose_levels<arithmetic>(load(points.lod + i * kLanes), last, trilinear);
    if constexpr (shape == TextureShape::flat) {
      const PlaceLanes as_it_is{.texture = texture,
                                .sampler = sampler,
                                .u = load(points.u + i * kLanes),
                                .v = load(points.v + i * kLanes),
                                .w = splat(0.0f),
                                .slice = splat(0)};
      if (is_quick && all((absolute(as_it_is.u) < usual) & (absolute(as_it_is.v) < usual)) &&
          plan_repeating<arithmetic>(as_it_is, levels, plans[static_cast<std::size_t>(i)])) {
        continue;
      }
    }
    const PlaceLanes place = find_place<arithmetic, shape>(texture, sampler, points, i);
    if (sampler.filter == Filter::nearest) {
      colours[i] = sample_nearest<arithmetic, shape>(place, levels.first);
    } else {
      plan_linear<arithmetic, shape>(
          place, levels, plans[static_cast<std::size_t>(i)],
          kIsVolume ? &plans[static_cast<std::size_t>(kMostSampled + i)] : nullptr);
    }
  }
  const int channels = channel_count(texture.source->levels.front().format);
  for (int i = 0; i < count; ++i) {
    if (sampler.filter != Filter::nearest) {
      SamplePlan& plan = plans[static_cast<std::size_t>(i)];
      if (plan.by_lane) {
        sample_by_lane(texture, sampler, profile, points, i, colours[i]);
        continue;
      }
      if constexpr (kIsVolume) {
        filter_volume<arithmetic>(texture.texels.get(), plan,
                                  plans[static_cast<std::size_t>(kMostSampled + i)], colours[i]);
      } else {
        filter_plan<arithmetic>(texture.texels.get(), plan, colours[i]);
      }
      if constexpr ((kIsVolume || shape == TextureShape::cube) && flushes_floats(arithmetic)) {
        if (plan.two_levels) flush_sums(colours[i]);
      }
    }
    colours[i].r = to_linear<arithmetic>(texture, colours[i].r);
    colours[i].g = to_linear<arithmetic>(texture, colours[i].g);
    colours[i].b = to_linear<arithmetic>(texture, colours[i].b);
    colours[i].a = to_linear<arithmetic>(texture, colours[i].a);
    put_missing_channels(channels, colours[i]);
  }
}

template <LaneArithmetic arithmetic>
void sample_shape(const DecodedTexture& texture, const Sampler& sampler, const Profile& profile,
                  const SamplePoints& points, int count, RgbaLanes* colours) {
  using enum TextureShape;
  // Arithmetics that volumes and cubes are never filtered in; lane_arithmetic() has them.
  constexpr bool kIsFlat =
      arithmetic == LaneArithmetic::swiftshader || arithmetic == LaneArithmetic::standard_integers;
  constexpr bool kIsSliced = arithmetic == LaneArithmetic::standard_flushed;
  const TextureShape shape = texture.source->shape;
  if constexpr (!kIsFlat) {
    if (shape == volume) {
      return sample_batch<arithmetic, volume>(texture, sampler, profile, points, count, colours);
    }
    if constexpr (arithmetic != LaneArithmetic::llvmpipe_integers) {
      if (shape == cube) {
        return sample_batch<arithmetic, cube>(texture, sampler, profile, points, count, colours);
      }
    }
  }
  if constexpr (!kIsSliced) {
    if (shape == array) {
      return sample_batch<arithmetic, array>(texture, sampler, profile, points, count, colours);
    }
    return sample_batch<arithmetic, flat>(texture, sampler, profile, points, count, colours);
  }
}

}  // namespace

/// sample() or sample_sliced() of `count` vectors, kMostSampled at most, in the arithmetic that
/// lane_arithmetic() chooses. A vector is a long chain of operations. So addresses of all come
/// first, then all filters: the CPU works on several vectors at once.
void sample_in_lanes(const DecodedTexture& texture, const Sampler& sampler, const Profile& profile,
                     const SamplePoints& points, int count, void* to) {
  auto* colours = static_cast<RgbaLanes*>(to);
  using enum LaneArithmetic;
  switch (lane_arithmetic(texture, sampler, profile)) {
    case by_sample:
      for (int i = 0; i < count; ++i) {
        sample_by_lane(texture, sampler, profile, points, i, colours[i]);
      }
      return;
    case standard: return sample_shape<standard>(texture, sampler, profile, points, count, colours);
    case standard_fixed_8:
      return sample_shape<standard_fixed_8>(texture, sampler, profile, points, count, colours);
    case standard_integers:
      return sample_shape<standard_integers>(texture, sampler, profile, points, count, colours);
    case standard_flushed:
      return sample_shape<standard_flushed>(texture, sampler, profile, points, count, colours);
    case llvmpipe_fused:
      return sample_shape<llvmpipe_fused>(texture, sampler, profile, points, count, colours);
    case llvmpipe_unfused:
      return sample_shape<llvmpipe_unfused>(texture, sampler, profile, points, count, colours);
    case llvmpipe_integers:
      return sample_shape<llvmpipe_integers>(texture, sampler, profile, points, count, colours);
    case swiftshader:
      return sample_shape<swiftshader>(texture, sampler, profile, points, count, colours);
  }
}

void decode_halves_in_lanes(const std::uint16_t* from, std::size_t count, float* to) {
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) store(to + i, load_halves(from + i));
  for (; i < count; ++i) to[i] = softfocus::half_to_float(from[i]);
}

#endif
