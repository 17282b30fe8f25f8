#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "scenes/warped_views/warped_colours.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace softfocus {

// A tile, and the planes that its colours come from. `red` and so on are of the source's first
// pixel, `tile_radii` and the sums of the tile's.
struct ColouredTile {
  const float *red = nullptr, *green = nullptr, *blue = nullptr, *radii = nullptr;
  int source_stride = 0;
  float shift_x = 0.0f, shift_y = 0.0f;
  float most_shift = 0.0f;
  Rectangle area;
  const float* tile_radii = nullptr;
  float *red_sum = nullptr, *green_sum = nullptr, *blue_sum = nullptr;
  int tile_stride = 0;
  std::int32_t* holes = nullptr;
};

// Added to a place to find its whole part, so that parts of a pixel are at least -kWholePx.
constexpr float kFloorPx = 0.5f - kWholePx;

constexpr std::int32_t hole_at(int x, int y) { return y << 16 | x; }

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/warped_views/warped_colours.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// From a pixel to where it comes from: a whole number and a part of a pixel, 0 to 63/64.
struct WayBack {
  int whole;
  float part;
};

WayBack way_back(float radius, float shift) {
  const float way = radius * -shift;
  const int whole = nearest_whole(way - kFloorPx);
  const float part = way - static_cast<float>(whole);
  return {whole, part < kWholePx ? 0.0f : part};
}

int add_tile_scalar(const ColouredTile& tile) {
  int holes = 0;
  for (int y = tile.area.y_begin; y < tile.area.y_end; ++y) {
    const int first = (y - tile.area.y_begin) * tile.tile_stride;
    for (int x = tile.area.x_begin; x < tile.area.x_end; ++x) {
      const int to = first + x - tile.area.x_begin;
      const float noted = tile.tile_radii[to];
      if (noted == kHoleRadius) {
        tile.holes[holes++] = hole_at(x, y);
        continue;
      }
      const float radius = radius_of(noted);
      const SourcePixel shown = shown_pixel({tile.shift_x, tile.shift_y}, x, y, noted);
      const int own = shown.y * tile.source_stride + shown.x;
      const WayBack back_x = way_back(radius, tile.shift_x),
                    back_y = way_back(radius, tile.shift_y);
      const int begin = (y + back_y.whole) * tile.source_stride + x + back_x.whole;
      const float w_x = back_x.part, w_y = back_y.part;
      const std::array<int, 4> taps{begin, begin + 1, begin + tile.source_stride,
                                    begin + tile.source_stride + 1};
      const std::array<float, 4> weights{(1.0f - w_x) * (1.0f - w_y), w_x * (1.0f - w_y),
                                         (1.0f - w_x) * w_y, w_x * w_y};
      const auto tap_or_own = [&](std::size_t tap) {
        const float away = std::fabs(radius_of(tile.radii[taps[tap]]) - radius) * tile.most_shift;
        return away <= kSameSurfacePx ? taps[tap] : own;
      };
      const auto read = [&](const float* plane) {
        if (w_x == 0.0f && w_y == 0.0f) return plane[tap_or_own(0)];
        float sum = plane[tap_or_own(0)] * weights[0];
        for (std::size_t tap = 1; tap < 4; ++tap) sum += plane[tap_or_own(tap)] * weights[tap];
        return sum;
      };
      tile.red_sum[to] += read(tile.red);
      tile.green_sum[to] += read(tile.green);
      tile.blue_sum[to] += read(tile.blue);
    }
  }
  return holes;
}

}  // namespace

void add_colours(const WarpSource& source, glm::vec2 shift, WarpTile& tile, WarpedColours& sums,
                 Isa isa) {
  const std::size_t first = plane_at(source, 0, 0);
  const Rectangle& area = tile.area;
  const std::size_t pixels = static_cast<std::size_t>(area.x_end - area.x_begin) *
                             static_cast<std::size_t>(area.y_end - area.y_begin);
  if (tile.places_of_holes.size() < pixels) tile.places_of_holes.resize(pixels);
  const ColouredTile coloured{.red = source.red.data() + first,
                              .green = source.green.data() + first,
                              .blue = source.blue.data() + first,
                              .radii = source.radii.data() + first,
                              .source_stride = plane_stride(source),
                              .shift_x = shift.x,
                              .shift_y = shift.y,
                              .most_shift = std::max(std::fabs(shift.x), std::fabs(shift.y)),
                              .area = area,
                              .tile_radii = tile.radii.data() + kTileBorder,
                              .red_sum = sums.red.data() + kTileBorder,
                              .green_sum = sums.green.data() + kTileBorder,
                              .blue_sum = sums.blue.data() + kTileBorder,
                              .tile_stride = tile_stride(tile),
                              .holes = tile.places_of_holes.data()};
  const int holes =
      isa == Isa::scalar ? add_tile_scalar(coloured) : SOFTFOCUS_KERNEL(isa, add_tile)(coloured);
  tile.hole_count = static_cast<std::size_t>(holes);
}

