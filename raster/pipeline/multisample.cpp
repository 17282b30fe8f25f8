#include "raster/pipeline/multisample.h"

#include <algorithm>
#include <cassert>

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
  glm::vec4 sum{-0.0f};  // so that zeros keep their sign
  int count = 0;
  int first = 0;

  void add(const glm::vec4& sample, int number) {
    if (count == 0) first = number;
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
  const bool is_one = farthest <= nearest * kOneSurface;
  const float border = 2.0f / (1.0f / nearest + 1.0f / farthest);
  Group near_group, far_group;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    (is_one || samples[s].w < border ? near_group : far_group).add(samples[s], static_cast<int>(s));
  }
  if (far_group.count == 0) return {near_group.mean(), {}};
  if (near_group.count == 0) return {far_group.mean(), {}};
  const bool shows_near = near_group.count >= far_group.count;
  const Group& shown = shows_near ? near_group : far_group;
  const Group& other = shows_near ? far_group : near_group;
  return {shown.mean(), other.mean(), other.count, shown.first};
}

void find_surfaces(const Image& colour, const Image& depth, int samples, const Rectangle& area,
                   const SurfaceTargets& to, const Profile& profile) {
  std::array<glm::vec4, kMaxSamples> of_pixel;
  const auto count = static_cast<std::size_t>(samples);
  for (int y = area.y_begin; y < area.y_end; ++y) {
    for (int x = area.x_begin; x < area.x_end; ++x) {
      for (std::size_t s = 0; s < count; ++s) {
        of_pixel[s] = load_texel<Format::rgba16f>(colour, x, y * samples + static_cast<int>(s));
      }
      const PixelSurfaces surfaces = surfaces_of(std::span{of_pixel}.first(count));
      const int at = y - to.y_begin;
      store_texel(*to.picture, x, at, surfaces.texel, profile);
      if (surfaces.other_samples > 0) store_texel(*to.other, x, at, surfaces.other, profile);
      const auto column = static_cast<std::size_t>(x);
      row<std::uint8_t>(*to.coverage, at)[column] = coverage_byte(surfaces.other_samples, samples);
      if (to.depth == nullptr) continue;
      row<float>(*to.depth, at)[column] = row<float>(depth, y * samples + surfaces.first)[column];
    }
  }
}

}  // namespace softfocus
