#include "dof/two_pass/two_pass_strip.h"

#include <algorithm>
#include <cstring>

#include "dof/weights.h"

#define SOFTFOCUS_KERNELS "dof/two_pass/two_pass_kernels.inl"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

int round_up(int value, int step) { return (value + step - 1) / step * step; }

// Nodes that vectors of extents and pairs of receivers may read past a line's end.
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
  // Eight vectors a node, a vector of depths for each along y, three for each result.
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

// Node `from` of every line along y, copied to nodes `begin` to `end` - 1.
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

// Nodes that reach none, of any content.
void blank_nodes(const Strip& strip, int lanes, int begin, int end) {
  for (int column = 0; column < strip.columns / lanes; ++column) {
    for (std::int32_t* extent : {strip.down.covers, strip.down.covers_all, strip.down.touches}) {
      std::fill(extent + column * strip.capacity + begin, extent + column * strip.capacity + end,
                0);
    }
  }
}

// Forgets the nodes that no row to come can reach.
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

void take_rows(Strip& strip, const StripFilter& filter, int count, std::uint16_t* result,
               std::size_t stride) {
  SOFTFOCUS_KERNEL(filter.isa, filter_down)
  (strip, filter, strip.next, count, result, static_cast<std::ptrdiff_t>(stride));
  strip.next += count;
}

}  // namespace softfocus
