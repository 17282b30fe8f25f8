#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/methods/generalised_diffusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dof/methods/diffusion.h"
#include "dof/picture_planes.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "dof/methods/generalised_diffusion.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// Solves the system of a line of pixels, `step` apart, from its first in the red plane on.
void diffuse_line(float* first, std::ptrdiff_t step, std::ptrdiff_t plane, int count) {
  std::vector<float> shares(static_cast<std::size_t>(count));
  const float* radius = first + 3 * plane;
  float before = 0.0f, ratio = 0.0f;
  std::array<float, 3> last{};
  for (int i = 0; i < count; ++i) {
    const float next = i + 1 < count ? heat_flow(radius[(i + 1) * step]) : 0.0f;
    const float after = std::min(heat_flow(radius[i * step]), next);
    const float through = 1.0f + before * ratio;
    const float scale = 1.0f / (through + after);
    ratio = through * scale;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      float& value = first[static_cast<std::ptrdiff_t>(channel) * plane + i * step];
      last[channel] = value = (value + before * last[channel]) * scale;
    }
    shares[static_cast<std::size_t>(i)] = after * scale;
    before = after;
  }
  last = {};
  for (int i = count - 1; i >= 0; --i) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      float& value = first[static_cast<std::ptrdiff_t>(channel) * plane + i * step];
      last[channel] = value = value + shares[static_cast<std::size_t>(i)] * last[channel];
    }
  }
}

// The picture, with the radii that came with it, if any.
Planes split_with_radii(const DofInput& input, ThreadPool& pool) {
  Planes planes = split_picture(input, pool);
  if (input.radii_px.empty()) return planes;
  const float most = input.settings.max_coc_px;
  pool.for_each(planes.height, [&](int y) {
    const float* from = input.radii_px.data() + std::ptrdiff_t{y} * planes.width;
    float* to = plane_row(planes, 3, y);
    for (int x = 0; x < planes.width; ++x) to[x] = std::clamp(from[x], -most, most);
  });
  return planes;
}

void store_planes(const DofInput& input, const ImageView& result, const Planes& planes,
                  ThreadPool& pool) {
  pool.for_each(planes.height, [&](int y) {
    store_row(input, result, y, plane_row(planes, 0, y), plane_row(planes, 1, y),
              plane_row(planes, 2, y), pool.isa());
  });
}

void generalised_diffusion_scalar(const DofInput& input, const ImageView& result,
                                  ThreadPool& pool) {
  Planes planes = split_with_radii(input, pool);
  pool.for_each(planes.height, [&](int y) {
    diffuse_line(plane_row(planes, 0, y), 1, planes.plane, planes.width);
  });
  pool.for_each(planes.width, [&](int x) {
    diffuse_line(plane_row(planes, 0, 0) + x, planes.stride, planes.plane, planes.height);
  });
  store_planes(input, result, planes, pool);
}

}  // namespace

void generalised_diffusion(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) return generalised_diffusion_scalar(input, result, pool);
  Planes planes = split_with_radii(input, pool);
  const int lanes = lanes_of(pool.isa());
  const int padded = (planes.width + lanes - 1) / lanes * lanes;
  const auto scratch = static_cast<std::size_t>(std::max(padded, planes.height) * 4 * lanes);
  ScratchShelf<std::vector<float>> shelf;
  for_each_with(shelf, pool, (planes.height + lanes - 1) / lanes, [&](int block, auto& nodes) {
    nodes.resize(scratch);
    std::array<float*, kMostLanes> rows;
    for (int i = 0; i < kMostLanes; ++i) {
      const int y = std::min(block * lanes + i, planes.height - 1);
      rows[static_cast<std::size_t>(i)] = plane_row(planes, 0, y);
    }
    SOFTFOCUS_KERNEL(pool.isa(), diffuse_rows)
    (rows.data(), std::min(lanes, planes.height - block * lanes), planes.plane, planes.width,
     padded, nodes.data());
  });
  for_each_with(shelf, pool, padded / lanes, [&](int block, auto& nodes) {
    nodes.resize(scratch);
    SOFTFOCUS_KERNEL(pool.isa(), diffuse_columns)
    (plane_row(planes, 0, 0) + block * lanes, planes.stride, planes.plane, planes.height,
     nodes.data());
  });
  store_planes(input, result, planes, pool);
}

}  // namespace softfocus

