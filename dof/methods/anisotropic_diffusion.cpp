#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/methods/anisotropic_diffusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/threads/loops.h"

namespace softfocus {

// A tile, the pixels around it that its stages need, and whole vectors at either end of a row.
constexpr int kDiffusionStages = 12;
constexpr int kDiffusionTileWidth = 160, kDiffusionTileHeight = 64;
constexpr int kDiffusionMargin = 16;
constexpr int kDiffusionRow = kDiffusionTileWidth + 2 * kDiffusionMargin;
constexpr int kDiffusionRows = kDiffusionTileHeight + 2 * kDiffusionStages;
static_assert(kDiffusionStages <= kDiffusionMargin && kDiffusionMargin >= kMostLanes);

using DiffusionPlane = float[kDiffusionRows][kDiffusionRow];
struct DiffusionTile {
  DiffusionPlane across;        // what flows from a pixel to the next, per difference
  DiffusionPlane down;          // to the one below
  DiffusionPlane states[2][3];  // the last two stages, by turns
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/methods/anisotropic_diffusion.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// w of a super step, times the factor of r^2.
float stage_factor(int stages) {
  return static_cast<float>(0.125 * 4.0 / (stages * (stages + 2.0) - 1.0));
}

float momentum(int stage) { return static_cast<float>((stage - 1.0) / (stage + 2.0)); }

float heat_flow_scaled(float radius_px, float factor) {
  return std::fabs(radius_px) > 0.5f ? radius_px * radius_px * factor : 0.0f;
}

float largest_radius(const Planes& scene, ThreadPool& pool) {
  const std::vector<float> of_rows = largest_of_rows(scene, 3, pool);
  return *std::max_element(of_rows.begin(), of_rows.end());
}

// Stores the mean of the last two stages. Blurred light is never negative, but sums of rounded
// flows may be.
void store_mean(const DofInput& input, const ImageView& result, const Planes& before,
                const Planes& last, const Planes& scene, ThreadPool& pool) {
  pool.for_each(result.height, [&](int y) {
    std::vector<float> rows(static_cast<std::size_t>(3 * last.stride));
    const float* radius = plane_row(scene, 3, y);
    for (int c = 0; c < 3; ++c) {
      const float* from[2] = {plane_row(before, c, y), plane_row(last, c, y)};
      float* to = rows.data() + c * last.stride;
      for (int x = 0; x < result.width; ++x) {
        const float mean = 0.5f * (from[0][x] + from[1][x]);
        to[x] = std::fabs(radius[x]) > 0.5f && mean < 0.0f ? 0.0f : mean;
      }
    }
    store_row(input, result, y, rows.data(), rows.data() + last.stride,
              rows.data() + 2 * last.stride, pool.isa());
  });
}

struct Sweep {
  const Planes& scene;
  const Planes* from[2];  // the stages before: the last but one, the last
  Planes* to[2];
  int first_stage, stages;
  float factor;
  Isa isa;
};

struct TilePlace {
  int x, y, width, height;
};
TilePlace place_of(const Planes& scene, int task) {
  const int columns = (scene.width + kDiffusionTileWidth - 1) / kDiffusionTileWidth;
  const int x = task % columns * kDiffusionTileWidth, y = task / columns * kDiffusionTileHeight;
  return {x, y, std::min(kDiffusionTileWidth, scene.width - x),
          std::min(kDiffusionTileHeight, scene.height - y)};
}

bool any_blurred(const Planes& scene, const TilePlace& at) {
  for (int y = at.y; y < at.y + at.height; ++y) {
    const float* radius = plane_row(scene, 3, y);
    float most = 0.0f;
    for (int x = at.x; x < at.x + at.width; ++x) most = std::max(most, std::fabs(radius[x]));
    if (most > 0.5f) return true;
  }
  return false;
}

// A row of a plane with its margins; outside the picture 0.
void copy_row(const Planes& planes, int plane, int x, int y, float* to) {
  const int left = std::clamp(-x, 0, kDiffusionRow);
  const int end = std::clamp(planes.width - x, left, kDiffusionRow);
  std::fill_n(to, left, 0.0f);
  if (y < 0 || y >= planes.height) {
    std::fill_n(to, kDiffusionRow, 0.0f);
    return;
  }
  std::copy(plane_row(planes, plane, y) + x + left, plane_row(planes, plane, y) + x + end,
            to + left);
  std::fill(to + end, to + kDiffusionRow, 0.0f);
}

void sweep_tile(const Sweep& sweep, const TilePlace& at, DiffusionTile& tile) {
  const int rows = at.height + 2 * kDiffusionStages;
  const int left = at.x - kDiffusionMargin, top = at.y - kDiffusionStages;
  float radius[2][kDiffusionRow + kMostLanes];
  copy_row(sweep.scene, 3, left, top, radius[0]);
  for (int y = 0; y < rows; ++y) {
    copy_row(sweep.scene, 3, left, top + y + 1, radius[(y + 1) % 2]);
    for (float(&row)[kDiffusionRow + kMostLanes] : radius) row[kDiffusionRow] = 0.0f;
    SOFTFOCUS_KERNEL(sweep.isa, make_flows)
    (radius[y % 2], radius[(y + 1) % 2], sweep.factor, tile.across[y], tile.down[y]);
    for (int i = 0; i < 2; ++i) {
      for (int c = 0; c < 3; ++c) {
        copy_row(*sweep.from[i], c, left, top + y, tile.states[i][c][y]);
      }
    }
  }
  for (int i = 0; i < sweep.stages; ++i) {
    // Rows within i + 1 of the copy's ends lack a neighbour of this stage.
    SOFTFOCUS_KERNEL(sweep.isa, diffuse_stage)
    (tile, i % 2, i + 1, rows - i - 1, momentum(sweep.first_stage + i));
  }
  for (int i = 0; i < 2; ++i) {
    const int state = (sweep.stages + i) % 2;
    for (int c = 0; c < 3; ++c) {
      for (int y = 0; y < at.height; ++y) {
        std::copy_n(tile.states[state][c][y + kDiffusionStages] + kDiffusionMargin, at.width,
                    plane_row(*sweep.to[i], c, at.y + y) + at.x);
      }
    }
  }
}

// A tile without blur, once for good.
void keep_tile(const Sweep& sweep, const TilePlace& at) {
  for (Planes* to : sweep.to) {
    for (int c = 0; c < 3; ++c) {
      for (int y = at.y; y < at.y + at.height; ++y) {
        std::copy_n(plane_row(sweep.scene, c, y) + at.x, at.width, plane_row(*to, c, y) + at.x);
      }
    }
  }
}

}  // namespace

int diffusion_stages(float largest_px) {
  if (!(largest_px > 0.5f)) return 0;
  const double square = static_cast<double>(largest_px) * static_cast<double>(largest_px);
  int stages = 1;
  while (stages * (stages + 2.0) - 1.0 < 2.0 * square) ++stages;
  return stages;
}

void anisotropic_diffusion_oracle(const DofInput& input, const ImageView& result,
                                  ThreadPool& pool) {
  const Planes scene = split_picture(input, pool);
  const int stages = diffusion_stages(largest_radius(scene, pool));
  const float factor = stages > 0 ? stage_factor(stages) : 0.0f;
  Planes states[2] = {split_picture(input, pool), split_picture(input, pool)};
  const auto flow = [&](int x, int y, int dx, int dy, int c, const Planes& from) {
    const int to_x = x + dx, to_y = y + dy;
    if (to_x < 0 || to_x >= scene.width || to_y < 0 || to_y >= scene.height) return 0.0f;
    const float per_difference =
        std::min(heat_flow_scaled(plane_row(scene, 3, y)[x], factor),
                 heat_flow_scaled(plane_row(scene, 3, to_y)[to_x], factor));
    return per_difference * (plane_row(from, c, to_y)[to_x] - plane_row(from, c, y)[x]);
  };
  for (int stage = 1; stage <= stages; ++stage) {
    const Planes& last = states[stage % 2];
    Planes& to = states[(stage + 1) % 2];
    const float m = momentum(stage);
    pool.for_each(scene.height, [&](int y) {
      for (int c = 0; c < 3; ++c) {
        for (int x = 0; x < scene.width; ++x) {
          const float own = plane_row(last, c, y)[x];
          const float flows = (flow(x, y, -1, 0, c, last) + flow(x, y, 1, 0, c, last)) +
                              (flow(x, y, 0, -1, c, last) + flow(x, y, 0, 1, c, last));
          float& value = plane_row(to, c, y)[x];
          value = own + (m * (own - value) + (1.0f + m) * flows);
        }
      }
    });
  }
  store_mean(input, result, states[0], states[1], scene, pool);
}

void anisotropic_diffusion(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) return anisotropic_diffusion_oracle(input, result, pool);
  const Planes scene = split_picture(input, pool);
  const int stages = diffusion_stages(largest_radius(scene, pool));
  if (stages == 0) return store_mean(input, result, scene, scene, scene, pool);
  Planes states[2][2];
  for (auto& pair : states) {
    for (Planes& state : pair) state = make_planes(3, scene.width, scene.height, pool);
  }
  const int tasks = ((scene.width + kDiffusionTileWidth - 1) / kDiffusionTileWidth) *
                    ((scene.height + kDiffusionTileHeight - 1) / kDiffusionTileHeight);
  std::vector<char> blurred(static_cast<std::size_t>(tasks));
  ScratchShelf<DiffusionTile> shelf;
  int sweeps = 0;
  for (int first = 1; first <= stages; first += kDiffusionStages, ++sweeps) {
    auto& to = states[sweeps % 2];
    auto& from = states[(sweeps + 1) % 2];
    const Sweep sweep{scene,
                      {sweeps == 0 ? &scene : &from[0], sweeps == 0 ? &scene : &from[1]},
                      {&to[0], &to[1]},
                      first,
                      std::min(kDiffusionStages, stages - first + 1),
                      stage_factor(stages),
                      pool.isa()};
    pool.for_each(tasks, [&](int task) {
      const TilePlace at = place_of(scene, task);
      char& any = blurred[static_cast<std::size_t>(task)];
      if (sweeps == 0) any = any_blurred(scene, at) ? 1 : 0;
      if (any == 0) {
        if (sweeps < 2) keep_tile(sweep, at);
        return;
      }
      std::unique_ptr<DiffusionTile> tile = shelf.take();
      sweep_tile(sweep, at, *tile);
      shelf.put_back(std::move(tile));
    });
  }
  const auto& made = states[(sweeps + 1) % 2];
  store_mean(input, result, made[0], made[1], scene, pool);
}

}  // namespace softfocus

