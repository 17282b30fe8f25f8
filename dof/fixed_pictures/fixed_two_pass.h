#pragma once
// The integer filter of dof/fixed for whole pictures in memory, on threads and vector units: the
// bits of the rows one by one (docs/fixed-point.md).
//
// Sums of integers do not depend on their order. So a pixel is not added to each neighbour along
// a line. Instead four differences are noted where its weight changes, and running sums along
// the line do the rest: the work does not grow with the radius.

#include <cstdint>
#include <span>
#include <vector>

#include "dof/dof.h"
#include "dof/fixed/fixed.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// A table of weights, from softfocus_fixed_table8() and the like, with the form of it that
/// vector lanes use. Made once a lens.
struct FixedTable {
  std::vector<fixed::Weights> weights;  ///< 256 or 65536, one for each code
  std::vector<std::int32_t> words;      ///< weight_words() of fixed_line.h
  int reach = 0;                        ///< the farthest of all entries, 0 to 63
};
FixedTable fixed_table(std::vector<fixed::Weights> weights);

/// Filters an RGBA8 or RGBA16F picture into another of its size and format, which shares no
/// memory with it. Colours are linear; alpha goes through. Codes of depth lie row by row without
/// gaps. Needs a table of 256 entries for codes of 8 bits, of 65536 for 16 bits.
void fixed_two_pass(const ConstImageView& picture, std::span<const std::uint8_t> codes,
                    const FixedTable& table, const ImageView& result, ThreadPool& pool);
void fixed_two_pass(const ConstImageView& picture, std::span<const std::uint16_t> codes,
                    const FixedTable& table, const ImageView& result, ThreadPool& pool);
/// RGBA16F whose alpha, as 16 bits, is the code.
void fixed_two_pass(const ConstImageView& picture, const FixedTable& table, const ImageView& result,
                    ThreadPool& pool);

}  // namespace softfocus
