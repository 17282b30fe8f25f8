#include "raster/images/llvmpipe_sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "raster/images/texel.h"
#include "raster/images/unorm8_filter.h"
#include "raster/numbers/float_to_int.h"
#include "raster/numbers/lerp.h"

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

// The level that a lod reads, and the weight of the next one.
struct Levels {
  std::size_t first;
  float next_weight;
};

Levels choose_levels(float lod, std::size_t level_count, Filter filter) {
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

}  // namespace

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
  const Levels levels = choose_levels(lod, texture.levels.size(), sampler.filter);

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

}  // namespace softfocus
