#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "scenes/warped_views/warp.h"

#include <algorithm>

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

}  // namespace softfocus

#else  // kernels

#include "scenes/warped_views/noted_lanes.inl"

namespace {

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

#endif
