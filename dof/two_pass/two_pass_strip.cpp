#ifndef SOFTFOCUS_ISA

#include "dof/two_pass/two_pass_strip.h"

#include <algorithm>
#include <cstring>

#define SOFTFOCUS_KERNELS "dof/two_pass/two_pass_strip.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

int round_up(int value, int step) { return (value + step - 1) / step * step; }

// Vectors of extents and pairs of receivers read up to this many nodes past a line's end.
constexpr int kPast = kMostLanes;

int node_capacity(const StripShape& shape, int lanes, int batch) {
  return 2 * shape.reach + batch + lanes;
}

struct StripSizes {
  std::size_t along_x, along_y;  // nodes
  std::size_t vectors, extents;  // numbers
};

StripSizes strip_sizes(int lanes, const StripShape& shape, int batch) {
  const int columns = round_up(shape.columns, lanes);
  const int capacity = node_capacity(shape, lanes, batch);
  const auto vector = static_cast<std::size_t>(lanes);
  StripSizes sizes{};
  sizes.along_x = static_cast<std::size_t>(2 * round_up(shape.reach, lanes) + columns + kPast);
  sizes.along_y = static_cast<std::size_t>(columns / lanes * capacity + kPast);
  const auto results = static_cast<std::size_t>(std::max(columns, capacity) + kPast);
  // Eight vectors a node, one of depths for a node along y, three for a result.
  sizes.vectors = (8 * sizes.along_x + 8 * sizes.along_y + sizes.along_y + 3 * results) * vector;
  sizes.extents = 3 * (sizes.along_x + sizes.along_y);
  return sizes;
}

float* place(GatherNodes& nodes, std::size_t count, int lanes, float* vectors,
             std::int32_t*& extents) {
  const std::size_t half = 4 * count * static_cast<std::size_t>(lanes);
  nodes = {vectors, vectors + half, extents, extents + count, extents + 2 * count};
  extents += 3 * count;
  return vectors + 2 * half;
}

// Copies node `from` of every line along y to nodes `begin` to `end` - 1.
void repeat_node(const Strip& strip, int lanes, int from, int begin, int end) {
  const std::size_t floats = 4 * static_cast<std::size_t>(lanes);
  for (int column = 0; column < strip.columns / lanes; ++column) {
    const int line = column * strip.capacity;
    const auto source = static_cast<std::size_t>(line + from);
    for (int i = begin; i < end; ++i) {
      const auto target = static_cast<std::size_t>(line + i);
      std::copy_n(strip.down.whole + source * floats, floats, strip.down.whole + target * floats);
      std::copy_n(strip.down.part + source * floats, floats, strip.down.part + target * floats);
      strip.down.covers[target] = strip.down.covers[source];
      strip.down.covers_all[target] = strip.down.covers_all[source];
      strip.down.touches[target] = strip.down.touches[source];
    }
  }
}

// Nodes that reach nothing; their colours do not matter.
void blank_nodes(const Strip& strip, int lanes, int begin, int end) {
  for (int column = 0; column < strip.columns / lanes; ++column) {
    for (std::int32_t* extent : {strip.down.covers, strip.down.covers_all, strip.down.touches}) {
      std::fill(extent + column * strip.capacity + begin, extent + column * strip.capacity + end,
                0);
    }
  }
}

// Drops the nodes that are out of reach of the next rows.
void slide(Strip& strip, int lanes) {
  const int gone = strip.next - strip.reach;
  if (gone <= 0) return;
  const std::size_t floats = static_cast<std::size_t>(lanes);
  for (int column = 0; column < strip.columns / lanes; ++column) {
    const auto to = static_cast<std::size_t>(column * strip.capacity);
    const std::size_t from = to + static_cast<std::size_t>(gone);
    const auto count = static_cast<std::size_t>(strip.filled - gone);
    std::memmove(strip.down.whole + to * 4 * floats, strip.down.whole + from * 4 * floats,
                 count * 4 * floats * sizeof(float));
    std::memmove(strip.down.part + to * 4 * floats, strip.down.part + from * 4 * floats,
                 count * 4 * floats * sizeof(float));
    std::memmove(strip.depths + to * floats, strip.depths + from * floats,
                 count * floats * sizeof(std::uint32_t));
    for (std::int32_t* extent : {strip.down.covers, strip.down.covers_all, strip.down.touches}) {
      std::memmove(extent + to, extent + from, count * sizeof(std::int32_t));
    }
  }
  strip.next -= gone;
  strip.filled -= gone;
}

}  // namespace

