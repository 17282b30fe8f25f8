#include "raster/images/decoded_texture.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>

#include "raster/images/integer_filter.h"
#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"
#include "raster/numbers/lerp.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
namespace {

bool is_8_bit(Format format) {
  return bytes_per_texel(format) == static_cast<std::size_t>(channel_count(format));
}

// Whether texels keep whole numbers, which are scaled after they are filtered. llvmpipe filters
// them in integers with most samplers.
bool stay_whole(const Texture& texture, const Profile& profile) {
  const Format format = texture.levels[0].format;
  const bool is_llvmpipe = profile.texture_unit == TextureUnit::llvmpipe;
  switch (texture.shape) {
    case TextureShape::cube: return false;
    case TextureShape::volume:
      if (!is_llvmpipe) return false;
      break;
    default: break;
  }
  if (profile.texture_unit == TextureUnit::swiftshader) return is_8_bit(format);
  return (is_llvmpipe || has_integer_filter(format, profile)) &&
         (format == Format::r8 || format == Format::rgba8);
}

// What fetch_texel() makes of each byte, in colours and in alpha.
struct Codes {
  std::array<float, 256> colour;
  std::array<float, 256> alpha;
};

Codes decode_codes(Format format, const Profile& profile) {
  Image image = make_image(format, 1, 1);
  Codes codes{};
  for (std::size_t code = 0; code < 256; ++code) {
    for (std::uint8_t& channel : row<std::uint8_t>(image, 0)) {
      channel = static_cast<std::uint8_t>(code);
    }
    const glm::vec4 texel = fetch_texel(image, 0, 0, profile);
    codes.colour[code] = texel.x;
    codes.alpha[code] = texel.w;
  }
  return codes;
}

Codes codes_as_they_are() {
  Codes codes{};
  for (std::size_t code = 0; code < 256; ++code) codes.colour[code] = static_cast<float>(code);
  codes.alpha = codes.colour;
  return codes;
}

Codes codes_in_65280ths(Format format) {
  Codes codes{};
  for (std::size_t code = 0; code < 256; ++code) {
    codes.alpha[code] = static_cast<float>(256 * code);
    codes.colour[code] =
        format == Format::srgb8
            ? static_cast<float>(srgb8_in_65280ths(static_cast<std::uint8_t>(code)))
            : codes.alpha[code];
  }
  return codes;
}

Codes codes_for(Format format, bool are_whole, const Profile& profile) {
  if (!are_whole) return decode_codes(format, profile);
  return profile.texture_unit == TextureUnit::swiftshader ? codes_in_65280ths(format)
                                                          : codes_as_they_are();
}

/// Rows end with `gap` floats that are not written.
void decode_8_bit(const Image& image, const Codes& codes, std::size_t gap, float* to) {
  for (int y = 0; y < image.height; ++y, to += gap) {
    const auto bytes = row<std::uint8_t>(image, y);
    if (image.format == Format::r8) {
      for (const std::uint8_t byte : bytes) {
        *to++ = codes.colour[byte];
        *to++ = 0.0f;
        *to++ = 0.0f;
        *to++ = codes.alpha[255];
      }
      continue;
    }
    for (std::size_t i = 0; i < bytes.size(); i += 4) {
      *to++ = codes.colour[bytes[i]];
      *to++ = codes.colour[bytes[i + 1]];
      *to++ = codes.colour[bytes[i + 2]];
      *to++ = codes.alpha[bytes[i + 3]];
    }
  }
}

void decode_floats(const Image& image, Isa isa, std::size_t gap, float* to) {
  if (image.format == Format::rgba16f && isa != Isa::scalar) {
    const std::size_t count = 4 * static_cast<std::size_t>(image.width);
    for (int y = 0; y < image.height; ++y) {
      decode_halves(isa, row<std::uint16_t>(image, y).data(), count, to);
      to += count + gap;
    }
    return;
  }
  for (int y = 0; y < image.height; ++y, to += gap) {
    for (int x = 0; x < image.width; ++x) {
      const glm::vec4 texel = load_texel(image, x, y);
      for (int i = 0; i < 4; ++i) *to++ = texel[i];
    }
  }
}

/// Texels of 32 bits may be subnormal. Only sample() flushes them.
bool flushes_texels(Format format, const Profile& profile) {
  return profile.denormals == Denormals::flush &&
         (format == Format::r32f || format == Format::rgba32f);
}

void add_level(DecodedAxis& axis, std::size_t level, int size) {
  const bool is_power_of_two = std::has_single_bit(static_cast<unsigned>(size));
  axis.sizes[level] = static_cast<float>(size);
  axis.inverses[level] = 1.0f / axis.sizes[level];
  axis.are_powers_of_two = is_power_of_two && (level == 0 || axis.are_powers_of_two);
  if (level == 0) axis.base_is_power_of_two = is_power_of_two;
}

/// Texels that a row or column has besides its image's.
int border_of(const Texture& texture) { return texture.shape == TextureShape::cube ? 2 : 0; }

std::size_t texel_floats(const Image& image, int border) {
  return 4 * static_cast<std::size_t>(image.width + border) *
         static_cast<std::size_t>(image.height + border);
}

/// What lies round the faces of a cube's level; `texels` of the first face.
void decode_borders(float* texels, int size) {
  const std::ptrdiff_t row = 4 * (static_cast<std::ptrdiff_t>(size) + 2), face = row * (size + 2);
  const auto at = [&](const CubeTexel& of) {
    return texels + of.face * face + of.y * row + 4 * static_cast<std::ptrdiff_t>(of.x);
  };
  for (int number = 0; number < 6; ++number) {
    for (int i = 0; i < size; ++i) {
      for (const CubeTexel& to : {CubeTexel{number, -1, i}, CubeTexel{number, size, i},
                                  CubeTexel{number, i, -1}, CubeTexel{number, i, size}}) {
        std::copy_n(at(cube_texel(to, size)), 4, at(to));
      }
    }
  }
  for (int corner = 0; corner < 24; ++corner) {
    const CubeTexel to{corner / 4, corner % 2 == 0 ? -1 : size, corner % 4 < 2 ? -1 : size};
    const int left = std::min(to.x, size - 1), upper = std::min(to.y, size - 1);
    std::array<const float*, 4> four{};
    std::size_t count = 0;
    for (const int y : {upper, upper + 1}) {
      for (const int x : {left, left + 1}) {
        if (x != to.x || y != to.y) four[count++] = at({to.face, x, y});
      }
    }
    for (int i = 0; i < 4; ++i) {
      at(to)[i] = ((four[0][i] + four[1][i]) + four[2][i]) * (1.0f / 3.0f);
    }
  }
}

}  // namespace

