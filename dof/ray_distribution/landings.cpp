#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include "dof/ray_distribution/landings.h"

#include <algorithm>
#include <cmath>

#define SOFTFOCUS_KERNELS "dof/ray_distribution/landings.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kFarAway = 1 << 20;

// The blocks that share a cell with the columns x0 to x1 of the rows y0 to y1.
Blocks blocks_at(int x0, int x1, int y0, int y1) {
  const int left = std::max(x0, 0) / kBlock, right = std::min(x1, kPatchColumns - 1) / kBlock;
  const int top = std::max(y0, 0) / kBlock, bottom = std::min(y1, kPatchRows - 1) / kBlock;
  if (x1 < 0 || y1 < 0 || left > right || top > bottom) return 0;
  const Blocks row = (Blocks{2} << right) - (Blocks{1} << left);
  Blocks blocks = 0;
  for (int y = top; y <= bottom; ++y) blocks |= row << (y * kBlocksAcross);
  return blocks;
}

// The scalar form of find_landings().
int find_landings_scalar(const float* least, const float* most, const std::int32_t* x,
                         const std::int32_t* y, int count, LensPoint lens, Landing* landings) {
  int found = 0;
  for (int i = 0; i < count; ++i) {
    const float across = least[i] * lens.u, across_too = most[i] * lens.u;
    const float down = least[i] * lens.v, down_too = most[i] * lens.v;
    const Landing landing{i,
                          x[i] + whole_cells(std::min(across, across_too)),
                          x[i] + whole_cells(std::max(across, across_too)),
                          y[i] + whole_cells(std::min(down, down_too)),
                          y[i] + whole_cells(std::max(down, down_too)),
                          0,
                          kPatchRows};
    if (blocks_of(landing) != 0) landings[found++] = landing;
  }
  return found;
}

}  // namespace

Blocks blocks_of(const Landing& landing) {
  return blocks_at(landing.x0, landing.x1 + kReachTile - 1, landing.y0,
                   landing.y1 + kReachTile - 1);
}

Blocks find_candidates(const Sheet& sheet, int x, int y, Candidates& candidates) {
  candidates.least.clear();
  candidates.most.clear();
  candidates.x.clear();
  candidates.y.clear();
  candidates.tiles.clear();
  Blocks moving = 0;
  const auto add = [&](float least, float most, int tile_x, int tile_y, int tile) {
    candidates.least.push_back(least);
    candidates.most.push_back(most);
    candidates.x.push_back(tile_x);
    candidates.y.push_back(tile_y);
    candidates.tiles.push_back(tile);
  };
  const auto tile_at = [&](int place, int tiles) {
    return std::clamp((place + sheet.before) / kReachTile, 0, tiles);
  };
  const int first = tile_at(x - sheet.reach, sheet.tiles_across);
  const int end = tile_at(x + kPatchColumns - 1 + sheet.reach, sheet.tiles_across - 1) + 1;
  const int bottom = tile_at(y + kPatchRows - 1 + sheet.reach, sheet.tiles_down - 1);
  for (int row = tile_at(y - sheet.reach, sheet.tiles_down); row <= bottom; ++row) {
    for (int tile = row * sheet.tiles_across + first; tile < row * sheet.tiles_across + end;
         ++tile) {
      const float least = sheet.least[static_cast<std::size_t>(tile)];
      const float most = sheet.most[static_cast<std::size_t>(tile)];
      if (least > most) continue;
      const int reach = whole_cells(std::max(std::fabs(least), std::fabs(most)));
      const int tile_x = tile % sheet.tiles_across * kReachTile - sheet.before - x;
      const int tile_y = row * kReachTile - sheet.before - y;
      const Blocks blocks = blocks_at(tile_x - reach, tile_x + kReachTile - 1 + reach,
                                      tile_y - reach, tile_y + kReachTile - 1 + reach);
      if (blocks == 0) continue;
      if (reach > 0) moving |= blocks;
      add(least, most, tile_x, tile_y, tile);
    }
  }
  while (candidates.x.size() % kMostLanes != 0) add(0.0f, 0.0f, kFarAway, kFarAway, 0);
  return moving;
}

int find_landings(const Candidates& candidates, LensPoint lens, Isa isa,
                  std::vector<Landing>& landings) {
  const auto find =
      isa == Isa::scalar ? find_landings_scalar : SOFTFOCUS_KERNEL(isa, find_landings);
  return find(candidates.least.data(), candidates.most.data(), candidates.x.data(),
              candidates.y.data(), static_cast<int>(candidates.x.size()), lens, landings.data());
}

}  // namespace softfocus

#else  // the kernel

/// The candidates that land in a patch.
int find_landings(const float* least, const float* most, const std::int32_t* x,
                  const std::int32_t* y, int count, LensPoint lens, Landing* landings) {
  int found = 0;
  for (int i = 0; i < count; i += kLanes) {
    const Floats low = load(least + i), high = load(most + i);
    const Floats across = low * lens.u, across_too = high * lens.u;
    const Floats down = low * lens.v, down_too = high * lens.v;
    const Ints x0 = load(x + i) + round_to_int(smaller(across, across_too));
    const Ints x1 = load(x + i) + round_to_int(larger(across, across_too));
    const Ints y0 = load(y + i) + round_to_int(smaller(down, down_too));
    const Ints y1 = load(y + i) + round_to_int(larger(down, down_too));
    const Mask lands =
        (x1 > -kReachTile) & (x0 < kPatchColumns) & (y1 > -kReachTile) & (y0 < kPatchRows);
    unsigned bits = lane_bits(lands);
    if (bits == 0) continue;
    std::int32_t left[kLanes], right[kLanes], top[kLanes], bottom[kLanes];
    store(left, x0);
    store(right, x1);
    store(top, y0);
    store(bottom, y1);
    for (; bits != 0; bits &= bits - 1) {
      const int lane = __builtin_ctz(bits);
      landings[found++] = {i + lane,     left[lane], right[lane], top[lane],
                           bottom[lane], 0,          kPatchRows};
    }
  }
  return found;
}

#endif
