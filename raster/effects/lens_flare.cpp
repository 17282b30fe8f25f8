#include "raster/effects/lens_flare.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "raster/images/texel.h"
#include "raster/passes/pyramid.h"

namespace softfocus {
BrightPass bright_pass_of(const LensFlareSettings& settings) {
  BrightPass pass = bright_pass_of(BloomSettings{settings.threshold, settings.knee});
  pass.beyond = settings.beyond_m;
  return pass;
}

std::vector<float> streak_weights(float length_px) {
  const int reach = static_cast<int>(length_px);
  const double end = static_cast<double>(reach) + 1.0;
  std::vector<double> side;
  double sum = 0.0;
  for (int i = 0; i <= reach; ++i) {
    // Bright in the middle, thin outwards, and nothing at the end.
    const double left = 1.0 - i / end;
    side.push_back(left * left / (1.0 + 12.0 * i / end));
    sum += (i == 0 ? 1.0 : 2.0) * side.back();
  }
  std::vector<float> weights;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(static_cast<float>(side[static_cast<std::size_t>(std::abs(i))] / sum));
  }
  return weights;
}

namespace {

/// A texture of `side` by `side` pixels, made of light(x, y) with (0, 0) in its middle, that keeps
/// the sum of light.
template <class Light>
Kernel texture_kernel(int reach, const Light& light) {
  std::vector<double> values;
  double sum = 0.0;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      values.push_back(light(x, y));
      sum += values.back();
    }
  }
  Kernel kernel{2 * reach + 1, 2 * reach + 1, {}};
  for (const double value : values) kernel.weights.push_back(static_cast<float>(value / sum));
  return kernel;
}

}  // namespace

Kernel halo_kernel(float radius_px) {
  const double square = static_cast<double>(radius_px) * static_cast<double>(radius_px);
  const double width = 0.18 * square + 1.0;
  return texture_kernel(static_cast<int>(radius_px * 1.25f) + 1, [&](int x, int y) {
    const double off = (x * x + y * y - square) / width;
    return off * off < 1.0 ? (1.0 - off * off) * (1.0 - off * off) : 0.0;
  });
}

Kernel aperture_kernel(float radius_px) {
  const double radius = static_cast<double>(radius_px);
  return texture_kernel(static_cast<int>(radius_px) + 1, [&](int x, int y) {
    // Six blades: the distance from the middle over that of the blade's edge.
    constexpr double kHalfOfRoot3 = 0.8660254037844386;
    const double away = std::max({std::abs(1.0 * y), std::abs(kHalfOfRoot3 * x + 0.5 * y),
                                  std::abs(kHalfOfRoot3 * x - 0.5 * y)});
    const double covered = std::clamp(kHalfOfRoot3 * radius - away + 0.5, 0.0, 1.0);
    const double out = away / (radius + 1.0);
    return covered * (0.5 + out * out);  // brighter towards the rim
  });
}

CopiesPass rays_pass(float length, glm::vec2 light) {
  constexpr int kCopies = 8;
  CopiesPass pass{.anchor = light, .fade = glm::vec2{1e9f}};
  for (int i = 0; i < kCopies; ++i) {
    // A pixel takes light from nearer the middle.
    const float scale = 1.0f - length * (static_cast<float>(i) / static_cast<float>(kCopies));
    pass.copies.push_back({glm::vec3{scale}, glm::vec3{1.0f / static_cast<float>(kCopies)}});
  }
  return pass;
}

CopiesPass ghosts_pass(const LensFlareSettings& settings, int width, int height) {
  struct Ghost {
    float scale;
    glm::vec3 colour;
  };
  // Chosen by eye.
  constexpr std::array kGhosts{
      Ghost{-1.7f, {0.30f, 0.18f, 0.10f}}, Ghost{-3.1f, {0.10f, 0.22f, 0.30f}},
      Ghost{2.6f, {0.12f, 0.28f, 0.14f}},  Ghost{-0.7f, {0.14f, 0.08f, 0.20f}},
      Ghost{-5.2f, {0.36f, 0.30f, 0.12f}}, Ghost{4.4f, {0.10f, 0.16f, 0.34f}},
      Ghost{-1.2f, {0.08f, 0.18f, 0.16f}}, Ghost{1.6f, {0.18f, 0.10f, 0.08f}}};
  const glm::vec2 size{static_cast<float>(width), static_cast<float>(height)};
  CopiesPass pass{.anchor = {0.5f * size.x, 0.5f * size.y}, .fade = {8.0f / size.x, 8.0f / size.y}};
  const glm::vec3 fringes{1.0f + settings.fringe, 1.0f, 1.0f - settings.fringe};
  for (int i = 0; i < settings.ghosts; ++i) {
    const Ghost& ghost = kGhosts[static_cast<std::size_t>(i)];
    pass.copies.push_back(
        {{ghost.scale * fringes.x, ghost.scale, ghost.scale * fringes.z}, ghost.colour});
  }
  return pass;
}

