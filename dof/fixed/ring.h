#pragma once
// The rows of a picture that are within reach of those to come out.

#include <stddef.h>
#include <stdint.h>

#include "dof/fixed/softfocus_fixed.h"
#include "dof/fixed/weights.h"

namespace softfocus::fixed {

using Stream = softfocus_fixed_stream;
using Settings = softfocus_fixed_settings;

/// A pixel's reach and its flag `beyond`, in a byte: 2 reach + beyond. The pixel weighs
/// something at distance d if that is at least 2 d.
constexpr uint8_t reach_and_side(const Weights& weights) {
  return static_cast<uint8_t>(weights.reach << 1 | weights.beyond);
}

/// A bit for a set of reaches; reaches that are 32 apart share one.
constexpr uint32_t reach_bit(uint32_t reach) { return 1u << (reach & 31u); }

struct Sums;  // sums8.h

/// A row within reach of the row that comes out.
struct Tap {
  uint32_t offset;           ///< of the row's first pixel in the ring
  uint32_t double_distance;  ///< 2 d
};

/// The ring's parts, all in the caller's memory. Each plane has 2 reach + 1 rows.
struct Ring {
  void* colours;             ///< uint32_t, three colours of 10 bits; or three planes of halves
  void* line;                ///< of the row that came in: a pixel as `colours`, or four halves
  Tap* taps;                 ///< 2 reach
  void* codes;               ///< uint8_t or uint16_t
  uint8_t* reaches;          ///< reach_and_side() of each pixel
  void* alphas;              ///< uint8_t or uint16_t, if there are any
  uint8_t* farthest;         ///< of each row, the largest reach
  uint8_t* farthest_beyond;  ///< of each row, the largest reach of pixels beyond the focus
  uint32_t* reaches_there;   ///< of each row, reach_bit() of its pixels
  Sums* columns;             ///< of 8-bit colour: of each column, for the next row
  Sums* changes;             ///< of 8-bit colour: of the row that came in
  uint32_t rows;
};

/// Hands out a stream's memory, part by part.
struct Parts {
  uint8_t* rest;

  uint8_t* next(size_t bytes) {
    uint8_t* part = rest;
    rest += bytes;
    return part;
  }
};

constexpr uint32_t ring_rows(const Settings& settings) { return 2u * settings.reach + 1u; }

/// The slot of a row: of one of the last `rows` rows that came in, or of the next row, which gets
/// the slot of the oldest.
inline uint32_t slot_of(const Stream& stream, uint32_t row) {
  const uint32_t rows = ring_rows(stream.settings);
  const uint32_t back = stream.rows_in - row;
  return back <= stream.next_slot ? stream.next_slot - back : stream.next_slot + rows - back;
}

/// The common part of softfocus_fixed_begin() and softfocus_fixed_begin_half().
int begin_stream(Stream* stream, const Settings* settings, const Weights* table, void* memory,
                 size_t bytes, size_t bytes_needed);

/// Copies a row's codes into the ring, and notes how far its pixels reach.
void put_codes(const Stream& stream, const Ring& ring, const void* codes, uint32_t slot);

/// Lists the other rows that reach `row`, and returns how many. `farthest` is the ring's farthest
/// or farthest_beyond. A row past the picture's edge is the row at the edge.
uint32_t list_taps(const Stream& stream, const Ring& ring, const uint8_t* farthest, uint32_t row);

}  // namespace softfocus::fixed
