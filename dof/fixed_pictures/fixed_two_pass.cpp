#ifndef SOFTFOCUS_ISA

#include "dof/fixed_pictures/fixed_two_pass.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>
#include <utility>

#include "dof/fixed_pictures/fixed_line.h"
#include "dof/focus_map.h"
#include "dof/two_pass/two_pass_strip.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "dof/fixed_pictures/fixed_two_pass.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// --- scalar: the rows of dof/fixed, in strips with the rows above and below that reach them ---

struct RowFilter {
  const ConstImageView& picture;
  const std::uint8_t* codes;
  std::size_t code_bytes;
  const fixed::Weights* table;
  fixed::Settings settings;  // of the whole picture
  const ImageView& result;
};

const std::byte* bytes_of(const ConstImageView& image, int y) {
  return image.texels + y * image.stride_bytes;
}
std::byte* bytes_of(const ImageView& image, int y) { return image.texels + y * image.stride_bytes; }

void filter_rows(const RowFilter& filter, int y_begin, int y_end) {
  const int first = std::max(y_begin - filter.settings.reach, 0);
  const int last = std::min(y_end + filter.settings.reach, filter.picture.height);
  fixed::Settings settings = filter.settings;
  settings.height = static_cast<std::uint16_t>(last - first);
  std::vector<std::uint32_t> memory(fixed::memory_bytes(settings) / sizeof(std::uint32_t) + 1);
  std::vector<std::byte> unwanted(bytes_per_texel(filter.result.format) *
                                  static_cast<std::size_t>(filter.result.width));
  fixed::Stream stream;
  const auto begin = settings.colour == SOFTFOCUS_FIXED_RGBA16F ? softfocus_fixed_begin_half
                                                                : softfocus_fixed_begin;
  [[maybe_unused]] const int error =
      begin(&stream, &settings, filter.table, memory.data(), memory.size() * sizeof(std::uint32_t));
  assert(error == 0);
  int out = first;
  const auto place = [&] {
    return out >= y_begin && out < y_end ? bytes_of(filter.result, out) : unwanted.data();
  };
  for (int y = first; y < last; ++y) {
    const std::size_t code = static_cast<std::size_t>(y) * settings.width * filter.code_bytes;
    out += softfocus_fixed_put_row(
        &stream, static_cast<std::uint32_t>(y - first), bytes_of(filter.picture, y),
        filter.codes != nullptr ? filter.codes + code : nullptr, place());
  }
  while (out < y_end && softfocus_fixed_finish_row(&stream, place()) == 1) ++out;
}

void fixed_two_pass_scalar(const ConstImageView& picture, softfocus_fixed_depth depth,
                           const void* codes, std::span<const fixed::Weights> table,
                           const ImageView& result, ThreadPool& pool) {
  const bool bytes = picture.format == Format::rgba8;
  assert(bytes || picture.format == Format::rgba16f);
  int reach = 0;
  for (const fixed::Weights& weights : table) reach = std::max(reach, int{weights.reach});
  const RowFilter filter{
      picture,
      static_cast<const std::uint8_t*>(codes),
      depth == SOFTFOCUS_FIXED_DEPTH8 ? std::size_t{1} : std::size_t{2},
      table.data(),
      {static_cast<std::uint16_t>(picture.width), static_cast<std::uint16_t>(picture.height),
       static_cast<std::uint8_t>(reach),
       static_cast<std::uint8_t>(bytes ? SOFTFOCUS_FIXED_RGBA8 : SOFTFOCUS_FIXED_RGBA16F),
       static_cast<std::uint8_t>(depth)},
      result};
  // Strips much higher than the rows around them, and enough for all threads.
  const int rows =
      std::max(4 * reach + 16, (picture.height + 4 * pool.threads() - 1) / (4 * pool.threads()));
  for_each_band(pool, picture.height, rows,
                [&](int first, int end) { filter_rows(filter, first, end); });
}

// --- lanes: strips of columns, kLanes lines at once ---

// A strip's lines should stay in a core's second cache (2 MiB where this was measured), with
// room for the picture beside them. With fewer columns or rows than these, too much of a strip
// is its surroundings.
constexpr std::size_t kLinesBytes = std::size_t{3} << 19;
constexpr int kMostColumns = 512;
constexpr int kLeastColumns = 128;
constexpr int kLeastRows = 128;

