#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "scenes/surface_splatting/surface_splatting.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>

#include "dof/weights.h"
#include "raster/images/texel.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

constexpr int kTile = 32;  // pixels along a side: whole vectors of every unit
constexpr std::size_t kTilePixels = std::size_t{kTile} * kTile;

// A splat where it meets a tile: places are from the tile's corner.
struct TileSplat {
  float x_px, y_px;
  float inverse_2v;
  float opacity;
  float reach_px;
  float r, g, b;
};

// Pixels of a tile, row by row.
struct TilePlanes {
  float* open;  // P
  float* r;
  float* g;
  float* b;
};

}  // namespace
}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/surface_splatting/surface_splatting.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

float falling_exponential(float t) {
  const float u = t * 0.125f;
  float p = 1.0f / 5040.0f;
  p = 1.0f / 720.0f - u * p;
  p = 1.0f / 120.0f - u * p;
  p = 1.0f / 24.0f - u * p;
  p = 1.0f / 6.0f - u * p;
  p = 0.5f - u * p;
  p = 1.0f - u * p;
  p = 1.0f - u * p;
  p = p * p;
  p = p * p;
  return p * p;
}

namespace {

// A Gaussian cut at 3 standard deviations has 0.9733 of its variance and 0.9973 of its weight.
constexpr float kCutVariance = 1.0f / 0.973337f;
constexpr float kCutWeight = 0.9973002f;
constexpr float kTwoPi = 6.28318531f;

// Below this radius a splat is its pixel: the nearest neighbours would get less than 2^-11.
constexpr float kSharpRadius = 0.5f;

// Up to this variance the weights at the pixels are added one by one.
constexpr float kSummedVariance = 4.0f;

float sum_at_pixels(float inverse_2v, float reach_px) {
  float sum = 1.0f;
  for (int i = 1; static_cast<float>(i) <= reach_px; ++i) {
    const float distance = static_cast<float>(i);
    sum += 2.0f * falling_exponential(distance * distance * inverse_2v);
  }
  return sum;
}

}  // namespace

Footprint footprint_of(const Splat& splat) {
  if (splat.radius_px < kSharpRadius) return {0.0f, 1.0f, 0.5f};
  float variance = splat.radius_px * splat.radius_px * 0.25f;
  if (splat.area_px > 1.0f) variance -= splat.area_px * (1.0f / 12.0f);
  variance *= kCutVariance;
  const float inverse_2v = 0.5f / variance;
  const float reach_px = 3.0f * std::sqrt(variance);
  if (variance <= kSummedVariance && splat.area_px == 1.0f) {
    const float sum = sum_at_pixels(inverse_2v, reach_px);
    return {inverse_2v, 1.0f / (sum * sum), reach_px};
  }
  const float weight = kCutWeight * kCutWeight * kTwoPi * variance;
  return {inverse_2v, splat.area_px / weight, reach_px};
}

namespace {

// --- scalar ---

float along_axis(float distance, const TileSplat& splat) {
  if (!(std::fabs(distance) <= splat.reach_px)) return 0.0f;
  return falling_exponential(distance * distance * splat.inverse_2v);
}

void add_splat_scalar(const TileSplat& splat, int x_begin, int x_end, int y_begin, int y_end,
                      float* rest, const TilePlanes& planes) {
  for (int y = y_begin; y < y_end; ++y) {
    const float row = splat.opacity * along_axis(static_cast<float>(y) + 0.5f - splat.y_px, splat);
    for (int x = x_begin; x < x_end; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * kTile + static_cast<std::size_t>(x);
      const float weight = row * along_axis(static_cast<float>(x) + 0.5f - splat.x_px, splat);
      const float taken = std::min(weight, rest[at]);
      const float share = taken > 0.0f ? planes.open[at] * (taken / rest[at]) : 0.0f;
      planes.r[at] += share * splat.r;
      planes.g[at] += share * splat.g;
      planes.b[at] += share * splat.b;
      planes.open[at] -= share;
      rest[at] -= taken;
    }
  }
}

// --- tiles ---

struct PlacedSplat {
  Footprint footprint;
  int left, right, top, bottom;  // pixels that it reaches, the last excluded
};

PlacedSplat placed(const Splat& splat) {
  const Footprint footprint = footprint_of(splat);
  const auto first = [&](float at) {
    return static_cast<int>(std::ceil(at - footprint.reach_px - 0.5f));
  };
  const auto end = [&](float at) {
    return static_cast<int>(std::floor(at + footprint.reach_px - 0.5f)) + 1;
  };
  if (footprint.inverse_2v > 0.0f) {
    return {footprint, first(splat.x_px), end(splat.x_px), first(splat.y_px), end(splat.y_px)};
  }
  const int x = static_cast<int>(std::floor(splat.x_px)),
            y = static_cast<int>(std::floor(splat.y_px));
  return {footprint, x, x + 1, y, y + 1};
}

// From front to back: 1/depth is positive, so its bits are in its order.
std::uint64_t sort_key(const Splat& splat, std::uint32_t number) {
  const std::uint32_t depth = ~std::bit_cast<std::uint32_t>(splat.inverse_depth);
  return static_cast<std::uint64_t>(depth) << 32 | number;
}

using TileList = std::vector<std::uint64_t>;

// The splats of each tile of a row of tiles.
std::vector<TileList> lists_of_row(std::span<const Splat> splats,
                                   const std::vector<PlacedSplat>& places, int tile_y,
                                   int tiles_across) {
  std::vector<TileList> lists(static_cast<std::size_t>(tiles_across));
  const int top = tile_y * kTile;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const PlacedSplat& place = places[i];
    if (place.bottom <= top || place.top >= top + kTile || place.right <= 0) continue;
    const int first = std::max(place.left, 0) / kTile;
    const int last = std::min((place.right - 1) / kTile, tiles_across - 1);
    const std::uint64_t key = sort_key(splats[i], static_cast<std::uint32_t>(i));
    for (int tile = first; tile <= last; ++tile)
      lists[static_cast<std::size_t>(tile)].push_back(key);
  }
  return lists;
}