std::size_t strip_bytes(const StripFilter& filter, const StripShape& shape, int batch) {
  const StripSizes sizes = strip_sizes(lanes_of(filter.isa), shape, batch);
  return sizeof(float) * (sizes.vectors + sizes.extents);
}

void begin_strip(Strip& strip, const StripFilter& filter, const StripShape& shape, int batch) {
  const int lanes = lanes_of(filter.isa);
  strip.picture_width = shape.picture_width;
  strip.x_begin = shape.x_begin;
  strip.columns = round_up(shape.columns, lanes);
  strip.reach = shape.reach;
  strip.halo = round_up(shape.reach, lanes);
  strip.capacity = node_capacity(shape, lanes, batch);

  const StripSizes sizes = strip_sizes(lanes, shape, batch);
  if (strip.vectors.size() < sizes.vectors) strip.vectors.resize(sizes.vectors);
  if (strip.extents.size() < sizes.extents) strip.extents.resize(sizes.extents);
  std::int32_t* extents = strip.extents.data();
  float* vectors = strip.vectors.data();
  vectors = place(strip.across, sizes.along_x, lanes, vectors, extents);
  vectors = place(strip.down, sizes.along_y, lanes, vectors, extents);
  strip.depths = reinterpret_cast<std::uint32_t*>(vectors);
  strip.gathered = strip.depths + sizes.along_y * static_cast<std::size_t>(lanes);
}

void begin_rows(Strip& strip, const StripFilter& filter, Outside above, int rows_before) {
  strip.next = strip.reach;
  strip.filled = strip.reach - rows_before;
  strip.lead = above == Outside::repeats ? strip.filled : 0;
  if (above == Outside::sharp) blank_nodes(strip, lanes_of(filter.isa), 0, strip.filled);
}

int room(Strip& strip, const StripFilter& filter) {
  if (strip.filled + lanes_of(filter.isa) > strip.capacity) slide(strip, lanes_of(filter.isa));
  return strip.capacity - strip.filled;
}

void add_rows(Strip& strip, const StripFilter& filter, const std::uint16_t* const* rows,
              int count) {
  SOFTFOCUS_KERNEL(filter.isa, filter_across)(strip, filter, rows, strip.filled);
  repeat_node(strip, lanes_of(filter.isa), strip.filled, 0, strip.lead);
  strip.lead = 0;
  strip.filled += count;
}

void add_rows_below(Strip& strip, const StripFilter& filter, Outside below, int count) {
  const int end = strip.filled + count;
  if (below == Outside::repeats) {
    repeat_node(strip, lanes_of(filter.isa), strip.filled - 1, strip.filled, end);
  } else {
    blank_nodes(strip, lanes_of(filter.isa), strip.filled, end);
  }
  strip.filled = end;
}

int rows_done(const Strip& strip) { return strip.filled - strip.reach - strip.next; }

void write_rows(Strip& strip, const StripFilter& filter, int count, std::uint16_t* result,
                std::ptrdiff_t stride_bytes) {
  SOFTFOCUS_KERNEL(filter.isa, filter_down)
  (strip, filter, strip.next, count, result, stride_bytes);
  strip.next += count;
}

}  // namespace softfocus

#else  // Both passes, once a vector unit.

