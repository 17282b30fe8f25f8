#include <array>
#include <bit>
#include <limits>
#include <string_view>

#include "raster/images/sampler.h"
#include "raster/images/texel.h"
#include "raster/numbers/hash.h"
#include "raster/numbers/random_bits.h"
#include "tools/golden/hashes.h"

namespace softfocus {
namespace {

struct NamedFormat {
  const char* name;
  Format format;
};
constexpr NamedFormat kFormats[] = {{"r8", Format::r8},       {"rgba8", Format::rgba8},
                                    {"srgb8", Format::srgb8}, {"rgba16f", Format::rgba16f},
                                    {"r32f", Format::r32f},   {"rgba32f", Format::rgba32f}};

struct NamedFilter {
  const char* name;
  Filter filter;
};
constexpr NamedFilter kFilters[] = {
    {"nearest", Filter::nearest}, {"bilinear", Filter::bilinear}, {"trilinear", Filter::trilinear}};

constexpr std::array kWraps{Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};

// One a power of two, one not.
constexpr std::array kWidths{16, 13};
constexpr int kSampledHeight = 8;
constexpr int kFetches = 64;

// Which NaN an operation gives differs between processors (half.h).
void add_number(Hash& hash, float value) {
  add_to_hash(hash, value == value ? value : std::numeric_limits<float>::quiet_NaN());
}

// Any float from 2^-30 to 2^17 and its negative: below and above what a half holds; now
// and then a zero, an infinity, a subnormal.
float random_float(RandomSequence& random) {
  constexpr std::array kSpecial{0.0f,
                                -0.0f,
                                0x1p-149f,
                                -0x1.8p-127f,
                                0x1p-20f,
                                65504.0f,
                                std::numeric_limits<float>::infinity(),
                                -std::numeric_limits<float>::infinity()};
  const std::uint64_t bits = next_bits(random);
  if (bits % 16 == 0) return kSpecial[bits >> 8 & 7u];
  const auto exponent = static_cast<std::uint32_t>(97 + (bits >> 8) % 48);
  return std::bit_cast<float>(static_cast<std::uint32_t>(bits >> 32 & 0x807FFFFFu) | exponent
                                                                                         << 23);
}

// Colours from 0 to 1 on the left, any float on the right.
Texture random_texture(Format format, int width, const Profile& profile) {
  Image image = make_image(format, width, kSampledHeight);
  RandomSequence random{static_cast<std::uint64_t>(width)};
  for (int y = 0; y < kSampledHeight; ++y) {
    for (int x = 0; x < width; ++x) {
      glm::vec4 texel{};
      for (int i = 0; i < 4; ++i) {
        texel[i] = 2 * x < width ? static_cast<float>(next_between(random, 0.0, 1.0))
                                 : random_float(random);
      }
      store_texel(image, x, y, texel, profile);
    }
  }
  Texture texture = make_texture(std::move(image));
  generate_mipmaps(texture, profile);
  return texture;
}

// Mostly near the texture, some far outside.
float random_coordinate(RandomSequence& random) {
  const double reach = next_bits(random) % 8 == 0 ? 1e4 : 2.5;
  return static_cast<float>(next_between(random, -reach, reach));
}

void add_samples(Hash& hash, const Texture& texture, Filter filter, const Profile& profile) {
  RandomSequence random{7};
  for (const Wrap wrap_u : kWraps) {
    for (const Wrap wrap_v : kWraps) {
      for (int i = 0; i < kFetches; ++i) {
        const float u = random_coordinate(random);
        const float v = random_coordinate(random);
        const auto lod = static_cast<float>(next_between(random, -1.0, 5.0));
        const glm::vec4 value = sample(texture, {filter, wrap_u, wrap_v}, {u, v}, lod, profile);
        for (int c = 0; c < 4; ++c) add_number(hash, value[c]);
      }
    }
  }
}

}  // namespace

std::vector<NamedHash> sampler_hashes(std::span<const NamedProfile> profiles) {
  std::vector<NamedHash> hashes;
  for (const NamedProfile& known : profiles) {
    const Profile& profile = known.profile;
    for (const auto& [format_name, format] : kFormats) {
      const std::string under = std::string{format_name} + ' ' + std::string{known.name};
      std::vector<Texture> textures;
      Hash mipmaps;
      for (const int width : kWidths) {
        textures.push_back(random_texture(format, width, profile));
        for (const Image& level : textures.back().levels) add_to_hash(mipmaps, hash_image(level));
      }
      hashes.push_back({"mipmaps " + under, mipmaps.value});
      for (const auto& [filter_name, filter] : kFilters) {
        Hash hash;
        for (const Texture& texture : textures) add_samples(hash, texture, filter, profile);
        hashes.push_back({"sampler " + std::string{filter_name} + ' ' + under, hash.value});
      }
    }
  }
  return hashes;
}

}  // namespace softfocus
