#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/methods/diffusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/threads/loops.h"

namespace softfocus {

// A layer's values for a pixel, a node of its lines: the radius, negative in the layer and
// positive where it is continued; then what is diffused: premultiplied colour, opacity, and for
// the near layer the colour behind it.
constexpr int kFarChannels = 4, kNearChannels = 7;
constexpr int kOpacity = 4, kBehind = 5;

// A continued radius loses this much a pixel.
constexpr float kRadiusFall = 0.125f;

// In lanes, a layer is cut into tiles of kLanes columns and rows. A block of columns has a node
// of vectors for each row, so rows read and write long pieces, and columns are solved where
// they lie. A tile that no circle reaches along rows has no nodes.
//
// A block of kLanes rows of the picture, and its part of the layer.
struct LayerRows {
  std::array<const float*, kMostLanes> picture;  // of the red plane; the last repeats
  std::ptrdiff_t plane;
  int height;  // rows that there are, 1 to kLanes
  int width, padded;
  float* layer;          // the node of the first row and block of columns
  std::ptrdiff_t block;  // floats from a block of columns to the next
  char* has_nodes;       // tile by tile
  float* shares;         // scratch
  float* nodes;
};

// A block of kLanes columns of the layer and of the picture.
struct LayerColumns {
  float* nodes;
  const char* has_nodes;  // of the uppermost tile
  int next_tile;          // from a tile's flag to that of the tile below
  int height;
  float* picture;  // the red plane's top
  std::ptrdiff_t stride, plane;
  float* shares;  // scratch
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/methods/diffusion.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// Outside the layer a node takes the largest radius that reaches it along the line.
void continue_radius(float& radius_px, float& reaching_px) {
  reaching_px = std::max(std::fabs(radius_px), reaching_px - kRadiusFall);
  if (!(radius_px < 0.0f)) radius_px = reaching_px;
}

// Solves the system of a line of nodes, `step` apart, from its first in the radius plane on.
void diffuse_line(float* first, std::ptrdiff_t step, std::ptrdiff_t plane, int count,
                  int channels) {
  const auto node = [&](int i) { return first + i * step; };
  float reaching = 0.0f;
  for (int i = 0; i < count; ++i) continue_radius(*node(i), reaching);
  reaching = 0.0f;
  for (int i = count - 1; i >= 0; --i) continue_radius(*node(i), reaching);

  std::vector<float> shares(static_cast<std::size_t>(count));
  std::array<float, kNearChannels> last{};
  float flow = 0.0f, ratio = 0.0f;
  for (int i = count - 1; i >= 0; --i) {
    const float next = i > 0 ? std::min(heat_flow(*node(i)), heat_flow(*node(i - 1))) : 0.0f;
    const float through = 1.0f + flow * ratio;
    const float scale = 1.0f / (through + next);
    ratio = through * scale;
    for (int c = 0; c < channels; ++c) {
      float& value = node(i)[(1 + c) * plane];
      last[static_cast<std::size_t>(c)] = value =
          (value + flow * last[static_cast<std::size_t>(c)]) * scale;
    }
    shares[static_cast<std::size_t>(i)] = next * scale;
    flow = next;
  }
  last = {};
  for (int i = 0; i < count; ++i) {
    for (int c = 0; c < channels; ++c) {
      float& value = node(i)[(1 + c) * plane];
      last[static_cast<std::size_t>(c)] = value =
          value + shares[static_cast<std::size_t>(i)] * last[static_cast<std::size_t>(c)];
    }
  }
}

// The nodes of the far layer or of the near one, diffused.
Planes diffused_layer(const Planes& picture, int channels, ThreadPool& pool) {
  const bool is_near = channels == kNearChannels;
  Planes layer = make_planes(1 + channels, picture.width, picture.height, pool);
  pool.for_each(layer.height, [&](int y) {
    for (int x = 0; x < layer.width; ++x) {
      const float* from = plane_row(picture, 0, y) + x;
      float* to = plane_row(layer, 0, y) + x;
      const float radius = from[3 * picture.plane];
      const bool inside = is_near ? radius < -0.5f : radius > 0.5f;
      to[0] = inside ? -std::fabs(radius) : 0.0f;
      to[kOpacity * layer.plane] = inside ? 1.0f : 0.0f;
      for (int c = 0; c < 3; ++c) {
        const float colour = from[c * picture.plane];
        to[(1 + c) * layer.plane] = inside ? colour : 0.0f;
        if (is_near) to[(kBehind + c) * layer.plane] = inside ? 0.0f : colour;
      }
    }
  });
  pool.for_each(layer.height, [&](int y) {
    diffuse_line(plane_row(layer, 0, y), 1, layer.plane, layer.width, channels);
  });
  pool.for_each(layer.width, [&](int x) {
    diffuse_line(plane_row(layer, 0, 0) + x, layer.stride, layer.plane, layer.height, channels);
  });
  return layer;
}

// A far pixel takes the far layer's colour, without what is hidden.
void put_far(const Planes& far, int x, int y, Planes& picture) {
  const float* node = plane_row(far, 0, y) + x;
  float* texel = plane_row(picture, 0, y) + x;
  if (!(texel[3 * picture.plane] > 0.5f)) return;
  for (int c = 0; c < 3; ++c) {
    texel[c * picture.plane] = node[(1 + c) * far.plane] / node[kOpacity * far.plane];
  }
}

// The near layer over all the rest.
void put_near(const Planes& near, int x, int y, Planes& picture) {
  const float* node = plane_row(near, 0, y) + x;
  float* texel = plane_row(picture, 0, y) + x;
  const bool is_near = texel[3 * picture.plane] < -0.5f;
  const float opacity = node[kOpacity * near.plane];
  if (!is_near && !(opacity > 0.0f)) return;
  for (int c = 0; c < 3; ++c) {
    float& colour = texel[c * picture.plane];
    const float behind =
        is_near ? node[(kBehind + c) * near.plane] : std::max(1.0f - opacity, 0.0f) * colour;
    colour = node[(1 + c) * near.plane] + behind;
  }
}

void put_layers_scalar(Planes& picture, ThreadPool& pool) {
  const auto put_layer = [&](int channels, const auto& put) {
    const Planes layer = diffused_layer(picture, channels, pool);
    pool.for_each(picture.height, [&](int y) {
      for (int x = 0; x < picture.width; ++x) put(layer, x, y, picture);
    });
  };
  put_layer(kFarChannels, put_far);
  put_layer(kNearChannels, put_near);
}

// A block's height in nodes is no power of two, or the blocks' rows would meet in a cache.
std::ptrdiff_t nodes_of_block(int height, int lanes) { return std::ptrdiff_t{height} + lanes; }

struct LayerKernels {
  int channels;
  void (*rows)(const LayerRows&);
  void (*columns)(const LayerColumns&);
};

// `layer` has room for the nodes.
void put_layer_lanes(Planes& picture, const LayerKernels& kernels, float* layer, ThreadPool& pool) {
  const int lanes = lanes_of(pool.isa());
  const int width = picture.width, height = picture.height;
  const int row_blocks = (height + lanes - 1) / lanes, column_blocks = (width + lanes - 1) / lanes;
  const int padded = column_blocks * lanes;
  const int node = (1 + kernels.channels) * lanes;
  const std::ptrdiff_t block = nodes_of_block(height, lanes) * node;
  std::vector<char> has_nodes(static_cast<std::size_t>(row_blocks * column_blocks));

  ScratchShelf<std::vector<float>> shelf;
  const auto for_each_block = [&](int count, const auto& work) {
    for_each_with(shelf, pool, count, [&](int i, auto& scratch) {
      scratch.resize(static_cast<std::size_t>(std::max(padded, height) * (node + lanes)));
      work(i, scratch.data());
    });
  };
  for_each_block(row_blocks, [&](int i, float* scratch) {
    const int y = i * lanes;
    LayerRows rows{.picture = {},
                   .plane = picture.plane,
                   .height = std::min(lanes, height - y),
                   .width = width,
                   .padded = padded,
                   .layer = layer + std::ptrdiff_t{y} * node,
                   .block = block,
                   .has_nodes = has_nodes.data() + std::ptrdiff_t{i} * column_blocks,
                   .shares = scratch,
                   .nodes = scratch + std::ptrdiff_t{padded} * lanes};
    for (int row = 0; row < kMostLanes; ++row) {
      rows.picture[static_cast<std::size_t>(row)] =
          plane_row(picture, 0, std::min(y + row, height - 1));
    }
    kernels.rows(rows);
  });
  for_each_block(column_blocks, [&](int i, float* scratch) {
    kernels.columns({.nodes = layer + i * block,
                     .has_nodes = has_nodes.data() + i,
                     .next_tile = column_blocks,
                     .height = height,
                     .picture = plane_row(picture, 0, 0) + i * lanes,
                     .stride = picture.stride,
                     .plane = picture.plane,
                     .shares = scratch});
  });
}

void put_layers_lanes(Planes& picture, ThreadPool& pool) {
  // One piece for both in turn, as it is the first writing of memory that costs.
  const int lanes = lanes_of(pool.isa());
  const int padded = (picture.width + lanes - 1) / lanes * lanes;
  const std::ptrdiff_t nodes = nodes_of_block(picture.height, lanes) * padded;
  const std::unique_ptr<float[]> layer(
      new float[static_cast<std::size_t>(nodes * (1 + kNearChannels))]);
  put_layer_lanes(picture,
                  {kFarChannels, SOFTFOCUS_KERNEL(pool.isa(), far_rows),
                   SOFTFOCUS_KERNEL(pool.isa(), far_columns)},
                  layer.get(), pool);
  put_layer_lanes(picture,
                  {kNearChannels, SOFTFOCUS_KERNEL(pool.isa(), near_rows),
                   SOFTFOCUS_KERNEL(pool.isa(), near_columns)},
                  layer.get(), pool);
}

}  // namespace

void diffusion(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  Planes picture = split_picture(input, pool);
  const bool in_lanes = pool.isa() != Isa::scalar;
  (in_lanes ? put_layers_lanes : put_layers_scalar)(picture, pool);
  pool.for_each(picture.height, [&](int y) {
    store_row(input, result, y, plane_row(picture, 0, y), plane_row(picture, 1, y),
              plane_row(picture, 2, y), pool.isa());
  });
}

}  // namespace softfocus