namespace {

#include "dof/weights.inl"

#include "dof/two_pass/two_pass_gather.inl"

/// Extents of kLanes nodes, one a lane: their smallest and largest radius, and whether any pixel
/// lies beyond the focus (the sign bit).
struct NodeExtent {
  Floats smallest, largest;
  Bits signs;
};
SOFTFOCUS_INLINE NodeExtent no_extent() { return {splat(0x1p20f), splat(0.0f), splat(0u)}; }
SOFTFOCUS_INLINE void widen(NodeExtent& extent, Floats signed_radius_px) {
  const Floats radius = absolute(signed_radius_px);
  extent.smallest = smaller(extent.smallest, radius);
  extent.largest = larger(extent.largest, radius);
  extent.signs = extent.signs | as_bits(signed_radius_px);
}

// overlap(r, d) is 1 if r - d >= 1, and 0 if r <= d; rounding r - d changes neither.
SOFTFOCUS_INLINE Ints covers(const NodeExtent& extent) {
  return larger(truncate(extent.smallest) - 1, splat(0));
}
SOFTFOCUS_INLINE Ints covers_all(const NodeExtent& extent) {
  return select(as_ints(extent.signs) < 0, splat(0), covers(extent));
}
SOFTFOCUS_INLINE Ints touches(const NodeExtent& extent) {
  const Ints whole = truncate(extent.largest);
  return larger(whole + (to_floats(whole) == extent.largest), splat(0));
}

SOFTFOCUS_INLINE void store_part(const GatherNodes& nodes, int node, Floats r, Floats g, Floats b,
                                 Floats intensity_of_node) {
  float* part = nodes.part + node * 4 * kLanes;
  store(part + kLanes, r);
  store(part + 2 * kLanes, g);
  store(part + 3 * kLanes, b);
  float* whole = nodes.whole + node * 4 * kLanes;
  store(whole + kLanes, r * intensity_of_node);
  store(whole + 2 * kLanes, g * intensity_of_node);
  store(whole + 3 * kLanes, b * intensity_of_node);
}

/// Makes nodes `at` to `at` + kLanes - 1 of the line along x from kLanes rows. Unless `column`
/// is negative, the pixels lie in the strip itself, in that vector of columns: then the lines
/// along y get their radius, intensity and depth too.
SOFTFOCUS_INLINE void load_block(const Strip& strip, const StripFilter& filter,
                                 const std::uint16_t* const* rows, int x, int at, int column,
                                 int node) {
  // A depth stored between the passes is the one that the second pass sees.
  const bool stored_between = filter.between == Between::half;
  Floats r[kLanes], g[kLanes], b[kLanes], radius[kLanes], light[kLanes];
  NodeExtent across = no_extent(), down = no_extent();
  for (int i = 0; i < kLanes; ++i) {
    // Rows lie too far apart for the hardware's prefetcher.
    __builtin_prefetch(rows[kLanes + i] + 4 * x);
    if constexpr (kLanes == 16) __builtin_prefetch(rows[kLanes + i] + 4 * x + 32);
    const HalfTexels texels = load_repeating(rows[i], x, strip.picture_width);
    r[i] = half_to_float(texels.r);
    g[i] = half_to_float(texels.g);
    b[i] = half_to_float(texels.b);
    radius[i] = signed_radius(filter.settings, half_to_float(texels.a));
    light[i] = intensity(absolute(radius[i]));
    widen(across, radius[i]);
    if (column >= 0) {
      const int to = column * strip.capacity + node + i;
      const Bits depth = stored_depth(texels.a, filter.rounding);
      // An infinity that became NaN keeps its radius, but is not beyond the focus.
      Mask lost = splat(0);
      if (stored_between) lost = depth != texels.a;
      store(strip.down.part + to * 4 * kLanes, select(lost, absolute(radius[i]), radius[i]));
      store(strip.down.whole + to * 4 * kLanes, light[i]);
      store(strip.depths + to * kLanes, depth);
    }
  }
  transpose(r);
  transpose(g);
  transpose(b);
  transpose(radius);
  transpose(light);
  for (int i = 0; i < kLanes; ++i) {
    widen(down, radius[i]);
    store(strip.across.part + (at + i) * 4 * kLanes, radius[i]);
    store(strip.across.whole + (at + i) * 4 * kLanes, light[i]);
    store_part(strip.across, at + i, r[i], g[i], b[i], light[i]);
  }
  store(strip.across.covers + at, covers(across));
  store(strip.across.covers_all + at, covers_all(across));
  store(strip.across.touches + at, touches(across));
  if (column >= 0) {
    const int to = column * strip.capacity + node;
    store(strip.down.covers + to, covers(down));
    store(strip.down.covers_all + to, covers_all(down));
    store(strip.down.touches + to, touches(down));
  }
}

SOFTFOCUS_INLINE GatherNodes nodes_from(const GatherNodes& nodes, int node) {
  return {nodes.whole + node * 4 * kLanes, nodes.part + node * 4 * kLanes, nodes.covers + node,
          nodes.covers_all + node, nodes.touches + node};
}

void gather(const StripFilter& filter, const GatherNodes& line, int count, int reach,
            std::uint32_t* gathered) {
  using enum HalfRounding;
  const float leak = filter.settings.leak;
  switch (filter.rounding) {
    case nearest_even:
      return gather_line<HalfResults<nearest_even> >(line, count, reach, leak, gathered);
    case toward_zero:
      return gather_line<HalfResults<toward_zero> >(line, count, reach, leak, gathered);
    case swiftshader:
      return gather_line<HalfResults<swiftshader> >(line, count, reach, leak, gathered);
  }
}

/// Turns the first pass's results, kLanes rows of a column, into nodes of the lines along y.
SOFTFOCUS_INLINE void halves_to_nodes(const Strip& strip, int column, int node) {
  Bits rg[kLanes], b[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const std::uint32_t* from = strip.gathered + (column * kLanes + i) * 2 * kLanes;
    rg[i] = load(from);
    b[i] = load(from + kLanes);
  }
  transpose(rg);
  transpose(b);
  for (int i = 0; i < kLanes; ++i) {
    const int to = column * strip.capacity + node + i;
    store_part(strip.down, to, half_to_float(rg[i] & 0xFFFFu), half_to_float(rg[i] >> 16),
               half_to_float(b[i]), load(strip.down.whole + to * 4 * kLanes));
  }
}
SOFTFOCUS_INLINE void singles_to_nodes(const Strip& strip, int column, int node) {
  Bits r[kLanes], g[kLanes], b[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const std::uint32_t* from = strip.gathered + (column * kLanes + i) * 3 * kLanes;
    r[i] = load(from);
    g[i] = load(from + kLanes);
    b[i] = load(from + 2 * kLanes);
  }
  transpose(r);
  transpose(g);
  transpose(b);
  for (int i = 0; i < kLanes; ++i) {
    const int to = column * strip.capacity + node + i;
    store_part(strip.down, to, as_floats(r[i]), as_floats(g[i]), as_floats(b[i]),
               load(strip.down.whole + to * 4 * kLanes));
  }
}

}  // namespace

