#include "raster/images/driver_samplers.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "raster/images/integer_filter.h"
#include "raster/images/texel.h"
#include "raster/numbers/fixed_point.h"
#include "raster/numbers/lerp.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
namespace {

bool is_power_of_two(int size) { return std::has_single_bit(static_cast<unsigned>(size)); }

// A triangle wave: 0 at even numbers, 1 at odd ones. NaN counts as 0.
float mirror(float coordinate) {
  const float half = coordinate * 0.5f;
  const float rest = half - std::nearbyint(half);
  const float distance = std::fabs(rest + rest);
  return distance > 0.0f ? distance : 0.0f;
}

}  // namespace

LevelChoice llvmpipe_levels(float lod, std::size_t level_count, Filter filter) {
  const auto last = static_cast<std::int32_t>(level_count - 1);
  if (filter != Filter::trilinear) {
    return {static_cast<std::size_t>(std::clamp(round_to_int(lod), 0, last)), 0.0f};
  }
  const float base = std::floor(lod);
  const std::int32_t level = truncate_to_int(base);
  if (level < 0) return {0, 0.0f};
  if (level >= last) return {static_cast<std::size_t>(last), 0.0f};
  return {static_cast<std::size_t>(level), lod - base};
}

Taps llvmpipe_taps(float coordinate, int size, int base_size, Wrap wrap) {
  const auto length = static_cast<float>(size);
  if (wrap == Wrap::repeat && is_power_of_two(base_size)) {
    const float position = coordinate * length - 0.5f;
    const float base = std::floor(position);
    const auto index = static_cast<unsigned>(truncate_to_int(base));
    const unsigned mask = static_cast<unsigned>(size) - 1;
    return {static_cast<int>(index & mask), static_cast<int>((index + 1) & mask), position - base};
  }
  if (wrap == Wrap::repeat) {
    const float position = (coordinate - std::floor(coordinate)) * length - 0.5f;
    const float base = std::floor(position);
    // NaN reads what lies left of 0: the last texel.
    const int first = position >= 0.0f ? static_cast<int>(base) : size - 1;
    return {first, first == size - 1 ? 0 : first + 1, position - base};
  }
  if (wrap == Wrap::clamp_to_edge) {
    const float scaled = coordinate * length;
    // NaN goes to the far end.
    const float position = std::max((scaled < length ? scaled : length) - 0.5f, 0.0f);
    const float base = std::floor(position);
    const int first = static_cast<int>(base);
    return {first, std::min(first + 1, size - 1), position - base};
  }
  const float position = mirror(coordinate) * length - 0.5f;
  const float base = std::floor(position);
  const int index = static_cast<int>(base);
  return {std::max(index, 0), std::min(index + 1, size - 1), position - base};
}

int llvmpipe_nearest(float coordinate, int size, int base_size, Wrap wrap) {
  const auto length = static_cast<float>(size);
  if (wrap == Wrap::repeat && is_power_of_two(base_size)) {
    return truncate_to_int(std::floor(coordinate * length)) & (size - 1);
  }
  if (wrap == Wrap::repeat) {
    constexpr float kBelowOne = 1.0f - 0x1p-24f;
    const float fraction = coordinate - std::floor(coordinate);
    return static_cast<int>((fraction < kBelowOne ? fraction : kBelowOne) * length);
  }
  if (wrap == Wrap::clamp_to_edge) {
    return std::clamp(truncate_to_int(coordinate * length), 0, size - 1);
  }
  return std::min(static_cast<int>(mirror(coordinate) * length), size - 1);
}

