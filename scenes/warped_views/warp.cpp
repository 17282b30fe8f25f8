#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "scenes/warped_views/warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace softfocus {

// A part of a row of a source, and the tile that it is warped to.
struct WarpedRow {
  const float* radii = nullptr;
  const float* above = nullptr;  // the row before
  std::int32_t place = 0;        // of the first pixel
  int x = 0, y = 0;              // of the first pixel, from the tile's
  int count = 0;
  float shift_x = 0.0f, shift_y = 0.0f;
  int tile_width = 0, tile_height = 0, stride = 0;
  float* tile_radii = nullptr;  // of the tile's first pixel
  std::int32_t* tile_places = nullptr;
};

// A row of a tile, and the planes that its colours come from. `red` and so on are of the source's
// first pixel.
struct ColouredRow {
  const float *red = nullptr, *green = nullptr, *blue = nullptr, *radii = nullptr;
  int stride = 0;  // of the planes
  float shift_x = 0.0f, shift_y = 0.0f;
  float most_shift = 0.0f;
  int x = 0, y = 0, count = 0;  // of the tile's row
  const float* tile_radii = nullptr;
  const std::int32_t* tile_places = nullptr;
  float *red_sum = nullptr, *green_sum = nullptr, *blue_sum = nullptr;
};

constexpr std::int32_t kRowOfPlaces = 1 << 16;

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/warped_views/warp.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr float kNoRadius = std::numeric_limits<float>::infinity();

void put(const WarpedRow& row, int x, int y, float radius, std::int32_t place) {
  if (x < 0 || x >= row.tile_width || y < 0 || y >= row.tile_height) return;
  const int at = y * row.stride + x;
  const float there = row.tile_radii[at];
  if (radius < there || (radius == there && place < row.tile_places[at])) {
    row.tile_radii[at] = radius;
    row.tile_places[at] = place;
  }
}

void warp_row_scalar(const WarpedRow& row) {
  for (int i = 0; i < row.count; ++i) {
    const float radius = row.radii[i], left = row.radii[i - 1], above = row.above[i];
    const std::int32_t place = row.place + i;
    const int dx = whole_shift(radius * row.shift_x), dy = whole_shift(radius * row.shift_y);
    const int x = row.x + i + dx, y = row.y + dy;
    put(row, x, y, radius, place);
    if (dx - whole_shift(left * row.shift_x) == 1) {
      put(row, x - 1, y, std::max(radius, left), left > radius ? place - 1 : place);
    }
    if (dy - whole_shift(above * row.shift_y) == 1) {
      put(row, x, y - 1, std::max(radius, above), above > radius ? place - kRowOfPlaces : place);
    }
  }
}

// How far the exact place is from the pixel's, -1 to 1, and 0 if it is hardly any.
float part_of_pixel(float from_px, int to_px) {
  const float part = from_px - static_cast<float>(to_px);
  if (std::fabs(part) < kWholePx) return 0.0f;
  return std::clamp(part, -1.0f, 1.0f);
}

int step_of(float part) { return part < 0.0f ? -1 : part > 0.0f ? 1 : 0; }

void add_row_scalar(const ColouredRow& row) {
  for (int i = 0; i < row.count; ++i) {
    const std::int32_t place = row.tile_places[i];
    if (place == kNoPlace) continue;
    const float radius = row.tile_radii[i];
    const float x =
        part_of_pixel(static_cast<float>(row.x + i) - radius * row.shift_x, place_x(place));
    const float y = part_of_pixel(static_cast<float>(row.y) - radius * row.shift_y, place_y(place));
    const int at = place_y(place) * row.stride + place_x(place);
    const std::array<int, 3> taps{at + step_of(x), at + step_of(y) * row.stride,
                                  at + step_of(y) * row.stride + step_of(x)};
    const float w_x = std::fabs(x), w_y = std::fabs(y);
    const std::array<float, 4> weights{(1.0f - w_x) * (1.0f - w_y), w_x * (1.0f - w_y),
                                       (1.0f - w_x) * w_y, w_x * w_y};
    const auto read = [&](const float* plane) {
      if (x == 0.0f && y == 0.0f) return plane[at];
      float sum = plane[at] * weights[0];
      for (std::size_t tap = 0; tap < taps.size(); ++tap) {
        const float away = std::fabs(row.radii[taps[tap]] - radius) * row.most_shift;
        sum += plane[away <= kSameSurfacePx ? taps[tap] : at] * weights[tap + 1];
      }
      return sum;
    };
    row.red_sum[i] += read(row.red);
    row.green_sum[i] += read(row.green);
    row.blue_sum[i] += read(row.blue);
  }
}

