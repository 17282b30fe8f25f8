#include "raster/effects/lens_flare.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "raster/images/texel.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/passes/pyramid.h"

namespace softfocus {
namespace {

/// Where a column or row of pixels of a copy lies in the source, along one axis.
struct Place {
  int first;    ///< of two pixels
  float share;  ///< of the second
  float fade;
};

Place place_of(int pixel, float scale, float anchor, float fade, int size) {
  const float middle = static_cast<float>(pixel) + 0.5f;
  const float at = anchor + scale * (middle - anchor);
  const float edge = std::min(at, static_cast<float>(size) - at) * fade;
  const float place = at - 0.5f;
  const float whole = std::floor(place);
  return {static_cast<int>(whole), place - whole, std::min(std::max(edge, 0.0f), 1.0f)};
}

std::vector<Place> places_of(const CopiesPass& pass, int axis, int size) {
  std::vector<Place> places;
  for (const ScaledCopy& copy : pass.copies) {
    for (int channel = 0; channel < 3; ++channel) {
      for (int pixel = 0; pixel < size; ++pixel) {
        places.push_back(
            place_of(pixel, copy.scale[channel], pass.anchor[axis], pass.fade[axis], size));
      }
    }
  }
  return places;
}

/// One channel of the source, as floats with a border of nothing.
class Channel {
 public:
  Channel(const ConstImageView& source, int channel)
      : stride_(static_cast<std::size_t>(source.width) + 2),
        values_(stride_ * (static_cast<std::size_t>(source.height) + 2)) {
    for (int y = 0; y < source.height; ++y) {
      const std::uint16_t* const from = row<std::uint16_t>(source, y).data() + channel;
      float* const to = &values_[(static_cast<std::size_t>(y) + 1) * stride_ + 1];
      for (int x = 0; x < source.width; ++x) to[x] = half_to_float(from[4 * x]);
    }
  }

  /// Both firsts from -1 to the size less 1.
  float bilinear(const Place& column, const Place& row) const {
    const float* const top = &values_[static_cast<std::size_t>(row.first + 1) * stride_ +
                                      static_cast<std::size_t>(column.first + 1)];
    const float* const bottom = top + stride_;
    const float above = top[0] + column.share * (top[1] - top[0]);
    const float below = bottom[0] + column.share * (bottom[1] - bottom[0]);
    return above + row.share * (below - above);
  }

 private:
  std::size_t stride_;
  std::vector<float> values_;
};

}  // namespace

void scaled_copies(const CopiesPass& pass, const ConstImageView& source, const ConstImageView& own,
                   const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(source.width == result.width && source.height == result.height);
  assert(own.width == result.width && own.height == result.height);
  const int width = result.width, height = result.height;
  const std::vector<Place> columns = places_of(pass, 0, width), rows = places_of(pass, 1, height);
  const std::array channels{Channel{source, 0}, Channel{source, 1}, Channel{source, 2}};
  fullscreen_pass<Format::rgba16f>(result, profile, pool, [&](int x, int y) {
    glm::vec4 sum = load_texel<Format::rgba16f>(own, x, y);
    for (std::size_t k = 0; k < pass.copies.size(); ++k) {
      for (int channel = 0; channel < 3; ++channel) {
        const std::size_t table = 3 * k + static_cast<std::size_t>(channel);
        const Place& column =
            columns[table * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
        const Place& row =
            rows[table * static_cast<std::size_t>(height) + static_cast<std::size_t>(y)];
        // What is not seen adds 0.
        const float kept = column.fade * row.fade;
        if (!(kept > 0.0f)) continue;
        if (column.first < -1 || column.first >= width || row.first < -1 || row.first >= height) {
          continue;
        }
        const float light = channels[static_cast<std::size_t>(channel)].bilinear(column, row);
        sum[channel] = sum[channel] + pass.copies[k].colour[channel] * kept * light;
      }
    }
    return sum;
  });
}

BrightPass bright_pass_of(const LensFlareSettings& settings) {
  BrightPass pass = bright_pass_of(BloomSettings{settings.threshold, settings.knee});
  pass.beyond = settings.beyond_m;
  return pass;
}

std::vector<float> streak_weights(float length_px) {
  // Some 2 % are left at the end.
  const int reach = static_cast<int>(length_px);
  const double kept = 1.0 - 4.0 / (static_cast<double>(reach) + 4.0);
  std::vector<double> side{1.0};
  double sum = 1.0;
  for (int i = 0; i < reach; ++i) {
    side.push_back(side.back() * kept);
    sum += 2.0 * side.back();
  }
  std::vector<float> weights;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(static_cast<float>(side[static_cast<std::size_t>(std::abs(i))] / sum));
  }
  return weights;
}

Kernel halo_kernel(float radius_px) {
  const int reach = static_cast<int>(radius_px * 1.25f) + 1;
  const double square = static_cast<double>(radius_px) * static_cast<double>(radius_px);
  const double width = 0.3 * square + 1.0;
  std::vector<double> ring;
  double sum = 0.0;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const double off = (x * x + y * y - square) / width;
      const double kept = off * off < 1.0 ? (1.0 - off * off) * (1.0 - off * off) : 0.0;
      ring.push_back(kept);
      sum += kept;
    }
  }
  Kernel kernel{2 * reach + 1, 2 * reach + 1, {}};
  for (const double weight : ring) kernel.weights.push_back(static_cast<float>(weight / sum));
  return kernel;
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
  // Chosen by eye; the light of each ghost falls with its area.
  constexpr std::array kGhosts{
      Ghost{-1.7f, {0.30f, 0.18f, 0.10f}}, Ghost{-3.1f, {0.10f, 0.22f, 0.30f}},
      Ghost{2.6f, {0.12f, 0.28f, 0.14f}},  Ghost{-0.8f, {0.14f, 0.08f, 0.20f}},
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
  upsample(image, own, 1.0f, wider, profile, pool);
  return wider;
}

