#include "dof/fixed/moving_sums.h"

namespace softfocus::fixed {
namespace {

inline const Weights& weights_of(const Stream& stream, const Ring& ring, size_t pixel) {
  const uint32_t code = stream.settings.depth == SOFTFOCUS_FIXED_DEPTH8
                            ? static_cast<const uint8_t*>(ring.codes)[pixel]
                            : static_cast<const uint16_t*>(ring.codes)[pixel];
  return stream.table[code];
}

/// Adds a tap, if it lies beyond the focus and reaches the distance `double_distance` / 2.
[[gnu::noinline]] void add_beyond(const Stream& stream, const Ring& ring, size_t pixel,
                                  uint32_t colour, uint32_t double_distance, Sums& sums) {
  const uint32_t reach = ring.reaches[pixel];
  if (reach < double_distance || (reach & 1u) == 0) return;
  const Weights& weights = weights_of(stream, ring, pixel);
  add(sums, colour, reach - double_distance < 2 ? weights.edge : weights.whole);
}

/// Sums along a row, and their changes from position to position, in a ring: a position's offset
/// in bytes counts modulo the ring's length.
struct MovingAcross {
  Sums sums;
  Sums* changes;
  uint32_t mask;  ///< the ring's bytes less 1
  uint32_t lag;   ///< offset from the receiver to the pixel that comes in
};

constexpr uint32_t offset_of(uint32_t position) {
  return position * static_cast<uint32_t>(sizeof(Sums));
}

inline Sums& change_at(const MovingAcross& moving, uint32_t offset) {
  return *reinterpret_cast<Sums*>(reinterpret_cast<uint8_t*>(moving.changes) +
                                  (offset & moving.mask));
}

/// Notes a pixel's four changes of the sums, and moves the sums on to the next receiver.
[[gnu::noinline]] void move_across(MovingAcross& moving, uint32_t offset, uint32_t colour,
                                   const Weights& weights) {
  const uint32_t reach = offset_of(weights.reach);
  const uint32_t before = offset - reach;
  const uint32_t after = offset + reach;
  add_and_subtract(change_at(moving, before), change_at(moving, after + offset_of(1)), colour,
                   weights.edge);
  const uint32_t inner = weights.whole - weights.edge;
  if (inner != 0) {  // 0 if the circle was cut to the largest, or at reach 0
    add_and_subtract(change_at(moving, before + offset_of(1)), change_at(moving, after), colour,
                     inner);
  }
  Sums& change = change_at(moving, offset - moving.lag);
  moving.sums.weight += change.weight;
  moving.sums.r += change.r;
  moving.sums.g += change.g;
  moving.sums.b += change.b;
  change.weight = 0;  // one by one: `change = {}` would call memset()
  change.r = 0;
  change.g = 0;
  change.b = 0;
}

// Half a step of the result, added to a sum before its quotient. A step is 1 after the first
// pass, and 4 after the second, when two bits are cut off.
constexpr uint32_t half_step_across(uint32_t weight) { return weight >> 1; }
constexpr uint32_t half_step_down(uint32_t weight) { return 2 * weight; }

/// The mean colour, `more` added to its sums.
[[gnu::noinline]] uint32_t resolve(const Sums& sums, LastDivisor& last, uint32_t more) {
  const Divisor divisor = last.of(sums.weight);
  return pack(quotient(sums.r + more, divisor), quotient(sums.g + more, divisor),
              quotient(sums.b + more, divisor));
}

/// The mean colour of a receiver that takes less from beyond the focus.
[[gnu::noinline]] uint32_t resolve_leaked(const Sums& all, const Sums& beyond, uint32_t leak,
                                          bool down) {
  const Sums taken = keep_leaked(all, beyond, leak);
  LastDivisor divisor{};
  return resolve(taken, divisor,
                 down ? half_step_down(taken.weight) : half_step_across(taken.weight));
}

/// resolve() for receivers that may take less from beyond the focus, or that nothing reaches.
[[gnu::noinline]] uint32_t resolve_leaking_across(const Stream& stream, const Ring& ring,
                                                  uint32_t slot, uint32_t x, const Sums& sums) {
  const uint32_t last = stream.settings.width - 1u;
  const size_t first = static_cast<size_t>(slot) * stream.settings.width;
  const auto* line = static_cast<const uint32_t*>(ring.line);
  const Weights& centre = weights_of(stream, ring, first + x);
  if (sums.weight == centre.whole) return line[x];
  Sums beyond{};
  for (uint32_t distance = 1; distance <= ring.farthest_beyond[slot]; ++distance) {
    const uint32_t before = x > distance ? x - distance : 0;
    const uint32_t after = last - x > distance ? x + distance : last;
    add_beyond(stream, ring, first + before, line[before], 2 * distance, beyond);
    add_beyond(stream, ring, first + after, line[after], 2 * distance, beyond);
  }
  return resolve_leaked(sums, beyond, centre.leak, false);
}

/// A row whose distance to the row that comes out changes by 1.
struct MovingRow {
  const Weights* table;
  const void* codes;
  bool small_codes;
  const uint32_t* colours;
  Sums* columns;
  uint32_t sign;  // 0 to come nearer, else ~0
};

/// Moves one of its pixels. `past` is 0 if its reach is the nearer distance, 2 if the farther,
/// and 1 more if it lies beyond the focus.
[[gnu::noinline]] void move_pixel(const MovingRow& row, size_t x, uint32_t past) {
  const uint32_t code = row.small_codes ? static_cast<const uint8_t*>(row.codes)[x]
                                        : static_cast<const uint16_t*>(row.codes)[x];
  const Weights& weights = row.table[code];
  const uint32_t weight = past > 1 ? weights.whole - weights.edge : weights.edge;
  if (weight == 0) return;  // the circle was cut to the largest: its edge is whole
  const Sums more = weighted(row.colours[x], (weight ^ row.sign) - row.sign);
  Sums& sums = row.columns[x];
  sums.weight += more.weight;
  sums.r += more.r;
  sums.g += more.g;
  sums.b += more.b;
}

/// Changes a row's weights in ring.columns from those at distance `from` to those at `to`, one
/// more or one less.
void move_row(const Stream& stream, const Ring& ring, uint32_t row, uint32_t from, uint32_t to) {
  const uint32_t slot = slot_of(stream, row);
  const uint32_t nearer = from < to ? from : to;
  const uint32_t changing = reach_bit(nearer) | reach_bit(nearer + 1);
  if ((ring.reaches_there[slot] & changing) == 0) return;
  const size_t width = stream.settings.width;
  const size_t first = slot * width;
  const bool small_codes = stream.settings.depth == SOFTFOCUS_FIXED_DEPTH8;
  const MovingRow moving = {
      stream.table, static_cast<const uint8_t*>(ring.codes) + first * (small_codes ? 1 : 2),
      small_codes,  static_cast<const uint32_t*>(ring.colours) + first,
      ring.columns, to < from ? 0u : ~0u};
  const uint8_t* const reaches = ring.reaches + first;
  const uint32_t double_nearer = 2 * nearer;
  for (size_t x = 0; x < width; ++x) {
    // Only pixels whose reach is one of the two distances change their weight.
    const uint32_t past = reaches[x] - double_nearer;
    if (past <= 3) move_pixel(moving, x, past);
  }
}

/// Moves ring.columns from row - 1 to `row`, or to row 0 from nothing.
void move_columns_to(const Stream& stream, const Ring& ring, uint32_t row) {
  const uint32_t reach = stream.settings.reach;
  const uint32_t last = stream.settings.height - 1u;
  if (row == 0) {
    for (uint32_t x = 0; x < stream.settings.width; ++x) ring.columns[x] = {};
  }
  for (uint32_t distance = 0; distance <= reach; ++distance) {
    const uint32_t below = last - row > distance ? row + distance : last;
    const uint32_t above = row > distance ? row - distance : 0;
    if (row > 0) {
      move_row(stream, ring, below, distance + 1, distance);
      if (distance > 0) move_row(stream, ring, above, distance - 1, distance);
    } else {
      for (uint32_t step = reach + 1; step-- > distance;) {
        move_row(stream, ring, below, step + 1, step);
        if (distance > 0) move_row(stream, ring, above, step + 1, step);
      }
    }
  }
}

/// Subtracts from ring.columns the row that reaches `row` and leaves the ring before row + 1
/// comes out.
void leave_row(const Stream& stream, const Ring& ring, uint32_t row) {
  const uint32_t reach = stream.settings.reach;
  move_row(stream, ring, row > reach ? row - reach : 0, reach, reach + 1);
}

/// resolve_leaking_across() along a column; `taps` rows are listed.
[[gnu::noinline]] uint32_t resolve_leaking_down(const Stream& stream, const Ring& ring,
                                                size_t first, uint32_t x, uint32_t taps) {
  const Sums& sums = ring.columns[x];
  const auto* colours = static_cast<const uint32_t*>(ring.colours);
  const Weights& centre = weights_of(stream, ring, first + x);
  if (sums.weight == centre.whole) return colours[first + x] + pack(2, 2, 2);
  Sums beyond{};
  for (uint32_t i = 0; i < taps; ++i) {
    const size_t pixel = ring.taps[i].offset + x;
    add_beyond(stream, ring, pixel, colours[pixel], ring.taps[i].double_distance, beyond);
  }
  return resolve_leaked(sums, beyond, centre.leak, true);
}

}  // namespace

void filter_across(const Stream& stream, const Ring& ring, uint32_t slot) {
  const uint32_t width = stream.settings.width;
  const size_t first = static_cast<size_t>(slot) * width;
  const uint32_t farthest = ring.farthest[slot];
  const auto* line = static_cast<const uint32_t*>(ring.line);
  auto* result = static_cast<uint32_t*>(ring.colours) + first;
  uint32_t length = 2;
  while (length < 2 * farthest + 2) length *= 2;
  for (uint32_t i = 0; i < length; ++i) ring.changes[i] = {};
  MovingAcross moving = {{}, ring.changes, offset_of(length) - 1, offset_of(farthest)};

  // Positions are moved up by 2 `farthest`: the first pixel stands for those before it.
  const uint32_t shift = 2 * farthest;
  LastDivisor last{};
  for (uint32_t position = farthest; position < width + shift + farthest; ++position) {
    uint32_t pixel = position > shift ? position - shift : 0;
    if (pixel >= width) pixel = width - 1;
    move_across(moving, offset_of(position), line[pixel], weights_of(stream, ring, first + pixel));
    if (position < shift + farthest) continue;
    const uint32_t x = position - shift - farthest;
    result[x] = ring.reaches[first + x] > stream.leaking
                    ? resolve(moving.sums, last, half_step_across(moving.sums.weight))
                    : resolve_leaking_across(stream, ring, slot, x, moving.sums);
  }
}

void filter_down(const Stream& stream, const Ring& ring, uint32_t row) {
  const uint32_t width = stream.settings.width;
  const size_t first = static_cast<size_t>(slot_of(stream, row)) * width;
  auto* line = static_cast<uint32_t*>(ring.line);
  move_columns_to(stream, ring, row);
  const uint32_t taps = list_taps(stream, ring, ring.farthest_beyond, row);
  LastDivisor last{};
  for (uint32_t x = 0; x < width; ++x) {
    line[x] = ring.reaches[first + x] > stream.leaking
                  ? resolve(ring.columns[x], last, half_step_down(ring.columns[x].weight))
                  : resolve_leaking_down(stream, ring, first, x, taps);
  }
  leave_row(stream, ring, row);
}

}  // namespace softfocus::fixed
