#pragma once
// Lines of pixels on their way through a pass of the integer filter, kLanes lines at once: node
// i holds pixel i of each. Nodes go in kLanes at a time, and come out `reach` nodes later.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dof/fixed/fixed.h"

namespace softfocus {

// Weights as the kernels use them: two words for each depth code. A weight w of 20 bits is
// split as 2^5 h + l, for products of 16 bits.
//
//   bits      31            30 .. 16    15 .. 12      11 .. 5        4 .. 0
//   inner     leakage is 1  h           leakage >> 11 reach, beyond  l        w = whole - edge
//   edge      nearly sharp  h           leakage: its lower 11 bits   l        w = edge
//
// A pixel is nearly sharp if its leakage is below 1 or it reaches nothing.

inline constexpr int kSplitBits = 5;
inline constexpr std::int32_t kSplitMask = 0x7FFF001F;
inline constexpr int kKeyShift = 5;
inline constexpr std::int32_t kKeyMask = 0x7F;  // reach << 1 | beyond
inline constexpr int kLeakShift = 5;            // in an edge's word
inline constexpr int kLeakBitsThere = 11;
inline constexpr std::int32_t kLeaksAll = INT32_MIN;
inline constexpr std::int32_t kNearlySharp = INT32_MIN;

// Vectors that a node's colours take, and a sum of weights and colours.

inline constexpr int kSmallColourWords = 1, kSmallSumVectors = 4;  ///< colours of 10 bits
inline constexpr int kHalfColourWords = 2, kHalfSumVectors = 7;    ///< RGBA16F

/// Node i lies in slot i modulo `node_slots`, the sums at node i in slot i modulo `sum_slots`.
/// A slot of sums is two: nearer than the focus, and beyond it.
struct FixedLine {
  int reach;               ///< no pixel reaches farther
  unsigned node_slots;     ///< a power of two, at least reach + kLanes
  unsigned sum_slots;      ///< a power of two, at least 2 reach + 2
  std::uint32_t* colours;  ///< in the words of fixed_colours.inl
  std::int32_t* inners;    ///< the table's words for a node
  std::int32_t* edges;
  std::uint32_t* sums;     ///< differences along the line
  std::uint32_t* running;  ///< a slot: their sums up to the node that came out last
  int touched[2];          ///< the last node that differences on this side go to
};

/// The part of a picture that a task filters, and how. Strides are in bytes.
struct FixedStrip {
  const std::int32_t* words;    ///< weight_words()
  int width, height;            ///< of the picture
  const std::uint8_t* picture;  ///< RGBA8 or RGBA16F
  std::ptrdiff_t picture_stride;
  const void* codes;  ///< null if they are the alpha of RGBA16F
  int code_bytes;
  std::uint8_t* result;  ///< in the format of the picture
  std::ptrdiff_t result_stride;
  bool past_caches;  ///< write_past_caches() of the result

  int x_begin, x_end, y_begin, y_end;  ///< x_begin and y_begin multiples of the lanes
  int halo;                            ///< the reach in whole vectors
  FixedLine across;
  FixedLine* down;        ///< one for each vector of columns
  std::uint32_t* passed;  ///< colours that come out of `across`, column by column
};

/// How much memory lines have, from the reach and the unit's lanes.
struct LineShape {
  int reach, lanes;
  unsigned node_slots, sum_slots;
  unsigned colour_words, slot_vectors;
};

LineShape line_shape(int reach, int lanes, bool halves);

/// 32-bit numbers of memory that a line takes.
std::size_t numbers_of(const LineShape& shape);

/// A line in that memory.
FixedLine line_at(std::uint32_t* memory, const LineShape& shape);

/// The kernels' words of a table, two for each code.
std::vector<std::int32_t> weight_words(std::span<const fixed::Weights> table);

}  // namespace softfocus
