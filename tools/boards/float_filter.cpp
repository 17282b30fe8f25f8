#include "tools/boards/float_filter.h"

namespace softfocus::boards {
namespace {

FloatDepth describe_depth(const FloatLens& lens, int code, float max_radius_px) {
  const float depth_m =
      lens.near_m + (lens.far_m - lens.near_m) * (static_cast<float>(code) / 255.0f);
  float radius = lens.radius_at_infinity_px * (depth_m - lens.focus_m) / depth_m;
  radius = radius < 0.0f ? -radius : radius;
  radius = radius < max_radius_px ? radius : max_radius_px;

  FloatDepth depth;
  const float spread = radius > 1.0f ? radius : 1.0f;
  depth.intensity = 1.0f / (spread * spread);
  const float share = lens.leak * radius;
  depth.leakage = share < 1.0f ? share : 1.0f;
  depth.beyond_focus = depth_m > lens.focus_m;
  auto whole = static_cast<int>(radius);
  if (static_cast<float>(whole) < radius) ++whole;
  depth.reach = static_cast<uint8_t>(whole > 0 ? whole - 1 : 0);
  // Nearer taps have overlap 1.
  depth.edge_weight = (radius - static_cast<float>(depth.reach)) * depth.intensity;
  return depth;
}

struct Sums {
  float colour[3];
  float weight;
};

/// A receiver that nothing reached may keep its colour: c * 1 / 1.
struct Receiver {
  Sums sums;
  float leakage;
  bool reached;
};

Receiver begin_receiver(const FloatPixel& centre, const FloatDepth& depth) {
  return {{{centre.light[0], centre.light[1], centre.light[2]}, depth.intensity},
          depth.leakage,
          depth.intensity != 1.0f};
}

/// dof/weights.h, add_neighbour(), for a tap with distance <= depth.reach.
void add_tap(Receiver& receiver, const FloatPixel& p, const FloatDepth& depth, int distance) {
  Sums& sums = receiver.sums;
  const bool leaking = depth.beyond_focus && receiver.leakage < 1.0f;
  if (distance < depth.reach && !leaking) {
    for (int i = 0; i < 3; ++i) sums.colour[i] += p.light[i];
    sums.weight += depth.intensity;
    receiver.reached = true;
    return;
  }
  float weight = distance < depth.reach ? depth.intensity : depth.edge_weight;
  if (leaking) weight *= receiver.leakage;
  if (!(weight > 0.0f)) return;
  for (int i = 0; i < 3; ++i) sums.colour[i] += p.colour[i] * weight;
  sums.weight += weight;
  receiver.reached = true;
}

void resolve(const Receiver& receiver, const FloatPixel& centre, float* colour) {
  for (int i = 0; i < 3; ++i) {
    colour[i] =
        receiver.reached ? receiver.sums.colour[i] / receiver.sums.weight : centre.colour[i];
  }
}

void light_pixel(FloatPixel& pixel, float intensity) {
  for (int i = 0; i < 3; ++i) {
    pixel.light[i] = intensity != 1.0f ? pixel.colour[i] * intensity : pixel.colour[i];
  }
}

int smaller(int a, int b) { return a < b ? a : b; }
int larger(int a, int b) { return a > b ? a : b; }

void filter_along_row(const FloatFilter& filter, const uint8_t* codes, int row_reach,
                      FloatPixel* target) {
  for (int x = 0; x < filter.width; ++x) {
    const FloatPixel& centre = filter.row[x];
    const FloatDepth& centre_depth = filter.depths[codes[x]];
    Receiver receiver = begin_receiver(centre, centre_depth);
    for (int d = 1; d <= row_reach; ++d) {
      const int left = larger(x - d, 0);
      const FloatDepth& left_depth = filter.depths[codes[left]];
      if (d <= left_depth.reach) add_tap(receiver, filter.row[left], left_depth, d);
      const int right = smaller(x + d, filter.width - 1);
      const FloatDepth& right_depth = filter.depths[codes[right]];
      if (d <= right_depth.reach) add_tap(receiver, filter.row[right], right_depth, d);
    }
    resolve(receiver, centre, target[x].colour);
    light_pixel(target[x], centre_depth.intensity);
  }
}

FloatRow ring_row(const FloatFilter& filter, int y) {
  const int offset = (y % filter.ring_rows) * filter.width;
  return {filter.ring + offset, filter.codes + offset};
}

}  // namespace

size_t float_filter_bytes(int width, int max_radius_px) {
  const auto columns = static_cast<size_t>(width);
  const auto rows = static_cast<size_t>(2 * larger(max_radius_px - 1, 0) + 1);
  return sizeof(FloatFilter) + (rows + 1) * columns * sizeof(FloatPixel) + rows * columns + rows;
}

FloatFilter* begin_float_filter(const FloatLens& lens, int width, int max_radius_px,
                                uint8_t* memory) {
  auto& filter = *reinterpret_cast<FloatFilter*>(memory);
  filter.width = width;
  filter.reach = larger(max_radius_px - 1, 0);
  filter.ring_rows = 2 * filter.reach + 1;
  filter.rows_in = 0;
  filter.rows_out = 0;
  filter.ended = false;
  for (int code = 0; code < 256; ++code) {
    filter.depths[code] = describe_depth(lens, code, static_cast<float>(max_radius_px));
  }
  filter.row = reinterpret_cast<FloatPixel*>(memory + sizeof(FloatFilter));
  filter.ring = filter.row + width;
  filter.codes = reinterpret_cast<uint8_t*>(filter.ring + filter.ring_rows * width);
  filter.row_reach = filter.codes + filter.ring_rows * width;
  return &filter;
}

void put_float_row(FloatFilter& filter, const float* colour, const uint8_t* depth) {
  const int slot = filter.rows_in % filter.ring_rows;
  uint8_t* const codes = filter.codes + slot * filter.width;
  int row_reach = 0;
  for (int x = 0; x < filter.width; ++x) {
    FloatPixel& pixel = filter.row[x];
    codes[x] = depth[x];
    const FloatDepth& of_pixel = filter.depths[depth[x]];
    for (int i = 0; i < 3; ++i) pixel.colour[i] = colour[3 * x + i];
    light_pixel(pixel, of_pixel.intensity);
    row_reach = larger(row_reach, of_pixel.reach);
  }
  filter.row_reach[slot] = static_cast<uint8_t>(row_reach);
  filter_along_row(filter, codes, row_reach, filter.ring + slot * filter.width);
  ++filter.rows_in;
}

void end_float_rows(FloatFilter& filter) { filter.ended = true; }

bool take_float_row(FloatFilter& filter, float* colour) {
  const int y = filter.rows_out;
  if (y >= filter.rows_in || (!filter.ended && y + filter.reach >= filter.rows_in)) return false;
  const int last = filter.rows_in - 1;
  int reach = 0;
  for (int d = -filter.reach; d <= filter.reach; ++d) {
    const int row = smaller(larger(y + d, 0), last);
    reach = larger(reach, filter.row_reach[row % filter.ring_rows]);
  }
  for (int d = 1; d <= reach; ++d) {
    filter.above[d] = ring_row(filter, larger(y - d, 0));
    filter.below[d] = ring_row(filter, smaller(y + d, last));
  }
  const FloatRow centre_row = ring_row(filter, y);
  for (int x = 0; x < filter.width; ++x) {
    const FloatPixel& centre = centre_row.pixels[x];
    Receiver receiver = begin_receiver(centre, filter.depths[centre_row.codes[x]]);
    for (int d = 1; d <= reach; ++d) {
      const FloatRow& above = filter.above[d];
      const FloatDepth& above_depth = filter.depths[above.codes[x]];
      if (d <= above_depth.reach) add_tap(receiver, above.pixels[x], above_depth, d);
      const FloatRow& below = filter.below[d];
      const FloatDepth& below_depth = filter.depths[below.codes[x]];
      if (d <= below_depth.reach) add_tap(receiver, below.pixels[x], below_depth, d);
    }
    resolve(receiver, centre, colour + 3 * x);
  }
  ++filter.rows_out;
  return true;
}

}  // namespace softfocus::boards
