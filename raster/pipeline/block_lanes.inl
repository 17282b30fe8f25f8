// How the pixels of a block lie in vectors.

namespace {

// A vector holds some rows of a block.
inline constexpr int kBlockParts = kBlockPixels / kLanes;
inline constexpr int kPartRows = kBlockSize / kBlockParts;

SOFTFOCUS_INLINE Ints lane_x() { return lane_numbers() & 3; }
SOFTFOCUS_INLINE Ints lane_y() { return lane_numbers() >> 2; }

// The number of the 2x2 pixels that a lane lies in, from left to right and down; and by
// quarters of the lanes, the pixels of each that differences are taken between.
SOFTFOCUS_INLINE Ints quad_of_lane() {
  return (lane_numbers() >> 1 & 1) + (lane_numbers() >> 3) * 2;
}
SOFTFOCUS_INLINE Ints block_corner_x() {
  const Ints quad = lane_numbers() & (kLanes / 4 - 1);
  const Ints quarter = lane_numbers() / (kLanes / 4);
  return (quad & 1) * 2 + select(quarter == 1, splat(1), splat(0));
}
SOFTFOCUS_INLINE Ints block_corner_y() {
  const Ints quad = lane_numbers() & (kLanes / 4 - 1);
  const Ints quarter = lane_numbers() / (kLanes / 4);
  return (quad >> 1) * 2 + select(quarter == 2, splat(1), splat(0));
}

}  // namespace
