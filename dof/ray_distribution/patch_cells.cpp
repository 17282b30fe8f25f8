#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/ray_distribution/patch_cells.h"

#include <algorithm>

#define SOFTFOCUS_KERNELS "dof/ray_distribution/patch_cells.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// The scalar form of empty_cells().
void empty_cells_scalar(float* cells, Blocks blocks) {
  for_each_block(blocks, [&](int block) {
    for (int y = 0; y < kBlock; ++y) {
      std::fill_n(cell_block(cells, block) + y * kCellStride, kBlock, kEmpty);
    }
  });
}

// The scalar form of add_cells().
Blocks add_cells_scalar(float* cells, Blocks blocks, float* sums) {
  Blocks with_empty = 0;
  for_each_block(blocks, [&](int block) {
    for (int i = 0; i < kBlock * kBlock; ++i) {
      const float* cell = cell_block(cells, block) + i / kBlock * kCellStride + i % kBlock;
      float* sum = sum_block(sums, block) + i / kBlock * kSumStride + i % kBlock;
      if (*cell == kEmpty) {
        with_empty |= Blocks{1} << block;
      } else if (*cell > kAdded) {
        for (int c = 0; c < 3; ++c) sum[c * kSumPlane] += cell[(c + 1) * kCellPlane];
      }
    }
  });
  return with_empty;
}

// The scalar form of count_cells().
void count_cells_scalar(float* cells, Blocks blocks, float* sums) {
  for_each_block(blocks, [&](int block) {
    for (int i = 0; i < kBlock * kBlock; ++i) {
      float* cell = cell_block(cells, block) + i / kBlock * kCellStride + i % kBlock;
      if (*cell == kEmpty || *cell == kAdded) continue;
      *cell = kAdded;
      sum_block(sums, block)[i / kBlock * kSumStride + i % kBlock + 3 * kSumPlane] += 1.0f;
    }
  });
}

// The scalar form of add_moved().
void add_moved_scalar(const float* pixels, std::ptrdiff_t stride, std::ptrdiff_t plane,
                      const std::ptrdiff_t* moved, int count, float* sums) {
  for (int i = 0; i < count; ++i) {
    for (int place = 0; place < kBlock * kBlock; ++place) {
      const int x = place % kBlock, y = place / kBlock;
      const float* from = pixels + moved[i] + y * stride + x;
      float* sum = sums + y * kSumStride + x;
      for (int c = 0; c < 3; ++c) sum[c * kSumPlane] += from[c * plane];
    }
  }
}

}  // namespace

void empty_cells(float* cells, Blocks blocks, Isa isa) {
  const auto empty = isa == Isa::scalar ? empty_cells_scalar : SOFTFOCUS_KERNEL(isa, empty_cells);
  empty(cells, blocks);
}

Blocks add_cells(float* cells, Blocks blocks, float* sums, Isa isa) {
  const auto add = isa == Isa::scalar ? add_cells_scalar : SOFTFOCUS_KERNEL(isa, add_cells);
  return add(cells, blocks, sums);
}

void count_cells(float* cells, Blocks blocks, float* sums, Isa isa) {
  const auto count = isa == Isa::scalar ? count_cells_scalar : SOFTFOCUS_KERNEL(isa, count_cells);
  count(cells, blocks, sums);
}

void add_moved(const float* pixels, std::ptrdiff_t stride, std::ptrdiff_t plane,
               const std::ptrdiff_t* moved, int count, float* sums, Isa isa) {
  const auto add = isa == Isa::scalar ? add_moved_scalar : SOFTFOCUS_KERNEL(isa, add_moved);
  add(pixels, stride, plane, moved, count, sums);
}

}  // namespace softfocus

#else  // kernels

/// Empties the cells of blocks.
void empty_cells(float* cells, Blocks blocks) {
  for (; blocks != 0; blocks &= blocks - 1) {
    float* block = cell_block(cells, __builtin_ctzll(blocks));
    for (int y = 0; y < kBlock; ++y) {
      for (int x = 0; x < kBlock; x += kLanes) store(block + y * kCellStride + x, splat(kEmpty));
    }
  }
}

/// Adds the colours of blocks of cells to the sums, but those that are added up already. The
/// blocks with empty cells.
Blocks add_cells(float* cells, Blocks blocks, float* sums) {
  Blocks with_empty = 0;
  for (; blocks != 0; blocks &= blocks - 1) {
    const int block = __builtin_ctzll(blocks);
    Mask empty{};
    for (int i = 0; i < kBlock * kBlock; i += kLanes) {
      const float* cell = cell_block(cells, block) + i / kBlock * kCellStride + i % kBlock;
      float* red = sum_block(sums, block) + i / kBlock * kSumStride + i % kBlock;
      float *green = red + kSumPlane, *blue = green + kSumPlane;
      const Floats radius = load(cell), none = splat(0.0f);
      const Mask reached = absolute(radius) < kEmpty;
      empty |= radius >= kEmpty;
      store(red, load(red) + select(reached, load(cell + kCellPlane), none));
      store(green, load(green) + select(reached, load(cell + 2 * kCellPlane), none));
      store(blue, load(blue) + select(reached, load(cell + 3 * kCellPlane), none));
    }
    if (any(empty)) with_empty |= Blocks{1} << block;
  }
  return with_empty;
}

/// Counts the cells that add_cells() added up, and marks them as added.
void count_cells(float* cells, Blocks blocks, float* sums) {
  for (; blocks != 0; blocks &= blocks - 1) {
    const int block = __builtin_ctzll(blocks);
    for (int i = 0; i < kBlock * kBlock; i += kLanes) {
      float* cell = cell_block(cells, block) + i / kBlock * kCellStride + i % kBlock;
      float* count = sum_block(sums, block) + i / kBlock * kSumStride + i % kBlock + 3 * kSumPlane;
      const Floats radius = load(cell);
      const Mask reached = absolute(radius) < kEmpty;
      store(cell, select(reached, splat(kAdded), radius));
      store(count, load(count) + select(reached, splat(1.0f), splat(0.0f)));
    }
  }
}

/// Adds moved pixels to a block of sums, in their order.
void add_moved(const float* pixels, std::ptrdiff_t stride, std::ptrdiff_t plane,
               const std::ptrdiff_t* moved, int count, float* sums) {
  for (int i = 0; i < kBlock * kBlock; i += kLanes) {
    const float* from = pixels + i / kBlock * stride + i % kBlock;
    float* sum = sums + i / kBlock * kSumStride + i % kBlock;
    Floats red = load(sum), green = load(sum + kSumPlane), blue = load(sum + 2 * kSumPlane);
    for (int plane_number = 0; plane_number < count; ++plane_number) {
      const float* at = from + moved[plane_number];
      red += load(at);
      green += load(at + plane);
      blue += load(at + 2 * plane);
    }
    store(sum, red);
    store(sum + kSumPlane, green);
    store(sum + 2 * kSumPlane, blue);
  }
}

#endif
