// What the kernels of both filters share: motion_filters.h for kLanes pixels at once. A filter is a
// type, by which blur_vectors() finds its filtered_lanes().

#include "raster/effects/motion/motion_samples_lanes.inl"

SOFTFOCUS_INLINE Floats unit_lanes(Floats x) {
  return smaller(larger(x, splat(0.0f)), splat(1.0f));
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
  const Floats depth = smaller(splat(kFarthestDepth), there.a);
  return {x, y, there, (depth - pixel.own.a) * pixel.per_depth};
}

/// Returns the first pixel that is not done.
template <class Filter, HalfRounding rounding>
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
    const Floats own_a = smaller(splat(kFarthestDepth), half_to_float(own.a));
    const PixelLanes pixel{
        to_floats(x),
        splat(static_cast<float>(row.y)),
        {half_to_float(own.r), half_to_float(own.g), half_to_float(own.b), own_a},
        half_to_float(v.r),
        half_to_float(v.g),
        half_to_float(v.b),
        select(own_a > 0.0f, row.pass.inverse_depth / own_a, zero)};
    const ColourLanes colour = filtered_lanes(Filter{}, row, pixel, x, n, length);
    store_half_texels(to + 4 * at,
                      {select(moves, float_to_half<rounding>(colour.r), own.r),
                       select(moves, float_to_half<rounding>(colour.g), own.g),
                       select(moves, float_to_half<rounding>(colour.b), own.b), own.a});
  }
  return at;
}

template <class Filter>
SOFTFOCUS_INLINE int blur_by(const BlurRow& row, int begin, int end, std::uint16_t* to,
                             HalfRounding rounding) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return blur_vectors<Filter, nearest_even>(row, begin, end, to);
    case toward_zero: return blur_vectors<Filter, toward_zero>(row, begin, end, to);
    case swiftshader: break;
  }
  return blur_vectors<Filter, swiftshader>(row, begin, end, to);
}