#else  // kernels

namespace {

SOFTFOCUS_INLINE Floats heat_flow(Floats radius_px) {
  return select(absolute(radius_px) > 0.5f, radius_px * radius_px * 0.125f, splat(0.0f));
}

/// Solves kLanes systems of `count` nodes. A node is four vectors: radius, red, green, blue.
SOFTFOCUS_INLINE void diffuse_lines(float* nodes, int count) {
  Floats ratio = splat(0.0f), before = splat(0.0f);
  Floats r = splat(0.0f), g = splat(0.0f), b = splat(0.0f);
  Floats here = heat_flow(load(nodes));
  for (int i = 0; i < count; ++i) {
    float* node = nodes + i * 4 * kLanes;
    const Floats next = i + 1 < count ? heat_flow(load(node + 4 * kLanes)) : splat(0.0f);
    const Floats after = smaller(here, next);
    const Floats through = 1.0f + before * ratio;
    const Floats scale = 1.0f / (through + after);
    ratio = through * scale;
    r = (load(node + kLanes) + before * r) * scale;
    g = (load(node + 2 * kLanes) + before * g) * scale;
    b = (load(node + 3 * kLanes) + before * b) * scale;
    store(node, after * scale);
    store(node + kLanes, r);
    store(node + 2 * kLanes, g);
    store(node + 3 * kLanes, b);
    before = after;
    here = next;
  }
  r = g = b = splat(0.0f);
  for (int i = count - 1; i >= 0; --i) {
    float* node = nodes + i * 4 * kLanes;
    const Floats share = load(node);
    r = load(node + kLanes) + share * r;
    g = load(node + 2 * kLanes) + share * g;
    b = load(node + 3 * kLanes) + share * b;
    store(node + kLanes, r);
    store(node + 2 * kLanes, g);
    store(node + 3 * kLanes, b);
  }
}

}  // namespace

/// Solves kLanes rows at once; the last `padded - width` nodes of each are padding. `rows`
/// are kLanes rows of the red plane; the first `height` are written.
void diffuse_rows(float* const* rows, int height, std::ptrdiff_t plane, int width, int padded,
                  float* nodes) {
  for (int x = 0; x < padded; x += kLanes) {
    for (int channel = 0; channel < 4; ++channel) {
      Floats block[kLanes];
      for (int i = 0; i < kLanes; ++i) block[i] = load(rows[i] + (channel + 3) % 4 * plane + x);
      transpose(block);
      for (int i = 0; i < kLanes; ++i) store(nodes + ((x + i) * 4 + channel) * kLanes, block[i]);
    }
  }
  diffuse_lines(nodes, width);
  for (int x = 0; x < padded; x += kLanes) {
    for (int channel = 1; channel < 4; ++channel) {
      Floats block[kLanes];
      for (int i = 0; i < kLanes; ++i) block[i] = load(nodes + ((x + i) * 4 + channel) * kLanes);
      transpose(block);
      for (int i = 0; i < height; ++i) store(rows[i] + (channel - 1) * plane + x, block[i]);
    }
  }
}

/// Solves kLanes columns at once, from `top` in the red plane down.
void diffuse_columns(float* top, std::ptrdiff_t stride, std::ptrdiff_t plane, int height,
                     float* nodes) {
  for (int y = 0; y < height; ++y) {
    for (int channel = 0; channel < 4; ++channel) {
      store(nodes + (y * 4 + channel) * kLanes, load(top + y * stride + (channel + 3) % 4 * plane));
    }
  }
  diffuse_lines(nodes, height);
  for (int y = 0; y < height; ++y) {
    for (int channel = 1; channel < 4; ++channel) {
      store(top + y * stride + (channel - 1) * plane, load(nodes + (y * 4 + channel) * kLanes));
    }
  }
}

#endif
