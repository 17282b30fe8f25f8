#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "raster/effects/bloom.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/passes/kernel.h"
#include "raster/passes/pyramid.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "raster/effects/bloom.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// The order of operations of these is that of the kernels and of the shaders.

float usable(float light) {
  return light > 0.0f ? (light < kLargestHalf ? light : kLargestHalf) : 0.0f;
}

/// The usable light, and in alpha the share of it that is bright.
glm::vec4 light_and_share(const BrightPass& pass, glm::vec4 texel) {
  const glm::vec3 light{usable(texel.x), usable(texel.y), usable(texel.z)};
  const float most = std::max(std::max(light.x, light.y), light.z);
  const float above = most - pass.begin;
  const float x = above > 0.0f ? (above < pass.double_knee ? above : pass.double_knee) : 0.0f;
  const float soft = x * x * pass.square_factor;
  const float hard = most - pass.threshold;
  const float kept = hard > soft ? hard : soft;
  return {light, most > 0.0f && !(texel.w < pass.beyond) ? kept / most : 0.0f};
}

glm::vec4 bright(const BrightPass& pass, glm::vec4 texel) {
  const glm::vec4 light = light_and_share(pass, texel);
  const float r = light.x * light.w, g = light.y * light.w, b = light.z * light.w;
  const float weight = pass.is_steady ? 1.0f / (1.0f + std::max(std::max(r, g), b)) : 1.0f;
  return {r * weight, g * weight, b * weight, weight};
}

glm::vec4 divided(glm::vec4 texel) {
  return {texel.x / texel.w, texel.y / texel.w, texel.z / texel.w, 1.0f};
}

glm::vec4 combined(const BrightPass& pass, float strength, glm::vec4 picture, glm::vec4 scattered) {
  const glm::vec4 light = light_and_share(pass, picture);
  return {picture.x + strength * (scattered.x - light.x * light.w),
          picture.y + strength * (scattered.y - light.y * light.w),
          picture.z + strength * (scattered.z - light.z * light.w), picture.w};
}

/// Each row of `result` from the same row of pictures: in whole vectors by kernel(width), which
/// returns how many pixels it did, then by scalar(x).
template <class Kernel, class Scalar>
void for_rows(const ImageView& result, const Profile& profile, ThreadPool& pool,
              const Kernel& kernel, const Scalar& scalar) {
  for_each_row(pool, result.height, kPassRows, [&](int y) {
    int x = pool.isa() == Isa::scalar ? 0 : kernel(y);
    for (; x < result.width; ++x) {
      store_texel<Format::rgba16f>(result, x, y, scalar(x, y), profile);
    }
  });
}

/// A row of find_bright_light() and of add_scattered_light().
void make_bright_row(const BrightPass& pass, const ConstImageView& picture, int y,
                     std::uint16_t* to, const Profile& profile, Isa isa) {
  const ImageView one = view_of(Format::rgba16f, to, picture.width, 1);
  int x = SOFTFOCUS_KERNEL(isa, bright_row)(pass, row<std::uint16_t>(picture, y).data(), to,
                                            picture.width, profile.half_store);
  for (; x < picture.width; ++x) {
    store_texel<Format::rgba16f>(one, x, 0,
                                 bright(pass, load_texel<Format::rgba16f>(picture, x, y)), profile);
  }
}

void make_combined_row(const BrightPass& pass, float strength, const ConstImageView& picture,
                       const std::uint16_t* scattered, int y, const ImageView& result,
                       const Profile& profile, Isa isa) {
  const ConstImageView one{Format::rgba16f, picture.width, 1, 0,
                           reinterpret_cast<const std::byte*>(scattered)};
  int x = SOFTFOCUS_KERNEL(isa, combine_row)(pass, strength, row<std::uint16_t>(picture, y).data(),
                                             scattered, row<std::uint16_t>(result, y).data(),
                                             result.width, profile.half_store);
  for (; x < picture.width; ++x) {
    store_texel<Format::rgba16f>(
        result, x, y,
        combined(pass, strength, load_texel<Format::rgba16f>(picture, x, y),
                 load_texel<Format::rgba16f>(one, x, 0)),
        profile);
  }
}

void divide_by_weight(const ImageView& image, const Profile& profile, ThreadPool& pool) {
  for_rows(
      image, profile, pool,
      [&](int y) {
        std::uint16_t* texels = row<std::uint16_t>(image, y).data();
        return SOFTFOCUS_KERNEL(pool.isa(), divide_row)(texels, image.width, profile.half_store);
      },
      [&](int x, int y) { return divided(load_texel<Format::rgba16f>(image, x, y)); });
}

Image half_of(const ConstImageView& image) {
  return make_image(Format::rgba16f, (image.width + 1) / 2, (image.height + 1) / 2);
}

}  // namespace

void find_bright_light(const BrightPass& pass, const ConstImageView& picture,
                       const ImageView& result, const Profile& profile, ThreadPool& pool) {
  for_rows(
      result, profile, pool,
      [&](int y) {
        return SOFTFOCUS_KERNEL(pool.isa(), bright_row)(pass, row<std::uint16_t>(picture, y).data(),
                                                        row<std::uint16_t>(result, y).data(),
                                                        result.width, profile.half_store);
      },
      [&](int x, int y) { return bright(pass, load_texel<Format::rgba16f>(picture, x, y)); });
}

bool has_bright_light(const BrightPass& pass, const ConstImageView& picture, ThreadPool& pool) {
  std::atomic<bool> found = false;
  for_each_band(pool, picture.height, kPassRows, [&](int first, int end) {
    for (int y = first; y < end && !found; ++y) {
      int x = 0;
      if (pool.isa() != Isa::scalar) {
        x = SOFTFOCUS_KERNEL(pool.isa(), first_bright)(pass, row<std::uint16_t>(picture, y).data(),
                                                       picture.width);
      }
      for (; x < picture.width; ++x) {
        const glm::vec4 light = light_and_share(pass, load_texel<Format::rgba16f>(picture, x, y));
        if (light.w > 0.0f) {
          found = true;
          break;
        }
      }
    }
  });
  return found;
}

void add_no_light(const ConstImageView& picture, const ImageView& result, const Profile& profile,
                  ThreadPool& pool) {
  const std::vector<std::uint16_t> zeros(4 * static_cast<std::size_t>(picture.width));
  const ConstImageView nothing{Format::rgba16f, picture.width, picture.height, 0,
                               reinterpret_cast<const std::byte*>(zeros.data())};
  add_scattered_light(kNothingBright, 0.0f, picture, nothing, result, profile, pool);
}

void add_scattered_light(const BrightPass& pass, float strength, const ConstImageView& picture,
                         const ConstImageView& scattered, const ImageView& result,
                         const Profile& profile, ThreadPool& pool) {
  for_rows(
      result, profile, pool,
      [&](int y) {
        return SOFTFOCUS_KERNEL(pool.isa(), combine_row)(
            pass, strength, row<std::uint16_t>(picture, y).data(),
            row<std::uint16_t>(scattered, y).data(), row<std::uint16_t>(result, y).data(),
            result.width, profile.half_store);
      },
      [&](int x, int y) {
        return combined(pass, strength, load_texel<Format::rgba16f>(picture, x, y),
                        load_texel<Format::rgba16f>(scattered, x, y));
      });
}

BrightPass bright_pass_of(const BloomSettings& settings) {
  const float knee = std::min(settings.knee, settings.threshold);
  return {settings.threshold,
          knee,
          settings.threshold - knee,
          2.0f * knee,
          knee > 0.0f ? 1.0f / (4.0f * knee) : 0.0f,
          settings.is_steady};
}

BrightPass bright_pass_of(const GaussianBloomSettings& settings) {
  return bright_pass_of(BloomSettings{settings.threshold, settings.knee});
}

void bloom(const BloomSettings& settings, const ConstImageView& picture, const ImageView& result,
           const Profile& profile, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && result.format == Format::rgba16f);
  assert(picture.width == result.width && picture.height == result.height);
  const BrightPass pass = bright_pass_of(settings);
  if (!has_bright_light(pass, picture, pool)) {
    return add_no_light(picture, result, profile, pool);
  }
  // In vectors the light of the picture's own size is made and used row by row, twice: two pictures
  // less that go through memory.
  const bool in_rows = pool.isa() != Isa::scalar;
  const MadeRows light{picture.width, picture.height, [&](int y, std::uint16_t* to) {
                         make_bright_row(pass, picture, y, to, profile, pool.isa());
                       }};
  std::vector<Image> levels(1);
  if (!in_rows) {
    levels[0] = make_image(Format::rgba16f, picture.width, picture.height);
    find_bright_light(pass, picture, levels[0], profile, pool);
  }
  for (int i = 0; i < settings.levels; ++i) {
    Image half = i == 0 ? half_of(picture) : half_of(levels.back());
    if (i == 0 && in_rows) {
      downsample_made(light, half, profile, pool);
    } else {
      downsample(levels.back(), half, profile, pool);
    }
    if (i == 0 && settings.is_steady) divide_by_weight(half, profile, pool);
    levels.push_back(std::move(half));
  }
  for (std::size_t i = levels.size() - 1; i-- > (in_rows ? 1u : 0u);) {
    const float share = i == 0 ? 1.0f : settings.spread;
    Image wider = make_image(Format::rgba16f, levels[i].width, levels[i].height);
    upsample(levels[i + 1], levels[i], {share}, wider, profile, pool);
    levels[i] = std::move(wider);
  }
  if (!in_rows) {
    return add_scattered_light(pass, settings.strength, picture, levels[0], result, profile, pool);
  }
  upsample_made(
      levels[1], light, {1.0f},
      [&](int y, const std::uint16_t* scattered) {
        make_combined_row(pass, settings.strength, picture, scattered, y, result, profile,
                          pool.isa());
      },
      profile, pool);
}

void bloom_by_gaussian(const GaussianBloomSettings& settings, const ConstImageView& picture,
                       const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && result.format == Format::rgba16f);
  assert(picture.width == result.width && picture.height == result.height);
  const BrightPass pass = bright_pass_of(settings);
  if (!has_bright_light(pass, picture, pool)) {
    return add_no_light(picture, result, profile, pool);
  }
  Image light = make_image(Format::rgba16f, picture.width, picture.height);
  Image across = make_image(Format::rgba16f, picture.width, picture.height);
  find_bright_light(pass, picture, light, profile, pool);
  const std::vector<float> weights = gaussian_weights(settings.sigma_px);
  convolve(row_kernel(weights), light, across, profile, pool);
  convolve(column_kernel(weights), across, light, profile, pool);
  add_scattered_light(pass, settings.strength, picture, light, result, profile, pool);
}

}  // namespace softfocus

#else  // the kernels

