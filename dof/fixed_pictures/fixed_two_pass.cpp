#include "dof/fixed_pictures/fixed_two_pass.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>
#include <utility>

#include "dof/fixed/weights.h"
#include "dof/fixed_pictures/fixed_line.h"
#include "dof/fixed_pictures/fixed_rows.h"
#include "dof/focus_map.h"
#include "dof/two_pass/two_pass_strip.h"
#include "raster/threads/scratch_shelf.h"

#define SOFTFOCUS_KERNELS "dof/fixed_pictures/fixed_two_pass_kernels.inl"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// A strip's lines should stay in a core's second cache, of 2 MiB on what was measured, with
// room for the picture beside them. Between these bounds: fewer columns or rows, and too much
// of a strip is what lies around it.
constexpr std::size_t kLinesBytes = std::size_t{3} << 19;
constexpr int kMostColumns = 512;
constexpr int kLeastColumns = 128;
constexpr int kLeastRows = 128;

std::int32_t split(std::uint32_t weight) {
  return static_cast<std::int32_t>((weight >> kSplitBits) << 16 |
                                   (weight & ((1u << kSplitBits) - 1)));
}

/// What a thread filters strips in.
struct StripMemory {
  std::vector<std::uint32_t, RowAllocator<std::uint32_t>> numbers;
  std::vector<FixedLine> down;
};

struct LineShape {
  int reach, lanes;
  unsigned node_slots, sum_slots;
  unsigned colour_words, slot_vectors;
};

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

int columns_of_strip(const LineShape& shape) {
  const std::size_t lines = kLinesBytes / (numbers_of(shape) * sizeof(std::uint32_t));
  return std::clamp(static_cast<int>(std::bit_floor(lines)) * shape.lanes, kLeastColumns,
                    kMostColumns);
}

FixedLine line_at(std::uint32_t* memory, const LineShape& shape) {
  const auto lanes = static_cast<std::size_t>(shape.lanes);
  const auto take = [&memory, lanes](std::size_t vectors) {
    std::uint32_t* part = memory;
    memory += vectors * lanes;
    return part;
  };
  const auto take_signed = [&take](std::size_t vectors) {
    return reinterpret_cast<std::int32_t*>(take(vectors));
  };
  return {shape.reach,
          shape.node_slots,
          shape.sum_slots,
          take(std::size_t{shape.colour_words} * shape.node_slots),
          take_signed(shape.node_slots),
          take_signed(shape.node_slots),
          take(std::size_t{shape.slot_vectors} * shape.sum_slots),
          take(shape.slot_vectors),
          {0, 0}};
}

int rounded_up(int value, int step) { return (value + step - 1) / step * step; }

/// Gives the strip its lines.
void lay_out(FixedStrip& strip, StripMemory& memory, const LineShape& shape) {
  const int lanes = shape.lanes;
  strip.halo = rounded_up(shape.reach, lanes);
  const int blocks = (strip.x_end - strip.x_begin + lanes - 1) / lanes;
  // Nodes come out from `reach` before the halo to `reach` before the end of the other.
  const std::size_t node = static_cast<std::size_t>(lanes) * shape.colour_words;
  const std::size_t before = static_cast<std::size_t>(strip.halo + shape.reach) * node;
  const std::size_t passed = before + static_cast<std::size_t>(blocks * lanes + strip.halo) * node;
  memory.numbers.resize(passed + static_cast<std::size_t>(blocks + 1) * numbers_of(shape));
  strip.passed = memory.numbers.data() + before;
  std::uint32_t* at = memory.numbers.data() + passed;
  strip.across = line_at(at, shape);
  memory.down.clear();
  for (int i = 0; i < blocks; ++i) {
    memory.down.push_back(line_at(at += numbers_of(shape), shape));
  }
  strip.down = memory.down.data();
}