glm::vec4 sample_llvmpipe(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                          const Profile& profile) {
  const Image& base = texture.levels[0];
  // Only these can be subnormal, and only floor() tells them from 0.
  uv = {flush_denormal(uv.x, profile.denormals), flush_denormal(uv.y, profile.denormals)};
  lod = flush_denormal(lod, profile.denormals);
  const LevelChoice levels = llvmpipe_levels(lod, texture.levels.size(), sampler.filter);

  if (sampler.filter == Filter::nearest) {
    const Image& image = texture.levels[levels.first];
    return fetch_texel(image, llvmpipe_nearest(uv.x, image.width, base.width, sampler.wrap_u),
                       llvmpipe_nearest(uv.y, image.height, base.height, sampler.wrap_v), profile);
  }
  if (is_filtered_in_integers(base.format, sampler)) {
    return sample_unorm8(texture, sampler, uv, levels.first, levels.next_weight);
  }
  const auto mix = [&](float a, float b, float t) { return lerp(a, b, t, profile); };
  const auto bilinear = [&](const Image& image) {
    const glm::vec4 value = filter_bilinear(
        llvmpipe_taps(uv.x, image.width, base.width, sampler.wrap_u),
        llvmpipe_taps(uv.y, image.height, base.height, sampler.wrap_v),
        [&](int x, int y) { return fetch_texel(image, x, y, profile); }, mix);
    return with_missing_channels(value, image.format);
  };
  const glm::vec4 fine = bilinear(texture.levels[levels.first]);
  if (!(levels.next_weight > 0.0f)) return fine;
  return mix_components(fine, bilinear(texture.levels[levels.first + 1]), levels.next_weight, mix);
}

namespace {

float fraction_of(float value) { return value - std::floor(value); }

// 1024 sizes make a little negative index positive; a larger one wraps round 2^32.
int repeat(std::int32_t index, int size) {
  const auto length = static_cast<std::uint32_t>(size);
  return static_cast<int>((static_cast<std::uint32_t>(index) + 1024 * length) % length);
}

struct CachedPlace {
  int x;
  int y;
};

// The driver fetches through a cache of tiles of 32x32 texels, which has 16 slots. A tile fits
// one slot. A fetch keeps where its four texels lie in the cache, not their values. If two of
// its tiles have the same slot, the later tile's texels are read for both. This happens only at
// some corners of tiles on the seam of a repeating texture.
constexpr int kTile = 32;

int slot_of(int tile_x, int tile_y) { return (tile_x + 9 * tile_y) % 16; }

// The texel that is read for (x, y), one of the four. If it would lie outside the picture, the
// driver reads texels that an earlier tile left there, which depends on all fetches before;
// here (x, y) comes back.
CachedPlace place_in_cache(const Image& image, int x, int y, const Taps& u, const Taps& v) {
  const bool one_tile = u.first / kTile == u.second / kTile && v.first / kTile == v.second / kTile;
  if (one_tile) return {x, y};
  const int slot = slot_of(x / kTile, y / kTile);
  for (const int row : {v.second, v.first}) {
    for (const int column : {u.second, u.first}) {
      if (slot_of(column / kTile, row / kTile) != slot) continue;
      const CachedPlace place{column / kTile * kTile + x % kTile, row / kTile * kTile + y % kTile};
      const bool inside = place.x < image.width && place.y < image.height;
      return inside ? place : CachedPlace{x, y};
    }
  }
  return {x, y};
}

}  // namespace

std::int32_t softpipe_floor(float value) {
  if (value != value) return 0;          // the sums would be any NaN
  constexpr double kMagic = 12582912.5;  // 1.5 * 2^23 + 0.5
  const auto above = std::bit_cast<std::uint32_t>(static_cast<float>(kMagic + value));
  const auto below = std::bit_cast<std::uint32_t>(static_cast<float>(kMagic - value));
  return static_cast<std::int32_t>(above - below) >> 1;
}

Taps softpipe_taps(float coordinate, int size, Wrap wrap) {
  const auto length = static_cast<float>(size);
  if (wrap == Wrap::repeat) {
    const float position = coordinate * length - 0.5f;
    const int first = repeat(softpipe_floor(position), size);
    return {first, repeat(first + 1, size), fraction_of(position)};
  }
  if (wrap == Wrap::clamp_to_edge) {
    const float scaled = coordinate * length;
    const float position = (scaled > 0.0f ? std::min(scaled, length) : 0.0f) - 0.5f;
    const int index = softpipe_floor(position);
    return {std::max(index, 0), std::min(index + 1, size - 1), fraction_of(position)};
  }
  if ((softpipe_floor(coordinate) & 1) == 0) {
    const float position = fraction_of(coordinate) * length - 0.5f;
    const int index = softpipe_floor(position);
    return {std::clamp(index, 0, size - 1), std::min(index + 1, size - 1), fraction_of(position)};
  }
  // In odd cells the axis runs backwards, from the texel right of the position.
  const float position = (1.0f - fraction_of(coordinate)) * length + 0.5f;
  const int index = softpipe_floor(position);
  return {std::min(index, size - 1), std::clamp(index - 1, 0, size - 1),
          fraction_of(1.0f - position)};
}

