#pragma once
// Rows of a relief, moved within the rows: the texels that each puts into the columns.

#include <algorithm>
#include <array>
#include <cstdlib>
#include <type_traits>
#include <vector>

#include "scenes/relief/warp/resample_walk.h"
#include "scenes/relief/warp/step_lanes.h"

namespace softfocus {

struct CountedPieces {
  WarpCounts counts;
  bool wanted;

  void add(std::uint32_t covered, bool stretched) {
    if (!wanted) return;
    ++counts.pieces;
    counts.overlaps += covered != 0 ? 1 : 0;
    counts.stretched += stretched ? 1 : 0;
  }
};

/// Read by all tasks of a warp.
struct WarpWork {
  const ReliefTexture& relief;
  ReliefExtent extent;
  PreWarp warp;
  PlaneRectangle place;
  Resampling resampling;
  WarpedRelief& warped;

  WalkLimits columns() const { return {place.x_begin, place.x_begin + place.width}; }
  WalkLimits rows() const { return {place.y_begin, place.y_begin + place.height}; }
  std::size_t at(int x, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(place.width) +
           static_cast<std::size_t>(x - place.x_begin);
  }
};

// --- a row's places, in either arithmetic ---

/// A row's places, and the other numbers that step_texels() reads and gives.
struct FloatRow {
  explicit FloatRow(int width)
      : along(static_cast<std::size_t>(width)),
        across(along),
        depths(along),
        to_across(along),
        to_depths(along),
        reached(along.size()),
        to_colours(along.size()) {}
  std::vector<float> along, across, depths, to_across, to_depths;
  std::vector<std::int32_t> reached;
  std::vector<std::uint32_t> to_colours;
};

struct FixedRow {
  explicit FixedRow(int width) : along(static_cast<std::size_t>(width)), across(along) {}
  std::vector<std::int32_t> along, across;
};

/// The texels of a row, within `limits`, that can reach the columns `band`: texels before the first
/// step into the band and behind the last are left out. A texel that is kept keeps its neighbour.
template <class Numbers, class Row>
WalkLimits reaching(const Row& row, WalkLimits limits, const WalkLimits& band) {
  const auto low = Numbers::place_of(band.begin - 1), high = Numbers::place_of(band.end + 1);
  const auto at = [&](int u) { return row.along[static_cast<std::size_t>(u)]; };
  const auto is_outside = [&](int u, int v) {
    return (at(u) < low && at(v) < low) || (at(u) > high && at(v) > high);
  };
  while (limits.begin + 1 < limits.end && is_outside(limits.begin, limits.begin + 1)) {
    ++limits.begin;
  }
  while (limits.begin + 1 < limits.end && is_outside(limits.end - 2, limits.end - 1)) --limits.end;
  return limits;
}

inline void place_row(const FloatPlaces& numbers, const WarpWork& work, int v, Isa isa,
                      FloatRow& row) {
  const std::uint16_t* codes =
      work.relief.depths.data() + static_cast<std::ptrdiff_t>(v) * work.relief.width;
  warp_row(numbers.warp, codes, work.extent.x_end, v, row.along.data(), row.across.data(), isa);
}

inline bool take(const FloatPlaces& numbers, const FloatRow& row, int u, int v, std::uint16_t code,
                 WalkTexel<FloatPlaces>& texel) {
  const auto at = static_cast<std::size_t>(u);
  static_cast<void>(v);
  texel.along = row.along[at];
  texel.across = row.across[at];
  texel.depth = static_cast<float>(code) * numbers.warp.step_m;
  return true;
}

/// Empty texels have the place of the last depth, which means nothing.
inline void place_row(const FixedPlaces& numbers, const WarpWork& work, int v, Isa, FixedRow& row) {
  const std::uint16_t* codes =
      work.relief.depths.data() + static_cast<std::ptrdiff_t>(v) * work.relief.width;
  for (int u = work.extent.x_begin; u < work.extent.x_end; ++u) {
    const FixedDepth& depth = numbers.table[std::min<std::int32_t>(codes[u], numbers.last_code)];
    row.along[static_cast<std::size_t>(u)] = fixed_place(u * 256, depth.shift_u, depth.scale);
    row.across[static_cast<std::size_t>(u)] = fixed_place(v * 256, depth.shift_v, depth.scale);
  }
}

inline bool take(const FixedPlaces&, const FixedRow& row, int u, int, std::uint16_t code,
                 WalkTexel<FixedPlaces>& texel) {
  const auto at = static_cast<std::size_t>(u);
  texel.along = row.along[at];
  texel.across = row.across[at];
  texel.depth = code;
  return true;
}

template <class Numbers>
struct RowOf;
template <>
struct RowOf<FloatPlaces> {
  using Type = FloatRow;
};
template <>
struct RowOf<FixedPlaces> {
  using Type = FixedRow;
};

/// Walks a row of the relief.
template <class Numbers, class Put>
void walk_row(const Numbers& numbers, const WarpWork& work, int v,
              const typename RowOf<Numbers>::Type& row, const WalkLimits& limits, const Put& put) {
  const std::size_t first =
      static_cast<std::size_t>(v) * static_cast<std::size_t>(work.relief.width);
  const std::uint16_t* codes = work.relief.depths.data() + first;
  const std::uint32_t* colours = work.relief.colours.data() + first;
  const std::uint16_t empty = empty_depth(work.relief.depth_bits);
  const WalkLimits texels =
      reaching<Numbers>(row, {work.extent.x_begin, work.extent.x_end}, limits);
  walk_both(
      numbers, half_walks(texels.begin, texels.end, work.warp.epipole_u, work.warp.outwards),
      limits,
      [&](int u, WalkTexel<Numbers>& texel) {
        if (codes[u] == empty) return false;
        texel.colour = colours[u];
        return take(numbers, row, u, v, codes[u], texel);
      },
      put);
}

/// A texel of a row's walk, with its place in the column as the resampling has it.
template <class Numbers>
WalkTexel<Numbers> in_column(const Numbers& numbers, Resampling resampling, int v,
                             std::uint32_t colour, typename Numbers::Place across,
                             typename Numbers::Depth depth) {
  if (resampling == Resampling::compensated) depth = numbers.compensated(v, across, depth);
  if (resampling == Resampling::two_pass || resampling == Resampling::compensated) {
    across = numbers.place_in_column(v, depth);
  }
  return {across, across, depth, colour};
}

/// Half of a row's walk in lanes: walk_row() with the column's places of `resampling`, for floats.
template <int sign, class Put>
void step_row(const FloatPlaces& numbers, const WarpWork& work, Resampling resampling, int v,
              FloatRow& row, int begin, int end, const WalkLimits& limits, Isa isa,
              const Put& put) {
  if (sign * begin >= sign * end) return;
  const std::uint32_t* colours =
      work.relief.colours.data() + static_cast<std::ptrdiff_t>(v) * work.relief.width;
  const float* along = row.along.data();
  const float* across = row.across.data();
  const float* depths = row.depths.data();
  const bool compensated = resampling == Resampling::compensated;
  const StepRule rule{
      numbers.warp, numbers.most_m, sign, v, compensated || resampling == Resampling::two_pass,
      compensated};
  // Steps to the second texel of the walk and on, in the order of memory.
  const int low = std::min(begin + sign, end - sign), count = std::abs(end - begin) - 1;
  const int first = sign > 0 ? begin + 1 : low;
  if (count > 0) {
    step_texels({along + first - sign, along + first, across + first - sign, across + first,
                 depths + first - sign, depths + first, colours + first - sign, colours + first},
                rule, count,
                {row.reached.data() + first, row.to_colours.data() + first,
                 row.to_across.data() + first, row.to_depths.data() + first},
                isa);
  }
  const auto texel_at = [&](int u) {
    return WalkTexel<FloatPlaces>{along[u], across[u], depths[u], colours[u]};
  };
  const auto put_step = [&](int x, std::uint32_t colour, float place, float depth, bool stretched) {
    const WalkTexel<FloatPlaces> texel = in_column(numbers, resampling, v, colour, place, depth);
    put(x, texel, stretched);
  };
  step<FloatPlaces, sign>(numbers, false, texel_at(begin), colours[begin] != 0, texel_at(begin),
                          limits, put_step);
  for (int u = begin + sign; sign * u < sign * end; u += sign) {
    const auto at = static_cast<std::size_t>(u);
    const std::int32_t x = row.reached[at];
    if (x == kNoTexel) continue;
    if (x != kOtherStep) {
      if (x < limits.begin || x >= limits.end) continue;
      const bool stretched = sign * (along[u] - along[u - sign]) > FloatPlaces::place_of(kApart);
      put(x,
          WalkTexel<FloatPlaces>{row.to_across[at], row.to_across[at], row.to_depths[at],
                                 row.to_colours[at]},
          stretched);
      continue;
    }
    step<FloatPlaces, sign>(numbers, colours[u - sign] != 0, texel_at(u - sign), colours[u] != 0,
                            texel_at(u), limits, put_step);
  }
  step<FloatPlaces, sign>(numbers, colours[end - sign] != 0, texel_at(end - sign), false,
                          texel_at(begin), limits, put_step);
}

/// Both halves. `put(x, texel of the column, stretched)`.
template <class Numbers, class Put>
void put_row(const Numbers& numbers, const WarpWork& work, Resampling resampling, int v,
             const WalkLimits& limits, Isa isa, typename RowOf<Numbers>::Type& row,
             const Put& put) {
  place_row(numbers, work, v, isa, row);
  if constexpr (std::is_same_v<Numbers, FloatPlaces>) {
    if (isa != Isa::scalar) {
      const std::uint16_t* codes =
          work.relief.depths.data() + static_cast<std::ptrdiff_t>(v) * work.relief.width;
      for (int u = work.extent.x_begin; u < work.extent.x_end; ++u) {
        row.depths[static_cast<std::size_t>(u)] =
            static_cast<float>(codes[u]) * numbers.warp.step_m;
      }
      const WalkLimits texels =
          reaching<Numbers>(row, {work.extent.x_begin, work.extent.x_end}, limits);
      const auto [forward, backward] =
          half_walks(texels.begin, texels.end, work.warp.epipole_u, work.warp.outwards);
      step_row<1>(numbers, work, resampling, v, row, forward.begin, forward.end, limits, isa, put);
      step_row<-1>(numbers, work, resampling, v, row, backward.begin, backward.end, limits, isa,
                   put);
      return;
    }
  }
  walk_row(numbers, work, v, row, limits,
           [&](int x, std::uint32_t colour, auto across, auto depth, bool stretched) {
             put(x, in_column(numbers, resampling, v, colour, across, depth), stretched);
           });
}

}  // namespace softfocus
