#include "raster/images/integer_filter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "raster/images/sliced_texture.h"
#include "raster/numbers/fixed_point.h"
#include "raster/numbers/half.h"
#include "raster/numbers/lerp.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
namespace {

// A position in 24.8 fixed point, less half a texel. Values that no integer holds come out at
// the far end, whatever their sign: x86 converts them to the least integer, and the subtraction
// wraps round.
std::int32_t less_half_texel(float position_256) { return from_centre(round_to_int(position_256)); }

// `size` is the level's; `base_size`, level 0's, chooses the path.
IntegerTaps taps8(float coordinate, int size, int base_size, Wrap wrap) {
  const auto length = static_cast<float>(size);
  if (wrap == Wrap::repeat && !std::has_single_bit(static_cast<unsigned>(base_size))) {
    const float fraction = coordinate - std::floor(coordinate);
    const std::int32_t position = less_half_texel((fraction * length) * 256.0f);
    const int index = position >> 8;
    const int first = index < 0 ? size - 1 : std::min(index, size - 1);
    return {first, first == size - 1 ? 0 : first + 1, position & 255};
  }
  const std::int32_t position = less_half_texel(coordinate * static_cast<float>(size * 256));
  return wrap == Wrap::repeat ? repeated_taps(position, size) : clamped_taps(position, size);
}

using Texel8 = std::array<int, 4>;

Texel8 load(const Image& image, int x, int y) {
  const auto bytes = row<std::uint8_t>(image, y);
  const auto index = static_cast<std::size_t>(x);
  if (image.format == Format::r8) return {bytes[index], 0, 0, 255};
  return {bytes[4 * index], bytes[4 * index + 1], bytes[4 * index + 2], bytes[4 * index + 3]};
}

Texel8 lerp4(const Texel8& a, const Texel8& b, int weight) {
  Texel8 result{};
  for (std::size_t i = 0; i < 4; ++i) result[i] = lerp_unorm8(a[i], b[i], weight);
  return result;
}

/// Of slices that lie about a place of a volume's level.
template <class Slice>
Texel8 mix_slices(const Texture& volume, const Sampler& sampler, float w, std::size_t level,
                  const Slice& slice) {
  const IntegerTaps taps =
      taps8(w, slice_count(volume, level), slice_count(volume), sampler.wrap_w);
  return lerp4(slice(slice_level(volume, taps.first, level)),
               slice(slice_level(volume, taps.second, level)), taps.weight);
}

Texel8 bilinear(const Image& image, const Image& base, const Sampler& sampler, glm::vec2 uv) {
  const IntegerTaps u = taps8(uv.x, image.width, base.width, sampler.wrap_u);
  const IntegerTaps v = taps8(uv.y, image.height, base.height, sampler.wrap_v);
  const auto along_row = [&](int y) {
    return lerp4(load(image, u.first, y), load(image, u.second, y), u.weight);
  };
  return lerp4(along_row(v.first), along_row(v.second), v.weight);
}

}  // namespace

bool is_filtered_in_integers(Format format, const Sampler& sampler) {
  const auto has_path = [](Wrap wrap) {
    return wrap == Wrap::repeat || wrap == Wrap::clamp_to_edge;
  };
  return (format == Format::r8 || format == Format::rgba8) && has_path(sampler.wrap_u) &&
         has_path(sampler.wrap_v);
}

glm::vec4 sample_slices_unorm8(const Texture& texture, const Sampler& sampler, glm::vec3 at,
                               std::size_t level, float next_weight) {
  const auto slice = [&](const Image& image) {
    return bilinear(image, texture.levels[0], sampler, {at.x, at.y});
  };
  const auto of_level = [&](std::size_t number) {
    return texture.shape == TextureShape::volume ? mix_slices(texture, sampler, at.z, number, slice)
                                                 : slice(texture.levels[number]);
  };
  Texel8 colour = of_level(level);
  const int weight = static_cast<int>(next_weight * 256.0f);
  if (weight > 0) colour = lerp4(colour, of_level(level + 1), weight);
  const auto decode = [&](std::size_t i) {
    return unorm8_by_reciprocal(static_cast<std::uint8_t>(colour[i]));
  };
  return {decode(0), decode(1), decode(2), decode(3)};
}