Image halo_of(const Image& light, float radius_px, const Profile& profile, ThreadPool& pool) {
  if (radius_px > kMostHaloRadiusPx) {
    const Image half = halved(light, profile, pool);
    return widened(halo_of(half, 0.5f * radius_px, profile, pool), light, profile, pool);
  }
  Image halo = make_image(Format::rgba16f, light.width, light.height);
  convolve(halo_kernel(radius_px), light, halo, profile, pool);
  return halo;
}

}  // namespace

void lens_flare(const LensFlareSettings& settings, const ConstImageView& picture,
                const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && result.format == Format::rgba16f);
  assert(picture.width == result.width && picture.height == result.height);
  std::array<Image, kFlareHalvings + 1> levels;
  levels[0] = make_image(Format::rgba16f, picture.width, picture.height);
  find_bright_light(bright_pass_of(settings), picture, levels[0], profile, pool);
  for (std::size_t i = 0; i < kFlareHalvings; ++i) {
    levels[i + 1] = halved(levels[i], profile, pool);
  }
  const Image& light = levels.back();
  const auto picture_of_size = [&] {
    return make_image(Format::rgba16f, light.width, light.height);
  };
  Image flare = picture_of_size();
  if (settings.streak_px > 0.0f) {
    const float length = settings.streak_px / static_cast<float>(1 << kFlareHalvings);
    convolve(row_kernel(streak_weights(length)), light, flare, profile, pool);
  }
  if (settings.halo > 0.0f) {
    const float radius_px = settings.halo * 0.5f * static_cast<float>(light.height);
    Image whole = picture_of_size();
    add_scattered_light(kNothingBright, 1.0f, flare, halo_of(light, radius_px, profile, pool),
                        whole, profile, pool);
    flare = std::move(whole);
  }
  if (settings.rays > 0.0f) {
    const CopiesPass pass = rays_pass(settings.rays, middle_of_light(light));
    Image once = picture_of_size(), twice = picture_of_size();
    scaled_copies(pass, light, once, twice, profile, pool);
    scaled_copies(pass, twice, flare, once, profile, pool);
    flare = std::move(once);
  }
  const CopiesPass ghosts = ghosts_pass(settings, light.width, light.height);
  if (!ghosts.copies.empty()) {
    Image whole = picture_of_size();
    scaled_copies(ghosts, light, flare, whole, profile, pool);
    flare = std::move(whole);
  }
  for (std::size_t i = kFlareHalvings; i-- > 0;) {
    flare = widened(flare, levels[i], profile, pool);
  }
  add_scattered_light(kNothingBright, settings.strength, picture, flare, result, profile, pool);
}

}  // namespace softfocus
