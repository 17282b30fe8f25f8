#pragma once
// The fixed-point filter of dof/fixed for pictures that lie in memory as a whole, on threads
// and vector units: the same bits as rows one by one (docs/fixed-point.md).
//
// In integers a sum does not depend on its order. So what a pixel adds to its neighbours
// along a line is not added neighbour by neighbour: four differences go to where its weight
// changes, and running sums along the line do the rest. The work does not grow with the
// radius, only the memory that it goes through.

#include <cstdint>
#include <span>
#include <vector>

#include "dof/fixed/fixed.h"
#include "dof/dof.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// A table from softfocus_fixed_table8() and its like, of 256 or 65536 entries, in the form
/// that vector lanes use. Made once a lens.
struct FixedTable {
  std::vector<fixed::Weights> weights;
  std::vector<std::int32_t> words;  ///< two for each code: dof/fixed_pictures/fixed_line.h
  int reach = 0;                    ///< of the farthest
};
FixedTable fixed_table(std::vector<fixed::Weights> weights);

/// Filters an RGBA8 or RGBA16F picture of up to 16384 pixels a side into another image of its
/// size and format. Codes of depth
/// lie row by row without gaps; the table has an entry for each code of 8 or 16 bits. `scalar`
/// runs the rows of dof/fixed.
void fixed_two_pass(const ConstImageView& picture, std::span<const std::uint8_t> codes,
                    const FixedTable& table, const ImageView& result, ThreadPool& pool);
void fixed_two_pass(const ConstImageView& picture, std::span<const std::uint16_t> codes,
                    const FixedTable& table, const ImageView& result, ThreadPool& pool);
/// The same with the alpha of RGBA16F for codes.
void fixed_two_pass(const ConstImageView& picture, const FixedTable& table, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus
