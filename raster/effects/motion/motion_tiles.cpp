#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "raster/effects/motion/motion_blur.h"
#include "raster/images/texel.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "raster/effects/motion/motion_tiles.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

float finite_or_0(float px) { return std::fabs(px) <= 65504.0f ? px : 0.0f; }

glm::vec4 to_either_side(const MotionBlurPass& pass, glm::vec4 velocity) {
  const float x = finite_or_0(velocity.x) * pass.to_half,
              y = finite_or_0(velocity.y) * pass.to_half;
  const float length = std::sqrt(x * x + y * y);
  const auto most = static_cast<float>(pass.radius_px);
  const float shorter = length > most ? most / length : 1.0f;
  const float cut = length > most ? most : length;
  return {x * shorter, y * shorter, 1.0f / (cut > 0.5f ? cut : 0.5f), 0.0f};
}

bool is_longer(glm::vec2 a, glm::vec2 b) {
  const float of_a = a.x * a.x + a.y * a.y, of_b = b.x * b.x + b.y * b.y;
  if (of_a != of_b) return of_a > of_b;
  return a.x != b.x ? a.x > b.x : a.y > b.y;
}

}  // namespace

MotionBlurPass pass_of(const MotionBlurSettings& settings) {
  const int across = settings.filter == MotionFilter::two_ways ? settings.samples / 2 : 0;
  const auto along_samples = static_cast<float>(settings.samples - across);
  const auto across_samples = static_cast<float>(std::max(across, 1));
  return {
      .samples = settings.samples - across,
      .sample_part = 1.0f / along_samples,
      .step = 2.0f / along_samples,
      .across_samples = across,
      .across_part = 1.0f / across_samples,
      .across_step = 2.0f / across_samples,
      .radius_px = settings.radius_px,
      .inverse_depth = (settings.filter == MotionFilter::two_ways ? 2.0f : 1.0f) / settings.depth,
      .to_half = 0.5f * settings.shutter,
      .filter = settings.filter};
}

void motion_to_either_side(const MotionBlurPass& pass, const ConstImageView& velocity,
                           const ImageView& spread, const Profile& profile, ThreadPool& pool) {
  assert(velocity.format == Format::rg16f && spread.format == Format::rgba16f);
  for_each_row(pool, spread.height, kPassRows, [&](int y) {
    int x = 0;
    if (pool.isa() != Isa::scalar) {
      x = SOFTFOCUS_KERNEL(pool.isa(), spread_row)(pass, row<std::uint16_t>(velocity, y).data(),
                                                   row<std::uint16_t>(spread, y).data(),
                                                   spread.width, profile.half_store);
    }
    for (; x < spread.width; ++x) {
      store_texel<Format::rgba16f>(
          spread, x, y, to_either_side(pass, load_texel<Format::rg16f>(velocity, x, y)), profile);
    }
  });
}

MotionTiles longest_of_tiles(const MotionBlurPass& pass, const ConstImageView& spread,
                             ThreadPool& pool) {
  const int size = pass.radius_px;
  MotionTiles tiles{(spread.width + size - 1) / size, (spread.height + size - 1) / size, {}};
  const auto columns = static_cast<std::size_t>(tiles.columns);
  tiles.v.resize(columns * static_cast<std::size_t>(tiles.rows));
  pool.for_each(tiles.rows, [&](int row_of_tiles) {
    glm::vec2* longest = tiles.v.data() + columns * static_cast<std::size_t>(row_of_tiles);
    const int end_y = std::min((row_of_tiles + 1) * size, spread.height);
    for (int y = row_of_tiles * size; y < end_y; ++y) {
      const std::uint16_t* texels = row<std::uint16_t>(spread, y).data();
      for (int tile = 0; tile < tiles.columns; ++tile) {
        const int end = std::min((tile + 1) * size, spread.width);
        int x = tile * size;
        if (pool.isa() != Isa::scalar) {
          x = SOFTFOCUS_KERNEL(pool.isa(), longest_in_row)(texels, x, end, longest[tile]);
        }
        for (; x < end; ++x) {
          const glm::vec2 v{load_texel<Format::rgba16f>(spread, x, y)};
          if (is_longer(v, longest[tile])) longest[tile] = v;
        }
      }
    }
  });
  return tiles;
}

