#pragma once
// Reads and writes one texel of any format as four floats. A one-channel format reads as
// (value, 0, 0, 1) and stores the first component, one of two channels (first, second, 0, 1),
// as in OpenGL.

#include <glm/vec4.hpp>
#include <limits>

#include "raster/images/image.h"
#include "raster/numbers/half.h"
#include "raster/numbers/lerp.h"
#include "raster/numbers/profile.h"
#include "raster/numbers/srgb.h"

namespace softfocus {

/// The format-known forms, for inner loops, of an Image or a view. `x` counts texels in the row.
template <Format format, class AnyImage>
glm::vec4 load_texel(const AnyImage& image, int x, int y) {
  const auto index = static_cast<std::size_t>(x) * static_cast<std::size_t>(channel_count(format));
  if constexpr (format == Format::r8) {
    return {unorm8_to_linear(row<std::uint8_t>(image, y)[index]), 0.0f, 0.0f, 1.0f};
  } else if constexpr (format == Format::r32f) {
    return {row<float>(image, y)[index], 0.0f, 0.0f, 1.0f};
  } else if constexpr (format == Format::rgba32f) {
    const auto* v = &row<float>(image, y)[index];
    return {v[0], v[1], v[2], v[3]};
  } else if constexpr (format == Format::rg16f) {
    const auto* v = &row<std::uint16_t>(image, y)[index];
    return {half_to_float(v[0]), half_to_float(v[1]), 0.0f, 1.0f};
  } else if constexpr (format == Format::rgba16f) {
    const auto* v = &row<std::uint16_t>(image, y)[index];
    return {half_to_float(v[0]), half_to_float(v[1]), half_to_float(v[2]), half_to_float(v[3])};
  } else {
    const auto* v = &row<std::uint8_t>(image, y)[index];
    const auto decode = format == Format::srgb8 ? srgb8_to_linear : unorm8_to_linear;
    return {decode(v[0]), decode(v[1]), decode(v[2]), unorm8_to_linear(v[3])};
  }
}

/// A value as a 32-bit float texel stores it: subnormals kept or flushed as the profile says,
/// every NaN as the same NaN (half.h says why).
inline float stored_float(float value, const Profile& profile) {
  if (value != value) return std::numeric_limits<float>::quiet_NaN();
  return flush_denormal(value, profile.denormals);
}

template <Format format, class AnyImage>
void store_texel(AnyImage&& image, int x, int y, glm::vec4 value, const Profile& profile) {
  const auto index = static_cast<std::size_t>(x) * static_cast<std::size_t>(channel_count(format));
  if constexpr (format == Format::r8) {
    row<std::uint8_t>(image, y)[index] = linear_to_unorm8(value.x, profile.unorm_store);
  } else if constexpr (format == Format::r32f) {
    row<float>(image, y)[index] = stored_float(value.x, profile);
  } else if constexpr (format == Format::rgba32f) {
    auto* v = &row<float>(image, y)[index];
    for (int i = 0; i < 4; ++i) v[i] = stored_float(value[i], profile);
  } else if constexpr (format == Format::rg16f || format == Format::rgba16f) {
    auto* v = &row<std::uint16_t>(image, y)[index];
    for (int i = 0; i < channel_count(format); ++i)
      v[i] = float_to_half(value[i], profile.half_store);
  } else {
    auto* v = &row<std::uint8_t>(image, y)[index];
    for (int i = 0; i < 3; ++i) {
      v[i] = format == Format::srgb8 ? linear_to_srgb8(value[i])
                                     : linear_to_unorm8(value[i], profile.unorm_store);
    }
    v[3] = linear_to_unorm8(value.w, profile.unorm_store);
  }
}

/// For any format. Needs 0 <= x < width, 0 <= y < height.
glm::vec4 load_texel(const Image& image, int x, int y);
void store_texel(Image& image, int x, int y, glm::vec4 value, const Profile& profile);

/// A filtered value with the channels that the format lacks set to 0, 0 and 1. Weights that are
/// NaN can have spoilt them.
inline glm::vec4 with_missing_channels(glm::vec4 value, Format format) {
  if (format == Format::rg16f) return {value.x, value.y, 0.0f, 1.0f};
  return channel_count(format) == 1 ? glm::vec4{value.x, 0.0f, 0.0f, 1.0f} : value;
}

/// A texel as the profile's texture unit decodes it (texelFetch in GLSL). The standard unit does
/// as load_texel; drivers' units decode 8-bit formats in their own ways.
glm::vec4 fetch_texel(const Image& image, int x, int y, const Profile& profile);

/// Sets every texel to `value`.
void clear_image(Image& image, glm::vec4 value, const Profile& profile);
/// Sets the texels x_begin <= x < x_end, y_begin <= y < y_end. Needs at least one.
void clear_image(Image& image, int x_begin, int y_begin, int x_end, int y_end, glm::vec4 value,
                 const Profile& profile);

}  // namespace softfocus
