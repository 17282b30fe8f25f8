// The two passes of dof/fixed_two_pass.h.

namespace {

#include "dof/fixed_line_kernels.inl"

// The word of four bytes r, g, b, a.
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
inline constexpr std::uint32_t kAlphaByte = 0x000000FFu;
SOFTFOCUS_INLINE Bits colours_from_bytes(Bits word) {
  return (word >> 22 & 0x3FCu) | (word >> 4 & 0xFF000u) | (word << 14 & 0x3FC00000u);
}
SOFTFOCUS_INLINE Bits bytes_from_colours(Bits colour) {
  return colour << 24 | (colour & 0xFF00u) << 8 | (colour >> 8 & 0xFF00u);
}
#else
inline constexpr std::uint32_t kAlphaByte = 0xFF000000u;
SOFTFOCUS_INLINE Bits colours_from_bytes(Bits word) {
  return (word & 0xFFu) << 2 | (word & 0xFF00u) << 4 | (word & 0xFF0000u) << 6;
}
SOFTFOCUS_INLINE Bits bytes_from_colours(Bits colour) { return colour; }
#endif

using Bytes [[gnu::vector_size(SOFTFOCUS_LANES)]] = std::uint8_t;
using Shorts [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = std::uint16_t;

/// kLanes numbers of a row from x on; past its ends the row repeats the pixel there.
template <class Vector, class Number>
SOFTFOCUS_INLINE Vector load_repeating(const Number* row, int x, int width) {
  Number numbers[kLanes];
  const Number* from = row + x;
  if (x < 0 || x + kLanes > width) {
    for (int i = 0; i < kLanes; ++i) {
      numbers[i] = row[x + i < 0 ? 0 : x + i < width ? x + i : width - 1];
    }
    from = numbers;
  }
  Vector vector;
  std::memcpy(&vector, from, sizeof vector);
  return vector;
}

SOFTFOCUS_INLINE int row_inside(const FixedStrip& strip, int y) {
  return y < 0 ? 0 : y < strip.height ? y : strip.height - 1;
}

// Rows lie too far apart for the hardware to see what comes next.
SOFTFOCUS_INLINE void fetch_ahead(const FixedStrip& strip, int x, int y) {
  const std::ptrdiff_t ahead = x + 2 * kLanes;
  __builtin_prefetch(strip.picture + y * strip.picture_stride + 4 * ahead);
  __builtin_prefetch(static_cast<const std::uint8_t*>(strip.codes) +
                     (static_cast<std::ptrdiff_t>(y) * strip.width + ahead) * strip.code_bytes);
}

SOFTFOCUS_INLINE Ints codes_at(const FixedStrip& strip, int x, int y) {
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y) * strip.width;
  if (strip.code_bytes == 1) {
    const auto* row = static_cast<const std::uint8_t*>(strip.codes) + first;
    return __builtin_convertvector(load_repeating<Bytes>(row, x, strip.width), Ints);
  }
  const auto* row = static_cast<const std::uint16_t*>(strip.codes) + first;
  return __builtin_convertvector(load_repeating<Shorts>(row, x, strip.width), Ints);
}

SOFTFOCUS_INLINE Bits pixels_at(const FixedStrip& strip, int x, int y) {
  const std::uint8_t* row = strip.picture + y * strip.picture_stride;
  return load_repeating<Bits>(reinterpret_cast<const std::uint32_t*>(row), x, strip.width);
}

/// Makes words of kLanes rows those of as many nodes along x.
template <class Vector, class Number>
SOFTFOCUS_INLINE void store_transposed(const FixedLine& line, Vector (&rows)[kLanes], Number* words,
                                       int x) {
  transpose(rows);
#pragma GCC unroll 16
  for (int i = 0; i < kLanes; ++i) store(words + node_at(line, x + i), rows[i]);
}

/// Makes nodes x to x + kLanes - 1 of the line along x from the rows from y, and what the
/// line along y, if there is one, needs beside their colours.
SOFTFOCUS_INLINE void load_block(const FixedStrip& strip, int x, int y, FixedLine* down) {
  Bits colours[kLanes];
#pragma GCC unroll 16
  for (int i = 0; i < kLanes; ++i) {
    const int row = row_inside(strip, y + i);
    fetch_ahead(strip, x, row);
    colours[i] = colours_from_bytes(pixels_at(strip, x, row));
  }
  store_transposed(strip.across, colours, strip.across.colours, x);
  Ints wholes[kLanes], edges[kLanes];
#pragma GCC unroll 16
  for (int i = 0; i < kLanes; ++i) {
    const Ints codes = codes_at(strip, x, row_inside(strip, y + i));
    const IntPairs words = gather_pairs(strip.words, codes);
    wholes[i] = words.first;
    edges[i] = words.second;
    if (down != nullptr) {
      const int at = node_at(*down, y + i);
      store(down->wholes + at, wholes[i]);
      store(down->edges + at, edges[i]);
    }
  }
  store_transposed(strip.across, wholes, strip.across.wholes, x);
  store_transposed(strip.across, edges, strip.across.edges, x);
}

/// The first pass of the rows from y: they become nodes of the lines along y.
SOFTFOCUS_INLINE void filter_across_fixed(FixedStrip& strip, int y) {
  begin_line(strip.across);
  const int columns = strip.x_end - strip.x_begin;
  const int end = strip.x_begin + (columns + kLanes - 1) / kLanes * kLanes;
  for (int x = strip.x_begin - strip.halo; x < end + strip.halo; x += kLanes) {
    const bool inside = x >= strip.x_begin && x < end;
    load_block(strip, x, y, inside ? strip.down + (x - strip.x_begin) / kLanes : nullptr);
    // Room for the nodes that come out before the strip begins lies before `passed`.
    filter_nodes<10>(strip.across, x, strip.x_begin,
                     strip.passed + (x - strip.across.reach - strip.x_begin) * kLanes);
  }
  for (int x = strip.x_begin; x < end; x += kLanes) {
    Bits colours[kLanes];
#pragma GCC unroll 16
    for (int i = 0; i < kLanes; ++i) {
      colours[i] = load(strip.passed + (x - strip.x_begin + i) * kLanes);
    }
    const FixedLine& down = strip.down[(x - strip.x_begin) / kLanes];
    store_transposed(down, colours, down.colours, y);
  }
}

/// The second pass of the nodes from y, in all columns; stores the rows that are finished.
SOFTFOCUS_INLINE void filter_down_fixed(FixedStrip& strip, int y) {
  for (int x = strip.x_begin; x < strip.x_end; x += kLanes) {
    FixedLine& line = strip.down[(x - strip.x_begin) / kLanes];
    std::uint32_t out[kLanes * kLanes];
    filter_nodes<8>(line, y, strip.y_begin, out);
    const int inside = strip.x_end - x < kLanes ? strip.x_end - x : kLanes;
    for (int i = 0; i < kLanes; ++i) {
      const int row = y + i - line.reach;
      if (row < strip.y_begin || row >= strip.y_end) continue;
      const Bits alpha = pixels_at(strip, x, row) & kAlphaByte;
      const Bits pixels = bytes_from_colours(load(out + i * kLanes)) | alpha;
      std::uint8_t* to = strip.result + row * strip.result_stride + 4 * x;
      if (inside == kLanes && strip.past_caches) {
        stream_bits(to, pixels);
      } else if (inside == kLanes) {
        std::memcpy(to, &pixels, sizeof pixels);
      } else {
        std::memcpy(to, &pixels, 4 * static_cast<std::size_t>(inside));
      }
    }
  }
}

}  // namespace

void filter_fixed_strip(FixedStrip& strip) {
  for (int i = 0; strip.x_begin + i * kLanes < strip.x_end; ++i) begin_line(strip.down[i]);
  for (int y = strip.y_begin - strip.halo; y - strip.across.reach < strip.y_end; y += kLanes) {
    filter_across_fixed(strip, y);
    filter_down_fixed(strip, y);
  }
  if (strip.past_caches) finish_streaming();
}