// A task's memory: P and colours, and R of the tile's surfaces.
struct SplatTile {
  std::vector<float> planes;
  std::vector<float> rests;
  std::vector<int> slot_of_surface;  // -1: not yet in the tile
  std::vector<std::uint32_t> used;
};

float* rest_of(SplatTile& memory, std::uint32_t surface) {
  int& slot = memory.slot_of_surface[surface];
  if (slot < 0) {
    slot = static_cast<int>(memory.used.size());
    memory.used.push_back(surface);
    const std::size_t needed = memory.used.size() * kTilePixels;
    if (memory.rests.size() < needed) memory.rests.resize(2 * needed);
    const auto first = memory.rests.begin() + static_cast<std::ptrdiff_t>(needed - kTilePixels);
    std::fill(first, first + kTilePixels, 1.0f);
  }
  return memory.rests.data() + static_cast<std::size_t>(slot) * kTilePixels;
}

void clear(SplatTile& memory, std::uint32_t surfaces) {
  if (memory.planes.empty()) {
    memory.planes.resize(4 * kTilePixels);
    memory.slot_of_surface.assign(surfaces, -1);
  }
  for (const std::uint32_t surface : memory.used) memory.slot_of_surface[surface] = -1;
  memory.used.clear();
  std::fill(memory.planes.begin(), memory.planes.begin() + kTilePixels, 1.0f);
  std::fill(memory.planes.begin() + kTilePixels, memory.planes.end(), 0.0f);
}

TilePlanes planes_of(SplatTile& memory) {
  float* first = memory.planes.data();
  return {first, first + kTilePixels, first + 2 * kTilePixels, first + 3 * kTilePixels};
}

void add_splats(std::span<const Splat> splats, const std::vector<PlacedSplat>& places,
                const TileList& list, int left, int top, SplatTile& memory, Isa isa) {
  const TilePlanes planes = planes_of(memory);
  for (const std::uint64_t key : list) {
    const auto i = static_cast<std::size_t>(key & 0xFFFFFFFFu);
    const Splat& splat = splats[i];
    const PlacedSplat& place = places[i];
    const int x_begin = std::max(place.left - left, 0), x_end = std::min(place.right - left, kTile);
    const int y_begin = std::max(place.top - top, 0), y_end = std::min(place.bottom - top, kTile);
    const bool sharp = place.footprint.inverse_2v == 0.0f;
    const TileSplat of_tile{
        sharp ? static_cast<float>(x_begin) + 0.5f : splat.x_px - static_cast<float>(left),
        sharp ? static_cast<float>(y_begin) + 0.5f : splat.y_px - static_cast<float>(top),
        place.footprint.inverse_2v,
        place.footprint.opacity,
        place.footprint.reach_px,
        splat.colour.x,
        splat.colour.y,
        splat.colour.z};
    float* rest = rest_of(memory, splat.surface);
    if (isa == Isa::scalar || sharp) {
      add_splat_scalar(of_tile, x_begin, x_end, y_begin, y_end, rest, planes);
    } else {
      SOFTFOCUS_KERNEL(isa, add_splat)(of_tile, x_begin, x_end, y_begin, y_end, rest, planes);
    }
  }
}

// Less than this of the lens sees a splat: then there are none.
constexpr float kLeastFound = 0x1p-10f;