// The part of a block's pixels along an axis from which a circle can come to the area.
struct Reaching {
  int begin, end;
};

Reaching reaching(int begin, int end, int area_begin, int area_end, float reach_px) {
  const int reach = static_cast<int>(reach_px) + 2;  // rounded, and a gap's pixel
  return {std::max(begin, area_begin - reach), std::min(end, area_end + reach)};
}

}  // namespace

glm::vec2 warp_shift(const WarpSource& source, glm::dvec2 point) {
  return {point.x - source.point.x, source.point.y - point.y};
}

void warp_to(const WarpSource& source, glm::vec2 shift, const Rectangle& area, WarpTile& tile,
             Isa isa) {
  tile.area = area;
  WarpedRow row{.shift_x = shift.x,
                .shift_y = shift.y,
                .tile_width = area.x_end - area.x_begin,
                .tile_height = area.y_end - area.y_begin,
                .stride = tile_stride(tile)};
  const auto size =
      static_cast<std::size_t>(row.stride) * static_cast<std::size_t>(row.tile_height);
  tile.radii.assign(size, kNoRadius);
  tile.places.assign(size, kNoPlace);
  row.tile_radii = tile.radii.data() + kTileBorder;
  row.tile_places = tile.places.data() + kTileBorder;
  const int across = warp_blocks(source.width);
  for (int block = 0; block < static_cast<int>(source.block_radii.size()); ++block) {
    const float radius = source.block_radii[static_cast<std::size_t>(block)];
    const int block_x = block % across * kWarpBlock, block_y = block / across * kWarpBlock;
    const Reaching xs = reaching(block_x, std::min(block_x + kWarpBlock, source.width),
                                 area.x_begin, area.x_end, radius * std::fabs(shift.x));
    const Reaching ys = reaching(block_y, std::min(block_y + kWarpBlock, source.height),
                                 area.y_begin, area.y_end, radius * std::fabs(shift.y));
    if (xs.begin >= xs.end) continue;
    row.x = xs.begin - area.x_begin;
    row.count = xs.end - xs.begin;
    for (int y = ys.begin; y < ys.end; ++y) {
      row.radii = source.radii.data() + plane_at(source, xs.begin, y);
      row.above = row.radii - plane_stride(source);
      row.place = y * kRowOfPlaces + xs.begin;
      row.y = y - area.y_begin;
      if (isa == Isa::scalar) {
        warp_row_scalar(row);
      } else {
        SOFTFOCUS_KERNEL(isa, warp_row)(row);
      }
    }
  }
}

bool add_colours(const WarpSource& source, glm::vec2 shift, const WarpTile& tile,
                 WarpedColours& sums, Isa isa) {
  const std::size_t first = plane_at(source, 0, 0);
  ColouredRow row{.red = source.red.data() + first,
                  .green = source.green.data() + first,
                  .blue = source.blue.data() + first,
                  .radii = source.radii.data() + first,
                  .stride = plane_stride(source),
                  .shift_x = shift.x,
                  .shift_y = shift.y,
                  .most_shift = std::max(std::fabs(shift.x), std::fabs(shift.y)),
                  .x = tile.area.x_begin,
                  .count = tile.area.x_end - tile.area.x_begin};
  bool has_holes = false;
  for (row.y = tile.area.y_begin; row.y < tile.area.y_end; ++row.y) {
    const std::size_t at = tile_at(tile, tile.area.x_begin, row.y);
    row.tile_radii = tile.radii.data() + at;
    row.tile_places = tile.places.data() + at;
    row.red_sum = sums.red.data() + at;
    row.green_sum = sums.green.data() + at;
    row.blue_sum = sums.blue.data() + at;
    if (isa == Isa::scalar) {
      add_row_scalar(row);
    } else {
      SOFTFOCUS_KERNEL(isa, add_row)(row);
    }
    has_holes = has_holes || std::find(row.tile_places, row.tile_places + row.count, kNoPlace) !=
                                 row.tile_places + row.count;
  }
  return has_holes;
}

}  // namespace softfocus

