#include "raster/images/sampler.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>

#include "raster/images/bilinear.h"
#include "raster/images/driver_samplers.h"
#include "raster/images/integer_filter.h"
#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"
#include "raster/numbers/exact_math.h"
#include "raster/numbers/lerp.h"

namespace softfocus {
namespace {

constexpr int kMantissaBits = 23;
constexpr std::uint32_t kMantissaMask = 0x7FFFFF;

float larger(float a, float b) { return a > b ? a : b; }

// The larger squared length of two differences, in texels.
float largest_square(glm::vec2 uv_per_x, glm::vec2 uv_per_y, float width, float height) {
  const auto squared_length = [&](glm::vec2 uv) {
    const float s = uv.x * width;
    const float t = uv.y * height;
    return s * s + t * t;
  };
  return larger(squared_length(uv_per_x), squared_length(uv_per_y));
}

int exponent_of(std::uint32_t bits) { return static_cast<int>(bits >> kMantissaBits & 0xFF) - 127; }

std::array<float, 257> logarithms() {
  std::array<float, 257> table{};
  for (std::size_t k = 0; k < table.size(); ++k) {
    table[k] = static_cast<float>(exact_math::log2(1.0 + static_cast<double>(k) / 256.0));
  }
  return table;
}

}  // namespace

float log2_linear(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const auto mantissa = std::bit_cast<float>((bits & kMantissaMask) | 0x3F800000u);
  return static_cast<float>(exponent_of(bits) - 1) + mantissa;
}

float log2_by_table(float x) {
  static const std::array<float, 257> table = logarithms();
  const auto bits = std::bit_cast<std::uint32_t>(x);
  constexpr int kCut = kMantissaBits - 8;
  const std::uint32_t index = ((bits & kMantissaMask) + (1u << (kCut - 1))) >> kCut;
  return static_cast<float>(exponent_of(bits)) + table[index];
}

float log2_of_root_by_bits(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x * x);
  return (static_cast<float>(bits) - 0x1.FCp+29f) * 0x1p-25f;
}

float level_of_detail(const Texture& texture, glm::vec2 uv_per_x, glm::vec2 uv_per_y,
                      const Profile& profile) {
  const auto width = static_cast<float>(texture.levels.front().width);
  const auto height = static_cast<float>(texture.levels.front().height);
  if (profile.texture_unit == TextureUnit::swiftshader) {
    return log2_of_root_by_bits(largest_square(uv_per_x, uv_per_y, width, height));
  }
  if (profile.texture_unit != TextureUnit::softpipe) {
    return level_of_detail(texture, uv_per_x, uv_per_y);
  }
  const float along_u = larger(std::fabs(uv_per_x.x), std::fabs(uv_per_y.x)) * width;
  const float along_v = larger(std::fabs(uv_per_x.y), std::fabs(uv_per_y.y)) * height;
  return log2_by_table(larger(along_u, along_v));
}

float level_of_detail(const Texture& texture, glm::vec2 uv_per_x, glm::vec2 uv_per_y) {
  const auto width = static_cast<float>(texture.levels.front().width);
  const auto height = static_cast<float>(texture.levels.front().height);
  return 0.5f * log2_linear(largest_square(uv_per_x, uv_per_y, width, height));
}

namespace {

// What each byte decodes to: texels are read four times as often as there are codes.
using ByteValues = std::array<float, 256>;

ByteValues values_of_bytes(float (*decode)(std::uint8_t encoded)) {
  ByteValues values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = decode(static_cast<std::uint8_t>(i));
  return values;
}

// Halves an image of four bytes a texel.
template <Format format>
void halve_bytes(const Image& fine, Image& coarse, const Profile& profile) {
  static const ByteValues colours =
      values_of_bytes(format == Format::srgb8 ? srgb8_to_linear : unorm8_to_linear);
  static const ByteValues alphas = values_of_bytes(unorm8_to_linear);
  const std::size_t right = fine.width > 1 ? 4 : 0;
  for (int y = 0; y < coarse.height; ++y) {
    const std::uint8_t* upper = row<std::uint8_t>(fine, 2 * y).data();
    const std::uint8_t* lower =
        row<std::uint8_t>(fine, std::min(2 * y + 1, fine.height - 1)).data();
    for (int x = 0; x < coarse.width; ++x, upper += 8, lower += 8) {
      glm::vec4 mean{};
      for (std::size_t c = 0; c < 4; ++c) {
        const ByteValues& codes = c < 3 ? colours : alphas;
        mean[static_cast<int>(c)] = ((codes[upper[c]] + codes[upper[right + c]]) +
                                     (codes[lower[c]] + codes[lower[right + c]])) *
                                    0.25f;
      }
      store_texel<format>(coarse, x, y, mean, profile);
    }
  }
}

void halve(const Image& fine, Image& coarse, const Profile& profile) {
  if (fine.format == Format::rgba8) return halve_bytes<Format::rgba8>(fine, coarse, profile);
  if (fine.format == Format::srgb8) return halve_bytes<Format::srgb8>(fine, coarse, profile);
  for (int y = 0; y < coarse.height; ++y) {
    const int y0 = std::min(2 * y, fine.height - 1);
    const int y1 = std::min(2 * y + 1, fine.height - 1);
    for (int x = 0; x < coarse.width; ++x) {
      const int x0 = std::min(2 * x, fine.width - 1);
      const int x1 = std::min(2 * x + 1, fine.width - 1);
      const glm::vec4 sum = (load_texel(fine, x0, y0) + load_texel(fine, x1, y0)) +
                            (load_texel(fine, x0, y1) + load_texel(fine, x1, y1));
      store_texel(coarse, x, y, sum * 0.25f, profile);
    }
  }
}

}  // namespace