DecodedTexture decode_texture(const Texture& texture, const Profile& profile, Isa isa) {
  assert(!texture.levels.empty());
  DecodedTexture decoded;
  decoded.source = &texture;
  decoded.level_count = static_cast<int>(texture.levels.size());
  // Levels of detail need it also of a texture that is not decoded.
  add_level(decoded.u, 0, texture.levels[0].width);
  add_level(decoded.v, 0, texture.levels[0].height);
  const float width = decoded.u.sizes[0], height = decoded.v.sizes[0];
  decoded.quad_sizes = {width, width, height, height};
  const bool has_own_filter =
      texture.shape == TextureShape::flat || texture.shape == TextureShape::array;
  if (has_own_filter && profile.texture_unit == TextureUnit::softpipe) return decoded;
  if (texture.levels.size() > kMaxDecodedLevels) return decoded;
  const int border = border_of(texture);
  std::size_t floats = 0;
  for (std::size_t i = 0; i < texture.levels.size(); ++i) {
    const Image& image = texture.levels[i];
    // A cube's first texel lies behind a row and a texel of its border.
    decoded.starts[i] =
        static_cast<std::int32_t>(floats) + (border > 0 ? 4 * (image.width + 3) : 0);
    add_level(decoded.u, i, image.width);
    add_level(decoded.v, i, image.height);
    add_level(decoded.w, i, slice_count(texture, i));
    floats += texel_floats(image, border) * static_cast<std::size_t>(slice_count(texture, i));
  }
  if (floats > std::numeric_limits<std::int32_t>::max()) return decoded;
  decoded.texels = make_row_memory<float>(floats);

  const Format format = texture.levels[0].format;
  decoded.are_whole = stay_whole(texture, profile);
  const Codes codes = is_8_bit(format) ? codes_for(format, decoded.are_whole, profile) : Codes{};
  for (std::size_t i = 0; i < texture.levels.size(); ++i) {
    float* to = decoded.texels.get() + decoded.starts[i];
    for (int slice = 0; slice < slice_count(texture, i); ++slice) {
      const Image& image = slice_level(texture, slice, i);
      const std::size_t gap = 4 * static_cast<std::size_t>(border);
      if (is_8_bit(format)) {
        decode_8_bit(image, codes, gap, to);
      } else {
        decode_floats(image, isa, gap, to);
      }
      to += texel_floats(image, border);
    }
    if (border > 0) {
      decode_borders(decoded.texels.get() + decoded.starts[i], texture.levels[i].width);
    }
  }
  return decoded;
}

