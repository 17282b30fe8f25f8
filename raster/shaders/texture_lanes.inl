// Steps that read textures, in lanes; shader_textures.cpp and sliced_samples.cpp have them a lane
// after the other. shader_lanes.cpp includes this.

namespace {

SOFTFOCUS_INLINE Bits bits_at(const std::byte* from) {
  Bits v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
SOFTFOCUS_INLINE void put_bits(std::byte* to, Bits v) { std::memcpy(to, &v, sizeof v); }

// --- differences in each four lanes: 0 1 above 2 3 ---

SOFTFOCUS_INLINE Floats along_x(Floats v) {
  const Mask upper = (lane_numbers() & 2) == 0;
  return select(upper, spread<1>(v) - spread<0>(v), spread<3>(v) - spread<2>(v));
}
SOFTFOCUS_INLINE Floats along_y(Floats v) {
  const Mask left = (lane_numbers() & 1) == 0;
  return select(left, spread<2>(v) - spread<0>(v), spread<3>(v) - spread<1>(v));
}

SOFTFOCUS_INLINE Ints numbers_of(const LaneSample::At& at, const LaneFrame& frame, int vector) {
  if (!at.is_there) return Ints{};
  return as_ints(bits_at(frame.memory + at.place + static_cast<std::size_t>(vector) * at.next));
}
SOFTFOCUS_INLINE void put_result(const LaneSample& sample, int channel, LaneFrame& frame,
                                 int vector, Bits v) {
  const LaneSample::At& at = sample.to[static_cast<std::size_t>(channel)];
  if (at.is_there) {
    put_bits(frame.memory + at.place + static_cast<std::size_t>(vector) * at.next, v);
  }
}

SOFTFOCUS_INLINE Floats floats_of(const LaneSample::At& at, const LaneFrame& frame, int vector) {
  return as_floats(as_bits(numbers_of(at, frame, vector)));
}

/// The first that a sample is made for, and the end.
SOFTFOCUS_INLINE std::pair<int, int> vectors_of(const LaneSample& sample, const LaneFrame& frame) {
  const LaneRange range = range_of(sample.vectors, frame);
  const auto first = static_cast<int>(range.first_bytes / sizeof(Bits));
  return {first, first + static_cast<int>(range.count)};
}

/// Where texelFetch reads a level: texels outside of it are 0.
struct FetchPlace {
  Ints x, y, slice;
  Mask inside;
};

SOFTFOCUS_INLINE FetchPlace fetch_place(const LaneSample& sample, const Image& level, int slices,
                                        const LaneFrame& frame, int vector) {
  FetchPlace place;
  place.x = numbers_of(sample.at[0], frame, vector) + numbers_of(sample.offset[0], frame, vector);
  place.y = numbers_of(sample.at[1], frame, vector) + numbers_of(sample.offset[1], frame, vector);
  place.inside = (Mask)(as_bits(place.x) < static_cast<std::uint32_t>(level.width)) &
                 (Mask)(as_bits(place.y) < static_cast<std::uint32_t>(level.height));
  place.slice = splat(0);
  if (sample.sample.shape == TextureShape::flat) return place;
  place.slice =
      numbers_of(sample.at[2], frame, vector) + numbers_of(sample.offset[2], frame, vector);
  place.inside &= (Mask)(as_bits(place.slice) < static_cast<std::uint32_t>(slices));
  return place;
}

/// Texels of halves of a flat texture.
void fetch_half_texels(const LaneSample& sample, const Image& level, LaneFrame& frame) {
  const auto stride = static_cast<std::int32_t>(level.stride_bytes / 8);
  const auto* texels = reinterpret_cast<const std::uint16_t*>(level.bytes.data());
  const auto [begin, end] = vectors_of(sample, frame);
  for (int vector = begin; vector < end; ++vector) {
    const auto [x, y, slice, inside] = fetch_place(sample, level, 1, frame, vector);
    HalfTexels found;
    const Ints in_row = splat(x[0]) + lane_numbers();
    if (all(inside & (x == in_row) & (y == splat(y[0])))) {
      found = load_half_texels(texels + 4 * (static_cast<std::ptrdiff_t>(y[0]) * stride + x[0]));
    } else {
      // Pairs of halves, the first in the low bits of little-endian machines.
      const Ints at = (y * stride + x) & inside;
      const auto* pairs = reinterpret_cast<const std::int32_t*>(texels);
      const IntPairs words = gather_pairs(pairs, at);
      const Bits first = as_bits(words.first & inside), second = as_bits(words.second & inside);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
      found = {first >> 16, first & 0xFFFFu, second >> 16, second & 0xFFFFu};
#else
      found = {first & 0xFFFFu, first >> 16, second & 0xFFFFu, second >> 16};
#endif
    }
    put_result(sample, 0, frame, vector, as_bits(half_to_float(found.r)));
    put_result(sample, 1, frame, vector, as_bits(half_to_float(found.g)));
    put_result(sample, 2, frame, vector, as_bits(half_to_float(found.b)));
    put_result(sample, 3, frame, vector, as_bits(half_to_float(found.a)));
  }
}

/// Texels that have been decoded. Not of cubes.
void fetch_decoded_texels(const LaneSample& sample, const DecodedTexture& texture,
                          std::size_t level, LaneFrame& frame) {
  const Image& image = texture.source->levels[level];
  const int slices = slice_count(*texture.source, level);
  const float* texels = texture.texels.get() + texture.starts[level];
  const auto [begin, end] = vectors_of(sample, frame);
  for (int vector = begin; vector < end; ++vector) {
    const auto [x, y, slice, inside] = fetch_place(sample, image, slices, frame, vector);
    const Ints at = (((slice * image.height + y) * image.width + x) * 4) & inside;
    for (int channel = 0; channel < 4; ++channel) {
      put_result(sample, channel, frame, vector, as_bits(gather(texels + channel, at, inside)));
    }
  }
}

/// Where a lane samples, of a side of a texture with that many texels.
SOFTFOCUS_INLINE Floats place_of(const LaneSample& sample, int axis, int size,
                                 const LaneFrame& frame, int vector) {
  const auto number = static_cast<std::size_t>(axis);
  if (!sample.at[number].is_there) return splat(0.5f);
  Floats at = as_floats(as_bits(numbers_of(sample.at[number], frame, vector)));
  if (sample.sample.dim == SpirvDim::one && axis == 1) at = splat(0.5f);
  if (sample.sample.dim == SpirvDim::rectangle) at = at / static_cast<float>(size);
  if (sample.offset[number].is_there) {
    at += to_floats(numbers_of(sample.offset[number], frame, vector)) / static_cast<float>(size);
  }
  return at;
}

// One level for all of a block, as GPUs have it.
SOFTFOCUS_INLINE Floats along_row(Floats v, bool lower) {
  return lower ? spread<3>(v) - spread<2>(v) : spread<1>(v) - spread<0>(v);
}
SOFTFOCUS_INLINE Floats along_left_column(Floats v) { return spread<2>(v) - spread<0>(v); }

SOFTFOCUS_INLINE Vec3Lanes along_row(const Vec3Lanes& v, bool lower) {
  return {along_row(v.x, lower), along_row(v.y, lower), along_row(v.z, lower)};
}
SOFTFOCUS_INLINE Vec3Lanes along_left_column(const Vec3Lanes& v) {
  return {along_left_column(v.x), along_left_column(v.y), along_left_column(v.z)};
}

/// The level for differences to the next pixels. llvmpipe's of a cube is a pixel's own, of its
/// face, row and column.
SOFTFOCUS_INLINE Floats level_in_block(const LaneSample& sample, const DecodedTexture& texture,
                                       const LaneFrame& frame, int vector) {
  const Profile& profile = *frame.profile;
  const bool lower = profile.attributes == AttributeSetup::planes_by_quad;
  const Vec3Lanes at{floats_of(sample.at[0], frame, vector), floats_of(sample.at[1], frame, vector),
                     floats_of(sample.at[2], frame, vector)};
  const TextureShape shape = sample.sample.shape;
  if (shape == TextureShape::flat || shape == TextureShape::array) {
    if (!lower) return level_of_detail_of_quads(texture, profile, at.x, at.y);
    return level_of_detail_lanes(texture, profile, along_row(at.x, true), along_row(at.y, true),
                                 along_left_column(at.x), along_left_column(at.y));
  }
  if (shape == TextureShape::cube && profile.texture_unit == TextureUnit::llvmpipe) {
    return sliced_level_of_detail_lanes(texture, profile, at,
                                        {along_x(at.x), along_x(at.y), along_x(at.z)},
                                        {along_y(at.x), along_y(at.y), along_y(at.z)});
  }
  return sliced_level_of_detail_lanes(texture, profile,
                                      {spread<0>(at.x), spread<0>(at.y), spread<0>(at.z)},
                                      along_row(at, lower), along_left_column(at));
}

SOFTFOCUS_INLINE Floats level_by_gradients(const LaneSample& sample, const DecodedTexture& texture,
                                           const LaneFrame& frame, int vector) {
  const auto& more = sample.more;
  if (sample.sample.shape == TextureShape::flat) {
    return level_of_detail_lanes(texture, *frame.profile, floats_of(more[0], frame, vector),
                                 floats_of(more[1], frame, vector),
                                 floats_of(more[3], frame, vector),
                                 floats_of(more[4], frame, vector));
  }
  return sliced_level_of_detail_lanes(
      texture, *frame.profile,
      {floats_of(sample.at[0], frame, vector), floats_of(sample.at[1], frame, vector),
       floats_of(sample.at[2], frame, vector)},
      {floats_of(more[0], frame, vector), floats_of(more[1], frame, vector),
       floats_of(more[2], frame, vector)},
      {floats_of(more[3], frame, vector), floats_of(more[4], frame, vector),
       floats_of(more[5], frame, vector)});
}

SOFTFOCUS_INLINE Floats level_of(const LaneSample& sample, const ShaderTexture& from,
                                 const LaneFrame& frame, int vector) {
  switch (sample.sample.kind) {
    case SampleKind::level: return floats_of(sample.more[0], frame, vector);
    case SampleKind::gradient: return level_by_gradients(sample, *from.decoded, frame, vector);
    default: break;
  }
  if (from.texture->levels.size() == 1) return splat(0.0f);
  return level_in_block(sample, *from.decoded, frame, vector) +
         floats_of(sample.more[0], frame, vector);
}

SOFTFOCUS_INLINE Mask comparison(Compare function, Floats given, Floats stored) {
  switch (function) {
    case Compare::never: return (given != given) & (given == given);
    case Compare::less: return given < stored;
    case Compare::equal: return given == stored;
    case Compare::less_equal: return given <= stored;
    case Compare::greater: return given > stored;
    case Compare::not_equal: return given != stored;
    case Compare::greater_equal: return given >= stored;
    case Compare::always: break;
  }
  return (given != given) | (given == given);
}

/// Filtered texels, by the profile's texture unit.
void sample_texels(const LaneSample& sample, const ShaderTexture& from, LaneFrame& frame) {
  alignas(64) std::array<float, kMostSampled * kLanes> u, v, w, lod;
  std::array<RgbaLanes, kMostSampled> colours;
  const Image& base = from.texture->levels.front();
  const bool is_flat = sample.sample.shape == TextureShape::flat;
  const int slices = slice_count(*from.texture);
  auto [first, end] = vectors_of(sample, frame);
  for (; first < end; first += kMostSampled) {
    const int count = std::min(kMostSampled, end - first);
    for (int i = 0; i < count; ++i) {
      store(u.data() + i * kLanes, place_of(sample, 0, base.width, frame, first + i));
      store(v.data() + i * kLanes, place_of(sample, 1, base.height, frame, first + i));
      if (!is_flat) store(w.data() + i * kLanes, place_of(sample, 2, slices, frame, first + i));
      store(lod.data() + i * kLanes, level_of(sample, from, frame, first + i));
    }
    sample_vectors(Isa::SOFTFOCUS_ISA, *from.decoded, from.sampler, *frame.profile,
                   {u.data(), v.data(), lod.data(), w.data()}, count, colours.data());
    for (int i = 0; i < count; ++i) {
      const RgbaLanes& colour = colours[static_cast<std::size_t>(i)];
      if (sample.compared.is_there) {
        const Mask passes =
            comparison(from.compare, floats_of(sample.compared, frame, first + i), colour.r);
        put_result(sample, 0, frame, first + i, as_bits(select(passes, splat(1.0f), splat(0.0f))));
        continue;
      }
      put_result(sample, 0, frame, first + i, as_bits(colour.r));
      put_result(sample, 1, frame, first + i, as_bits(colour.g));
      put_result(sample, 2, frame, first + i, as_bits(colour.b));
      put_result(sample, 3, frame, first + i, as_bits(colour.a));
    }
  }
}

/// Two neighbouring texels of a side, as gather_texels() has them.
struct GatheredTexels {
  Ints first, second;
};

SOFTFOCUS_INLINE GatheredTexels gathered_texels(const LaneSample& sample, int axis,
                                                const DecodedAxis& side, Wrap wrap,
                                                const LaneFrame& frame, int vector) {
  const Floats size = splat(side.sizes[0]);
  const Floats at = place_of(sample, axis, static_cast<int>(side.sizes[0]), frame, vector);
  const Floats finite = select(absolute(at) < __builtin_inff(), at, splat(0.0f));
  const Floats texels = smaller(larger(finite * size - 0.5f, splat(-0x1p22f)), splat(0x1p22f));
  GatheredTexels found;
  wrap_standard({side, wrap, at, splat(0), size}, floor(texels), found.first, found.second);
  return found;
}

/// gather_texels() in lanes.
void gather_decoded_texels(const LaneSample& sample, const ShaderTexture& from, LaneFrame& frame) {
  const DecodedTexture& texture = *from.decoded;
  const std::int32_t width = texture.source->levels.front().width;
  const bool compares = sample.compared.is_there;
  const float* texels =
      texture.texels.get() + texture.starts[0] + (compares ? 0 : sample.sample.channel);
  const auto [begin, end] = vectors_of(sample, frame);
  for (int vector = begin; vector < end; ++vector) {
    const auto x = gathered_texels(sample, 0, texture.u, from.sampler.wrap_u, frame, vector);
    const auto y = gathered_texels(sample, 1, texture.v, from.sampler.wrap_v, frame, vector);
    const Ints upper = y.first * width, lower = y.second * width;
    const Floats given = floats_of(sample.compared, frame, vector);
    const auto put = [&](int channel, Ints at) {
      Floats found = gather(texels, at * 4, (Mask)splat(-1));
      if (compares) {
        found = select(comparison(from.compare, given, found), splat(1.0f), splat(0.0f));
      }
      put_result(sample, channel, frame, vector, as_bits(found));
    };
    put(0, lower + x.first);
    put(1, lower + x.second);
    put(2, upper + x.second);
    put(3, upper + x.first);
  }
}

/// A texelFetch in lanes, of a level that all have; whether there is such a way.
SOFTFOCUS_INLINE bool fetch_texels(const LaneSample& sample, const ShaderTexture& from,
                                   LaneFrame& frame) {
  const SpirvDim dim = sample.sample.dim;
  if ((dim != SpirvDim::two && dim != SpirvDim::three) || sample.more[0].next != 0) return false;
  const std::int32_t level = numbers_of(sample.more[0], frame, 0)[0];
  if (level < 0 || level >= std::ssize(from.texture->levels)) return false;
  const Image& image = from.texture->levels[static_cast<std::size_t>(level)];
  if (image.format == Format::rgba16f && sample.sample.shape == TextureShape::flat) {
    fetch_half_texels(sample, image, frame);
    return true;
  }
  if (from.decoded == nullptr || from.decoded->are_whole || from.decoded->texels == nullptr) {
    return false;
  }
  fetch_decoded_texels(sample, *from.decoded, static_cast<std::size_t>(level), frame);
  return true;
}

void run_sample(const LaneStep& step, LaneFrame& frame) {
  const LaneSample& sample = frame.samples[step.place];
  const ShaderSample& of = sample.sample;
  const ShaderTexture* from = sample.texture.next == 0 ? texture_of(sample, frame) : nullptr;
  if (from == nullptr || of.is_integer) return sample_by_lane(sample, frame, kLanes);
  if (of.kind == SampleKind::fetch && fetch_texels(sample, *from, frame)) return;
  const bool filters = of.kind == SampleKind::implicit || of.kind == SampleKind::level ||
                       of.kind == SampleKind::gradient;
  if (filters && from->decoded != nullptr) return sample_texels(sample, *from, frame);
  const bool gathers = of.kind == SampleKind::gather && of.shape == TextureShape::flat;
  if (gathers && from->decoded != nullptr && !from->decoded->are_whole &&
      from->decoded->texels != nullptr) {
    return gather_decoded_texels(sample, *from, frame);
  }
  sample_by_lane(sample, frame, kLanes);
}

}  // namespace
