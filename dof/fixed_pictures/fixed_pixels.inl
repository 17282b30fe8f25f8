// Pixels of either format on their way from a picture to the lines of fixed_line.inl, and back.

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

/// kLanes numbers of a row, at any address, from x on. Past its ends the row repeats its
/// outermost numbers.
template <class Vector, class Number>
SOFTFOCUS_INLINE Vector load_repeating(const void* row, int x, int width) {
  constexpr auto kBytes = static_cast<std::ptrdiff_t>(sizeof(Number));
  const auto* bytes = static_cast<const std::uint8_t*>(row);
  Number numbers[kLanes];
  const void* from = bytes + kBytes * x;
  if (x < 0 || x + kLanes > width) {
    for (int i = 0; i < kLanes; ++i) {
      const int inside = x + i < 0 ? 0 : x + i < width ? x + i : width - 1;
      std::memcpy(numbers + i, bytes + kBytes * inside, sizeof(Number));
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

// Rows lie too far apart for the hardware's prefetcher.
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
    return __builtin_convertvector(load_repeating<Bytes, std::uint8_t>(row, x, strip.width), Ints);
  }
  const auto* row = static_cast<const std::uint16_t*>(strip.codes) + first;
  return __builtin_convertvector(load_repeating<Shorts, std::uint16_t>(row, x, strip.width), Ints);
}

/// Turns words of kLanes rows into words of kLanes nodes along x, `step` vectors apart.
template <class Vector, class Number>
SOFTFOCUS_INLINE void store_transposed(const FixedLine& line, Vector (&rows)[kLanes], Number* words,
                                       int step, int x) {
  transpose(rows);
#pragma GCC unroll 16
  for (int i = 0; i < kLanes; ++i) store(words + step * node_at(line, x + i), rows[i]);
}

struct BytePixels : SmallColours {
  SOFTFOCUS_INLINE static Bits pixels_at(const FixedStrip& strip, int x, int y) {
    const std::uint8_t* row = strip.picture + y * strip.picture_stride;
    return load_repeating<Bits, std::uint32_t>(row, x, strip.width);
  }

  SOFTFOCUS_INLINE static Ints codes(const FixedStrip& strip, int x, int y, const Bits&) {
    return codes_at(strip, x, y);
  }

  /// Turns colours of kLanes rows into nodes.
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

  /// Turns colours of kLanes rows into nodes. Stores their alpha, a vector a row: it may be the
  /// codes.
  SOFTFOCUS_INLINE static void load_colours(const FixedStrip& strip, int x, int y, Bits* alpha) {
    Bits rg[kLanes], b[kLanes];
#pragma GCC unroll 16
    for (int i = 0; i < kLanes; ++i) {
      const int row = row_inside(strip, y + i);
      fetch_ahead(strip, x, row, 8);
      HalfTexels texels = pixels_at(strip, x, row);
      // True of all that is not finite, and rarely of anything else.
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