void settle_sums(std::span<float> sums, std::span<double> totals, Isa isa) {
  if (isa != Isa::scalar) {
    SOFTFOCUS_KERNEL(isa, settle)(sums.data(), totals.data(), sums.size());
    return;
  }
  for (std::size_t i = 0; i < sums.size(); ++i) totals[i] += static_cast<double>(sums[i]);
  std::fill(sums.begin(), sums.end(), 0.0f);
}

}  // namespace softfocus

#else  // kernels

#include "scenes/warped_views/noted_lanes.inl"

using WarpTotals [[gnu::vector_size(8 * SOFTFOCUS_LANES)]] = double;

/// Adds the sums to the totals, and forgets them.
void settle(float* sums, double* totals, std::size_t count) {
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    WarpTotals total;
    std::memcpy(&total, totals + i, sizeof total);
    total += __builtin_convertvector(load(sums + i), WarpTotals);
    std::memcpy(totals + i, &total, sizeof total);
    store(sums + i, splat(0.0f));
  }
  for (; i < count; ++i) {
    totals[i] += static_cast<double>(sums[i]);
    sums[i] = 0.0f;
  }
}

namespace {

// way_back() of each lane.
struct WaysBack {
  Ints whole;
  Floats part;
};
SOFTFOCUS_INLINE WaysBack ways_back(Floats radii, float shift) {
  const Floats way = radii * -shift;
  const Ints whole = nearest_wholes(way - kFloorPx);
  const Floats part = way - to_floats(whole);
  return {whole, select(part < kWholePx, splat(0.0f), part)};
}

struct WarpWeights {
  Floats first, x, y, xy;
};
SOFTFOCUS_INLINE WarpWeights warp_weights(Floats w_x, Floats w_y) {
  return {(1.0f - w_x) * (1.0f - w_y), w_x * (1.0f - w_y), (1.0f - w_x) * w_y, w_x * w_y};
}

SOFTFOCUS_INLINE Floats read_smooth(const float* plane, int stride, const WarpWeights& weights) {
  return load(plane) * weights.first + load(plane + 1) * weights.x +
         load(plane + stride) * weights.y + load(plane + stride + 1) * weights.xy;
}

// Which of four taps are of a pixel's own surface.
struct SameTaps {
  Mask first, x, y, xy;
};
SOFTFOCUS_INLINE Mask same_surface(const float* noted, Floats radii, float most_shift) {
  return absolute(without_notes(load(noted)) - radii) * most_shift <= kSameSurfacePx;
}
SOFTFOCUS_INLINE Floats read_same(const float* plane, int stride, const WarpWeights& weights,
                                  const SameTaps& same, Floats own) {
  return select(same.first, load(plane), own) * weights.first +
         select(same.x, load(plane + 1), own) * weights.x +
         select(same.y, load(plane + stride), own) * weights.y +
         select(same.xy, load(plane + stride + 1), own) * weights.xy;
}

SOFTFOCUS_INLINE void add_vector(float* sums, Floats values) { store(sums, load(sums) + values); }

// shown_pixel(), as a place in the planes.
SOFTFOCUS_INLINE Ints shown_places(const ColouredTile& tile, int first, Floats noted,
                                   Floats radii) {
  const Ints note = as_ints(as_bits(noted) & kRadiusNotes);
  const Ints x = nearest_wholes(radii * tile.shift_x) + (note == std::int32_t{kRightOf}) -
                 (note == std::int32_t{kLeftOf});
  const Ints y = nearest_wholes(radii * tile.shift_y) + (note == std::int32_t{kBelow}) -
                 (note == std::int32_t{kAbove});
  return lane_numbers() + first - x - y * tile.source_stride;
}

// A vector whose pixels come from several places, or that has an edge of a surface. `first` is the
// place of its first pixel in the planes, `to` in the sums.
SOFTFOCUS_INLINE void add_rough(const ColouredTile& tile, int first, int to, Mask there,
                                Floats noted, const WaysBack& x, const WaysBack& y) {
  const Floats radii = without_notes(noted);
  const WarpWeights weights = warp_weights(x.part, y.part);
  const Mask smooth = there & ((as_bits(noted) & kRadiusNotes) == kSmoothNote);
  const Ints begins = y.whole * tile.source_stride + x.whole;
  const Mask rough = there & ~smooth;
  Floats own_red{}, own_green{}, own_blue{};
  if (any(rough)) {
    const Ints places = shown_places(tile, first, noted, radii);
    own_red = gather(tile.red, places, rough);
    own_green = gather(tile.green, places, rough);
    own_blue = gather(tile.blue, places, rough);
  }
  const int stride = tile.source_stride;
  Floats red{}, green{}, blue{};
  unsigned lanes = lane_bits(there);
  while (lanes != 0) {
    const std::int32_t begin = begins[__builtin_ctz(lanes)];
    const Mask group = there & (begins == begin);
    lanes &= ~lane_bits(group);
    const int at = first + begin;
    const float *const reds = tile.red + at, *const greens = tile.green + at,
                       *const blues = tile.blue + at, *const others = tile.radii + at;
    if (any(group & rough)) {
      const SameTaps same{smooth | same_surface(others, radii, tile.most_shift),
                          smooth | same_surface(others + 1, radii, tile.most_shift),
                          smooth | same_surface(others + stride, radii, tile.most_shift),
                          smooth | same_surface(others + stride + 1, radii, tile.most_shift)};
      red = select(group, read_same(reds, stride, weights, same, own_red), red);
      green = select(group, read_same(greens, stride, weights, same, own_green), green);
      blue = select(group, read_same(blues, stride, weights, same, own_blue), blue);
    } else {
      red = select(group, read_smooth(reds, stride, weights), red);
      green = select(group, read_smooth(greens, stride, weights), green);
      blue = select(group, read_smooth(blues, stride, weights), blue);
    }
  }
  add_vector(tile.red_sum + to, red);
  add_vector(tile.green_sum + to, green);
  add_vector(tile.blue_sum + to, blue);
}

}  // namespace

