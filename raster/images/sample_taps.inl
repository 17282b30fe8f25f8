// Which levels and which texels along an axis a sample reads, in lanes. The addresses are those of
// sampler.cpp, integer_filter.cpp and driver_samplers.cpp, to the bit. For any coordinate and lod,
// NaN too, the texels lie in the texture. sample_lanes.cpp includes this.

// --- which levels ---

/// table[index]. Needs 0 <= index < 16.
template <class Number>
SOFTFOCUS_INLINE auto look_up(const std::array<Number, kMaxDecodedLevels>& table, Ints index) {
  using Lanes = decltype(load(table.data()));
#if SOFTFOCUS_LANES == 16
  return (Lanes)_mm512_maskz_permutexvar_epi32(0xFFFF, (__m512i)index, (__m512i)load(table.data()));
#elif SOFTFOCUS_LANES == 8
  const Lanes low = load(table.data());
  const Lanes high = load(table.data() + 8);
  return select(index > 7, (Lanes)_mm256_permutevar8x32_epi32((__m256i)high, (__m256i)index),
                (Lanes)_mm256_permutevar8x32_epi32((__m256i)low, (__m256i)index));
#else
  // Neighbouring pixels mostly have one level.
  if (all(index == spread<0>(index))) return splat(table[static_cast<std::size_t>(index[0])]);
  Lanes values;
  for (int i = 0; i < kLanes; ++i) values[i] = table[static_cast<std::size_t>(index[i])];
  return values;
#endif
}

/// The level that each lane reads, and the weight of the next one.
struct LevelLanes {
  Ints first;
  Floats next_weight;
};

SOFTFOCUS_INLINE LevelLanes choose_standard_levels(Floats lod, int last, bool trilinear,
                                                   bool fixed_8) {
  const Floats largest = splat(static_cast<float>(last));
  const Floats level = select(lod > 0.0f, smaller(lod, largest), splat(0.0f));
  if (!trilinear) return {truncate(level + 0.5f), splat(0.0f)};
  const Floats base = floor(level);
  Floats weight = level - base;
  if (fixed_8) weight = nearest(weight * 256.0f) * (1.0f / 256.0f);
  return {truncate(base), weight};
}

// Lods that no int32 holds, and those that the profile flushes, give level 0.
SOFTFOCUS_INLINE LevelLanes choose_llvmpipe_levels(Floats lod, int last, bool trilinear) {
  const Floats used = select((lod >= 0x1p-126f) & (lod < 0x1p31f), lod, splat(0.0f));
  const Ints end = splat(last);
  if (!trilinear) return {smaller(truncate(nearest(used)), end), splat(0.0f)};
  const Floats base = floor(used);
  const Ints level = truncate(base);
  return {smaller(level, end), select(level < end, used - base, splat(0.0f))};
}

SOFTFOCUS_INLINE LevelLanes choose_swiftshader_levels(Floats lod, int last, bool trilinear) {
  const Floats used = select(lod >= 0x1p-126f, smaller(lod, splat(1000.0f)), splat(0.0f));
  const Ints end = splat(last);
  if (!trilinear) return {smaller(truncate(nearest(used)), end), splat(0.0f)};
  const Floats base = floor(used);
  return {smaller(truncate(base), end), smaller(used - base, splat(1.0f - 0x1p-24f))};
}

// --- which texels along an axis ---

struct AxisLanes {
  const DecodedAxis& levels;
  Wrap wrap;
  Floats coordinate;
  Ints level;
  Floats size;  ///< of the level
};

struct TapLanes {
  Ints first, second;
  Floats weight;
};

// A whole number, at most 2^22 + 1 in magnitude, modulo `period`. Two roundings move the
// quotient by at most (2^22 + 1) 2^-23 / period. If the number is no multiple, the quotient lies
// at least 1 / period below the next whole number, and its floor is right. A multiple may come
// out short by one. Products and differences are whole numbers below 2^24, thus exact.
SOFTFOCUS_INLINE Floats whole_modulo(Floats whole, Floats period, Floats inverse) {
  const Floats rest = whole - floor(whole * inverse) * period;
  return select(rest >= period, rest - period, rest);
}

