#include "dof/fixed_two_pass.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include "dof/fixed_line.h"
#include "dof/fixed_rows.h"
#include "dof/focus_map.h"
#include "dof/two_pass_strip.h"
#include "raster/scratch_shelf.h"

#define SOFTFOCUS_KERNELS "dof/fixed_two_pass_kernels.inl"
#include "raster/numbers/for_each_isa.inl"

namespace softfocus {
namespace {

// Columns of a strip: its lines stay in a core's second cache, and few columns lie in more
// than one strip's reach. And rows that it should have, for the same reason.
constexpr int kColumns = 256;
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
};

std::size_t numbers_of(const LineShape& shape) {
  return (3 * std::size_t{shape.node_slots} + 8 * std::size_t{shape.sum_slots} + 8) *
         static_cast<std::size_t>(shape.lanes);
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
          take(shape.node_slots),
          take_signed(shape.node_slots),
          take_signed(shape.node_slots),
          take(8 * std::size_t{shape.sum_slots}),
          take(8),
          {0, 0}};
}

int rounded_up(int value, int step) { return (value + step - 1) / step * step; }

/// Gives the strip its lines.
void lay_out(FixedStrip& strip, StripMemory& memory, int reach, int lanes) {
  const LineShape shape{reach, lanes, std::bit_ceil(static_cast<unsigned>(reach + 2 * lanes)),
                        std::bit_ceil(static_cast<unsigned>(2 * reach + 2))};
  strip.halo = rounded_up(reach, lanes);
  const int blocks = (strip.x_end - strip.x_begin + lanes - 1) / lanes;
  // Nodes come out from `reach` before the halo to `reach` before the end of the other.
  const std::size_t before =
      static_cast<std::size_t>(strip.halo + reach) * static_cast<std::size_t>(lanes);
  const std::size_t passed = before + static_cast<std::size_t>(blocks * lanes + strip.halo) *
                                          static_cast<std::size_t>(lanes);
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

void filter_in_lanes(const FixedStrip& whole, int reach, ThreadPool& pool) {
  const int lanes = lanes_of(pool.isa());
  const int across = (whole.width + kColumns - 1) / kColumns;
  // Enough parts that no thread waits long for the last.
  const int wanted = (2 * pool.threads() + across - 1) / across;
  const int rows = std::max(rounded_up((whole.height + wanted - 1) / wanted, lanes), kLeastRows);
  const int down = (whole.height + rows - 1) / rows;
  ScratchShelf<StripMemory> shelf;
  pool.for_each(across * down, [&](int part) {
    StripMemory memory = shelf.take();
    FixedStrip strip = whole;
    strip.x_begin = part % across * kColumns;
    strip.x_end = std::min(strip.x_begin + kColumns, whole.width);
    strip.y_begin = part / across * rows;
    strip.y_end = std::min(strip.y_begin + rows, whole.height);
    lay_out(strip, memory, reach, lanes);
    SOFTFOCUS_KERNEL(pool.isa(), filter_fixed_strip)(strip);
    shelf.put_back(std::move(memory));
  });
}

void filter(const Image& picture, const void* codes, int code_bytes, const FixedTable& table,
            Image& result, ThreadPool& pool) {
  assert(picture.format == Format::rgba8 && result.format == Format::rgba8);
  FixedStrip whole{};
  whole.words = table.words.data();
  whole.width = picture.width;
  whole.height = picture.height;
  whole.picture = row<std::uint8_t>(picture, 0).data();
  whole.picture_stride = static_cast<std::ptrdiff_t>(picture.stride_bytes);
  whole.codes = codes;
  whole.code_bytes = code_bytes;
  whole.result = row<std::uint8_t>(result, 0).data();
  whole.result_stride = static_cast<std::ptrdiff_t>(result.stride_bytes);
  whole.past_caches = write_past_caches(result);
  filter_in_lanes(whole, table.reach, pool);
}

}  // namespace

FixedTable fixed_table(std::vector<fixed::Weights> weights) {
  FixedTable table{std::move(weights), {}};
  table.words.reserve(2 * table.weights.size());
  for (const fixed::Weights& entry : table.weights) {
    const int key = entry.reach << 1 | entry.beyond;
    const int leak = entry.leak & 0x7FFF;
    table.words.push_back(split(entry.whole) | key << kKeyShift |
                          leak >> kLeakBitsThere << (kKeyShift + 7));
    table.words.push_back(split(entry.edge) | (leak & ((1 << kLeakBitsThere) - 1)) << kLeakShift |
                          (entry.leak < 32768 ? kLeaking : 0));
    table.reach = std::max(table.reach, int{entry.reach});
  }
  return table;
}

void fixed_two_pass(const Image& picture, std::span<const std::uint8_t> codes,
                    const FixedTable& table, Image& result, ThreadPool& pool) {
  assert(table.weights.size() == 256);
  if (pool.isa() == Isa::scalar) {
    fixed_two_pass_rows(picture, SOFTFOCUS_FIXED_DEPTH8, codes.data(), table.weights, result, pool);
  } else {
    filter(picture, codes.data(), 1, table, result, pool);
  }
}

void fixed_two_pass(const Image& picture, std::span<const std::uint16_t> codes,
                    const FixedTable& table, Image& result, ThreadPool& pool) {
  assert(table.weights.size() == 65536);
  if (pool.isa() == Isa::scalar) {
    fixed_two_pass_rows(picture, SOFTFOCUS_FIXED_DEPTH16, codes.data(), table.weights, result,
                        pool);
  } else {
    filter(picture, codes.data(), 2, table, result, pool);
  }
}

}  // namespace softfocus