/// Returns how many holes there are.
int add_tile(const ColouredTile& tile) {
  int holes = 0;
  const int width = tile.area.x_end - tile.area.x_begin;
  for (int y = tile.area.y_begin; y < tile.area.y_end; ++y) {
    const int row = (y - tile.area.y_begin) * tile.tile_stride;
    // Most pixels come from beside where their left neighbours come from.
    int way_x = 0, way_y = 0;
    for (int i = 0; i < width; i += kLanes) {
      const int to = row + i, first = y * tile.source_stride + tile.area.x_begin + i;
      const Floats noted = load(tile.tile_radii + to), radii = without_notes(noted);
      const WaysBack back_x = ways_back(radii, tile.shift_x),
                     back_y = ways_back(radii, tile.shift_y);
      const Mask smooth = (as_bits(noted) & kRadiusNotes) == kSmoothNote;
      if (all(smooth & (back_x.whole == way_x) & (back_y.whole == way_y))) {
        const int at = first + way_y * tile.source_stride + way_x;
        const float *const red = tile.red + at, *const green = tile.green + at,
                           *const blue = tile.blue + at;
        if (all((back_x.part == 0.0f) & (back_y.part == 0.0f))) {
          add_vector(tile.red_sum + to, load(red));
          add_vector(tile.green_sum + to, load(green));
          add_vector(tile.blue_sum + to, load(blue));
          continue;
        }
        const WarpWeights weights = warp_weights(back_x.part, back_y.part);
        add_vector(tile.red_sum + to, read_smooth(red, tile.source_stride, weights));
        add_vector(tile.green_sum + to, read_smooth(green, tile.source_stride, weights));
        add_vector(tile.blue_sum + to, read_smooth(blue, tile.source_stride, weights));
        continue;
      }
      Mask there = first_lanes(width - i);
      const Mask hole = there & (noted == kHoleRadius);
      for (unsigned lanes = lane_bits(hole); lanes != 0; lanes &= lanes - 1) {
        tile.holes[holes++] = hole_at(tile.area.x_begin + i + __builtin_ctz(lanes), y);
      }
      there &= ~hole;
      if (!any(there)) continue;
      add_rough(tile, first, to, there, noted, back_x, back_y);
      const int last = 31 - __builtin_clz(lane_bits(there));
      way_x = back_x.whole[last];
      way_y = back_y.whole[last];
    }
  }
  return holes;
}

#endif
