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
bool stay_whole(Format format, const Profile& profile) {
  if (profile.texture_unit == TextureUnit::swiftshader) return is_8_bit(format);
  const bool may_be =
      profile.texture_unit == TextureUnit::llvmpipe || has_integer_filter(format, profile);
  return may_be && (format == Format::r8 || format == Format::rgba8);
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

void decode_8_bit(const Image& image, const Codes& codes, float* to) {
  for (int y = 0; y < image.height; ++y) {
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

void decode_floats(const Image& image, Isa isa, float* to) {
  if (image.format == Format::rgba16f && isa != Isa::scalar) {
    const std::size_t count = 4 * static_cast<std::size_t>(image.width);
    for (int y = 0; y < image.height; ++y) {
      decode_halves(isa, row<std::uint16_t>(image, y).data(), count, to);
      to += count;
    }
    return;
  }
  for (int y = 0; y < image.height; ++y) {
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

std::size_t texel_floats(const Image& image) {
  return 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

}  // namespace

DecodedTexture decode_texture(const Texture& texture, const Profile& profile, Isa isa) {
  assert(!texture.levels.empty());
  DecodedTexture decoded;
  decoded.source = &texture;
  decoded.level_count = static_cast<int>(texture.levels.size());
  if (profile.texture_unit == TextureUnit::softpipe || texture.levels.size() > kMaxDecodedLevels) {
    return decoded;
  }
  const bool is_flat = texture.shape == TextureShape::flat;
  if (!is_flat && flushes_texels(texture.levels[0].format, profile)) return decoded;
  std::size_t floats = 0;
  for (std::size_t i = 0; i < texture.levels.size(); ++i) {
    const Image& image = texture.levels[i];
    decoded.starts[i] = static_cast<std::int32_t>(floats);
    add_level(decoded.u, i, image.width);
    add_level(decoded.v, i, image.height);
    floats += texel_floats(image) * static_cast<std::size_t>(slice_count(texture, i));
  }
  if (floats > std::numeric_limits<std::int32_t>::max()) return decoded;
  decoded.texels.resize(floats);

  const Format format = texture.levels[0].format;
  decoded.are_whole = is_flat && stay_whole(format, profile);
  const Codes codes = is_8_bit(format) ? codes_for(format, decoded.are_whole, profile) : Codes{};
  for (std::size_t i = 0; i < texture.levels.size(); ++i) {
    float* to = decoded.texels.data() + decoded.starts[i];
    for (int slice = 0; slice < slice_count(texture, i); ++slice) {
      const Image& image = slice_level(texture, slice, i);
      if (is_8_bit(format)) {
        decode_8_bit(image, codes, to);
      } else {
        decode_floats(image, isa, to);
      }
      to += texel_floats(image);
    }
  }
  return decoded;
}

LaneArithmetic lane_arithmetic(const DecodedTexture& texture, const Sampler& sampler,
                               const Profile& profile) {
  if (texture.texels.empty()) return LaneArithmetic::by_sample;
  const Format format = texture.source->levels[0].format;
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
