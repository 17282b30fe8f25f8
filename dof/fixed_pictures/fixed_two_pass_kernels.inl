// The two passes of dof/fixed_pictures/fixed_two_pass.h.

namespace {

#include "dof/fixed_pictures/fixed_line_kernels.inl"

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
SOFTFOCUS_INLINE void fetch_ahead(const FixedStrip& strip, int x, int y, int pixel_bytes) {
  const std::ptrdiff_t ahead = x + 2 * kLanes;
  __builtin_prefetch(strip.picture + y * strip.picture_stride + pixel_bytes * ahead);
  if (strip.codes == nullptr) return;
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

/// Makes words of kLanes rows those of as many nodes along x, `step` vectors apart.
template <class Vector, class Number>
SOFTFOCUS_INLINE void store_transposed(const FixedLine& line, Vector (&rows)[kLanes], Number* words,
                                       int step, int x) {
  transpose(rows);
#pragma GCC unroll 16
  for (int i = 0; i < kLanes; ++i) store(words + step * node_at(line, x + i), rows[i]);
}

// --- what pictures of either format are ---

struct BytePixels : SmallColours {
  SOFTFOCUS_INLINE static Bits pixels_at(const FixedStrip& strip, int x, int y) {
    const std::uint8_t* row = strip.picture + y * strip.picture_stride;
    return load_repeating<Bits>(reinterpret_cast<const std::uint32_t*>(row), x, strip.width);
  }

  SOFTFOCUS_INLINE static Ints codes(const FixedStrip& strip, int x, int y, const Bits&) {
    return codes_at(strip, x, y);
  }

  /// Makes colours of kLanes rows nodes.
  SOFTFOCUS_INLINE static void load_colours(const FixedStrip& strip, int x, int y, Bits*) {
    Bits colours[kLanes];
#pragma GCC unroll 16
    for (int i = 0; i < kLanes; ++i) {
      const int row = row_inside(strip, y + i);
      fetch_ahead(strip, x, row, 4);
      colours[i] = colours_from_bytes(pixels_at(strip, x, row));
    }
    store_transposed(strip.across, colours, strip.across.colours, 1, x);
  }

  /// Writes `count` pixels, `words` from the second pass.
  SOFTFOCUS_INLINE static void store_pixels(const FixedStrip& strip, int x, int y, int count,
                                            const std::uint32_t* words) {
    const Bits alpha = pixels_at(strip, x, y) & kAlphaByte;
    const Bits pixels = bytes_from_colours(load(words)) | alpha;
    std::uint8_t* to = strip.result + y * strip.result_stride + 4 * x;
    if (count == kLanes && strip.past_caches) {
      stream_bits(to, pixels);
    } else if (count == kLanes) {
      std::memcpy(to, &pixels, sizeof pixels);
    } else {
      std::memcpy(to, &pixels, 4 * static_cast<std::size_t>(count));
    }
  }
};

struct HalfPixels : HalfColours {
  SOFTFOCUS_INLINE static HalfTexels pixels_at(const FixedStrip& strip, int x, int y) {
    const auto* row =
        reinterpret_cast<const std::uint16_t*>(strip.picture + y * strip.picture_stride);
    if (x >= 0 && x + kLanes <= strip.width) return load_half_texels(row + 4 * x);
    std::uint16_t halves[4 * kLanes];
    for (int i = 0; i < kLanes; ++i) {
      const int inside = x + i < 0 ? 0 : x + i < strip.width ? x + i : strip.width - 1;
      std::memcpy(halves + 4 * i, row + 4 * inside, 4 * sizeof(std::uint16_t));
    }
    return load_half_texels(halves);
  }

  /// Infinities count as the largest half, NaN as 0.
  SOFTFOCUS_INLINE static Bits finite(Bits half) {
    const Bits magnitude = half & 0x7FFFu;
    return select(magnitude > kHalfInfinity, splat(0u),
                  select(magnitude == std::uint32_t{kHalfInfinity}, half - 1u, half));
  }

  SOFTFOCUS_INLINE static Ints codes(const FixedStrip& strip, int x, int y, const Bits& alpha) {
    return strip.codes != nullptr ? codes_at(strip, x, y) : as_ints(alpha);
  }

  /// Makes colours of kLanes rows nodes. Stores their alpha, a vector a row: it may be the codes.
  SOFTFOCUS_INLINE static void load_colours(const FixedStrip& strip, int x, int y, Bits* alpha) {
    Bits rg[kLanes], b[kLanes];
#pragma GCC unroll 16
    for (int i = 0; i < kLanes; ++i) {
      const int row = row_inside(strip, y + i);
      fetch_ahead(strip, x, row, 8);
      HalfTexels texels = pixels_at(strip, x, row);
      // True of more than those that are not finite, but seldom.
      if (any(((texels.r | texels.g | texels.b) & std::uint32_t{kHalfInfinity}) ==
              std::uint32_t{kHalfInfinity})) {
        texels.r = finite(texels.r);
        texels.g = finite(texels.g);
        texels.b = finite(texels.b);
      }
      rg[i] = texels.r | texels.g << 16;
      b[i] = texels.b;
      alpha[i] = texels.a;
    }
    store_transposed(strip.across, rg, strip.across.colours, kWords, x);
    store_transposed(strip.across, b, strip.across.colours + kLanes, kWords, x);
  }

  SOFTFOCUS_INLINE static void store_pixels(const FixedStrip& strip, int x, int y, int count,
                                            const std::uint32_t* words) {
    const Bits rg = load(words);
    const TexelWords pixels = interleave(
        HalfTexels{rg & 0xFFFFu, rg >> 16, load(words + kLanes), pixels_at(strip, x, y).a});
    std::uint8_t* row = strip.result + y * strip.result_stride;
    auto* to = reinterpret_cast<std::uint16_t*>(row) + 4 * x;
    if (count == kLanes && strip.past_caches) {
      stream_texel_words(to, pixels);
    } else if (count == kLanes) {
      store_texel_words(to, pixels);
    } else {
      std::memcpy(to, &pixels, 8 * static_cast<std::size_t>(count));
    }
  }
};

// --- the passes ---

/// Makes nodes x to x + kLanes - 1 of the line along x from the rows from y, and what the
/// line along y, if there is one, needs beside their colours.
template <class Pixels>
void load_block(const FixedStrip& strip, int x, int y, FixedLine* down) {
  Bits alpha[kLanes];
  Pixels::load_colours(strip, x, y, alpha);
  Ints inners[kLanes], edges[kLanes];
#pragma GCC unroll 16
  for (int i = 0; i < kLanes; ++i) {
    const Ints codes = Pixels::codes(strip, x, row_inside(strip, y + i), alpha[i]);
    const IntPairs words = gather_pairs(strip.words, codes);
    inners[i] = words.first;
    edges[i] = words.second;
    if (down != nullptr) {
      const int at = node_at(*down, y + i);
      store(down->inners + at, inners[i]);
      store(down->edges + at, edges[i]);
    }
  }
  store_transposed(strip.across, inners, strip.across.inners, 1, x);
  store_transposed(strip.across, edges, strip.across.edges, 1, x);
}

/// Makes `count` nodes from `first` what node `like` is.
template <class Pixels>
SOFTFOCUS_INLINE void repeat_node(const FixedLine& line, int like, int first, int count) {
  const std::uint32_t* colours = colours_at<Pixels>(line, like);
  const Ints inner = load(line.inners + node_at(line, like));
  const Ints edge = load(line.edges + node_at(line, like));
  for (int node = first; node < first + count; ++node) {
    for (int word = 0; word < Pixels::kWords; ++word) {
      store(colours_at<Pixels>(line, node) + word * kLanes, load(colours + word * kLanes));
    }
    store(line.inners + node_at(line, node), inner);
    store(line.edges + node_at(line, node), edge);
  }
}

/// The first pass of the rows from y: they become nodes of the lines along y.
template <class Pixels>
void filter_across_fixed(FixedStrip& strip, int y) {
  constexpr int kStep = Pixels::kWords * kLanes;
  begin_line<Pixels>(strip.across);
  const int columns = strip.x_end - strip.x_begin;
  const int end = strip.x_begin + (columns + kLanes - 1) / kLanes * kLanes;
  int loaded_to = strip.x_begin - strip.halo;
  if (strip.x_begin == 0) {
    load_block<Pixels>(strip, 0, y, strip.down);
    repeat_node<Pixels>(strip.across, 0, -strip.halo, strip.halo);
    loaded_to = kLanes;
  }
  for (int x = strip.x_begin - strip.halo; x < end + strip.halo; x += kLanes) {
    if (x >= strip.width) {
      repeat_node<Pixels>(strip.across, x - 1, x, kLanes);
    } else if (x >= loaded_to) {
      const bool inside = x >= strip.x_begin && x < end;
      load_block<Pixels>(strip, x, y, inside ? strip.down + (x - strip.x_begin) / kLanes : nullptr);
    }
    // Room for the nodes that come out before the strip begins lies before `passed`.
    filter_nodes<Pixels, false>(strip.across, x, strip.x_begin,
                                strip.passed + (x - strip.across.reach - strip.x_begin) * kStep);
  }
  for (int x = strip.x_begin; x < end; x += kLanes) {
    const FixedLine& down = strip.down[(x - strip.x_begin) / kLanes];
    for (int word = 0; word < Pixels::kWords; ++word) {
      Bits colours[kLanes];
#pragma GCC unroll 16
      for (int i = 0; i < kLanes; ++i) {
        colours[i] = load(strip.passed + (x - strip.x_begin + i) * kStep + word * kLanes);
      }
      store_transposed(down, colours, down.colours + word * kLanes, Pixels::kWords, y);
    }
  }
}

/// The second pass of the nodes from y, in all columns; stores the rows that are finished.
template <class Pixels>
void filter_down_fixed(FixedStrip& strip, int y) {
  for (int x = strip.x_begin; x < strip.x_end; x += kLanes) {
    FixedLine& line = strip.down[(x - strip.x_begin) / kLanes];
    std::uint32_t out[kLanes * Pixels::kWords * kLanes];
    filter_nodes<Pixels, true>(line, y, strip.y_begin, out);
    const int inside = strip.x_end - x < kLanes ? strip.x_end - x : kLanes;
    for (int i = 0; i < kLanes; ++i) {
      const int row = y + i - line.reach;
      if (row < strip.y_begin || row >= strip.y_end) continue;
      Pixels::store_pixels(strip, x, row, inside, out + i * Pixels::kWords * kLanes);
    }
  }
}

template <class Pixels>
SOFTFOCUS_INLINE void filter_strip(FixedStrip& strip) {
  const int blocks = (strip.x_end - strip.x_begin + kLanes - 1) / kLanes;
  for (int i = 0; i < blocks; ++i) begin_line<Pixels>(strip.down[i]);
  int passed_to = strip.y_begin - strip.halo;
  if (strip.y_begin == 0) {
    filter_across_fixed<Pixels>(strip, 0);
    for (int i = 0; i < blocks; ++i) {
      repeat_node<Pixels>(strip.down[i], 0, -strip.halo, strip.halo);
    }
    passed_to = kLanes;
  }
  for (int y = strip.y_begin - strip.halo; y - strip.across.reach < strip.y_end; y += kLanes) {
    if (y >= strip.height) {
      for (int i = 0; i < blocks; ++i) repeat_node<Pixels>(strip.down[i], y - 1, y, kLanes);
    } else if (y >= passed_to) {
      filter_across_fixed<Pixels>(strip, y);
    }
    filter_down_fixed<Pixels>(strip, y);
  }
  if (strip.past_caches) finish_streaming();
}

}  // namespace

void filter_strip_of_bytes(FixedStrip& strip) { filter_strip<BytePixels>(strip); }
void filter_strip_of_halves(FixedStrip& strip) { filter_strip<HalfPixels>(strip); }