#else  // kernels

namespace {

SOFTFOCUS_INLINE Floats heat_flow_scaled(Floats radius_px, float factor) {
  return select(absolute(radius_px) > 0.5f, radius_px * radius_px * factor, splat(0.0f));
}

}  // namespace

/// Flows from each pixel of a row to the next, and to the row below.
void make_flows(const float* radius, const float* below, float factor, float* across, float* down) {
  for (int x = 0; x < kDiffusionRow; x += kLanes) {
    const Floats own = heat_flow_scaled(load(radius + x), factor);
    store(across + x, smaller(own, heat_flow_scaled(load(radius + x + 1), factor)));
    store(down + x, smaller(own, heat_flow_scaled(load(below + x), factor)));
  }
}

/// A stage of rows `begin` to `end`: over state `to`, the last but one, from the other, the last.
void diffuse_stage(DiffusionTile& tile, int to, int begin, int end, float momentum) {
  const float flow_factor = 1.0f + momentum;
  for (int y = begin; y < end; ++y) {
    // The first and the last pixels lack a neighbour; they are margin.
    for (int x = 0; x < kDiffusionRow; x += kLanes) {
      const Floats right = load(tile.across[y] + x), left = load(tile.across[y] + x - 1);
      const Floats lower = load(tile.down[y] + x), upper = load(tile.down[y - 1] + x);
      for (int c = 0; c < 3; ++c) {
        const float* at = tile.states[1 - to][c][y] + x;
        float* value = tile.states[to][c][y] + x;
        const Floats own = load(at);
        const Floats sideways = left * (load(at - 1) - own) + right * (load(at + 1) - own);
        const Floats flows = sideways + (upper * (load(at - kDiffusionRow) - own) +
                                         lower * (load(at + kDiffusionRow) - own));
        store(value, own + (momentum * (own - load(value)) + flow_factor * flows));
      }
    }
  }
}

#endif