void store_tile(const TilePlanes& planes, int left, int top, glm::vec3 background,
                const Image& depth, const Profile& profile, Image& picture) {
  for (int y = top; y < std::min(top + kTile, picture.height); ++y) {
    for (int x = left; x < std::min(left + kTile, picture.width); ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y - top) * kTile + static_cast<std::size_t>(x - left);
      const float found = 1.0f - planes.open[at];
      const auto colour = [&](const float* plane, float empty) {
        return found > kLeastFound ? clamp_to_half(plane[at] / found) : empty;
      };
      store_texel<Format::rgba16f>(
          picture, x, y,
          {colour(planes.r, background.x), colour(planes.g, background.y),
           colour(planes.b, background.z), load_texel<Format::rgba16f>(depth, x, y).w},
          profile);
    }
  }
}

}  // namespace

Image draw_splats(std::span<const Splat> splats, std::uint32_t surfaces, glm::vec3 background,
                  const Image& depth, const Profile& profile, ThreadPool& pool) {
  Image picture = make_image(Format::rgba16f, depth.width, depth.height);
  std::vector<PlacedSplat> places(splats.size());
  constexpr int kRun = 4096;
  const int runs = static_cast<int>((splats.size() + kRun - 1) / kRun);
  pool.for_each(runs, [&](int run) {
    const std::size_t begin = static_cast<std::size_t>(run) * kRun;
    const std::size_t end = std::min(begin + kRun, splats.size());
    for (std::size_t i = begin; i < end; ++i) places[i] = placed(splats[i]);
  });
  const int across = (depth.width + kTile - 1) / kTile;
  const int down = (depth.height + kTile - 1) / kTile;
  std::vector<std::vector<TileList>> lists(static_cast<std::size_t>(down));
  pool.for_each(down, [&](int tile_y) {
    lists[static_cast<std::size_t>(tile_y)] = lists_of_row(splats, places, tile_y, across);
  });
  for_each_with<SplatTile>(pool, across * down, [&](int tile, auto& memory) {
    TileList& list =
        lists[static_cast<std::size_t>(tile / across)][static_cast<std::size_t>(tile % across)];
    std::sort(list.begin(), list.end());
    clear(memory, surfaces);
    const int left = tile % across * kTile, top = tile / across * kTile;
    add_splats(splats, places, list, left, top, memory, pool.isa());
    store_tile(planes_of(memory), left, top, background, depth, profile, picture);
    TileList{}.swap(list);
  });
  return picture;
}

SampledPicture surface_splatting(const LensViewInput& input, ThreadPool& pool) {
  const std::vector<Splat> splats = surface_splats(input, pool);
  const auto surfaces = static_cast<std::uint32_t>(input.scene.objects.size() + 1);
  return {draw_splats(splats, surfaces, input.scene.background, input.pinhole, input.profile, pool),
          1,
          {},
          {}};
}

}  // namespace softfocus

#else  // kernels

namespace {

SOFTFOCUS_INLINE Floats falling_exponential(Floats t) {
  const Floats u = t * 0.125f;
  Floats p = splat(1.0f / 5040.0f);
  p = 1.0f / 720.0f - u * p;
  p = 1.0f / 120.0f - u * p;
  p = 1.0f / 24.0f - u * p;
  p = 1.0f / 6.0f - u * p;
  p = 0.5f - u * p;
  p = 1.0f - u * p;
  p = 1.0f - u * p;
  p = p * p;
  p = p * p;
  return p * p;
}

// The Gaussian along an axis at the vectors of pixels from `begin` to `end`.
SOFTFOCUS_INLINE void along_axis(const TileSplat& by, float middle, int begin, int end, float* to) {
  const Floats reach = splat(by.reach_px);
  for (int i = begin; i < end; i += kLanes) {
    const Floats distance = (to_floats(lane_numbers() + i) + 0.5f) - middle;
    const Floats value = falling_exponential(distance * distance * by.inverse_2v);
    store(to + i, select(absolute(distance) <= reach, value, splat(0.0f)));
  }
}

}  // namespace

/// add_splat_scalar() in whole vectors: outside the splat nothing changes.
void add_splat(const TileSplat& by, int x_begin, int x_end, int y_begin, int y_end, float* rest,
               const TilePlanes& planes) {
  float columns[kTile], rows[kTile];
  x_begin = x_begin / kLanes * kLanes;
  along_axis(by, by.x_px, x_begin, x_end, columns);
  along_axis(by, by.y_px, y_begin / kLanes * kLanes, y_end, rows);
  for (int y = y_begin; y < y_end; ++y) {
    const float row = by.opacity * rows[y];
    for (int x = x_begin; x < x_end; x += kLanes) {
      const int at = y * kTile + x;
      const Floats weight = row * load(columns + x);
      const Floats left = load(rest + at), open = load(planes.open + at);
      const Floats taken = smaller(weight, left);
      const Floats share = select(taken > 0.0f, open * (taken / left), splat(0.0f));
      store(planes.r + at, load(planes.r + at) + share * by.r);
      store(planes.g + at, load(planes.g + at) + share * by.g);
      store(planes.b + at, load(planes.b + at) + share * by.b);
      store(planes.open + at, open - share);
      store(rest + at, left - taken);
    }
  }
}

#endif