void filter_in_lanes(const FixedStrip& whole, int reach, bool halves, ThreadPool& pool) {
  const LineShape shape = line_shape(reach, lanes_of(pool.isa()), halves);
  const int columns = columns_of_strip(shape);
  const int across = (whole.width + columns - 1) / columns;
  // What a part takes hardly depends on what is in it: as many for one thread as for another.
  const int wanted = pool.threads() / std::gcd(pool.threads(), across);
  const int rows =
      std::max(rounded_up((whole.height + wanted - 1) / wanted, shape.lanes), kLeastRows);
  const int down = (whole.height + rows - 1) / rows;
  ScratchShelf<StripMemory> shelf;
  pool.for_each(across * down, [&](int part) {
    StripMemory memory = shelf.take();
    FixedStrip strip = whole;
    strip.x_begin = part % across * columns;
    strip.x_end = std::min(strip.x_begin + columns, whole.width);
    strip.y_begin = part / across * rows;
    strip.y_end = std::min(strip.y_begin + rows, whole.height);
    lay_out(strip, memory, shape);
    if (halves) {
      SOFTFOCUS_KERNEL(pool.isa(), filter_strip_of_halves)(strip);
    } else {
      SOFTFOCUS_KERNEL(pool.isa(), filter_strip_of_bytes)(strip);
    }
    shelf.put_back(std::move(memory));
  });
}

/// `codes` are null if they are the picture's alpha.
void filter(const ConstImageView& picture, const void* codes, softfocus_fixed_depth depth,
            const FixedTable& table, const ImageView& result, ThreadPool& pool) {
  const bool halves = picture.format == Format::rgba16f;
  assert(halves || (picture.format == Format::rgba8 && codes != nullptr));
  assert(result.format == picture.format);
  if (pool.isa() == Isa::scalar) {
    fixed_two_pass_rows(picture, depth, codes, table.weights, result, pool);
    return;
  }
  FixedStrip whole{};
  whole.words = table.words.data();
  whole.width = picture.width;
  whole.height = picture.height;
  whole.picture = reinterpret_cast<const std::uint8_t*>(picture.texels);
  whole.picture_stride = picture.stride_bytes;
  whole.codes = codes;
  whole.code_bytes = depth == SOFTFOCUS_FIXED_DEPTH8 ? 1 : 2;
  whole.result = reinterpret_cast<std::uint8_t*>(result.texels);
  whole.result_stride = result.stride_bytes;
  whole.past_caches = write_past_caches(result);
  filter_in_lanes(whole, table.reach, halves, pool);
}

}  // namespace

FixedTable fixed_table(std::vector<fixed::Weights> weights) {
  FixedTable table{std::move(weights), {}};
  table.words.reserve(2 * table.weights.size());
  for (const fixed::Weights& entry : table.weights) {
    const int key = entry.reach << 1 | entry.beyond;
    const int leak = entry.leak & (fixed::kLeakOne - 1);
    table.words.push_back(split(entry.whole - entry.edge) | key << kKeyShift |
                          leak >> kLeakBitsThere << (kKeyShift + 7) |
                          (entry.leak == fixed::kLeakOne ? kLeaksAll : 0));
    table.words.push_back(split(entry.edge) | (leak & ((1 << kLeakBitsThere) - 1)) << kLeakShift |
                          (entry.leak < fixed::kLeakOne || entry.reach == 0 ? kNearlySharp : 0));
    table.reach = std::max(table.reach, int{entry.reach});
  }
  return table;
}

void fixed_two_pass(const ConstImageView& picture, std::span<const std::uint8_t> codes,
                    const FixedTable& table, const ImageView& result, ThreadPool& pool) {
  assert(table.weights.size() == 256);
  filter(picture, codes.data(), SOFTFOCUS_FIXED_DEPTH8, table, result, pool);
}

void fixed_two_pass(const ConstImageView& picture, std::span<const std::uint16_t> codes,
                    const FixedTable& table, const ImageView& result, ThreadPool& pool) {
  assert(table.weights.size() == 65536);
  filter(picture, codes.data(), SOFTFOCUS_FIXED_DEPTH16, table, result, pool);
}

void fixed_two_pass(const ConstImageView& picture, const FixedTable& table, const ImageView& result,
                    ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && table.weights.size() == 65536);
  filter(picture, nullptr, SOFTFOCUS_FIXED_DEPTH_IN_ALPHA, table, result, pool);
}

}  // namespace softfocus
