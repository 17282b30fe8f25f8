#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).
// There is no scalar form: Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/ring_bucket/ring_bucket.h"

#include <algorithm>
#include <vector>

#include "dof/half_resolution/half_fields.h"
#include "dof/half_resolution/merge_fields.h"
#include "dof/ring_bucket/ring_taps.h"

namespace softfocus {

// A far cell of less weight shows only what is sharp: it stays as it is.
inline constexpr float kLeastBlurredWeight = 0x1p-10f;

// Planes that taps read: colour times share, share (weight, or opacity), size, light 1 / A(size),
// and for the near field what counts at all.
inline constexpr int kTapShare = 3, kTapSize = 4, kTapLight = 5, kTapAll = 6;
inline constexpr int kFarTaps = 6, kNearTaps = 7;

struct CellRow {
  const float* cells;
  std::ptrdiff_t plane;
  int count;
  const float* light;
  float* to;
  std::ptrdiff_t to_plane;
};

// A row of a level from the level before.
struct LevelledRow {
  const float* above;
  const float* here;
  const float* below;
  std::ptrdiff_t plane;
  int offset;  // of the left and right samples
  bool centre;
  float least_size;  // cells up to it do not reach the level's taps
  int count;
  const float* light;
  float* to;
  std::ptrdiff_t to_plane;
};

// A row of a tile.
struct BucketRow {
  // rows[level][dy] points at the row's first cell, dy rows away.
  const float* const* const* rows;
  std::ptrdiff_t plane;
  int x, count;

  const BucketTap* taps;
  const BucketRing* rings;
  int ring_count;
  float least, most;  // of the sizes that reach the tile

