#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "scenes/warped_views/warp.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace softfocus {

// A part of a block of a source, and the tile that it is warped to.
struct WarpedBlock {
  const float* radii = nullptr;  // of the part's first pixel
  int source_stride = 0;
  int x = 0, y = 0;  // of the first pixel, from the tile's
  int columns = 0, rows = 0;
  int room = 0;           // pixels from the first one to the end of the source's row
  bool is_rigid = false;  // all, and their neighbours, go the way of the first
  float shift_x = 0.0f, shift_y = 0.0f;
  float* tile_radii = nullptr;  // of the tile's first pixel
  int tile_stride = 0, tile_width = 0, tile_height = 0;
};

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

// Of the whole part of a place, so that parts of a pixel are at least -kWholePx.
constexpr float kFloorPx = 0.5f - kWholePx;

constexpr std::int32_t hole_at(int x, int y) { return y << 16 | x; }

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/warped_views/warp.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

void put(const WarpedBlock& block, int x, int y, float radius) {
  if (x < 0 || x >= block.tile_width || y < 0 || y >= block.tile_height) return;
  float& there = block.tile_radii[y * block.tile_stride + x];
  there = std::min(there, radius);
}

void warp_block_scalar(const WarpedBlock& block) {
  for (int row = 0; row < block.rows; ++row) {
    const float* const radii = block.radii + row * block.source_stride;
    for (int i = 0; i < block.columns; ++i) {
      const float radius = radius_of(radii[i]), left = radius_of(radii[i - 1]),
                  above = radius_of(radii[i - block.source_stride]);
      const int dx = nearest_whole(radius * block.shift_x),
                dy = nearest_whole(radius * block.shift_y);
      const int x = block.x + i + dx, y = block.y + row + dy;
      put(block, x, y, radii[i]);
      if (dx - nearest_whole(left * block.shift_x) == 1) {
        if (left > radius) {
          put(block, x - 1, block.y + row + nearest_whole(left * block.shift_y),
              noted_radius(left, kLeftOf));
        } else {
          put(block, x - 1, y, noted_radius(radius, kRightOf));
        }
      }
      if (dy - nearest_whole(above * block.shift_y) == 1) {
        if (above > radius) {
          put(block, block.x + i + nearest_whole(above * block.shift_x), y - 1,
              noted_radius(above, kAbove));
        } else {
          put(block, x, y - 1, noted_radius(radius, kBelow));
        }
      }
    }
  }
}

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

// Whole pixels that circles move along an axis, the least and the most.
struct Ways {
  int low, high;
};

Ways ways_of(const RadiusRange& radii, float shift) {
  const int low = nearest_whole(radii.low * shift), high = nearest_whole(radii.high * shift);
  return {std::min(low, high), std::max(low, high)};
}

// The part of pixels begin to end - 1 that can come to the area, or a gap beside them.
struct Reaching {
  int begin, end;
};

Reaching reaching(int begin, int end, int area_begin, int area_end, const Ways& ways) {
  return {std::max(begin, area_begin - ways.high), std::min(end, area_end - ways.low + 1)};
}

}  // namespace

glm::vec2 warp_shift(const WarpSource& source, glm::dvec2 point) {
  return {point.x - source.point.x, source.point.y - point.y};
}

SourcePixel shown_pixel(glm::vec2 shift, int x, int y, float radius) {
  const float own = radius_of(radius);
  const std::uint32_t note = note_of(radius);
  return {x - nearest_whole(own * shift.x) + (note == kRightOf ? 1 : 0) - (note == kLeftOf ? 1 : 0),
          y - nearest_whole(own * shift.y) + (note == kBelow ? 1 : 0) - (note == kAbove ? 1 : 0)};
}

void warp_to(const WarpSource& source, glm::vec2 shift, const Rectangle& area, WarpTile& tile,
             Isa isa) {
  tile.area = area;
  WarpedBlock block{.source_stride = plane_stride(source),
                    .shift_x = shift.x,
                    .shift_y = shift.y,
                    .tile_stride = tile_stride(tile),
                    .tile_width = area.x_end - area.x_begin,
                    .tile_height = area.y_end - area.y_begin};
  const auto size =
      static_cast<std::size_t>(block.tile_stride) * static_cast<std::size_t>(block.tile_height);
  tile.radii.resize(size);
  if (isa == Isa::scalar) {
    std::fill(tile.radii.begin(), tile.radii.end(), kHoleRadius);
  } else {
    SOFTFOCUS_KERNEL(isa, clear_tile)(tile.radii.data(), size);
  }
  block.tile_radii = tile.radii.data() + kTileBorder;
  const Ways all_x = ways_of(source.all, shift.x), all_y = ways_of(source.all, shift.y);
  const Reaching within_x = reaching(0, source.width, area.x_begin, area.x_end, all_x);
  const Reaching within_y = reaching(0, source.height, area.y_begin, area.y_end, all_y);
  const int across = warp_blocks(source.width);
  for (int block_y = within_y.begin / kWarpBlock; block_y * kWarpBlock < within_y.end; ++block_y) {
    for (int block_x = within_x.begin / kWarpBlock; block_x * kWarpBlock < within_x.end;
         ++block_x) {
      const RadiusRange& range =
          source.blocks[static_cast<std::size_t>(block_y * across + block_x)];
      const Ways ways_x = ways_of(range, shift.x), ways_y = ways_of(range, shift.y);
      const int x = block_x * kWarpBlock, y = block_y * kWarpBlock;
      const Reaching xs =
          reaching(x, std::min(x + kWarpBlock, source.width), area.x_begin, area.x_end, ways_x);
      const Reaching ys =
          reaching(y, std::min(y + kWarpBlock, source.height), area.y_begin, area.y_end, ways_y);
      if (xs.begin >= xs.end || ys.begin >= ys.end) continue;
      block.radii = source.radii.data() + plane_at(source, xs.begin, ys.begin);
      block.x = xs.begin - area.x_begin;
      block.y = ys.begin - area.y_begin;
      block.columns = xs.end - xs.begin;
      block.rows = ys.end - ys.begin;
      block.room = source.width - xs.begin;
      block.is_rigid = ways_x.low == ways_x.high && ways_y.low == ways_y.high;
      if (isa == Isa::scalar) {
        warp_block_scalar(block);
      } else {
        SOFTFOCUS_KERNEL(isa, warp_block)(block);
      }
    }
  }
}

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

