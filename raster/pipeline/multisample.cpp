#include "raster/pipeline/multisample.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "raster/images/texel.h"

namespace softfocus {
namespace {

// The standard gives them in 1/16 pixel.
constexpr glm::ivec2 at(int x, int y) { return {16 * x, 16 * y}; }

constexpr std::array<glm::ivec2, 1> kOne{at(0, 0)};
constexpr std::array<glm::ivec2, 4> kFour{at(-2, -6), at(6, -2), at(-6, 2), at(2, 6)};
constexpr std::array<glm::ivec2, 8> kEight{at(1, -3), at(-1, 3),  at(5, 1), at(-3, -5),
                                           at(-5, 5), at(-7, -1), at(3, 7), at(7, -7)};

struct Group {
  glm::vec4 sum{0.0f};
  int count = 0;

  void add(const glm::vec4& sample) {
    sum += sample;
    ++count;
  }
  glm::vec4 mean() const { return sum * (1.0f / static_cast<float>(count)); }
};

}  // namespace

std::span<const glm::ivec2> sample_places(int samples) {
  assert(samples == 1 || samples == 4 || samples == 8);
  if (samples == 4) return kFour;
  if (samples == 8) return kEight;
  return kOne;
}

int sample_reach(int samples) { return samples == 4 ? 96 : samples == 8 ? 112 : 0; }

Image resolve(const Image& multisampled, int samples, const Profile& profile) {
  Image image = make_image(multisampled.format, multisampled.width, multisampled.height / samples);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      glm::vec4 sum{0.0f};
      for (int s = 0; s < samples; ++s) sum += load_texel(multisampled, x, y * samples + s);
      store_texel(image, x, y, sum * (1.0f / static_cast<float>(samples)), profile);
    }
  }
  return image;
}

PixelSurfaces surfaces_of(std::span<const glm::vec4> samples) {
  float nearest = samples[0].w, farthest = samples[0].w;
  for (const glm::vec4& sample : samples) {
    nearest = std::min(nearest, sample.w);
    farthest = std::max(farthest, sample.w);
  }
  // Not a sum, which would lose the sign of a zero: drawing in tiles stores such pixels as they
  // are.
  const auto is_first = [&](const glm::vec4& sample) {
    return std::memcmp(&sample, samples.data(), sizeof sample) == 0;
  };
  if (std::all_of(samples.begin(), samples.end(), is_first)) return {samples[0], {}, 0};
  const bool is_one = farthest <= nearest * kOneSurface;
  const float border = 2.0f / (1.0f / nearest + 1.0f / farthest);
  Group near_group, far_group;
  for (const glm::vec4& sample : samples) {
    (is_one || sample.w < border ? near_group : far_group).add(sample);
  }
  if (far_group.count == 0) return {near_group.mean(), {}, 0};
  if (near_group.count == 0) return {far_group.mean(), {}, 0};
  if (near_group.count >= far_group.count) {
    return {near_group.mean(), far_group.mean(), far_group.count};
  }
  return {far_group.mean(), near_group.mean(), near_group.count};
}

}  // namespace softfocus