void generate_mipmaps(Texture& texture, const Profile& profile) {
  assert(!texture.levels.empty());
  if (texture.shape != TextureShape::flat) return generate_sliced_mipmaps(texture, profile);
  texture.levels.resize(1);
  for (;;) {
    const Image& fine = texture.levels.back();
    if (fine.width == 1 && fine.height == 1) return;
    Image coarse =
        make_image(fine.format, std::max(1, fine.width / 2), std::max(1, fine.height / 2));
    halve(fine, coarse, profile);
    texture.levels.push_back(std::move(coarse));
  }
}

namespace {

// Past this, floats have no fraction left and the texel index would not fit.
constexpr float kLargestCoordinate = 0x1p22f;

// Brings a texel index inside. `size` >= 1.
int wrap_index(int index, int size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return std::clamp(index, 0, size - 1);
  if (wrap == Wrap::repeat) {
    const int rest = index % size;
    return rest < 0 ? rest + size : rest;
  }
  const int period = 2 * size;
  int rest = index % period;
  if (rest < 0) rest += period;
  return rest < size ? rest : period - 1 - rest;
}

// A coordinate scaled to texels, kept where an int can hold its floor.
float to_texels(float coordinate, int size) {
  if (!std::isfinite(coordinate)) return 0.0f;
  return std::clamp(coordinate * static_cast<float>(size), -kLargestCoordinate, kLargestCoordinate);
}

// In 256ths, rounded to nearest. to_texels() keeps it below 2^31.
std::int32_t to_256ths(float value) {
  return static_cast<std::int32_t>(std::nearbyint(value * 256.0f));
}

IntegerTaps integer_taps(float coordinate, int size, Wrap wrap) {
  const std::int32_t position = to_256ths(to_texels(coordinate, size) - 0.5f);
  const int index = position >> 8;
  return {wrap_index(index, size, wrap), wrap_index(index + 1, size, wrap), position & 255};
}

}  // namespace

Taps standard_taps(float coordinate, int size, Wrap wrap, BilinearWeights weights) {
  if (weights == BilinearWeights::fixed_8) {
    const IntegerTaps taps = integer_taps(coordinate, size, wrap);
    return {taps.first, taps.second, static_cast<float>(taps.weight) * (1.0f / 256.0f)};
  }
  const float position = to_texels(coordinate, size) - 0.5f;
  const float base = std::floor(position);
  const int index = static_cast<int>(base);
  return {wrap_index(index, size, wrap), wrap_index(index + 1, size, wrap), position - base};
}

int standard_nearest(float coordinate, int size, Wrap wrap) {
  return wrap_index(static_cast<int>(std::floor(to_texels(coordinate, size))), size, wrap);
}

namespace {

glm::vec4 sample_nearest(const Image& level, const Sampler& sampler, glm::vec2 uv) {
  return load_texel(level, standard_nearest(uv.x, level.width, sampler.wrap_u),
                    standard_nearest(uv.y, level.height, sampler.wrap_v));
}

glm::vec4 sample_bilinear(const Image& level, const Sampler& sampler, glm::vec2 uv,
                          const Profile& profile) {
  const Taps u = standard_taps(uv.x, level.width, sampler.wrap_u, profile.bilinear_weights);
  const Taps v = standard_taps(uv.y, level.height, sampler.wrap_v, profile.bilinear_weights);
  return filter_bilinear(
      u, v, [&](int x, int y) { return load_texel(level, x, y); },
      [&](float a, float b, float t) { return lerp(a, b, t, profile.lerp); });
}

IntegerFetch integer_fetch(const Image& level, const Sampler& sampler, glm::vec2 uv) {
  return {&level, integer_taps(uv.x, level.width, sampler.wrap_u),
          integer_taps(uv.y, level.height, sampler.wrap_v)};
}

}  // namespace

glm::vec4 sample(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                 const Profile& profile) {
  assert(!texture.levels.empty());
  switch (profile.texture_unit) {
    case TextureUnit::llvmpipe: return sample_llvmpipe(texture, sampler, uv, lod, profile);
    case TextureUnit::softpipe: return sample_softpipe(texture, sampler, uv, lod, profile);
    case TextureUnit::swiftshader: return sample_swiftshader(texture, sampler, uv, lod, profile);
    case TextureUnit::standard: break;
  }
  const auto last = static_cast<float>(texture.levels.size() - 1);
  const float level = lod > 0.0f ? std::min(lod, last) : 0.0f;
  const auto image = [&](float index) -> const Image& {
    return texture.levels[static_cast<std::size_t>(index)];
  };
  if (sampler.filter == Filter::nearest) return sample_nearest(image(level + 0.5f), sampler, uv);
  const bool trilinear = sampler.filter == Filter::trilinear;
  const float base = std::floor(trilinear ? level : level + 0.5f);
  float weight = trilinear ? level - base : 0.0f;
  if (has_integer_filter(image(base).format, profile)) {
    const int weight_256 = to_256ths(weight);
    const IntegerFetch fine = integer_fetch(image(base), sampler, uv);
    return filter_in_integers(
        fine, weight_256 > 0 ? integer_fetch(image(base + 1.0f), sampler, uv) : fine, weight_256,
        profile);
  }
  if (profile.bilinear_weights == BilinearWeights::fixed_8) {
    weight = static_cast<float>(to_256ths(weight)) * (1.0f / 256.0f);
  }
  const glm::vec4 fine = sample_bilinear(image(base), sampler, uv, profile);
  if (weight == 0.0f) return fine;
  const glm::vec4 coarse = sample_bilinear(image(base + 1.0f), sampler, uv, profile);
  return mix_components(fine, coarse, weight,
                        [&](float a, float b, float t) { return lerp(a, b, t, profile.lerp); });
}

}  // namespace softfocus