namespace {

/// nearest_whole().
SOFTFOCUS_INLINE Ints nearest_wholes(Floats value) {
  return as_ints(value + kWholeSum) - kWholeSumBits;
}
SOFTFOCUS_INLINE Floats without_notes(Floats noted) {
  return as_floats(as_bits(noted) & ~kRadiusNotes);
}
SOFTFOCUS_INLINE Floats with_note(Floats radius, std::uint32_t note) {
  return as_floats(as_bits(radius) | note);
}

// Puts the lanes of a vector to (x, y), those that are infinite nowhere.
SOFTFOCUS_INLINE void put_vector(const WarpedBlock& block, int x, int y, Floats radii) {
  if (y < 0 || y >= block.tile_height || x <= -kLanes || x >= block.tile_width) return;
  float* const there = block.tile_radii + y * block.tile_stride + x;
  store(there, smaller(load(there), radii));
}

// put() of the lanes of a mask, in groups of those that go the same way. No way is longer than
// 2 kMostWarpRadiusPx, so one number has both of its parts.
SOFTFOCUS_INLINE void put_lanes(const WarpedBlock& block, int x, int y, Mask mask, Ints dx, Ints dy,
                                Floats radii) {
  const Ints ways = dy * 0x10000 + dx;
  unsigned lanes = lane_bits(mask);
  while (lanes != 0) {
    const int first = __builtin_ctz(lanes);
    const Mask group = mask & (ways == ways[first]);
    lanes &= ~lane_bits(group);
    put_vector(block, x + dx[first], y + dy[first], select(group, radii, splat(kHoleRadius)));
  }
}

SOFTFOCUS_INLINE Floats gap_radii(Floats own, Floats other, std::uint32_t if_own,
                                  std::uint32_t if_other) {
  return select(other > own, with_note(other, if_other), with_note(own, if_own));
}

void warp_rigid_block(const WarpedBlock& block) {
  const float first = radius_of(block.radii[0]);
  const int x = block.x + nearest_whole(first * block.shift_x),
            y = block.y + nearest_whole(first * block.shift_y);
  for (int row = 0; row < block.rows; ++row) {
    const float* const radii = block.radii + row * block.source_stride;
    for (int i = 0; i < block.columns; i += kLanes) {
      Floats some = load(radii + i);
      if (i + kLanes > block.columns) {
        some = select(first_lanes(block.columns - i), some, splat(kHoleRadius));
      }
      put_vector(block, x + i, y + row, some);
    }
  }
}

}  // namespace

void clear_tile(float* radii, std::size_t count) {
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) store(radii + i, splat(kHoleRadius));
  for (; i < count; ++i) radii[i] = kHoleRadius;
}

void warp_block(const WarpedBlock& block) {
  if (block.is_rigid) {
    warp_rigid_block(block);
    return;
  }
  for (int row = 0; row < block.rows; ++row) {
    const float* const radii = block.radii + row * block.source_stride;
    const int y = block.y + row;
    // Most pixels go the way of their left neighbour: then nothing is between them.
    const float before = radius_of(radii[-1]);
    int way_x = nearest_whole(before * block.shift_x),
        way_y = nearest_whole(before * block.shift_y);
    for (int i = 0; i < block.columns; i += kLanes) {
      const Floats noted = load(radii + i), own = without_notes(noted);
      const Floats above = without_notes(load(radii + i - block.source_stride));
      const Ints dx = nearest_wholes(own * block.shift_x), dy = nearest_wholes(own * block.shift_y);
      const Ints above_dy = nearest_wholes(above * block.shift_y);
      const bool is_whole = i + kLanes <= block.room;
      if (is_whole && all((dx == way_x) & (dy == way_y) & (above_dy == way_y))) {
        put_vector(block, block.x + i + way_x, y + way_y, noted);
        continue;
      }
      const Mask there = first_lanes(block.room - i);
      put_lanes(block, block.x + i, y, there, dx, dy, noted);
      const Floats left = without_notes(load(radii + i - 1));
      const Mask gap_x = there & (dx - nearest_wholes(left * block.shift_x) == 1);
      if (any(gap_x)) {
        const Ints left_dy = nearest_wholes(left * block.shift_y);
        put_lanes(block, block.x + i - 1, y, gap_x, dx, select(left > own, left_dy, dy),
                  gap_radii(own, left, kRightOf, kLeftOf));
      }
      const Mask gap_y = there & (dy - above_dy == 1);
      if (any(gap_y)) {
        const Ints above_dx = nearest_wholes(above * block.shift_x);
        put_lanes(block, block.x + i, y - 1, gap_y, select(above > own, above_dx, dx), dy,
                  gap_radii(own, above, kBelow, kAbove));
      }
      way_x = dx[kLanes - 1];
      way_y = dy[kLanes - 1];
    }
  }
}

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

// Pixels of which some come from elsewhere than the others, or from beside another surface.
// `first` is the place of the first one in the planes, `to` in the sums.
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