#else  // kernels

namespace {

SOFTFOCUS_INLINE Ints whole_shifts(Floats shift_px) {
  return truncate(shift_px + select(shift_px < 0.0f, splat(-0.5f), splat(0.5f)));
}

// One number for a way along both axes: neither is longer than 2 kMostWarpRadiusPx.
SOFTFOCUS_INLINE Ints ways_of(Ints dx, Ints dy) { return dy * 0x10000 + dx; }

SOFTFOCUS_INLINE void put_group(const WarpedRow& row, int i, Mask group, std::int32_t to_x,
                                std::int32_t to_y, Floats radii, Ints places) {
  const int x = row.x + i + to_x, y = row.y + to_y;
  if (y < 0 || y >= row.tile_height || x <= -kLanes || x >= row.tile_width) return;
  float* const radii_there = row.tile_radii + y * row.stride + x;
  std::int32_t* const places_there = row.tile_places + y * row.stride + x;
  const Floats there = load(radii_there);
  const Ints place_there = load(places_there);
  group &= (radii < there) | ((radii == there) & (places < place_there));
  store(radii_there, select(group, radii, there));
  store(places_there, select(group, places, place_there));
}

// put() of the lanes of a mask, in groups of those that go the same way.
SOFTFOCUS_INLINE void put_lanes(const WarpedRow& row, int i, Mask mask, Ints dx, Ints dy,
                                Floats radii, Ints places) {
  const Ints ways = ways_of(dx, dy);
  unsigned lanes = lane_bits(mask);
  while (lanes != 0) {
    const int first = __builtin_ctz(lanes);
    const Mask group = mask & (ways == ways[first]);
    lanes &= ~lane_bits(group);
    put_group(row, i, group, dx[first], dy[first], radii, places);
  }
}

SOFTFOCUS_INLINE Floats parts_of_pixels(Floats from_px, Ints to_px) {
  const Floats part = from_px - to_floats(to_px);
  const Floats cut = select(part < -1.0f, splat(-1.0f), select(part > 1.0f, splat(1.0f), part));
  return select(absolute(part) < kWholePx, splat(0.0f), cut);
}

SOFTFOCUS_INLINE Ints steps_of(Floats parts) {
  return select(parts < 0.0f, splat(-1), select(parts > 0.0f, splat(1), splat(0)));
}

// The next texels along x, along y, and along both: where they are, whether they are of the same
// surface, and their weights.
struct WarpTaps {
  int to_x, to_y, to_xy;
  Mask is_x, is_y, is_xy;
  Floats own, x, y, xy;
};

SOFTFOCUS_INLINE Mask same_surface(const float* radii_there, Floats radii, float most_shift) {
  return absolute(load(radii_there) - radii) * most_shift <= kSameSurfacePx;
}

SOFTFOCUS_INLINE Floats read_lanes(const float* plane, const WarpTaps& taps) {
  const Floats own = load(plane);
  return own * taps.own + select(taps.is_x, load(plane + taps.to_x), own) * taps.x +
         select(taps.is_y, load(plane + taps.to_y), own) * taps.y +
         select(taps.is_xy, load(plane + taps.to_xy), own) * taps.xy;
}

SOFTFOCUS_INLINE void add_lanes(float* sums, Mask mask, Floats values) {
  const Floats before = load(sums);
  store(sums, select(mask, before + values, before));
}

}  // namespace

