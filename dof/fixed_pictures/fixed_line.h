#pragma once
// Lines of pixels on their way through a pass of the fixed-point filter: as many at once as
// a vector has lanes, node i holding pixel i of each. Nodes go in block by block, kLanes at
// once, and come out `reach` nodes later.

#include <cstddef>
#include <cstdint>

namespace softfocus {

// Weights as the kernels use them: two words for each depth code. Numbers of 20 bits are split
// as 2^5 h + l, for products of 16 bits: h lies in the upper half of a word, l in its lowest 5
// bits. The bits between hold the rest:
//   first word   whole - edge; reach and side (kKeyShift); the upper 4 bits of the leakage;
//                below 0 if the leakage is 1
//   second word  edge; the leakage's lower 11 bits; below 0 if the pixel is nearly sharp: its
//                leakage is less than 1, or it reaches nothing

inline constexpr int kSplitBits = 5;
inline constexpr std::int32_t kSplitMask = 0x7FFF001F;
inline constexpr int kKeyShift = 5;
inline constexpr std::int32_t kKeyMask = 0x7F;  // reach << 1 | beyond
inline constexpr int kLeakShift = 5;            // in an edge's word
inline constexpr int kLeakBitsThere = 11;
inline constexpr std::int32_t kLeaksAll = INT32_MIN;
inline constexpr std::int32_t kNearlySharp = INT32_MIN;

// What a node's colours take, and a sum of its weight and colours, in vectors.

inline constexpr int kSmallColourWords = 1, kSmallSumVectors = 4;  ///< colours of 10 bits
inline constexpr int kHalfColourWords = 2, kHalfSumVectors = 7;    ///< RGBA16F

/// Nodes lie in a ring, as their numbers say modulo `node_slots`, sums at nodes in another.
/// Sums are kept for either side of the focus: a slot is two of them.
struct FixedLine {
  int reach;               ///< no pixel reaches farther
  unsigned node_slots;     ///< a power of two, at least reach + kLanes
  unsigned sum_slots;      ///< a power of two, at least 2 reach + 2
  std::uint32_t* colours;  ///< in the words of fixed_colours.inl or fixed_half_colours.inl
  std::int32_t* inners;    ///< the table's words for a node
  std::int32_t* edges;
  std::uint32_t* sums;     ///< differences along the line
  std::uint32_t* running;  ///< a slot: their sums up to the node that came out last
  int touched[2];          ///< the last node that differences on this side go to
};

/// A part of a picture that a thread filters in one go, and how; strides in bytes.
struct FixedStrip {
  const std::int32_t* words;    ///< two for each code
  int width, height;            ///< of the picture
  const std::uint8_t* picture;  ///< RGBA8 or RGBA16F
  std::ptrdiff_t picture_stride;
  const void* codes;  ///< null if they are the alpha of RGBA16F
  int code_bytes;
  std::uint8_t* result;  ///< in the format of the picture
  std::ptrdiff_t result_stride;
  bool past_caches;  ///< writes it past the caches

  int x_begin, x_end, y_begin, y_end;  ///< x_begin and y_begin multiples of the lanes
  int halo;                            ///< the reach in whole vectors
  FixedLine across;
  FixedLine* down;        ///< one for each vector of columns
  std::uint32_t* passed;  ///< what comes out of `across`: colours for each column
};

}  // namespace softfocus