int softpipe_nearest(float coordinate, int size, Wrap wrap) {
  const auto length = static_cast<float>(size);
  if (wrap == Wrap::repeat) return repeat(softpipe_floor(coordinate * length), size);
  if (wrap == Wrap::clamp_to_edge) {
    const float position = coordinate * length;
    if (position < 0.5f) return 0;
    return position > length - 0.5f ? size - 1 : softpipe_floor(position);
  }
  const float half_texel = 1.0f / (2.0f * length);
  const bool backwards = (softpipe_floor(coordinate) & 1) != 0;
  const float position = backwards ? 1.0f - fraction_of(coordinate) : fraction_of(coordinate);
  if (position < half_texel) return 0;
  return position > 1.0f - half_texel ? size - 1 : softpipe_floor(position * length);
}

glm::vec4 sample_softpipe(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                          const Profile& profile) {
  const Image& base = texture.levels[0];
  const std::size_t last = texture.levels.size() - 1;
  // The sampler's default range of lods; NaN goes to its start.
  const float level = lod > 0.0f ? std::min(lod, 1000.0f) : 0.0f;
  const std::size_t nearest_level = std::min(static_cast<std::size_t>(level + 0.5f), last);
  if (sampler.filter == Filter::nearest) {
    const Image& image = texture.levels[nearest_level];
    return fetch_texel(image, softpipe_nearest(uv.x, image.width, sampler.wrap_u),
                       softpipe_nearest(uv.y, image.height, sampler.wrap_v), profile);
  }

  // The driver's fast path: it takes the weight from softpipe_floor, and mixes level 1 into level
  // 0 with weight 0.
  const bool is_fast = std::has_single_bit(static_cast<unsigned>(base.width)) &&
                       std::has_single_bit(static_cast<unsigned>(base.height)) &&
                       sampler.wrap_u == Wrap::repeat && sampler.wrap_v == Wrap::repeat;
  const auto taps = [&](float coordinate, int size, Wrap wrap) {
    Taps result = softpipe_taps(coordinate, size, wrap);
    if (is_fast) {
      const float position = coordinate * static_cast<float>(size) - 0.5f;
      result.weight = position - static_cast<float>(softpipe_floor(position));
    }
    return result;
  };
  const auto mix = [&](float a, float b, float t) { return lerp(a, b, t, profile); };
  const auto bilinear = [&](const Image& image) {
    const Taps u = taps(uv.x, image.width, sampler.wrap_u);
    const Taps v = taps(uv.y, image.height, sampler.wrap_v);
    const glm::vec4 value = filter_bilinear(
        u, v,
        [&](int x, int y) {
          const CachedPlace place = place_in_cache(image, x, y, u, v);
          return fetch_texel(image, place.x, place.y, profile);
        },
        mix);
    return with_missing_channels(value, image.format);
  };
  if (sampler.filter == Filter::bilinear) return bilinear(texture.levels[nearest_level]);

  const auto fine = static_cast<std::size_t>(level);
  if (fine >= last) return bilinear(texture.levels[last]);
  if (level == 0.0f && !is_fast) return bilinear(base);
  return mix_components(bilinear(texture.levels[fine]), bilinear(texture.levels[fine + 1]),
                        fraction_of(level), mix);
}

