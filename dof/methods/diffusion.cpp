#include "dof/methods/diffusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/threads/scratch_shelf.h"

#define SOFTFOCUS_KERNELS "dof/methods/diffusion_kernels.inl"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kMostLanes = 16;

int lanes_of(Isa isa) { return isa == Isa::avx512 ? 16 : isa == Isa::avx2 ? 8 : 4; }

float heat_flow(float radius_px) {
  return std::fabs(radius_px) > 0.5f ? radius_px * radius_px * 0.125f : 0.0f;
}

// One line of `count` pixels, `step` apart, from the first in the red plane.
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

void store_planes(const DofInput& input, const ImageView& result, const Planes& planes,
                  ThreadPool& pool) {
  pool.for_each(planes.height, [&](int y) {
    store_row(input, result, y, plane_row(planes, 0, y), plane_row(planes, 1, y),
              plane_row(planes, 2, y), pool.isa());
  });
}

}  // namespace

void diffusion_plain(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  Planes planes = split_picture(input, pool);
  pool.for_each(planes.height, [&](int y) {
    diffuse_line(plane_row(planes, 0, y), 1, planes.plane, planes.width);
  });
  pool.for_each(planes.width, [&](int x) {
    diffuse_line(plane_row(planes, 0, 0) + x, planes.stride, planes.plane, planes.height);
  });
  store_planes(input, result, planes, pool);
}

void diffusion(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) return diffusion_plain(input, result, pool);
  Planes planes = split_picture(input, pool);
  const int lanes = lanes_of(pool.isa());
  const int padded = (planes.width + lanes - 1) / lanes * lanes;
  const auto scratch = static_cast<std::size_t>(std::max(padded, planes.height) * 4 * lanes);
  ScratchShelf<std::vector<float>> shelf;
  pool.for_each((planes.height + lanes - 1) / lanes, [&](int block) {
    std::vector<float> nodes = shelf.take();
    nodes.resize(scratch);
    std::array<float*, kMostLanes> rows;
    for (int i = 0; i < kMostLanes; ++i) {
      const int y = std::min(block * lanes + i, planes.height - 1);
      rows[static_cast<std::size_t>(i)] = plane_row(planes, 0, y);
    }
    SOFTFOCUS_KERNEL(pool.isa(), diffuse_rows)
    (rows.data(), std::min(lanes, planes.height - block * lanes), planes.plane, planes.width,
     padded, nodes.data());
    shelf.put_back(std::move(nodes));
  });
  pool.for_each(padded / lanes, [&](int block) {
    std::vector<float> nodes = shelf.take();
    nodes.resize(scratch);
    SOFTFOCUS_KERNEL(pool.isa(), diffuse_columns)
    (plane_row(planes, 0, 0) + block * lanes, planes.stride, planes.plane, planes.height,
     nodes.data());
    shelf.put_back(std::move(nodes));
  });
  store_planes(input, result, planes, pool);
}

}  // namespace softfocus
