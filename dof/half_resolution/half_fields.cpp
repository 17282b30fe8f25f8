#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).
// Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/half_resolution/half_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "dof/half_resolution/fill_holes.h"
#include "dof/half_resolution/polygon_spans.h"
#include "raster/threads/loops.h"

namespace softfocus {

// Two rows of pixels, planes of red, green, blue and radius, and the planes of the cells' row
// that they make. `light` gets the cell's largest L.
struct HalfRow {
  const float* rows[2];
  std::ptrdiff_t row_plane;
  int count;  // of cells
  float* cells;
  std::ptrdiff_t cell_plane;
  float* light;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/half_resolution/half_fields.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kHalfTaskRows = 8;

int in_range(int value, int count) { return std::clamp(value, 0, count - 1); }

// L in each cell.
Planes split_cells(const DofInput& input, Planes& cells, ThreadPool& pool) {
  const int width = input.scene.width, height = input.scene.height;
  Planes light = make_planes(1, cells.width, cells.height, pool);
  const std::ptrdiff_t padded = plane_stride(width) + 2 * kMostLanes;
  for_each_row_with<std::vector<float>>(
      pool, cells.height, kHalfTaskRows, [&](int y, auto& scratch) {
        scratch.resize(static_cast<std::size_t>(8 * padded));
        HalfRow row{
            {}, padded, cells.width, plane_row(cells, 0, y), cells.plane, plane_row(light, 0, y)};
        for (int i = 0; i < 2; ++i) {
          float* to = scratch.data() + i * 4 * padded;
          split_picture_row(input, std::min(2 * y + i, height - 1), to, padded,
                            static_cast<int>(padded), pool.isa());
          row.rows[i] = to;
        }
        SOFTFOCUS_KERNEL(pool.isa(), halve_row)(row);
      });
  return light;
}

// Takes a cell's highlights out of it and into the lists of its rows.
void take_out(const DofInput& input, int x, int y, float surroundings, Planes& cells,
              Highlights& highlights) {
  const int width = input.scene.width, height = input.scene.height;
  std::array<SplitTexel, 4> four;
  bool any = false;
  for (int i = 0; i < 4; ++i) {
    const int px = 2 * x + i % 2, py = 2 * y + i / 2;
    SplitTexel& texel = four[static_cast<std::size_t>(i)];
    texel = split_texel(input, std::min(px, width - 1), std::min(py, height - 1));
    Highlight light{px, highlight_layer(texel.radius_px), disc_of(texel.radius_px), {}};
    highlight_excess(texel, surroundings, light.excess);
    if (light.excess[0] == 0.0f && light.excess[1] == 0.0f && light.excess[2] == 0.0f) continue;
    any = true;
    texel.r -= light.excess[0];
    texel.g -= light.excess[1];
    texel.b -= light.excess[2];
    if (px < width && py < height) highlights.rows[static_cast<std::size_t>(py)].push_back(light);
  }
  if (!any) return;
  std::array<float, kHalfPlanes> cell{};
  half_cell(four.data(), cell.data());
  for (int c = 0; c < kHalfPlanes; ++c) {
    plane_row(cells, c, y)[x] = cell[static_cast<std::size_t>(c)];
  }
}

Highlights take_highlights(const DofInput& input, const Planes& light, Planes& cells, int corners,
                           ThreadPool& pool) {
  Highlights highlights;
  highlights.rows.resize(static_cast<std::size_t>(input.scene.height));
  for_each_row_with<std::vector<float>>(
      pool, cells.height, kHalfTaskRows, [&](int y, auto& scratch) {
        const std::ptrdiff_t room = light.stride + 3 * kMostLanes;
        scratch.resize(static_cast<std::size_t>(3 * room));
        float* sums = scratch.data() + 2 * room;
        const float* rows[5];
        for (int i = 0; i < 5; ++i)
          rows[i] = plane_row(light, 0, in_range(y + kHighlightReach / 2 * (i - 2), light.height));
        SOFTFOCUS_KERNEL(pool.isa(), surroundings_row)
        (rows, cells.width, scratch.data() + kMostLanes, scratch.data() + room + kMostLanes, sums);
        for (int x = 0; x < cells.width; ++x) {
          if (rows[2][x] > kHighlightContrast * sums[x]) {
            take_out(input, x, y, sums[x], cells, highlights);
          }
        }
      });
  std::vector<std::uint8_t> used;
  for (const std::vector<Highlight>& row : highlights.rows) {
    for (const Highlight& one : row) {
      const auto disc = static_cast<std::size_t>(one.disc);
      if (disc >= used.size()) used.resize(disc + 1);
      used[disc] = 1;
    }
  }
  if (!used.empty()) {
    const float largest_px = 0.25f * static_cast<float>(used.size() - 1);
    if (corners > 0) {
      PolygonSpans spans = make_polygon_spans(corners, largest_px, used);
      highlights.discs = std::move(spans.above);
      highlights.below = std::move(spans.below);
    } else {
      highlights.discs = make_discs(largest_px, used);
    }
    highlights.reach = highlights.discs.reach;
  }
  return highlights;
}

bool any_above_zero(const Planes& planes, int plane, ThreadPool& pool) {
  const std::vector<float> most = [&] {
    std::vector<float> of_rows(static_cast<std::size_t>(planes.height));
    pool.for_each(planes.height, [&](int y) {
      const float* row = plane_row(planes, plane, y);
      of_rows[static_cast<std::size_t>(y)] = *std::max_element(row, row + planes.width);
    });
    return of_rows;
  }();
  return *std::max_element(most.begin(), most.end()) > 0.0f;
}

void fill(Planes& cells, ThreadPool& pool) {
  const int far[] = {kFarColour, kFarColour + 1, kFarColour + 2, kFarSize, kFarWeight};
  fill_holes(cells, far, kFarSeen, pool);
  const int near[] = {kNearSize};
  fill_holes(cells, near, kNearOpacity, pool);
}

}  // namespace

void half_cell(const SplitTexel* four, float* to) {
  HalfRow row{};
  float rows[2][4][2 * kMostLanes], cells[kHalfPlanes][kMostLanes], light[kMostLanes];
  for (int i = 0; i < 2 * kMostLanes; ++i) {
    for (int y = 0; y < 2; ++y) {
      const SplitTexel& texel = four[2 * y + i % 2];
      rows[y][0][i] = texel.r;
      rows[y][1][i] = texel.g;
      rows[y][2][i] = texel.b;
      rows[y][3][i] = texel.radius_px;
    }
  }
  row = {{&rows[0][0][0], &rows[1][0][0]}, 2 * kMostLanes, 1, &cells[0][0], kMostLanes, light};
  SOFTFOCUS_KERNEL(Isa::scalar, halve_row)(row);
  for (int c = 0; c < kHalfPlanes; ++c) to[c] = cells[c][0];
}

HalfFields make_half_fields(const DofInput& input, ThreadPool& pool, int corners) {
  HalfFields fields{
      make_planes(kHalfPlanes, (input.scene.width + 1) / 2, (input.scene.height + 1) / 2, pool),
      false,
      {}};
  const Planes light = split_cells(input, fields.cells, pool);
  fields.highlights = take_highlights(input, light, fields.cells, corners, pool);
  fields.near_field = any_above_zero(fields.cells, kNearOpacity, pool);
  if (fields.near_field) fill(fields.cells, pool);
  return fields;
}

HalfTiles make_half_tiles(const HalfFields& fields, float stretch, bool gathers, ThreadPool& pool) {
  const Planes& cells = fields.cells;
  HalfTiles tiles{(cells.width + kHalfTile - 1) / kHalfTile,
                  (cells.height + kHalfTile - 1) / kHalfTile,
                  {},
                  {},
                  {}};
  const std::size_t count = tiles.at(0, tiles.rows);
  std::vector<float> far(count, kLeastHalfSize), near(count, 0.0f), own_near(count, 0.0f),
      least(count, 1e9f);
  pool.for_each(tiles.rows, [&](int row) {
    const int end = std::min((row + 1) * kHalfTile, cells.height);
    for (int y = row * kHalfTile; y < end; ++y) {
      const float* far_size = plane_row(cells, kFarSize, y);
      const float* near_size = plane_row(cells, kNearSize, y);
      const float* opacity = plane_row(cells, kNearOpacity, y);
      for (int x = 0; x < cells.width; ++x) {
        const std::size_t tile = tiles.at(x / kHalfTile, row);
        far[tile] = std::max(far[tile], far_size[x]);
        least[tile] = std::min(least[tile], far_size[x]);
        if (gathers && fields.near_field) own_near[tile] = std::max(own_near[tile], near_size[x]);
        if (opacity[x] > 0.0f) near[tile] = std::max(near[tile], near_size[x]);
      }
    }
  });
  const float farthest = std::max(*std::max_element(far.begin(), far.end()),
                                  *std::max_element(near.begin(), near.end()));
  const int steps = static_cast<int>(farthest * stretch) / kHalfTile + 1;
  tiles.far_reach.assign(count, kLeastHalfSize);
  tiles.near_reach.assign(count, 0.0f);
  tiles.far_least.assign(count, 1e9f);
  pool.for_each(tiles.rows, [&](int row) {
    for (int column = 0; column < tiles.columns; ++column) {
      const std::size_t own = tiles.at(column, row);
      for (int y = std::max(row - steps, 0); y <= std::min(row + steps, tiles.rows - 1); ++y) {
        for (int x = std::max(column - steps, 0); x <= std::min(column + steps, tiles.columns - 1);
             ++x) {
          const int apart = std::max(std::abs(x - column), std::abs(y - row));
          const auto gap = static_cast<float>((apart - 1) * kHalfTile);
          const std::size_t other = tiles.at(x, y);
          if (far[other] * stretch + 0.5f >= gap) {
            tiles.far_reach[own] = std::max(tiles.far_reach[own], far[other]);
            tiles.far_least[own] = std::min(tiles.far_least[own], least[other]);
          }
          const float size = std::max(near[other], own_near[own]);
          if (near[other] > 0.0f && size * stretch + 0.5f >= gap) {
            tiles.near_reach[own] = std::max(tiles.near_reach[own], near[other]);
          }
        }
      }
    }
  });
  return tiles;
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

SOFTFOCUS_INLINE Floats half_size(Floats radius_px) {
  return larger(square_root(larger(radius_px * radius_px - 4.0f, splat(0.0f))) * 0.5f,
                splat(kLeastHalfSize));
}

// Pairs first, so that a mirrored picture has the same sums.
SOFTFOCUS_INLINE Floats sum_of_four(const Floats* v) { return (v[0] + v[1]) + (v[2] + v[3]); }

SOFTFOCUS_INLINE Floats weighted_sum(const Floats* weights, const Floats* v) {
  const Floats products[] = {weights[0] * v[0], weights[1] * v[1], weights[2] * v[2],
                             weights[3] * v[3]};
  return sum_of_four(products);
}

}  // namespace

void halve_row(const HalfRow& row) {
  for (int x = 0; x < row.count; x += kLanes) {
    Floats v[4][4];  // channel, pixel
    for (int c = 0; c < 4; ++c) {
      for (int i = 0; i < 2; ++i) {
        const TwoVectors pixels = load_pairs(row.rows[i] + c * row.row_plane + 2 * x);
        v[c][2 * i] = pixels.first;
        v[c][2 * i + 1] = pixels.second;
      }
    }
    Floats near[4], behind[4], left[4], weight[4], depth[4], before[4], brightest = splat(0.0f);
    for (int i = 0; i < 4; ++i) {
      const Floats radius = v[3][i];
      const Floats share = saturate((radius * radius - 2.25f) * (1.0f / 1.75f));
      const Mask nearer = radius < 0.0f;
      near[i] = select(nearer, share, splat(0.0f));
      behind[i] = select(nearer, splat(0.0f), share);
      left[i] = 1.0f - near[i];
      weight[i] = left[i] * larger(behind[i], splat(kSharpWeight));
      depth[i] = larger(radius, splat(0.0f));
      before[i] = larger(-radius, splat(0.0f));
      brightest = larger(brightest, larger(v[0][i], larger(v[1][i], v[2][i])));
    }
    float* to = row.cells + x;
    const Floats weights = sum_of_four(weight), seen = sum_of_four(left), nears = sum_of_four(near);
    const Mask hidden = weights <= 0.0f, none = nears <= 0.0f;
    const Floats per_weight = 1.0f / select(hidden, splat(1.0f), weights);
    for (int c = 0; c < 3; ++c) {
      const Floats mean = weighted_sum(weight, v[c]) * per_weight;
      store(to + (kFarColour + c) * row.cell_plane,
            select(hidden, sum_of_four(v[c]) * 0.25f, mean));
      store(to + (kNearColour + c) * row.cell_plane, weighted_sum(near, v[c]) * 0.25f);
    }
    store(to + kFarSize * row.cell_plane, half_size(weighted_sum(weight, depth) * per_weight));
    store(to + kFarWeight * row.cell_plane,
          larger(weights / select(hidden, splat(1.0f), seen), splat(kSharpWeight)));
    store(to + kFarSeen * row.cell_plane, seen * 0.25f);
    store(to + kNearOpacity * row.cell_plane, nears * 0.25f);
    store(to + kNearSize * row.cell_plane,
          half_size(weighted_sum(near, before) / select(none, splat(1.0f), nears)));
    store(row.light + x, brightest);
  }
}

// The mean of 16 cells on a square of 2 kHighlightReach. `rows` are its five rows; the ends
// repeat. `columns` and `ends` have room for kHighlightReach before them, and for that and a
// vector after.
void surroundings_row(const float* const* rows, int count, float* columns, float* ends, float* to) {
  // Sums of a column's five cells, and of its outer two.
  for (int x = 0; x < count; x += kLanes) {
    const Floats outer = load(rows[0] + x) + load(rows[4] + x);
    store(columns + x, (outer + (load(rows[1] + x) + load(rows[3] + x))) + load(rows[2] + x));
    store(ends + x, outer);
  }
  for (int i = 1; i <= kHighlightReach; ++i) {
    columns[-i] = columns[0];
    ends[-i] = ends[0];
    columns[count - 1 + i] = columns[count - 1];
    ends[count - 1 + i] = ends[count - 1];
  }
  for (int x = 0; x < count; x += kLanes) {
    const Floats sides = load(columns + x - kHighlightReach) + load(columns + x + kHighlightReach);
    const Floats above =
        (load(ends + x - kHighlightReach / 2) + load(ends + x + kHighlightReach / 2)) +
        load(ends + x);
    store(to + x, (sides + above) * (1.0f / 16.0f));
  }
}

#endif