// Two neighbouring texels, the first as a whole number up to 2^22 + 1 in magnitude.
SOFTFOCUS_INLINE void wrap_standard(const AxisLanes& axis, Floats base, Ints& first, Ints& second) {
  const Ints size = truncate(axis.size);
  if (axis.wrap == Wrap::clamp_to_edge) {
    const Ints index = truncate(base);
    first = smaller(larger(index, splat(0)), size - 1);
    second = smaller(larger(index + 1, splat(0)), size - 1);
    return;
  }
  const bool mirrored = axis.wrap == Wrap::mirrored_repeat;
  const Ints last = (mirrored ? size + size : size) - 1;
  if (axis.levels.are_powers_of_two) {
    const Ints index = truncate(base);
    first = index & last;
    second = (index + 1) & last;
  } else {
    const float scale = mirrored ? 2.0f : 1.0f;
    const Floats inverse = look_up(axis.levels.inverses, axis.level) * (1.0f / scale);
    first = truncate(whole_modulo(base, axis.size * scale, inverse));
    second = select(first == last, splat(0), first + 1);
  }
  if (mirrored) {
    first = smaller(first, last - first);
    second = smaller(second, last - second);
  }
}

// A coordinate scaled to texels. Needs a finite one.
SOFTFOCUS_INLINE Floats standard_texels(const AxisLanes& axis) {
  return smaller(larger(axis.coordinate * axis.size, splat(-0x1p22f)), splat(0x1p22f));
}

SOFTFOCUS_INLINE TapLanes standard_taps(const AxisLanes& axis, bool fixed_8) {
  Floats position = standard_texels(axis) - 0.5f;
  if (fixed_8) position = nearest(position * 256.0f) * (1.0f / 256.0f);
  const Floats base = floor(position);
  TapLanes taps;
  wrap_standard(axis, base, taps.first, taps.second);
  taps.weight = position - base;
  return taps;
}

SOFTFOCUS_INLINE Ints standard_nearest(const AxisLanes& axis) {
  Ints first, second;
  wrap_standard(axis, floor(standard_texels(axis)), first, second);
  return first;
}

// A triangle wave: 0 at even numbers, 1 at odd ones. NaN counts as 0.
SOFTFOCUS_INLINE Floats mirror(Floats coordinate) {
  const Floats half = coordinate * 0.5f;
  const Floats rest = half - nearest(half);
  return larger(absolute(rest + rest), splat(0.0f));
}

SOFTFOCUS_INLINE TapLanes llvmpipe_taps(const AxisLanes& axis) {
  const Ints size = truncate(axis.size);
  if (axis.wrap == Wrap::repeat && axis.levels.base_is_power_of_two) {
    const Floats position = axis.coordinate * axis.size - 0.5f;
    const Floats base = floor(position);
    const Bits index = as_bits(truncate_to_int(base));
    const Bits mask = as_bits(size - 1);
    return {as_ints(index & mask), as_ints((index + 1u) & mask), position - base};
  }
  if (axis.wrap == Wrap::repeat) {
    const Floats fraction = axis.coordinate - floor(axis.coordinate);
    const Floats position = fraction * axis.size - 0.5f;
    const Floats base = floor(position);
    const Mask inside = position >= 0.0f;
    const Ints first = select(inside, truncate(select(inside, base, splat(0.0f))), size - 1);
    return {first, select(first == size - 1, splat(0), first + 1), position - base};
  }
  if (axis.wrap == Wrap::clamp_to_edge) {
    const Floats scaled = smaller(axis.coordinate * axis.size, axis.size);
    const Floats position = larger(scaled - 0.5f, splat(0.0f));
    const Floats base = floor(position);
    const Ints first = truncate(base);
    return {first, smaller(first + 1, size - 1), position - base};
  }
  const Floats position = mirror(axis.coordinate) * axis.size - 0.5f;
  const Floats base = floor(position);
  const Ints index = truncate(base);
  return {larger(index, splat(0)), smaller(index + 1, size - 1), position - base};
}

