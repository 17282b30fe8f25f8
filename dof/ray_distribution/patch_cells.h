#pragma once
// The cells of a patch: of each the nearest pixel's radius and colour, and sums over the planes.

#include <cstddef>

#include "dof/ray_distribution/landings.h"

namespace softfocus {

// A row of cells: radius, red, green, blue, each with margins for vectors that stick out.
inline constexpr int kCellMargin = kReachTile;
inline constexpr std::ptrdiff_t kCellPlane = kPatchColumns + 2 * kCellMargin;
inline constexpr std::ptrdiff_t kCellStride = 4 * kCellPlane;
// A row of sums: red, green, blue, number of cells.
inline constexpr std::ptrdiff_t kSumPlane = kPatchColumns;
inline constexpr std::ptrdiff_t kSumStride = 4 * kSumPlane;

// What a cell holds in place of a radius: nothing, or a pixel that is added up already.
inline constexpr float kEmpty = kNothingBehind;
inline constexpr float kAdded = -kNothingBehind;

inline float* cell_block(float* cells, int block) {
  return cells + block / kBlocksAcross * kBlock * kCellStride + kCellMargin +
         block % kBlocksAcross * kBlock;
}
inline float* sum_block(float* sums, int block) {
  return sums + block / kBlocksAcross * kBlock * kSumStride + block % kBlocksAcross * kBlock;
}

/// Empties the cells of blocks.
void empty_cells(float* cells, Blocks blocks, Isa isa);

/// Adds the colours of blocks of cells to the sums, but those that are added up already. The blocks
/// with empty cells.
Blocks add_cells(float* cells, Blocks blocks, float* sums, Isa isa);

/// Counts the cells that add_cells() added up, and marks them as added.
void count_cells(float* cells, Blocks blocks, float* sums, Isa isa);

/// Adds pixels to the sums of a block, plane after plane: `moved` says where each plane's begin.
/// Rows lie `stride` apart, channels `plane`.
void add_moved(const float* pixels, std::ptrdiff_t stride, std::ptrdiff_t plane,
               const std::ptrdiff_t* moved, int count, float* sums, Isa isa);

}  // namespace softfocus