namespace {

// One channel of the four texels, the upper ones first.
template <class Number>
std::array<Number, 4> corners(const IntegerFetch& fetch, int channel) {
  const int channels = channel_count(fetch.level->format);
  const auto left = static_cast<std::size_t>(fetch.u.first * channels + channel);
  const auto right = static_cast<std::size_t>(fetch.u.second * channels + channel);
  const auto upper = row<Number>(*fetch.level, fetch.v.first);
  const auto lower = row<Number>(*fetch.level, fetch.v.second);
  return {upper[left], upper[right], lower[left], lower[right]};
}

std::uint32_t sum_bytes(const IntegerFetch& fetch, int channel) {
  const auto c = corners<std::uint8_t>(fetch, channel);
  return static_cast<std::uint32_t>(
      bilinear_sum_unorm8(c[0], c[1], c[2], c[3], fetch.u.weight, fetch.v.weight));
}

float filter_bytes(const IntegerFetch& fine, const IntegerFetch& coarse, int next_weight,
                   int channel) {
  const auto weight = static_cast<std::uint32_t>(next_weight);
  std::uint32_t sum = sum_bytes(fine, channel) * (256u - weight);  // at most 255 2^24 < 2^32
  if (weight > 0) sum += sum_bytes(coarse, channel) * weight;
  return static_cast<float>(sum) * 0x1p-24f / 255.0f;
}

using Halves = std::array<std::uint16_t, 4>;

bool are_finite(const Halves& c) { return std::all_of(c.begin(), c.end(), is_finite_half); }

std::int64_t sum_halves(const Halves& c, const IntegerFetch& fetch) {
  return bilinear_sum_half(c[0], c[1], c[2], c[3], fetch.u.weight, fetch.v.weight);
}

float mix(float a, float b, int weight_256, const Profile& profile) {
  return lerp(a, b, static_cast<float>(weight_256) * (1.0f / 256.0f), profile.lerp);
}

float mix_in_floats(const Halves& c, const IntegerFetch& fetch, const Profile& profile) {
  const float upper = mix(half_to_float(c[0]), half_to_float(c[1]), fetch.u.weight, profile);
  const float lower = mix(half_to_float(c[2]), half_to_float(c[3]), fetch.u.weight, profile);
  return mix(upper, lower, fetch.v.weight, profile);
}

float filter_halves(const IntegerFetch& fine, const IntegerFetch& coarse, int next_weight,
                    int channel, const Profile& profile) {
  const Halves first = corners<std::uint16_t>(fine, channel);
  const Halves next = next_weight > 0 ? corners<std::uint16_t>(coarse, channel) : Halves{};
  if (are_finite(first) && are_finite(next)) {
    return std::bit_cast<float>(
        mix_sums_half(sum_halves(first, fine), sum_halves(next, coarse), next_weight));
  }
  const float value = mix_in_floats(first, fine, profile);
  if (next_weight == 0) return value;
  return mix(value, mix_in_floats(next, coarse, profile), next_weight, profile);
}

}  // namespace

bool has_integer_filter(Format format, const Profile& profile) {
  return profile.texture_unit == TextureUnit::standard &&
         profile.bilinear_filter == BilinearFilter::integers &&
         (format == Format::r8 || format == Format::rgba8 || format == Format::rgba16f);
}

glm::vec4 filter_in_integers(const IntegerFetch& fine, const IntegerFetch& coarse, int next_weight,
                             const Profile& profile) {
  const Format format = fine.level->format;
  assert(format == Format::r8 || format == Format::rgba8 || format == Format::rgba16f);
  glm::vec4 value{0.0f, 0.0f, 0.0f, 1.0f};
  for (int channel = 0; channel < channel_count(format); ++channel) {
    value[channel] = format == Format::rgba16f
                         ? filter_halves(fine, coarse, next_weight, channel, profile)
                         : filter_bytes(fine, coarse, next_weight, channel);
  }
  return value;
}

}  // namespace softfocus
