#include "raster/images/sampler.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>

#include "raster/images/texel.h"
#include "raster/numbers/lerp.h"

namespace softfocus {
namespace {

// Past this, floats have no fraction left and the texel index would not fit.
constexpr float kLargestCoordinate = 0x1p22f;

// A texel index that may lie outside, brought inside. `size` >= 1.
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

// The two texels that a bilinear fetch reads along one axis, and the second's weight.
struct Taps {
  int first;
  int second;
  float weight;
};

Taps bilinear_taps(float coordinate, int size, Wrap wrap, BilinearWeights weights) {
  float position = to_texels(coordinate, size) - 0.5f;
  if (weights == BilinearWeights::fixed_8) {
    position = std::nearbyint(position * 256.0f) * (1.0f / 256.0f);
  }
  const float base = std::floor(position);
  const int index = static_cast<int>(base);
  return {wrap_index(index, size, wrap), wrap_index(index + 1, size, wrap), position - base};
}

glm::vec4 lerp4(glm::vec4 a, glm::vec4 b, float t, Contraction contraction) {
  return {lerp(a.x, b.x, t, contraction), lerp(a.y, b.y, t, contraction),
          lerp(a.z, b.z, t, contraction), lerp(a.w, b.w, t, contraction)};
}

glm::vec4 sample_nearest(const Image& level, const Sampler& sampler, glm::vec2 uv) {
  const int x = static_cast<int>(std::floor(to_texels(uv.x, level.width)));
  const int y = static_cast<int>(std::floor(to_texels(uv.y, level.height)));
  return load_texel(level, wrap_index(x, level.width, sampler.wrap_u),
                    wrap_index(y, level.height, sampler.wrap_v));
}

glm::vec4 sample_bilinear(const Image& level, const Sampler& sampler, glm::vec2 uv,
                          const Profile& profile) {
  const Taps u = bilinear_taps(uv.x, level.width, sampler.wrap_u, profile.bilinear_weights);
  const Taps v = bilinear_taps(uv.y, level.height, sampler.wrap_v, profile.bilinear_weights);
  const auto along_row = [&](int y) {
    return lerp4(load_texel(level, u.first, y), load_texel(level, u.second, y), u.weight,
                 profile.lerp);
  };
  return lerp4(along_row(v.first), along_row(v.second), v.weight, profile.lerp);
}

}  // namespace

glm::vec4 sample(const Texture& texture, const Sampler& sampler, glm::vec2 uv, float lod,
                 const Profile& profile) {
  assert(!texture.levels.empty());
  const auto last = static_cast<float>(texture.levels.size() - 1);
  const float level = lod > 0.0f ? std::min(lod, last) : 0.0f;
  const auto image = [&](float index) -> const Image& {
    return texture.levels[static_cast<std::size_t>(index)];
  };
  switch (sampler.filter) {
    case Filter::nearest: return sample_nearest(image(level + 0.5f), sampler, uv);
    case Filter::bilinear: return sample_bilinear(image(level + 0.5f), sampler, uv, profile);
    case Filter::trilinear: break;
  }
  const float base = std::floor(level);
  float weight = level - base;
  if (profile.bilinear_weights == BilinearWeights::fixed_8) {
    weight = std::nearbyint(weight * 256.0f) * (1.0f / 256.0f);
  }
  const glm::vec4 fine = sample_bilinear(image(base), sampler, uv, profile);
  if (weight == 0.0f) return fine;
  const glm::vec4 coarse = sample_bilinear(image(base + 1.0f), sampler, uv, profile);
  return lerp4(fine, coarse, weight, profile.lerp);
}

float log2_linear(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  return static_cast<float>(bits) * 0x1p-23f - 127.0f;
}

float level_of_detail(const Texture& texture, glm::vec2 uv_per_x, glm::vec2 uv_per_y) {
  const auto width = static_cast<float>(texture.levels.front().width);
  const auto height = static_cast<float>(texture.levels.front().height);
  const auto squared_length = [&](glm::vec2 uv) {
    const float s = uv.x * width;
    const float t = uv.y * height;
    return s * s + t * t;
  };
  const float along_x = squared_length(uv_per_x);
  const float along_y = squared_length(uv_per_y);
  return 0.5f * log2_linear(along_x > along_y ? along_x : along_y);
}

void generate_mipmaps(Texture& texture, const Profile& profile) {
  assert(!texture.levels.empty());
  texture.levels.resize(1);
  for (;;) {
    const Image& fine = texture.levels.back();
    if (fine.width == 1 && fine.height == 1) return;
    Image coarse =
        make_image(fine.format, std::max(1, fine.width / 2), std::max(1, fine.height / 2));
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
    texture.levels.push_back(std::move(coarse));
  }
}

Texture make_texture(Image image) {
  Texture texture;
  texture.levels.push_back(std::move(image));
  return texture;
}

}  // namespace softfocus
