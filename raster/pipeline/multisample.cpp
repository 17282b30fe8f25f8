#include "raster/pipeline/multisample.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/vec3.hpp>

#include "raster/images/texel.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

// The standard gives them in 1/16 pixel.
constexpr glm::ivec2 at(int x, int y) { return {16 * x, 16 * y}; }

constexpr std::array<glm::ivec2, 1> kOnePosition{at(0, 0)};
constexpr std::array<glm::ivec2, 4> kFour{at(-2, -6), at(6, -2), at(-6, 2), at(2, 6)};
constexpr std::array<glm::ivec2, 8> kEight{at(1, -3), at(-1, 3),  at(5, 1), at(-3, -5),
                                           at(-5, 5), at(-7, -1), at(3, 7), at(7, -7)};

}  // namespace

std::span<const glm::ivec2> sample_places(int samples) {
  assert(samples == 1 || samples == 4 || samples == 8);
  if (samples == 4) return kFour;
  if (samples == 8) return kEight;
  return kOnePosition;
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

OtherSurface other_surface(float centre_depth, std::span<const glm::vec4> samples) {
  const float centre = 1.0f / centre_depth;
  float farthest = centre;
  bool is_one = true;
  for (const glm::vec4& sample : samples) {
    const float inverse = 1.0f / sample.w;
    if (std::fabs(inverse - centre) > std::fabs(farthest - centre)) farthest = inverse;
    is_one = is_one && is_one_surface(sample.w, centre_depth);
  }
  const float border = 0.5f * (centre + farthest);
  const auto is_other = [&](const glm::vec4& sample) {
    const float inverse = 1.0f / sample.w;
    return is_one || (farthest > centre ? inverse > border : inverse <= border);
  };
  glm::vec3 sum{0.0f};
  float depth = 0.0f;
  int count = 0, most = 0;
  for (const glm::vec4& sample : samples) {
    if (!is_other(sample)) continue;
    sum += glm::vec3{sample};
    ++count;
    const auto alike =
        static_cast<int>(std::count_if(samples.begin(), samples.end(), [&](const glm::vec4& one) {
          return is_other(one) && one.w == sample.w;
        }));
    if (alike > most) depth = sample.w;
    most = std::max(most, alike);
  }
  return {{sum * (1.0f / static_cast<float>(count)), depth}, count};
}

void find_edges(const Image& picture, const Image& multisampled, const EdgeTargets& to,
                const Profile& profile, ThreadPool& pool) {
  assert(to.y_begin == 0);
  constexpr int kRows = 8;  // that a thread takes at a time
  for_each_row(pool, picture.height, kRows, [&](int y) {
    for (int x = 0; x < picture.width; ++x) {
      const float centre = load_texel<Format::rgba16f>(picture, x, y).w;
      std::array<glm::vec4, kMaxSamples> others;
      std::size_t count = 0;
      for (int s = 0; s < to.samples; ++s) {
        const glm::vec4 sample = load_texel<Format::rgba16f>(multisampled, x, y * to.samples + s);
        if (!is_one_surface(sample.w, centre)) others[count++] = sample;
      }
      const OtherSurface other =
          count > 0 ? other_surface(centre, std::span{others}.first(count)) : OtherSurface{};
      row<std::uint8_t>(*to.coverage, y)[static_cast<std::size_t>(x)] =
          coverage_byte(other.samples, to.samples);
      if (other.samples > 0) store_texel(*to.other, x, y, other.texel, profile);
    }
  });
}

}  // namespace softfocus
