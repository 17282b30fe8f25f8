#include "raster/images/softpipe_sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "raster/images/texel.h"
#include "raster/numbers/lerp.h"

namespace softfocus {
namespace {

float fraction_of(float value) { return value - std::floor(value); }

// 1024 sizes make a little negative index positive; a larger one wraps round 2^32.
int repeat(std::int32_t index, int size) {
  const auto length = static_cast<std::uint32_t>(size);
  return static_cast<int>((static_cast<std::uint32_t>(index) + 1024 * length) % length);
}

struct Place {
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
Place place_in_cache(const Image& image, int x, int y, const Taps& u, const Taps& v) {
  const bool one_tile = u.first / kTile == u.second / kTile && v.first / kTile == v.second / kTile;
  if (one_tile) return {x, y};
  const int slot = slot_of(x / kTile, y / kTile);
  for (const int row : {v.second, v.first}) {
    for (const int column : {u.second, u.first}) {
      if (slot_of(column / kTile, row / kTile) != slot) continue;
      const Place place{column / kTile * kTile + x % kTile, row / kTile * kTile + y % kTile};
      const bool inside = place.x < image.width && place.y < image.height;
      return inside ? place : Place{x, y};
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
          const Place place = place_in_cache(image, x, y, u, v);
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

}  // namespace softfocus
