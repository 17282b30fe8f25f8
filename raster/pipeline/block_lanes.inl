// How the pixels of a block lie in vectors.

namespace {

// A vector holds some rows of a block.
inline constexpr int kBlockParts = kBlockPixels / kLanes;
inline constexpr int kPartRows = kBlockSize / kBlockParts;

SOFTFOCUS_INLINE Ints lane_x() { return lane_numbers() & 3; }
SOFTFOCUS_INLINE Ints lane_y() { return lane_numbers() >> 2; }

}  // namespace