void warp_row(const WarpedRow& row) {
  for (int i = 0; i < row.count; i += kLanes) {
    const Floats radii = load(row.radii + i), left = load(row.radii + i - 1),
                 above = load(row.above + i);
    const Ints places = lane_numbers() + (row.place + i);
    const Ints dx = whole_shifts(radii * row.shift_x), dy = whole_shifts(radii * row.shift_y);
    const Mask there = first_lanes(row.count - i);
    if (all(there & (ways_of(dx, dy) == splat(ways_of(dx, dy)[0])))) {
      put_group(row, i, there, dx[0], dy[0], radii, places);
    } else {
      put_lanes(row, i, there, dx, dy, radii, places);
    }
    const Mask gap_x = there & (dx - whole_shifts(left * row.shift_x) == 1);
    if (any(gap_x)) {
      put_lanes(row, i - 1, gap_x, dx, dy, select(left > radii, left, radii),
                select(left > radii, places - 1, places));
    }
    const Mask gap_y = there & (dy - whole_shifts(above * row.shift_y) == 1);
    if (any(gap_y)) {
      put_lanes(row, i, gap_y, dx, dy - 1, select(above > radii, above, radii),
                select(above > radii, places - kRowOfPlaces, places));
    }
  }
}

void add_row(const ColouredRow& row) {
  for (int i = 0; i < row.count; i += kLanes) {
    const Ints places = load(row.tile_places + i);
    const Mask there = first_lanes(row.count - i) & (places != kNoPlace);
    unsigned lanes = lane_bits(there);
    if (lanes == 0) continue;
    const Floats radii = load(row.tile_radii + i);
    const Ints place_xs = places & 0xFFFF, place_ys = places >> 16;
    const Floats x =
        parts_of_pixels(to_floats(lane_numbers() + (row.x + i)) - radii * row.shift_x, place_xs);
    const Floats y =
        parts_of_pixels(splat(static_cast<float>(row.y)) - radii * row.shift_y, place_ys);
    const Ints steps_x = steps_of(x), steps_y = steps_of(y);
    const Floats w_x = absolute(x), w_y = absolute(y);
    WarpTaps taps;
    taps.own = (1.0f - w_x) * (1.0f - w_y);
    taps.x = w_x * (1.0f - w_y);
    taps.y = (1.0f - w_x) * w_y;
    taps.xy = w_x * w_y;
    // Lanes of one group read places side by side, and the next ones on the same side.
    const Ints begins = place_ys * row.stride + place_xs - lane_numbers();
    const Ints groups = begins * 16 + (steps_y + 1) * 4 + (steps_x + 1);
    while (lanes != 0) {
      const int first = __builtin_ctz(lanes);
      const Mask group = there & (groups == groups[first]);
      lanes &= ~lane_bits(group);
      const std::int32_t begin = begins[first], step_x = steps_x[first], step_y = steps_y[first];
      const float *const red = row.red + begin, *const green = row.green + begin,
                         *const blue = row.blue + begin;
      if (step_x == 0 && step_y == 0) {
        add_lanes(row.red_sum + i, group, load(red));
        add_lanes(row.green_sum + i, group, load(green));
        add_lanes(row.blue_sum + i, group, load(blue));
        continue;
      }
      taps.to_x = step_x;
      taps.to_y = step_y * row.stride;
      taps.to_xy = taps.to_y + step_x;
      const float* const radii_there = row.radii + begin;
      taps.is_x = same_surface(radii_there + taps.to_x, radii, row.most_shift);
      taps.is_y = same_surface(radii_there + taps.to_y, radii, row.most_shift);
      taps.is_xy = same_surface(radii_there + taps.to_xy, radii, row.most_shift);
      add_lanes(row.red_sum + i, group, read_lanes(red, taps));
      add_lanes(row.green_sum + i, group, read_lanes(green, taps));
      add_lanes(row.blue_sum + i, group, read_lanes(blue, taps));
    }
  }
}

#endif
