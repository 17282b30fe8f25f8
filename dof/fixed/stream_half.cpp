// The filter for RGBA16F. Colours are Q16.24 in 64 bits: exact for every half, and for the sums,
// which are below 2^20.2 2^40. Between the passes colours are halves again.

#include "dof/fixed/quotient.h"
#include "dof/fixed/ring.h"
#include "dof/fixed/weights.h"

namespace softfocus::fixed {
namespace {

/// Q16.24. Infinities count as the largest half, NaN as 0.
inline int64_t decode(uint32_t half) {
  uint32_t magnitude = half & 0x7FFFu;
  if (magnitude >= kHalfInfinity) magnitude = magnitude == kHalfInfinity ? kHalfLargest : 0;
  const auto value = static_cast<int64_t>(half_magnitude(magnitude));
  return (half & 0x8000u) != 0 ? -value : value;
}

/// The half nearest to sum / weight, Q16.24, ties to even. The sign is the sum's, and + for 0.
///
/// In units of 2^-25 the magnitude is 2 |sum| / weight, below 2^41. n is its upper 12 bits, one
/// more than a half has room for. The reciprocal finds n or at most 3 less: its error of 0.06 %
/// is 2.5 of 4096, the bits cut off are 1/8, and n is rounded down.
inline uint16_t encode_quotient(int64_t sum, uint32_t weight, const Divisor& divisor) {
  const uint64_t twice = 2 * static_cast<uint64_t>(sum < 0 ? -sum : sum);
  int cut = 0;
  uint64_t end = uint64_t{weight} << 12;
  for (; twice >= end; end <<= 1) ++cut;
  const uint64_t step = end >> 12;                                              // weight 2^cut
  const auto top = static_cast<uint32_t>(twice >> cut << divisor.shift >> 17);  // below 2^16
  uint32_t n = (top * divisor.reciprocal) >> 19;
  uint64_t rest = twice - n * step;
  for (; rest >= step; rest -= step) ++n;
  const bool up = (n & 1u) != 0 && (rest > 0 || (n & 2u) != 0);
  // At cut 0, 1024 to 2047 are the normal halves of the least exponent: their code is their value
  // in units of 2^-24. A carry runs into the exponent.
  uint32_t code = (n >> 1) + (static_cast<uint32_t>(cut) << 10) + (up ? 1 : 0);
  if (code > kHalfLargest) code = kHalfLargest;
  return static_cast<uint16_t>((sum < 0 ? 0x8000u : 0u) | code);
}

struct WideSums {
  uint32_t weight;
  int64_t colour[3];
};

inline uint32_t leaked_weight(uint32_t sum, uint32_t leak) {
  return static_cast<uint32_t>((uint64_t{sum} * leak) >> kLeakBits);
}
/// floor(sum leak) without an intermediate of more than 64 bits.
inline int64_t leaked_colour(int64_t sum, uint32_t leak) {
  const auto low = static_cast<uint32_t>(sum) & (kLeakOne - 1);
  return (sum >> kLeakBits) * static_cast<int64_t>(leak) +
         static_cast<int64_t>((low * leak) >> kLeakBits);
}

struct BothSides {
  WideSums near, beyond;
};

/// Where the taps of a pass find their pixels: in the ring, with colours in the row that came in
/// (four halves a pixel) or in the ring's planes.
struct Source {
  const Stream& stream;
  const Ring& ring;
  const uint16_t* colours;
  size_t pixel_step, channel_step;
};

inline void add(WideSums& sums, const Source& source, size_t colour_pixel, uint32_t weight) {
  const uint16_t* colour = source.colours + colour_pixel * source.pixel_step;
  sums.weight += weight;
  for (int i = 0; i < 3; ++i) {
    sums.colour[i] += decode(*colour) * static_cast<int64_t>(weight);
    colour += source.channel_step;
  }
}

inline const Weights& weights_of(const Source& source, size_t pixel) {
  const uint32_t code = source.stream.settings.depth == SOFTFOCUS_FIXED_DEPTH8
                            ? static_cast<const uint8_t*>(source.ring.codes)[pixel]
                            : static_cast<const uint16_t*>(source.ring.codes)[pixel];
  return source.stream.table[code];
}

inline void add_tap(const Source& source, size_t pixel, size_t colour_pixel,
                    uint32_t double_distance, BothSides& sides) {
  const uint32_t reach = source.ring.reaches[pixel];
  if (reach < double_distance) return;
  const Weights& weights = weights_of(source, pixel);
  add((reach & 1u) != 0 ? sides.beyond : sides.near, source, colour_pixel,
      reach - double_distance < 2 ? weights.edge : weights.whole);
}

/// Stores the three halves of a pixel, `step` apart.
inline void resolve(const BothSides& sides, uint32_t leak, uint16_t* to, size_t step) {
  const uint32_t weight = sides.near.weight + leaked_weight(sides.beyond.weight, leak);
  const Divisor divisor = make_divisor(weight);
  for (int i = 0; i < 3; ++i) {
    *to = encode_quotient(sides.near.colour[i] + leaked_colour(sides.beyond.colour[i], leak),
                          weight, divisor);
    to += step;
  }
}

Ring ring_half(const Stream& stream) {
  const Settings& settings = stream.settings;
  Ring ring{};
  ring.rows = ring_rows(settings);
  const size_t pixels = static_cast<size_t>(ring.rows) * settings.width;
  Parts parts{stream.memory};
  ring.taps = reinterpret_cast<Tap*>(parts.next(2 * sizeof(Tap) * settings.reach));
  ring.reaches_there = reinterpret_cast<uint32_t*>(parts.next(4 * ring.rows));
  ring.colours = parts.next(6 * pixels);
  ring.alphas = parts.next(2 * pixels);
  ring.codes = parts.next(2 * pixels);
  ring.reaches = parts.next(pixels);
  ring.farthest = parts.next(ring.rows);
  ring.farthest_beyond = parts.next(ring.rows);
  return ring;
}

void add_row_half(Stream* stream, const void* colours, const void* depths) {
  const Ring ring = ring_half(*stream);
  const uint32_t width = stream->settings.width;
  const uint32_t slot = slot_of(*stream, stream->rows_in);
  const size_t first = static_cast<size_t>(slot) * width;
  const size_t plane = static_cast<size_t>(ring.rows) * width;
  const auto* halves = static_cast<const uint16_t*>(colours);
  uint16_t* alphas = static_cast<uint16_t*>(ring.alphas) + first;
  for (uint32_t x = 0; x < width; ++x) alphas[x] = halves[4 * static_cast<size_t>(x) + 3];
  const bool in_alpha = stream->settings.depth == SOFTFOCUS_FIXED_DEPTH_IN_ALPHA;
  put_codes(*stream, ring, in_alpha ? alphas : depths, slot);

  const Source source{*stream, ring, halves, 4, 1};
  const uint32_t last = width - 1;
  const uint32_t farthest = ring.farthest[slot];
  uint16_t* result = static_cast<uint16_t*>(ring.colours) + first;
  for (uint32_t x = 0; x < width; ++x) {
    const Weights& centre = weights_of(source, first + x);
    BothSides sides{};
    add(sides.near, source, x, centre.whole);
    for (uint32_t distance = 1; distance <= farthest; ++distance) {
      const uint32_t before = x > distance ? x - distance : 0;
      const uint32_t after = last - x > distance ? x + distance : last;
      add_tap(source, first + before, before, 2 * distance, sides);
      add_tap(source, first + after, after, 2 * distance, sides);
    }
    resolve(sides, centre.leak, result + x, plane);
  }
}

void write_row_half(Stream* stream, void* out) {
  const Ring ring = ring_half(*stream);
  const uint32_t width = stream->settings.width;
  const uint32_t slot = slot_of(*stream, stream->rows_out);
  const size_t first = static_cast<size_t>(slot) * width;
  const size_t plane = static_cast<size_t>(ring.rows) * width;
  const uint32_t taps = list_taps(*stream, ring, ring.farthest, stream->rows_out);
  const Source source{*stream, ring, static_cast<const uint16_t*>(ring.colours), 1, plane};
  auto* halves = static_cast<uint16_t*>(out);
  for (uint32_t x = 0; x < width; ++x, halves += 4) {
    const Weights& centre = weights_of(source, first + x);
    BothSides sides{};
    add(sides.near, source, first + x, centre.whole);
    for (uint32_t i = 0; i < taps; ++i) {
      const size_t pixel = ring.taps[i].offset + x;
      add_tap(source, pixel, pixel, ring.taps[i].double_distance, sides);
    }
    resolve(sides, centre.leak, halves, 1);
    halves[3] = static_cast<const uint16_t*>(ring.alphas)[first + x];
  }
}

}  // namespace
}  // namespace softfocus::fixed

using namespace softfocus::fixed;

int softfocus_fixed_begin_half(Stream* stream, const Settings* settings, const Weights* table,
                               void* memory, size_t bytes) {
  if (settings == nullptr) return SOFTFOCUS_FIXED_BAD_ARGUMENT;
  if (settings->colour != SOFTFOCUS_FIXED_RGBA16F) return SOFTFOCUS_FIXED_BAD_FORMAT;
  const int error =
      begin_stream(stream, settings, table, memory, bytes, softfocus_fixed_memory(settings));
  if (error != 0) return error;
  stream->add_row = add_row_half;
  stream->write_row = write_row_half;
  return 0;
}
