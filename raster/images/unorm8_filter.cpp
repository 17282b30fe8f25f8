#include "raster/images/unorm8_filter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "raster/numbers/float_to_int.h"
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

glm::vec4 sample_unorm8(const Texture& texture, const Sampler& sampler, glm::vec2 uv,
                        std::size_t level, float next_weight) {
  Texel8 colour = bilinear(texture.levels[level], texture.levels[0], sampler, uv);
  const int weight = static_cast<int>(next_weight * 256.0f);
  if (weight > 0) {
    const Image& next = texture.levels[level + 1];
    colour = lerp4(colour, bilinear(next, texture.levels[0], sampler, uv), weight);
  }
  const auto decode = [&](std::size_t i) {
    return unorm8_by_reciprocal(static_cast<std::uint8_t>(colour[i]));
  };
  return {decode(0), decode(1), decode(2), decode(3)};
}

}  // namespace softfocus