MotionTiles longest_of_neighbours(const MotionTiles& tiles, MotionFilter filter) {
  MotionTiles all{tiles.columns, tiles.rows, {}};
  all.v.reserve(tiles.v.size());
  for (int y = 0; y < tiles.rows; ++y) {
    for (int x = 0; x < tiles.columns; ++x) {
      glm::vec2 longest{0.0f};
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          if (x + i < 0 || x + i >= tiles.columns || y + j < 0 || y + j >= tiles.rows) continue;
          const glm::vec2 v = tiles.v[static_cast<std::size_t>((y + j) * tiles.columns + x + i)];
          const bool at_corner = i * j != 0;
          // Motions go to either side: their sign does not matter, the diagonal does.
          if (at_corner && filter == MotionFilter::two_ways &&
              !(static_cast<float>(i * j) * v.x * v.y > 0.0f)) {
            continue;
          }
          if (is_longer(v, longest)) longest = v;
        }
      }
      all.v.push_back(longest);
    }
  }
  return all;
}

}  // namespace softfocus

#else  // the kernels

namespace {

SOFTFOCUS_INLINE Floats finite_or_0_lanes(Floats px) {
  return select(absolute(px) <= 65504.0f, px, splat(0.0f));
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE int spread_vectors(const MotionBlurPass& pass, const std::uint16_t* from,
                                    std::uint16_t* to, int width) {
  const float most = static_cast<float>(pass.radius_px);
  const Bits none{};
  const Bits still = float_to_half<rounding>(splat(2.0f));
  int i = 0;
  for (; i + kLanes <= width; i += kLanes) {
    const HalfPairs velocity = load_half_pairs(from + 2 * i);
    if (all(as_ints((velocity.r | velocity.g) & 0x7FFFu) == 0)) {
      store_half_texels(to + 4 * i, {none, none, still, none});
      continue;
    }
    const Floats x = finite_or_0_lanes(half_to_float(velocity.r)) * pass.to_half;
    const Floats y = finite_or_0_lanes(half_to_float(velocity.g)) * pass.to_half;
    const Floats length = square_root(x * x + y * y);
    const Mask is_long = length > most;
    const Floats shorter = select(is_long, most / length, splat(1.0f));
    const Floats cut = select(is_long, splat(most), length);
    const Floats inverse = 1.0f / select(cut > 0.5f, cut, splat(0.5f));
    store_half_texels(to + 4 * i,
                      {float_to_half<rounding>(x * shorter), float_to_half<rounding>(y * shorter),
                       float_to_half<rounding>(inverse), none});
  }
  return i;
}

}  // namespace

/// Returns how many pixels are done.
int spread_row(const MotionBlurPass& pass, const std::uint16_t* from, std::uint16_t* to, int width,
               HalfRounding rounding) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return spread_vectors<nearest_even>(pass, from, to, width);
    case toward_zero: return spread_vectors<toward_zero>(pass, from, to, width);
    case swiftshader: break;
  }
  return spread_vectors<swiftshader>(pass, from, to, width);
}

/// Takes the pixels from `x` on into account; returns the first that is not.
int longest_in_row(const std::uint16_t* texels, int x, int end, glm::vec2& longest) {
  if (x + kLanes > end) return x;
  Floats best_x = splat(longest.x), best_y = splat(longest.y);
  Floats best = best_x * best_x + best_y * best_y;
  for (; x + kLanes <= end; x += kLanes) {
    const HalfTexels texel = load_half_texels(texels + 4 * x);
    const Floats v_x = half_to_float(texel.r), v_y = half_to_float(texel.g);
    const Floats square = v_x * v_x + v_y * v_y;
    const Mask as_long = (square == best) & ((v_x > best_x) | ((v_x == best_x) & (v_y > best_y)));
    const Mask longer = (square > best) | as_long;
    best = select(longer, square, best);
    best_x = select(longer, v_x, best_x);
    best_y = select(longer, v_y, best_y);
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    const glm::vec2 v{best_x[lane], best_y[lane]};
    const float of_v = best[lane], of_longest = longest.x * longest.x + longest.y * longest.y;
    const bool is_longer = of_v != of_longest ? of_v > of_longest
                           : v.x != longest.x ? v.x > longest.x
                                              : v.y > longest.y;
    if (is_longer) longest = v;
  }
  return x;
}

#endif