#else  // kernels

namespace {

SOFTFOCUS_INLINE Floats heat_flow(Floats radius_px) {
  return select(absolute(radius_px) > 0.5f, radius_px * radius_px * 0.125f, splat(0.0f));
}

/// Continues radii that are not the layer's own.
SOFTFOCUS_INLINE Floats continued(Floats radius_px, Floats& reaching_px) {
  reaching_px = larger(absolute(radius_px), reaching_px - kRadiusFall);
  return select(radius_px < 0.0f, radius_px, reaching_px);
}

/// Floats from a node to the next.
template <int channels>
inline constexpr int kNode = (1 + channels) * kLanes;

/// From the end of kLanes lines to their start: ends the continuing of radii and eliminates.
template <int channels>
SOFTFOCUS_INLINE void eliminate(float* nodes, int count, float* shares) {
  Floats ratio = splat(0.0f), flow = splat(0.0f), reaching = splat(0.0f), last[channels] = {};
  Floats radius = continued(load(nodes + (count - 1) * kNode<channels>), reaching);
  Floats here = heat_flow(radius);
  for (int i = count - 1; i >= 0; --i) {
    float* node = nodes + i * kNode<channels>;
    store(node, radius);
    Floats below = splat(0.0f);
    if (i > 0) {
      radius = continued(load(node - kNode<channels>), reaching);
      below = heat_flow(radius);
    }
    const Floats next = smaller(here, below);
    const Floats through = 1.0f + flow * ratio;
    const Floats scale = 1.0f / (through + next);
    ratio = through * scale;
#pragma GCC unroll 8
    for (int c = 0; c < channels; ++c) {
      last[c] = (load(node + (1 + c) * kLanes) + flow * last[c]) * scale;
      store(node + (1 + c) * kLanes, last[c]);
    }
    store(shares + i * kLanes, next * scale);
    flow = next;
    here = below;
  }
}

/// The way back, by one node: `last` becomes its solution.
template <int channels>
SOFTFOCUS_INLINE void substitute(const float* node, Floats share, Floats* last) {
#pragma GCC unroll 8
  for (int c = 0; c < channels; ++c) last[c] = load(node + (1 + c) * kLanes) + share * last[c];
}

template <bool near>
SOFTFOCUS_INLINE Mask is_inside(Floats radius) {
  return near ? radius < -0.5f : radius > 0.5f;
}

template <bool near>
SOFTFOCUS_INLINE bool has_layer(const LayerRows& rows) {
  for (int i = 0; i < rows.height; ++i) {
    const float* radius = rows.picture[static_cast<std::size_t>(i)] + 3 * rows.plane;
    Mask found = {};
    for (int x = 0; x < rows.padded; x += kLanes) found |= is_inside<near>(load(radius + x));
    if (any(found)) return true;
  }
  return false;
}

/// The values of nodes, as vectors along row `i`.
template <int channels>
SOFTFOCUS_INLINE void make_nodes(const LayerRows& rows, int i, int x, Floats (*values)[kLanes]) {
  constexpr bool near = channels == kNearChannels;
  const float* from = rows.picture[static_cast<std::size_t>(i)] + x;
  const Floats radius = load(from + 3 * rows.plane);
  const Mask inside = is_inside<near>(radius);
  values[0][i] = select(inside, -absolute(radius), splat(0.0f));
  values[kOpacity][i] = select(inside, splat(1.0f), splat(0.0f));
#pragma GCC unroll 8
  for (int c = 0; c < 3; ++c) {
    const Floats colour = load(from + c * rows.plane);
    values[1 + c][i] = select(inside, colour, splat(0.0f));
    if constexpr (near) values[kBehind + c][i] = select(inside, splat(0.0f), colour);
  }
}

/// A layer's nodes, diffused along rows.
template <int channels>
SOFTFOCUS_INLINE void layer_rows(const LayerRows& rows) {
  if (!has_layer<channels == kNearChannels>(rows)) return;
  Floats reaching = splat(0.0f);
  for (int x = 0; x < rows.padded; x += kLanes) {
    Floats values[1 + channels][kLanes];
    for (int i = 0; i < kLanes; ++i) make_nodes<channels>(rows, i, x, values);
    for (int c = 0; c <= channels; ++c) {
      transpose(values[c]);
      float* to = rows.nodes + x * (1 + channels) * kLanes + c * kLanes;
      for (int i = 0; i < kLanes; ++i) {
        store(to + i * kNode<channels>, c > 0 ? values[c][i] : continued(values[c][i], reaching));
      }
    }
  }
  eliminate<channels>(rows.nodes, rows.width, rows.shares);

  Floats last[channels] = {};
  for (int x = 0; x < rows.padded; x += kLanes) {
    Floats values[1 + channels][kLanes];
    Mask reached = {};
    for (int i = 0; i < kLanes; ++i) {
      // Nodes past the width repeat the last.
      if (x + i < rows.width) {
        const float* node = rows.nodes + (x + i) * kNode<channels>;
        values[0][i] = load(node);
        substitute<channels>(node, load(rows.shares + (x + i) * kLanes), last);
      } else {
        values[0][i] = values[0][i - 1];
      }
#pragma GCC unroll 8
      for (int c = 0; c < channels; ++c) values[1 + c][i] = last[c];
      reached |= values[0][i] != 0.0f;
    }
    if (!any(reached)) continue;
    rows.has_nodes[x / kLanes] = 1;
    float* tile = rows.layer + x / kLanes * rows.block;
    for (int c = 0; c <= channels; ++c) {
      transpose(values[c]);
      for (int i = 0; i < rows.height; ++i) {
        store(tile + i * kNode<channels> + c * kLanes, values[c][i]);
      }
    }
  }
}

/// Makes the node of row `y`, to which nothing comes along the row.
template <int channels>
SOFTFOCUS_INLINE void make_outer_node(const LayerColumns& columns, int y) {
  float* node = columns.nodes + y * kNode<channels>;
  for (int c = 0; c <= channels; ++c) {
    const float* colour = columns.picture + y * columns.stride + (c - kBehind) * columns.plane;
    store(node + c * kLanes, c < kBehind ? splat(0.0f) : load(colour));
  }
}

/// The far layer's colour, without what is hidden. `node` is colour, then opacity.
SOFTFOCUS_INLINE void put_far(const Floats* node, float* texel, std::ptrdiff_t plane) {
  const Mask far = load(texel + 3 * plane) > 0.5f;
  // All loads come before the stores: planes may lie a multiple of 4 KiB apart, and CPUs take
  // such addresses for the same one.
  const Floats r = load(texel), g = load(texel + plane), b = load(texel + 2 * plane);
  store(texel, select(far, node[0] / node[3], r));
  store(texel + plane, select(far, node[1] / node[3], g));
  store(texel + 2 * plane, select(far, node[2] / node[3], b));
}

/// The near layer over all the rest. `node` is colour, opacity, then colour behind.
SOFTFOCUS_INLINE void put_near(const Floats* node, float* texel, std::ptrdiff_t plane) {
  const Mask near = load(texel + 3 * plane) < -0.5f;
  const Mask shown = near | (node[3] > 0.0f);
  const Floats rest = larger(1.0f - node[3], splat(0.0f));
  const Floats r = load(texel), g = load(texel + plane), b = load(texel + 2 * plane);
  store(texel, select(shown, node[0] + select(near, node[4], rest * r), r));
  store(texel + plane, select(shown, node[1] + select(near, node[5], rest * g), g));
  store(texel + 2 * plane, select(shown, node[2] + select(near, node[6], rest * b), b));
}

/// Diffuses along columns, if the layer reaches any, and puts the layer into the picture.
template <int channels>
SOFTFOCUS_INLINE void layer_columns(const LayerColumns& columns) {
  const int tiles = (columns.height + kLanes - 1) / kLanes;
  bool reached = false;
  for (int i = 0; i < tiles; ++i) reached |= columns.has_nodes[i * columns.next_tile] != 0;
  if (!reached) return;

  Floats reaching = splat(0.0f);
  for (int y = 0; y < columns.height; ++y) {
    if (columns.has_nodes[y / kLanes * columns.next_tile] == 0) {
      make_outer_node<channels>(columns, y);
    }
    float* radius = columns.nodes + y * kNode<channels>;
    store(radius, continued(load(radius), reaching));
  }
  eliminate<channels>(columns.nodes, columns.height, columns.shares);

  Floats last[channels] = {};
  for (int y = 0; y < columns.height; ++y) {
    float* texel = columns.picture + y * columns.stride;
    substitute<channels>(columns.nodes + y * kNode<channels>, load(columns.shares + y * kLanes),
                         last);
    if constexpr (channels == kNearChannels) {
      put_near(last, texel, columns.plane);
    } else {
      put_far(last, texel, columns.plane);
    }
  }
}

}  // namespace

void far_rows(const LayerRows& rows) { layer_rows<kFarChannels>(rows); }
void near_rows(const LayerRows& rows) { layer_rows<kNearChannels>(rows); }
void far_columns(const LayerColumns& columns) { layer_columns<kFarChannels>(columns); }
void near_columns(const LayerColumns& columns) { layer_columns<kNearChannels>(columns); }

#endif
