#include "raster/images/integer_filter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>

#include "raster/numbers/half.h"
#include "raster/numbers/lerp.h"

namespace softfocus {
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
