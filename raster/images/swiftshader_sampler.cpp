#include "raster/images/swiftshader_sampler.h"

#include <algorithm>
#include <cmath>

#include "raster/images/texel.h"
#include "raster/numbers/float_to_int.h"
#include "raster/numbers/lerp.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
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