SOFTFOCUS_INLINE Ints llvmpipe_nearest(const AxisLanes& axis) {
  const Ints size = truncate(axis.size);
  const Floats scaled = axis.coordinate * axis.size;
  if (axis.wrap == Wrap::repeat && axis.levels.base_is_power_of_two) {
    return truncate_to_int(floor(scaled)) & (size - 1);
  }
  if (axis.wrap == Wrap::repeat) {
    const Floats fraction = axis.coordinate - floor(axis.coordinate);
    return truncate(smaller(fraction, splat(1.0f - 0x1p-24f)) * axis.size);
  }
  if (axis.wrap == Wrap::clamp_to_edge) {
    return smaller(larger(truncate_to_int(scaled), splat(0)), size - 1);
  }
  return smaller(truncate(mirror(axis.coordinate) * axis.size), size - 1);
}

SOFTFOCUS_INLINE Floats swiftshader_coordinate(const AxisLanes& axis) {
  const Floats u = axis.coordinate;
  const Floats most = splat(1.0f - 0x1p-24f);
  if (axis.wrap == Wrap::clamp_to_edge) return smaller(larger(u, splat(0.0f)), most);
  if (axis.wrap == Wrap::repeat) return smaller(u - floor(u), most);
  return smaller(absolute(u - 2.0f * nearest(u * 0.5f)), most);
}

SOFTFOCUS_INLINE TapLanes swiftshader_taps(const AxisLanes& axis) {
  const Ints last = truncate(axis.size) - 1;
  const Floats position = swiftshader_coordinate(axis) * axis.size - 0.5f;
  const Floats base = floor(position);
  const Ints first = truncate(base);
  const bool repeats = axis.wrap == Wrap::repeat;
  return {select(first < 0, repeats ? last : splat(0), first),
          select(first < last, first + 1, repeats ? splat(0) : last), position - base};
}

SOFTFOCUS_INLINE Ints swiftshader_nearest(const AxisLanes& axis) {
  return truncate(swiftshader_coordinate(axis) * axis.size);
}

SOFTFOCUS_INLINE Ints swiftshader_nearest_byte(const AxisLanes& axis) {
  const Ints size = truncate(axis.size);
  if (axis.wrap == Wrap::clamp_to_edge) {
    const Floats inside = smaller(larger(axis.coordinate, splat(0.0f)), splat(65535.0f / 65536.0f));
    return truncate(inside * 65536.0f) * size >> 16;
  }
  Ints position = truncate_to_int(axis.coordinate * 65536.0f);
  if (axis.wrap == Wrap::mirrored_repeat) {
    position = select((position & 0x10000) != 0, ~position, position);
  }
  return (position & 0xFFFF) * size >> 16;
}

// Taps of integer_filter.cpp, which repeat or clamp; weights are multiples of 1/256.
SOFTFOCUS_INLINE TapLanes unorm8_taps(const AxisLanes& axis) {
  const Ints size = truncate(axis.size);
  Floats position_256;
  if (axis.wrap == Wrap::repeat && !axis.levels.base_is_power_of_two) {
    position_256 = ((axis.coordinate - floor(axis.coordinate)) * axis.size) * 256.0f;
  } else {
    position_256 = axis.coordinate * (axis.size * 256.0f);
  }
  // Positions that no integer holds wrap round to the far end here.
  const Ints position = as_ints(as_bits(round_to_int(position_256)) - 128u);
  const Floats weight = to_floats(position & 255) * (1.0f / 256.0f);
  const Ints index = position >> 8;
  if (axis.wrap == Wrap::clamp_to_edge) {
    const Ints first = smaller(larger(index, splat(0)), size - 1);
    const Mask inside = (index >= 0) & (index < size - 1);
    return {first, select(inside, index + 1, first), weight};
  }
  if (axis.levels.base_is_power_of_two)
    return {index & (size - 1), (index + 1) & (size - 1), weight};
  const Ints first = select(index < 0, size - 1, smaller(index, size - 1));
  return {first, select(first == size - 1, splat(0), first + 1), weight};
}

/// Texels along a face of a cube, from -1 to `size`: a face has a border of its neighbours'.
SOFTFOCUS_INLINE TapLanes face_taps(Floats at, Floats size, bool fixed_8) {
  Floats position = at * size - 0.5f;
  if (fixed_8) position = nearest(position * 256.0f) * (1.0f / 256.0f);
  const Floats base = floor(position);
  const Ints first = truncate(base);
  return {first, first + 1, position - base};
}