// The memory that a task filters a strip in.
struct StripMemory {
  std::vector<std::uint32_t, RowAllocator<std::uint32_t>> numbers;
  std::vector<FixedLine> down;
};

int columns_of_strip(const LineShape& shape) {
  const std::size_t lines = kLinesBytes / (numbers_of(shape) * sizeof(std::uint32_t));
  return std::clamp(static_cast<int>(std::bit_floor(lines)) * shape.lanes, kLeastColumns,
                    kMostColumns);
}

int rounded_up(int value, int step) { return (value + step - 1) / step * step; }

// Gives the strip its lines.
void lay_out(FixedStrip& strip, StripMemory& memory, const LineShape& shape) {
  const int lanes = shape.lanes;
  strip.halo = rounded_up(shape.reach, lanes);
  const int blocks = (strip.x_end - strip.x_begin + lanes - 1) / lanes;
  // The first node comes out `reach` before the left halo, and nothing reads it.
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

void fixed_two_pass_lanes(const FixedStrip& whole, int reach, bool halves, ThreadPool& pool) {
  const LineShape shape = line_shape(reach, lanes_of(pool.isa()), halves);
  const int columns = columns_of_strip(shape);
  const int across = (whole.width + columns - 1) / columns;
  // All parts cost about the same, so every thread gets as many.
  const int wanted = pool.threads() / std::gcd(pool.threads(), across);
  const int rows =
      std::max(rounded_up((whole.height + wanted - 1) / wanted, shape.lanes), kLeastRows);
  const int down = (whole.height + rows - 1) / rows;
  for_each_with<StripMemory>(pool, across * down, [&](int part, auto& memory) {
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
  });
}

// `codes` are null if they are the picture's alpha.
void filter(const ConstImageView& picture, const void* codes, softfocus_fixed_depth depth,
            const FixedTable& table, const ImageView& result, ThreadPool& pool) {
  const bool halves = picture.format == Format::rgba16f;
  assert(halves || (picture.format == Format::rgba8 && codes != nullptr));
  assert(result.format == picture.format);
  if (pool.isa() == Isa::scalar) {
    fixed_two_pass_scalar(picture, depth, codes, table.weights, result, pool);
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
  fixed_two_pass_lanes(whole, table.reach, halves, pool);
}

}  // namespace

FixedTable fixed_table(std::vector<fixed::Weights> weights) {
  FixedTable table{std::move(weights), {}};
  table.words = weight_words(table.weights);
  for (const fixed::Weights& entry : table.weights) {
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

#else  // Both passes, once a vector unit.

namespace {

#include "dof/fixed_pictures/fixed_line.inl"
#include "dof/fixed_pictures/fixed_pixels.inl"

// --- the passes ---

/// Makes nodes x to x + kLanes - 1 of the line along x from the kLanes rows from y on. The line
/// along y, if there is one, gets their weights.
template <class Pixels>
void load_block(const FixedStrip& strip, int x, int y, FixedLine* down) {
  Bits alpha[kLanes];
  Pixels::load_colours(strip, x, y, alpha);
  Ints inners[kLanes], edges[kLanes];
#pragma GCC unroll 16
  for (int i = 0; i < kLanes; ++i) {
    const Ints codes = Pixels::codes(strip, x, row_inside(strip, y + i), alpha[i]);
    const IntPairs words = gather_pairs(strip.words, codes);
    inners[i] = words.first;
    edges[i] = words.second;
    if (down != nullptr) {
      const int at = node_at(*down, y + i);
      store(down->inners + at, inners[i]);
      store(down->edges + at, edges[i]);
    }
  }
  store_transposed(strip.across, inners, strip.across.inners, 1, x);
  store_transposed(strip.across, edges, strip.across.edges, 1, x);
}

/// Copies node `like` to the `count` nodes from `first` on.
template <class Pixels>
SOFTFOCUS_INLINE void repeat_node(const FixedLine& line, int like, int first, int count) {
  const std::uint32_t* colours = colours_at<Pixels>(line, like);
  const Ints inner = load(line.inners + node_at(line, like));
  const Ints edge = load(line.edges + node_at(line, like));
  for (int node = first; node < first + count; ++node) {
    for (int word = 0; word < Pixels::kWords; ++word) {
      store(colours_at<Pixels>(line, node) + word * kLanes, load(colours + word * kLanes));
    }
    store(line.inners + node_at(line, node), inner);
    store(line.edges + node_at(line, node), edge);
  }
}

/// The first pass of the kLanes rows from y on: they become nodes of the lines along y.
template <class Pixels>
void filter_across_fixed(FixedStrip& strip, int y) {
  constexpr int kStep = Pixels::kWords * kLanes;
  begin_line<Pixels>(strip.across);
  const int columns = strip.x_end - strip.x_begin;
  const int end = strip.x_begin + (columns + kLanes - 1) / kLanes * kLanes;
  int loaded_to = strip.x_begin - strip.halo;
  if (strip.x_begin == 0) {
    load_block<Pixels>(strip, 0, y, strip.down);
    repeat_node<Pixels>(strip.across, 0, -strip.halo, strip.halo);
    loaded_to = kLanes;
  }
  for (int x = strip.x_begin - strip.halo; x < end + strip.halo; x += kLanes) {
    if (x >= strip.width) {
      repeat_node<Pixels>(strip.across, x - 1, x, kLanes);
    } else if (x >= loaded_to) {
      const bool inside = x >= strip.x_begin && x < end;
      load_block<Pixels>(strip, x, y, inside ? strip.down + (x - strip.x_begin) / kLanes : nullptr);
    }
    // Room for the nodes that come out before the strip begins lies before `passed`.
    filter_nodes<Pixels, false>(strip.across, x, strip.x_begin,
                                strip.passed + (x - strip.across.reach - strip.x_begin) * kStep);
  }
  for (int x = strip.x_begin; x < end; x += kLanes) {
    const FixedLine& down = strip.down[(x - strip.x_begin) / kLanes];
    for (int word = 0; word < Pixels::kWords; ++word) {
      Bits colours[kLanes];
#pragma GCC unroll 16
      for (int i = 0; i < kLanes; ++i) {
        colours[i] = load(strip.passed + (x - strip.x_begin + i) * kStep + word * kLanes);
      }
      store_transposed(down, colours, down.colours + word * kLanes, Pixels::kWords, y);
    }
  }
}

/// The second pass of the kLanes nodes from y on, in all columns. Stores the finished rows.
template <class Pixels>
void filter_down_fixed(FixedStrip& strip, int y) {
  for (int x = strip.x_begin; x < strip.x_end; x += kLanes) {
    FixedLine& line = strip.down[(x - strip.x_begin) / kLanes];
    std::uint32_t out[kLanes * Pixels::kWords * kLanes];
    filter_nodes<Pixels, true>(line, y, strip.y_begin, out);
    const int inside = strip.x_end - x < kLanes ? strip.x_end - x : kLanes;
    for (int i = 0; i < kLanes; ++i) {
      const int row = y + i - line.reach;
      if (row < strip.y_begin || row >= strip.y_end) continue;
      Pixels::store_pixels(strip, x, row, inside, out + i * Pixels::kWords * kLanes);
    }
  }
}

template <class Pixels>
SOFTFOCUS_INLINE void filter_strip(FixedStrip& strip) {
  const int blocks = (strip.x_end - strip.x_begin + kLanes - 1) / kLanes;
  for (int i = 0; i < blocks; ++i) begin_line<Pixels>(strip.down[i]);
  int passed_to = strip.y_begin - strip.halo;
  if (strip.y_begin == 0) {
    filter_across_fixed<Pixels>(strip, 0);
    for (int i = 0; i < blocks; ++i) {
      repeat_node<Pixels>(strip.down[i], 0, -strip.halo, strip.halo);
    }
    passed_to = kLanes;
  }
  for (int y = strip.y_begin - strip.halo; y - strip.across.reach < strip.y_end; y += kLanes) {
    if (y >= strip.height) {
      for (int i = 0; i < blocks; ++i) repeat_node<Pixels>(strip.down[i], y - 1, y, kLanes);
    } else if (y >= passed_to) {
      filter_across_fixed<Pixels>(strip, y);
    }
    filter_down_fixed<Pixels>(strip, y);
  }
  if (strip.past_caches) finish_streaming();
}

}  // namespace

void filter_strip_of_bytes(FixedStrip& strip) { filter_strip<BytePixels>(strip); }
void filter_strip_of_halves(FixedStrip& strip) { filter_strip<HalfPixels>(strip); }

#endif