/// The first pass: filters kLanes rows along x. They become the nodes of the lines along y
/// from `node` on.
void filter_across(const Strip& strip, const StripFilter& filter, const std::uint16_t* const* rows,
                   int node) {
  const int length = strip.halo + strip.columns + strip.halo;
  for (int at = 0; at < length; at += kLanes) {
    const bool inside = at >= strip.halo && at < strip.halo + strip.columns;
    load_block(strip, filter, rows, strip.x_begin - strip.halo + at, at,
               inside ? (at - strip.halo) / kLanes : -1, node);
  }
  const GatherNodes line = nodes_from(strip.across, strip.halo);
  if (filter.between == Between::single) {
    gather_line<FloatResults>(line, strip.columns, strip.reach, filter.settings.leak,
                              strip.gathered);
  } else {
    gather(filter, line, strip.columns, strip.reach, strip.gathered);
  }
  for (int column = 0; column < strip.columns / kLanes; ++column) {
    if (filter.between == Between::single) {
      singles_to_nodes(strip, column, node);
    } else {
      halves_to_nodes(strip, column, node);
    }
  }
}

/// The second pass: filters nodes `node` to `node` + count - 1 of the lines along y into rows
/// of the picture, the first of which begins at `result`.
void filter_down(const Strip& strip, const StripFilter& filter, int node, int count,
                 std::uint16_t* result, std::ptrdiff_t stride_bytes) {
  for (int column = 0; column < strip.columns / kLanes; ++column) {
    const int from = column * strip.capacity + node;
    const int x = strip.x_begin + column * kLanes;
    gather(filter, nodes_from(strip.down, from), count, strip.reach, strip.gathered);
    const int inside = strip.picture_width - x < kLanes ? strip.picture_width - x : kLanes;
    for (int i = 0; i < count; ++i) {
      const Bits rg = load(strip.gathered + i * 2 * kLanes);
      const Bits b = load(strip.gathered + i * 2 * kLanes + kLanes);
      const HalfTexels texels{rg & 0xFFFFu, rg >> 16, b, load(strip.depths + (from + i) * kLanes)};
      auto* row =
          reinterpret_cast<std::uint16_t*>(reinterpret_cast<std::byte*>(result) + i * stride_bytes);
      std::uint16_t* to = row + 4 * x;
      if (inside == kLanes) {
        if (filter.past_caches) {
          stream_texel_words(to, interleave(texels));
        } else {
          store_half_texels(to, texels);
        }
      } else if (inside > 0) {
        std::uint16_t last[4 * kLanes];
        store_half_texels(last, texels);
        std::memcpy(to, last, 4 * sizeof *last * static_cast<std::size_t>(inside));
      }
    }
  }
  if (filter.past_caches) finish_streaming();
}

#endif
