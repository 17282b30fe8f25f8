// How the pixels of a block lie in vectors: quad by quad, in the order of place_of_pixel().

namespace {

// A vector holds a part of a block: kQuads quads, side by side or above each other.
inline constexpr int kQuads = kLanes / kQuadPixels;
inline constexpr int kBlockParts = kBlockPixels / kLanes;
inline constexpr int kPartColumns = kQuads > 1 ? 4 : 2;
inline constexpr int kPartRows = kQuads > 2 ? 4 : 2;

// The place of the part to the right in a row of parts.
SOFTFOCUS_INLINE constexpr std::size_t next_part_place(std::size_t place) {
  if (kPartColumns == kBlockSize) return place + kBlockPixels;
  return place % (2 * kQuadPixels) == 0 ? place + kQuadPixels : place + kBlockPixels - kQuadPixels;
}

// A lane's pixel, from the part's first.
SOFTFOCUS_INLINE constexpr int lane_x(int lane) { return (lane & 1) + (lane >> 1 & 2); }
SOFTFOCUS_INLINE constexpr int lane_y(int lane) { return (lane >> 1 & 1) + (lane >> 2 & 2); }
SOFTFOCUS_INLINE Ints lane_x() { return (lane_numbers() & 1) + (lane_numbers() >> 1 & 2); }
SOFTFOCUS_INLINE Ints lane_y() { return (lane_numbers() >> 1 & 1) + (lane_numbers() >> 2 & 2); }

}  // namespace