namespace {

constexpr float kBelowOne = 1.0f - 0x1p-24f;
constexpr float kLargestLod = 1000.0f;  // a sampler's by default

// The cut as x86's MINPS makes it: NaN gives the second operand.
float below_one(float value) { return value < kBelowOne ? value : kBelowOne; }

float fraction_below_one(float value) { return below_one(value - std::floor(value)); }

bool holds_bytes(Format format) {
  return bytes_per_texel(format) == static_cast<std::size_t>(channel_count(format));
}

// In 65280ths: a byte, or what an sRGB byte encodes, times 256.
glm::vec4 load_whole(const Image& image, int x, int y) {
  const auto channels = static_cast<std::size_t>(channel_count(image.format));
  const std::uint8_t* bytes = &row<std::uint8_t>(image, y)[static_cast<std::size_t>(x) * channels];
  glm::vec4 result{};
  for (std::size_t i = 0; i < channels; ++i) {
    const bool encoded = image.format == Format::srgb8 && i < 3;
    result[static_cast<int>(i)] =
        static_cast<float>(encoded ? srgb8_in_65280ths(bytes[i]) : 256 * bytes[i]);
  }
  return result;
}

glm::vec4 sample_nearest_texel(const Image& image, const Sampler& sampler, glm::vec2 uv) {
  if (holds_bytes(image.format)) {
    return load_whole(image, swiftshader_nearest_byte(uv.x, image.width, sampler.wrap_u),
                      swiftshader_nearest_byte(uv.y, image.height, sampler.wrap_v));
  }
  return load_texel(image, swiftshader_nearest(uv.x, image.width, sampler.wrap_u),
                    swiftshader_nearest(uv.y, image.height, sampler.wrap_v));
}

}  // namespace

float swiftshader_coordinate(float coordinate, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return below_one(coordinate > 0.0f ? coordinate : 0.0f);
  if (wrap == Wrap::repeat) return fraction_below_one(coordinate);
  return below_one(std::fabs(coordinate - 2.0f * std::nearbyint(coordinate * 0.5f)));
}

Taps swiftshader_taps(float coordinate, int size, Wrap wrap) {
  const float position = swiftshader_coordinate(coordinate, wrap) * static_cast<float>(size) - 0.5f;
  const float base = std::floor(position);
  const int first = static_cast<int>(base);
  const bool repeats = wrap == Wrap::repeat;
  return {first < 0 ? (repeats ? size - 1 : 0) : first,
          first + 1 < size ? first + 1 : (repeats ? 0 : size - 1), position - base};
}

int swiftshader_nearest(float coordinate, int size, Wrap wrap) {
  return static_cast<int>(swiftshader_coordinate(coordinate, wrap) * static_cast<float>(size));
}

int swiftshader_nearest_byte(float coordinate, int size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) {
    const float low = coordinate > 0.0f ? coordinate : 0.0f;
    const auto position = static_cast<std::int32_t>(std::min(low, 65535.0f / 65536.0f) * 65536.0f);
    return position * size >> 16;
  }
  const auto position = static_cast<std::uint32_t>(truncate_to_int(coordinate * 65536.0f));
  const bool backwards = wrap == Wrap::mirrored_repeat && (position & 0x10000u) != 0;
  return static_cast<int>((backwards ? ~position : position) & 0xFFFFu) * size >> 16;
}

glm::vec4 sample_swiftshader(const Texture& texture, const Sampler& sampler, glm::vec2 uv,
                             float lod, const Profile& profile) {
  const Format format = texture.levels[0].format;
  const bool whole = holds_bytes(format);
  const auto last = static_cast<float>(texture.levels.size() - 1);
  // Only these can be subnormal, and only floor() tells them from 0.
  uv = {flush_denormal(uv.x, profile.denormals), flush_denormal(uv.y, profile.denormals)};
  const float level =
      flush_denormal(lod > 0.0f ? std::min(lod, kLargestLod) : 0.0f, profile.denormals);
  const auto image = [&](float index) -> const Image& {
    return texture.levels[static_cast<std::size_t>(std::min(index, last))];
  };
  const auto mix = [&](float a, float b, float t) { return lerp(a, b, t, profile); };
  const auto bilinear = [&](const Image& one) {
    return filter_bilinear(
        swiftshader_taps(uv.x, one.width, sampler.wrap_u),
        swiftshader_taps(uv.y, one.height, sampler.wrap_v),
        [&](int x, int y) { return whole ? load_whole(one, x, y) : load_texel(one, x, y); }, mix);
  };
  const auto filtered = [&] {
    if (sampler.filter == Filter::nearest) {
      return sample_nearest_texel(image(std::nearbyint(level)), sampler, uv);
    }
    if (sampler.filter == Filter::bilinear) return bilinear(image(std::nearbyint(level)));
    const float base = std::floor(level);
    return mix_components(bilinear(image(base)), bilinear(image(base + 1.0f)),
                          fraction_below_one(level), mix);
  };
  const glm::vec4 value = filtered();
  return with_missing_channels(whole ? value * (1.0f / 65280.0f) : value, format);
}

}  // namespace softfocus