namespace {

/// Of volumes and cubes, which no unit but llvmpipe's filters in a way of its own.
LaneArithmetic slice_arithmetic(const Texture& texture, const Sampler& sampler,
                                const Profile& profile) {
  const bool is_fused = profile.lerp == Contraction::fused;
  const bool has_fixed_weights = profile.bilinear_weights == BilinearWeights::fixed_8;
  const bool flushes = profile.denormals == Denormals::flush;
  if (profile.texture_unit == TextureUnit::llvmpipe) {
    if (!flushes || has_fixed_weights) return LaneArithmetic::by_sample;
    const auto in_floats =
        is_fused ? LaneArithmetic::llvmpipe_fused : LaneArithmetic::llvmpipe_unfused;
    if (sampler.filter == Filter::nearest || !stay_whole(texture, profile)) return in_floats;
    return is_filtered_in_integers(texture.levels[0].format, sampler) &&
                   sampler.wrap_w != Wrap::mirrored_repeat
               ? LaneArithmetic::llvmpipe_integers
               : LaneArithmetic::by_sample;
  }
  if (is_fused) return LaneArithmetic::by_sample;
  if (profile.texture_unit != TextureUnit::standard && flushes) {
    return has_fixed_weights ? LaneArithmetic::by_sample : LaneArithmetic::standard_flushed;
  }
  return has_fixed_weights ? LaneArithmetic::standard_fixed_8 : LaneArithmetic::standard;
}

}  // namespace

LaneArithmetic lane_arithmetic(const DecodedTexture& texture, const Sampler& sampler,
                               const Profile& profile) {
  if (texture.texels == nullptr) return LaneArithmetic::by_sample;
  const Format format = texture.source->levels[0].format;
  const TextureShape shape = texture.source->shape;
  if (shape == TextureShape::volume || shape == TextureShape::cube) {
    return flushes_texels(format, profile) ? LaneArithmetic::by_sample
                                           : slice_arithmetic(*texture.source, sampler, profile);
  }
  const bool fused = profile.lerp == Contraction::fused;
  if (profile.texture_unit == TextureUnit::standard) {
    if (fused) return LaneArithmetic::by_sample;
    if (texture.are_whole) return LaneArithmetic::standard_integers;
    if (sampler.filter != Filter::nearest && has_integer_filter(format, profile)) {
      return LaneArithmetic::by_sample;  // halves' sums do not fit in a float
    }
    return profile.bilinear_weights == BilinearWeights::fixed_8 ? LaneArithmetic::standard_fixed_8
                                                                : LaneArithmetic::standard;
  }
  if (profile.denormals == Denormals::keep || flushes_texels(format, profile)) {
    return LaneArithmetic::by_sample;
  }
  if (profile.texture_unit == TextureUnit::swiftshader) {
    return fused ? LaneArithmetic::by_sample : LaneArithmetic::swiftshader;
  }
  const auto in_floats = fused ? LaneArithmetic::llvmpipe_fused : LaneArithmetic::llvmpipe_unfused;
  if (sampler.filter == Filter::nearest || !texture.are_whole) return in_floats;
  return is_filtered_in_integers(format, sampler) ? LaneArithmetic::llvmpipe_integers
                                                  : LaneArithmetic::by_sample;
}

}  // namespace softfocus