  float* cells;  // the tile's row in HalfFields, blurred in place
  std::ptrdiff_t cell_plane;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/ring_bucket/ring_bucket.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// Levels of one field. The ends of rows repeat for `margin` cells and a tile. All are one piece
// of memory, which the allocator keeps from frame to frame.
struct TapLevels {
  int margin;
  int planes_of_one;
  Planes planes;
  std::vector<std::vector<const float*>> rows;  // of a level: `margin` rows above the first on
};

TapLevels levels_for(const Planes& cells, int reach, int levels, bool near_field,
                     ThreadPool& pool) {
  const int margin = reach + kMostLanes, planes = near_field ? kNearTaps : kFarTaps;
  return {
      margin,
      planes,
      make_planes(planes * levels, cells.width + 2 * margin + 2 * kHalfTile, cells.height, pool),
      {}};
}

void repeat_ends(float* row, int margin, int width, std::ptrdiff_t stride) {
  std::fill_n(row, margin, row[margin]);
  std::fill(row + margin + width, row + stride, row[margin + width - 1]);
}

// Fills the levels from one field.
void make_levels(const Planes& cells, bool near, const RingTaps& taps, TapLevels& all,
                 ThreadPool& pool) {
  const int count = near ? kNearTaps : kFarTaps, margin = all.margin;
  Planes& planes = all.planes;
  all.rows.clear();
  for (int level = 0; level < taps.levels; ++level) {
    const int first = level * all.planes_of_one;
    pool.for_each(cells.height, [&](int y) {
      float* to = plane_row(planes, first, y) + margin;
      if (level == 0) {
        const CellRow row{plane_row(cells, 0, y), cells.plane, cells.width,
                          taps.light.data(),      to,          planes.plane};
        SOFTFOCUS_KERNEL(pool.isa(), light_row)(row, near);
      } else {
        const int offset = level == 1 ? 1 : 1 << (level - 2);
        const auto at = [&](int row) {
          return plane_row(planes, first - all.planes_of_one,
                           std::clamp(row, 0, cells.height - 1)) +
                 margin;
        };
        const LevelledRow row{at(y - offset),
                              at(y),
                              at(y + offset),
                              planes.plane,
                              offset,
                              level == 1,
                              taps.least_size[static_cast<std::size_t>(level)],
                              cells.width,
                              taps.light.data(),
                              to,
                              planes.plane};
        SOFTFOCUS_KERNEL(pool.isa(), level_row)(row, near);
      }
      for (int c = 0; c < count; ++c) {
        repeat_ends(plane_row(planes, first + c, y), margin, cells.width, planes.stride);
      }
    });
    std::vector<const float*> rows;
    for (int y = -margin; y < cells.height + margin; ++y) {
      rows.push_back(plane_row(planes, first, std::clamp(y, 0, cells.height - 1)) + margin);
    }
    all.rows.push_back(std::move(rows));
  }
}

// The rows of every level at row y of the cells.
std::vector<const float* const*> rows_at(const TapLevels& levels, int y) {
  std::vector<const float* const*> rows;
  for (const std::vector<const float*>& of_level : levels.rows) {
    rows.push_back(of_level.data() + levels.margin + y);
  }
  return rows;
}

// Blurs a row of tiles in one field, in place: taps read the levels.
void gather_tiles(Planes& cells, const HalfTiles& tiles, const TapLevels& levels,
                  const RingTaps& taps, bool near, int tile_row, Isa isa) {
  const int end = std::min((tile_row + 1) * kHalfTile, cells.height);
  for (int y = tile_row * kHalfTile; y < end; ++y) {
    const std::vector<const float* const*> rows = rows_at(levels, y);
    for (int column = 0; column < tiles.columns; ++column) {
      const std::size_t tile = tiles.at(column, tile_row);
      const float reach = near ? tiles.near_reach[tile] : tiles.far_reach[tile];
      const int x = column * kHalfTile;
      if (reach <= 0.0f) continue;  // nothing near is in it
      const int outside = rings_outside(taps, reach);
      const BucketRow row{rows.data(),
                          levels.planes.plane,
                          x,
                          kHalfTile,
                          taps.taps.data(),
                          taps.rings.data() + outside,
                          static_cast<int>(taps.rings.size()) - outside,
                          tiles.far_least[tile],
                          reach,
                          plane_row(cells, 0, y) + x,
                          cells.plane};
      SOFTFOCUS_KERNEL(isa, gather_rings)(row, near);
    }
  }
}

}  // namespace

void ring_bucket(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  HalfFields fields = make_half_fields(input, pool);
  const HalfTiles tiles = make_half_tiles(fields, 1.0f, false, pool);
  Planes& cells = fields.cells;
  const auto taps_of = [](const std::vector<float>& reach) {
    return make_ring_taps(*std::max_element(reach.begin(), reach.end()));
  };
  const RingTaps far = taps_of(tiles.far_reach);
  const RingTaps near = fields.near_field ? taps_of(tiles.near_reach) : RingTaps{};
  TapLevels levels = levels_for(cells, std::max(far.reach, near.reach),
                                std::max(far.levels, near.levels), fields.near_field, pool);
  for (const bool in_near : {false, true}) {
    if (in_near && !fields.near_field) continue;
    const RingTaps& taps = in_near ? near : far;
    make_levels(cells, in_near, taps, levels, pool);
    pool.for_each(tiles.rows, [&](int row) {
      gather_tiles(cells, tiles, levels, taps, in_near, row, pool.isa());
    });
  }
  merge_fields(input, fields, result, pool);
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

// The table's entry, between two linear.
SOFTFOCUS_INLINE Floats light_of(const float* table, Floats size) {
  const Floats place = size * 16.0f;
  const Ints entry = truncate(place);
  const Floats lower = gather(table, entry, entry >= 0);
  return mix(lower, gather(table, entry + 1, entry >= 0), place - to_floats(entry));
}

template <bool near>
SOFTFOCUS_INLINE void light_cells(const CellRow& row) {
  for (int x = 0; x < row.count; x += kLanes) {
    const float* cell = row.cells + x;
    const Floats size = load(cell + (near ? kNearSize : kFarSize) * row.plane);
    const Floats share = load(cell + (near ? kNearOpacity : kFarWeight) * row.plane);
    for (int c = 0; c < 3; ++c) {
      const Floats colour = load(cell + ((near ? kNearColour : kFarColour) + c) * row.plane);
      store(row.to + c * row.to_plane + x, near ? colour : share * colour);
    }
    store(row.to + kTapShare * row.to_plane + x, share);
    store(row.to + kTapSize * row.to_plane + x, size);
    store(row.to + kTapLight * row.to_plane + x, light_of(row.light, size));
    if (near) store(row.to + kTapAll * row.to_plane + x, splat(1.0f));
  }
}

// The sum of four corners, and with the centre all of (1 2 1) x (1 2 1).
SOFTFOCUS_INLINE Floats tent(const Floats* v, bool centre) {
  const Floats corners = (v[0] + v[2]) + (v[6] + v[8]);
  if (!centre) return corners;
  const Floats sides = (v[1] + v[7]) + (v[3] + v[5]);
  return (corners + (sides + sides)) + v[4] * 4.0f;
}

template <bool near>
SOFTFOCUS_INLINE void level_cells(const LevelledRow& row) {
  const float scale = row.centre ? 1.0f / 16.0f : 0.25f;
  for (int x = 0; x < row.count; x += kLanes) {
    const float* at[] = {row.above + x, row.here + x, row.below + x};
    const float* from[9];
    Floats counts[9], values[9], sizes[9], weights[9];
    for (int i = 0; i < 9; ++i) {
      if (!row.centre && (i % 2 == 1 || i == 4)) continue;
      from[i] = at[i / 3] + (i % 3 - 1) * row.offset;
      const Floats size = load(from[i] + kTapSize * row.plane);
      counts[i] = saturate(size - row.least_size);
      Floats share = load(from[i] + kTapShare * row.plane);
      if (near) share = share + load(from[i] + kTapAll * row.plane) * kSharpWeight;
      weights[i] = counts[i] * share;
      sizes[i] = weights[i] * size;
    }
    for (int c = 0; c < (near ? kNearTaps : kFarTaps); ++c) {
      if (c == kTapSize || c == kTapLight) continue;
      for (int i = 0; i < 9; ++i) {
        if (!row.centre && (i % 2 == 1 || i == 4)) continue;
        values[i] = counts[i] * load(from[i] + c * row.plane);
      }
      store(row.to + c * row.to_plane + x, tent(values, row.centre) * scale);
    }
    const Floats weight = tent(weights, row.centre);
    const Floats size = tent(sizes, row.centre) / select(weight > 0.0f, weight, splat(1.0f));
    store(row.to + kTapSize * row.to_plane + x, size);
    store(row.to + kTapLight * row.to_plane + x, light_of(row.light, size));
  }
}

}  // namespace

void light_row(const CellRow& row, bool near) {
  near ? light_cells<true>(row) : light_cells<false>(row);
}
void level_row(const LevelledRow& row, bool near) {
  near ? level_cells<true>(row) : level_cells<false>(row);
}

namespace {

SOFTFOCUS_INLINE Floats overlap_of(Floats size, const BucketRing& ring, const BucketTap& tap) {
  return saturate(size * ring.inverse_spacing - (tap.distance - 0.5f)) * tap.area;
}

// Sums of light: colour, weight, size.
struct Bucket {
  Floats sums[5];
};

SOFTFOCUS_INLINE void add(Bucket& bucket, const Floats* values) {
  for (int c = 0; c < 5; ++c) bucket.sums[c] = bucket.sums[c] + values[c];
}

SOFTFOCUS_INLINE Floats mean_size(const Bucket& bucket) {
  return select(bucket.sums[3] > 0.0f, bucket.sums[4] / bucket.sums[3], splat(0.0f));
}

// Adds a ring. With `buckets` its taps part by their size.
template <bool buckets>
SOFTFOCUS_INLINE void add_ring(const BucketRow& row, int x, const BucketRing& ring,
                               Bucket& previous) {
  const float* const* rows = row.rows[ring.level];
  Bucket current{};
  Floats hits = splat(0.0f);
  for (int t = ring.first; t < ring.end; ++t) {
    const BucketTap tap = row.taps[t];
    const float* at = rows[tap.dy] + (row.x + x + tap.dx);
    const Floats size = load(at + kTapSize * row.plane);
    const Floats overlap = overlap_of(size, ring, tap);
    // Lanes that are left out below would add 0: the sums' bits are those of all lanes.
    if (!any(overlap > 0.0f)) continue;
    const Floats light = overlap * load(at + kTapLight * row.plane);
    Floats values[5];
    for (int c = 0; c < 4; ++c) values[c] = light * load(at + c * row.plane);
    values[4] = values[3] * size;
    const unsigned joins = buckets ? lane_bits(size > ring.border) : kAllLaneBits;
    if (joins == kAllLaneBits) {
      add(previous, values);
    } else if (joins == 0) {
      add(current, values);
      hits = hits + overlap;
    } else {
      const Mask mask = size > ring.border;
      for (int c = 0; c < 5; ++c) {
        previous.sums[c] = previous.sums[c] + select(mask, values[c], splat(0.0f));
        current.sums[c] = current.sums[c] + select(mask, splat(0.0f), values[c]);
      }
      hits = hits + select(mask, splat(0.0f), overlap);
    }
  }
  if (!buckets) return;
  const Floats occlusion = saturate(mean_size(previous) - mean_size(current));
  const Floats kept = 1.0f - (hits * ring.inverse_area) * occlusion;
  for (int c = 0; c < 5; ++c) previous.sums[c] = previous.sums[c] * kept + current.sums[c];
}

SOFTFOCUS_INLINE void gather_far(const BucketRow& row) {
  const bool all_alike = row.most - row.least <= 0.25f;
  for (int x = 0; x < row.count; x += kLanes) {
    float* cells = row.cells + x;
    const Floats weight = load(cells + kFarWeight * row.cell_plane);
    const Mask blurred = weight >= kLeastBlurredWeight;
    Bucket sums{};
    if (any(blurred)) {
      for (int i = 0; i < row.ring_count; ++i) {
        const BucketRing ring = row.rings[i];
        if (all_alike || ring.border < row.least) {
          add_ring<false>(row, x, ring, sums);
        } else {
          add_ring<true>(row, x, ring, sums);
        }
      }
    }
    const Floats scale = weight / select(blurred, sums.sums[3], splat(1.0f));
    for (int c = 0; c < 3; ++c) {
      const Floats own = weight * load(cells + (kFarColour + c) * row.cell_plane);
      store(cells + (kFarColour + c) * row.cell_plane, select(blurred, sums.sums[c] * scale, own));
    }
  }
}

SOFTFOCUS_INLINE void gather_near(const BucketRow& row) {
  for (int x = 0; x < row.count; x += kLanes) {
    Floats sums[5] = {};
    for (int i = 0; i < row.ring_count; ++i) {
      const BucketRing ring = row.rings[i];
      const float* const* rows = row.rows[ring.level];
      for (int t = ring.first; t < ring.end; ++t) {
        const BucketTap tap = row.taps[t];
        const float* at = rows[tap.dy] + (row.x + x + tap.dx);
        const Floats overlap = overlap_of(load(at + kTapSize * row.plane), ring, tap);
        if (!any(overlap > 0.0f)) continue;
        const Floats light = overlap * load(at + kTapLight * row.plane);
        for (int c = 0; c < 4; ++c) sums[c] = sums[c] + light * load(at + c * row.plane);
        sums[4] = sums[4] + light * load(at + kTapAll * row.plane);
      }
    }
    const Floats ratio = sums[3] / select(sums[4] > 0.0f, sums[4], splat(1.0f));
    const Floats opacity = smaller(larger(sums[3], ratio), splat(1.0f));
    const Floats scale = select(sums[3] > 0.0f, opacity / sums[3], splat(0.0f));
    float* cells = row.cells + x;
    for (int c = 0; c < 3; ++c) {
      store(cells + (kNearColour + c) * row.cell_plane, sums[c] * scale);
    }
    store(cells + kNearOpacity * row.cell_plane, opacity);
  }
}

}  // namespace

void gather_rings(const BucketRow& row, bool near) {
  if (near) return gather_near(row);
  gather_far(row);
}

#endif
