// How the pixels of a block lie in vectors: 2x2 by 2x2, in lane_draw.h's order.

namespace {

// A vector holds some 2x2 pixels of a block, next to or above each other.
inline constexpr int kQuads = kLanes / kQuadPixels;
inline constexpr int kBlockParts = kBlockPixels / kLanes;
inline constexpr int kPartColumns = kQuads > 1 ? 4 : 2;
inline constexpr int kPartRows = kQuads > 2 ? 4 : 2;

// Of a lane, in the part that it lies in.
SOFTFOCUS_INLINE constexpr int lane_x(int lane) { return (lane & 1) + (lane >> 1 & 2); }
SOFTFOCUS_INLINE constexpr int lane_y(int lane) { return (lane >> 1 & 1) + (lane >> 2 & 2); }
SOFTFOCUS_INLINE Ints lane_x() { return (lane_numbers() & 1) + (lane_numbers() >> 1 & 2); }
SOFTFOCUS_INLINE Ints lane_y() { return (lane_numbers() >> 1 & 1) + (lane_numbers() >> 2 & 2); }

}  // namespace
