#include "dof/fixed_pictures/fixed_line.h"

#include <bit>

#include "dof/fixed/weights.h"

namespace softfocus {
namespace {

std::int32_t split(std::uint32_t weight) {
  return static_cast<std::int32_t>((weight >> kSplitBits) << 16 |
                                   (weight & ((1u << kSplitBits) - 1)));
}

}  // namespace

LineShape line_shape(int reach, int lanes, bool halves) {
  return {reach,
          lanes,
          std::bit_ceil(static_cast<unsigned>(reach + lanes)),
          std::bit_ceil(static_cast<unsigned>(2 * reach + 2)),
          static_cast<unsigned>(halves ? kHalfColourWords : kSmallColourWords),
          2u * static_cast<unsigned>(halves ? kHalfSumVectors : kSmallSumVectors)};
}

std::size_t numbers_of(const LineShape& shape) {
  return ((2 + std::size_t{shape.colour_words}) * shape.node_slots +
          std::size_t{shape.slot_vectors} * (shape.sum_slots + std::size_t{1})) *
         static_cast<std::size_t>(shape.lanes);
}

FixedLine line_at(std::uint32_t* memory, const LineShape& shape) {
  const auto lanes = static_cast<std::size_t>(shape.lanes);
  const auto part_of = [&memory, lanes](std::size_t vectors) {
    std::uint32_t* part = memory;
    memory += vectors * lanes;
    return part;
  };
  const auto signed_part = [&part_of](std::size_t vectors) {
    return reinterpret_cast<std::int32_t*>(part_of(vectors));
  };
  return {shape.reach,
          shape.node_slots,
          shape.sum_slots,
          part_of(std::size_t{shape.colour_words} * shape.node_slots),
          signed_part(shape.node_slots),
          signed_part(shape.node_slots),
          part_of(std::size_t{shape.slot_vectors} * shape.sum_slots),
          part_of(shape.slot_vectors),
          {0, 0}};
}

std::vector<std::int32_t> weight_words(std::span<const fixed::Weights> table) {
  std::vector<std::int32_t> words;
  words.reserve(2 * table.size());
  for (const fixed::Weights& entry : table) {
    const int key = entry.reach << 1 | entry.beyond;
    const int leak = entry.leak & (fixed::kLeakOne - 1);
    words.push_back(split(entry.whole - entry.edge) | key << kKeyShift |
                    leak >> kLeakBitsThere << (kKeyShift + 7) |
                    (entry.leak == fixed::kLeakOne ? kLeaksAll : 0));
    words.push_back(split(entry.edge) | (leak & ((1 << kLeakBitsThere) - 1)) << kLeakShift |
                    (entry.leak < fixed::kLeakOne || entry.reach == 0 ? kNearlySharp : 0));
  }
  return words;
}

}  // namespace softfocus
