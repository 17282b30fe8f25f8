#pragma once
// The two-pass filter of dof/two_pass/two_pass.h in binary32, written for a board that has its
// floating point from a library: what belongs to a code of depth or to a pixel is computed
// once, taps that weigh nothing are passed over by a comparison of integers, and whole taps
// are added without a product. The same bits as two_pass_single().
//
// Rows go in, rows come out `reach` rows later. The caller gives all memory.

#include <stddef.h>
#include <stdint.h>

namespace softfocus::boards {

struct FloatLens {
  float radius_at_infinity_px;
  float focus_m;
  float near_m;  ///< of depth code 0; 255 lies at far_m
  float far_m;
  float leak;
};

/// A code of depth, by dof/weights.h (10) to (13).
struct FloatDepth {
  float intensity;
  float edge_weight;  ///< overlap * intensity of the farthest tap
  float leakage;      ///< as a receiver
  uint8_t reach;      ///< the farthest tap
  bool beyond_focus;
};

struct FloatPixel {
  float colour[3];
  float light[3];  ///< colour * intensity
};

struct FloatRow {
  const FloatPixel* pixels;
  const uint8_t* codes;
};

constexpr int kMaxFloatReach = 31;

struct FloatFilter {
  int width;
  int reach;      ///< tap_count() of the largest radius
  int ring_rows;  ///< 2 * reach + 1
  int rows_in;
  int rows_out;
  bool ended;
  FloatDepth depths[256];
  FloatPixel* row;                     ///< that came in, `width` of them
  FloatPixel* ring;                    ///< rows filtered along x
  uint8_t* codes;                      ///< of the ring's rows
  uint8_t* row_reach;                  ///< the largest reach in each
  FloatRow above[kMaxFloatReach + 1];  ///< by distance, of the row that comes out
  FloatRow below[kMaxFloatReach + 1];
};

/// The largest radius is at most kMaxFloatReach + 1.
size_t float_filter_bytes(int width, int max_radius_px);

/// `memory` is aligned for pointers. The filter lies at its start.
FloatFilter* begin_float_filter(const FloatLens& lens, int width, int max_radius_px,
                                uint8_t* memory);

/// Takes a row of `width` times three floats and a code each.
void put_float_row(FloatFilter& filter, const float* colour, const uint8_t* depth);
/// After the last row.
void end_float_rows(FloatFilter& filter);
/// The next row that can come out, `width` times three floats; false if none can.
bool take_float_row(FloatFilter& filter, float* colour);

}  // namespace softfocus::boards