glm::vec2 middle_of_light(const ConstImageView& picture) {
  double sum = 0.0, across = 0.0, down = 0.0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const glm::vec4 texel = load_texel<Format::rgba16f>(picture, x, y);
      const double light = static_cast<double>(texel.x) + static_cast<double>(texel.y) +
                           static_cast<double>(texel.z);
      sum += light * light;
      across += light * light * (x + 0.5);
      down += light * light * (y + 0.5);
    }
  }
  if (!(sum > 0.0)) {
    return {0.5f * static_cast<float>(picture.width), 0.5f * static_cast<float>(picture.height)};
  }
  return {static_cast<float>(across / sum), static_cast<float>(down / sum)};
}

namespace {

Image halved(const ConstImageView& image, const Profile& profile, ThreadPool& pool) {
  Image half = make_image(Format::rgba16f, (image.width + 1) / 2, (image.height + 1) / 2);
  downsample(image, half, profile, pool);
  return half;
}

Image widened(const ConstImageView& image, const ConstImageView& own, const Profile& profile,
              ThreadPool& pool) {
  Image wider = make_image(Format::rgba16f, own.width, own.height);
  upsample(image, own, {1.0f}, wider, profile, pool);
  return wider;
}

/// Light spread by a texture, which for a wide one is done at half the size.
Image spread(const ConstImageView& light, float radius_px, Kernel (*kernel)(float),
             const Profile& profile, ThreadPool& pool) {
  if (radius_px > kMostFlareRadiusPx) {
    const Image half = halved(light, profile, pool);
    return widened(spread(half, 0.5f * radius_px, kernel, profile, pool), light, profile, pool);
  }
  Image wide = make_image(Format::rgba16f, light.width, light.height);
  convolve(kernel(radius_px), light, wide, profile, pool);
  return wide;
}

}  // namespace

void lens_flare(const LensFlareSettings& settings, const ConstImageView& picture,
                const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && result.format == Format::rgba16f);
  assert(picture.width == result.width && picture.height == result.height);
  const BrightPass pass = bright_pass_of(settings);
  if (!has_bright_light(pass, picture, pool)) {
    return add_no_light(picture, result, profile, pool);
  }
  std::array<Image, kFlareHalvings + 1> levels;
  levels[0] = make_image(Format::rgba16f, picture.width, picture.height);
  find_bright_light(pass, picture, levels[0], profile, pool);
  for (std::size_t i = 0; i < kFlareHalvings; ++i) {
    levels[i + 1] = halved(levels[i], profile, pool);
  }
  const Image& light = levels.back();
  const auto picture_of_size = [&] {
    return make_image(Format::rgba16f, light.width, light.height);
  };
  const auto radius_px = [&](float share) {
    return share * 0.5f * static_cast<float>(light.height);
  };
  Image flare = picture_of_size();
  if (settings.streak_px > 0.0f) {
    const float length = settings.streak_px / static_cast<float>(1 << kFlareHalvings);
    convolve(row_kernel(streak_weights(length)), light, flare, profile, pool);
  }
  if (settings.halo > 0.0f) {
    Image whole = picture_of_size();
    add_scattered_light(kNothingBright, 1.0f, flare,
                        spread(light, radius_px(settings.halo), halo_kernel, profile, pool), whole,
                        profile, pool);
    flare = std::move(whole);
  }
  if (settings.rays > 0.0f) {
    const CopiesPass rays = rays_pass(settings.rays, middle_of_light(light));
    Image once = picture_of_size(), twice = picture_of_size();
    scaled_copies(rays, light, once, twice, profile, pool);
    scaled_copies(rays, twice, flare, once, profile, pool);
    flare = std::move(once);
  }
  const CopiesPass ghosts = ghosts_pass(settings, light.width, light.height);
  if (!ghosts.copies.empty()) {
    Image shapes{};
    if (settings.aperture > 0.0f) {
      shapes = spread(light, radius_px(settings.aperture), aperture_kernel, profile, pool);
    }
    Image whole = picture_of_size();
    scaled_copies(ghosts, settings.aperture > 0.0f ? shapes : light, flare, whole, profile, pool);
    flare = std::move(whole);
  }
  for (std::size_t i = kFlareHalvings; i-- > 0;) {
    flare = widened(flare, levels[i], profile, pool);
  }
  add_scattered_light(kNothingBright, settings.strength, picture, flare, result, profile, pool);
}

}  // namespace softfocus