namespace {

SOFTFOCUS_INLINE Floats usable_lanes(Floats light) {
  const Floats cut = select(light < kLargestHalf, light, splat(kLargestHalf));
  return select(light > 0.0f, cut, splat(0.0f));
}

struct BrightLanes {
  Floats r, g, b;
};

SOFTFOCUS_INLINE Floats largest(const BrightLanes& light) {
  return larger(larger(light.r, light.g), light.b);
}

SOFTFOCUS_INLINE BrightLanes usable_light(const HalfTexels& texels) {
  return {usable_lanes(half_to_float(texels.r)), usable_lanes(half_to_float(texels.g)),
          usable_lanes(half_to_float(texels.b))};
}

SOFTFOCUS_INLINE Floats bright_share(const BrightPass& pass, const BrightLanes& light,
                                     Floats depth) {
  const Floats most = largest(light);
  const Floats above = most - pass.begin;
  const Floats cut = select(above < pass.double_knee, above, splat(pass.double_knee));
  const Floats x = select(above > 0.0f, cut, splat(0.0f));
  const Floats soft = x * x * pass.square_factor;
  const Floats hard = most - pass.threshold;
  const Floats kept = select(hard > soft, hard, soft);
  const Floats seen = select(depth < pass.beyond, splat(0.0f), most);
  return select(seen > 0.0f, kept / most, splat(0.0f));
}

SOFTFOCUS_INLINE BrightLanes bright_lanes(const BrightPass& pass, const HalfTexels& texels) {
  const BrightLanes light = usable_light(texels);
  const Floats share = bright_share(pass, light, half_to_float(texels.a));
  return {light.r * share, light.g * share, light.b * share};
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE int bright_vectors(const BrightPass& pass, const std::uint16_t* from,
                                    std::uint16_t* to, int width) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const BrightLanes light = bright_lanes(pass, load_half_texels(from + 4 * x));
    const Floats weight = pass.is_steady ? 1.0f / (1.0f + largest(light)) : splat(1.0f);
    store_half_texels(
        to + 4 * x,
        {float_to_half<rounding>(light.r * weight), float_to_half<rounding>(light.g * weight),
         float_to_half<rounding>(light.b * weight), float_to_half<rounding>(weight)});
  }
  return x;
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE int divide_vectors(std::uint16_t* texels, int width) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const HalfTexels texel = load_half_texels(texels + 4 * x);
    const Floats weight = half_to_float(texel.a);
    store_half_texels(texels + 4 * x, {float_to_half<rounding>(half_to_float(texel.r) / weight),
                                       float_to_half<rounding>(half_to_float(texel.g) / weight),
                                       float_to_half<rounding>(half_to_float(texel.b) / weight),
                                       float_to_half<rounding>(splat(1.0f))});
  }
  return x;
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE int combine_vectors(const BrightPass& pass, float strength,
                                     const std::uint16_t* picture, const std::uint16_t* scattered,
                                     std::uint16_t* to, int width) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const HalfTexels own = load_half_texels(picture + 4 * x);
    const HalfTexels wide = load_half_texels(scattered + 4 * x);
    const BrightLanes light = bright_lanes(pass, own);
    const Floats r = half_to_float(own.r) + strength * (half_to_float(wide.r) - light.r);
    const Floats g = half_to_float(own.g) + strength * (half_to_float(wide.g) - light.g);
    const Floats b = half_to_float(own.b) + strength * (half_to_float(wide.b) - light.b);
    store_half_texels(to + 4 * x,
                      {float_to_half<rounding>(r), float_to_half<rounding>(g),
                       float_to_half<rounding>(b), float_to_half<rounding>(half_to_float(own.a))});
  }
  return x;
}

}  // namespace

/// How many whole vectors of pixels have nothing bright, in pixels.
int first_bright(const BrightPass& pass, const std::uint16_t* from, int width) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const HalfTexels texels = load_half_texels(from + 4 * x);
    if (any(bright_share(pass, usable_light(texels), half_to_float(texels.a)) > 0.0f)) break;
  }
  return x;
}

/// Each returns how many pixels are done.
int bright_row(const BrightPass& pass, const std::uint16_t* from, std::uint16_t* to, int width,
               HalfRounding rounding) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return bright_vectors<nearest_even>(pass, from, to, width);
    case toward_zero: return bright_vectors<toward_zero>(pass, from, to, width);
    case swiftshader: break;
  }
  return bright_vectors<swiftshader>(pass, from, to, width);
}

int divide_row(std::uint16_t* texels, int width, HalfRounding rounding) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return divide_vectors<nearest_even>(texels, width);
    case toward_zero: return divide_vectors<toward_zero>(texels, width);
    case swiftshader: break;
  }
  return divide_vectors<swiftshader>(texels, width);
}

int combine_row(const BrightPass& pass, float strength, const std::uint16_t* picture,
                const std::uint16_t* scattered, std::uint16_t* to, int width,
                HalfRounding rounding) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even:
      return combine_vectors<nearest_even>(pass, strength, picture, scattered, to, width);
    case toward_zero:
      return combine_vectors<toward_zero>(pass, strength, picture, scattered, to, width);
    case swiftshader: break;
  }
  return combine_vectors<swiftshader>(pass, strength, picture, scattered, to, width);
}

#endif
