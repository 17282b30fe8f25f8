#include "scenes/relief/resample.h"

#include <cassert>
#include <cmath>
#include <cstdlib>
#include <span>
#include <type_traits>

#include "scenes/relief/resample_walk.h"
#include "scenes/relief/step_lanes.h"

namespace softfocus {
namespace {

// Columns that a task of the second pass takes.
constexpr int kBandColumns = 64;

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

WarpCounts total_of(std::span<const CountedPieces> all) {
  WarpCounts total;
  for (const CountedPieces& some : all) {
    total.pieces += some.counts.pieces;
    total.overlaps += some.counts.overlaps;
    total.stretched += some.counts.stretched;
  }
  return total;
}

/// What all tasks of a warp read.
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

struct FloatRow {
  std::array<float, kMostReliefSize> along, across;
};

/// The texels of a row, `limits`, that can reach columns `band`: those before the first step into
/// it, and behind the last, are left out. A texel that is kept has its neighbour beside it.
WalkLimits reaching(const FloatRow& row, WalkLimits limits, const WalkLimits& band) {
  const auto low = static_cast<float>(band.begin - 1), high = static_cast<float>(band.end + 1);
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

void place_row(const FloatPlaces& numbers, const WarpWork& work, int v, Isa isa, FloatRow& row) {
  const std::uint16_t* codes =
      work.relief.depths.data() + static_cast<std::ptrdiff_t>(v) * work.relief.width;
  warp_row(numbers.warp, codes, work.extent.x_end, v, row.along.data(), row.across.data(), isa);
}

bool take(const FloatPlaces& numbers, const FloatRow& row, int u, int v, std::uint16_t code,
          WalkTexel<FloatPlaces>& texel) {
  const auto at = static_cast<std::size_t>(u);
  static_cast<void>(v);
  texel.along = row.along[at];
  texel.across = row.across[at];
  texel.depth = static_cast<float>(code) * numbers.warp.step_m;
  return true;
}

/// What step_texels() reads beside a row's places, and what it gives.
struct FloatSteps {
  std::array<float, kMostReliefSize> depths, across, to_depths;
  std::array<std::int32_t, kMostReliefSize> reached;
  std::array<std::uint32_t, kMostReliefSize> colours;
};

struct FixedRow {};

WalkLimits reaching(const FixedRow&, const WalkLimits& limits, const WalkLimits&) { return limits; }

void place_row(const FixedPlaces&, const WarpWork&, int, Isa, FixedRow&) {}

bool take(const FixedPlaces& numbers, const FixedRow&, int u, int v, std::uint16_t code,
          WalkTexel<FixedPlaces>& texel) {
  const FixedDepth& depth = numbers.table[code];
  texel.along = fixed_place(u * 256, depth.shift_u, depth.scale);
  texel.across = fixed_place(v * 256, depth.shift_v, depth.scale);
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
  const WalkLimits texels = reaching(row, {work.extent.x_begin, work.extent.x_end}, limits);
  walk_to_epipole(
      numbers, texels.begin, texels.end, work.warp.epipole_u, limits,
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

// --- two passes ---

template <class Numbers>
std::vector<typename Numbers::Place>& places_of(WarpedRelief& warped) {
  if constexpr (std::is_same_v<Numbers, FloatPlaces>)
    return warped.row_places;
  else
    return warped.row_fixed;
}
template <class Numbers>
std::vector<typename Numbers::Depth>& depths_of(WarpedRelief& warped) {
  if constexpr (std::is_same_v<Numbers, FloatPlaces>)
    return warped.row_depths_m;
  else
    return warped.row_codes;
}

/// Half of a row's walk in lanes: walk_row() with the column's places of `resampling`, for floats.
template <int sign, class Put>
void step_row(const FloatPlaces& numbers, const WarpWork& work, Resampling resampling, int v,
              const FloatRow& row, FloatSteps& steps, int begin, int end, const WalkLimits& limits,
              Isa isa, const Put& put) {
  if (sign * begin >= sign * end) return;
  const std::uint32_t* colours =
      work.relief.colours.data() + static_cast<std::ptrdiff_t>(v) * work.relief.width;
  const float* along = row.along.data();
  const float* across = row.across.data();
  const float* depths = steps.depths.data();
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
                {steps.reached.data() + first, steps.colours.data() + first,
                 steps.across.data() + first, steps.to_depths.data() + first},
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
    const std::int32_t x = steps.reached[at];
    if (x == kNoTexel) continue;
    if (x != kOtherStep) {
      if (x < limits.begin || x >= limits.end) continue;
      const bool stretched = sign * (along[u] - along[u - sign]) > FloatPlaces::place_of(kApart);
      put(x,
          WalkTexel<FloatPlaces>{steps.across[at], steps.across[at], steps.to_depths[at],
                                 steps.colours[at]},
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
             FloatSteps& steps, const Put& put) {
  place_row(numbers, work, v, isa, row);
  if constexpr (std::is_same_v<Numbers, FloatPlaces>) {
    if (isa != Isa::scalar) {
      const std::uint16_t* codes =
          work.relief.depths.data() + static_cast<std::ptrdiff_t>(v) * work.relief.width;
      for (int u = work.extent.x_begin; u < work.extent.x_end; ++u) {
        steps.depths[static_cast<std::size_t>(u)] =
            static_cast<float>(codes[u]) * numbers.warp.step_m;
      }
      const WalkLimits texels = reaching(row, {work.extent.x_begin, work.extent.x_end}, limits);
      const int split = walk_split(texels.begin, texels.end, work.warp.epipole_u);
      step_row<1>(numbers, work, resampling, v, row, steps, texels.begin, split, limits, isa, put);
      step_row<-1>(numbers, work, resampling, v, row, steps, texels.end - 1, split - 1, limits, isa,
                   put);
      return;
    }
  }
  walk_row(numbers, work, v, row, limits,
           [&](int x, std::uint32_t colour, auto across, auto depth, bool stretched) {
             put(x, in_column(numbers, resampling, v, colour, across, depth), stretched);
           });
}

template <class Numbers>
void warp_rows(const Numbers& numbers, const WarpWork& work, int v, Isa isa,
               CountedPieces& counted) {
  typename RowOf<Numbers>::Type row;
  FloatSteps steps;
  std::uint32_t* colours = work.warped.row_colours.data();
  typename Numbers::Place* places = places_of<Numbers>(work.warped).data();
  typename Numbers::Depth* depths = depths_of<Numbers>(work.warped).data();
  const int line = v - work.extent.y_begin;
  std::fill_n(colours + work.at(work.place.x_begin, line), work.place.width, 0u);
  put_row(numbers, work, work.resampling, v, work.columns(), isa, row, steps,
          [&](int x, const WalkTexel<Numbers>& texel, bool stretched) {
            const std::size_t at = work.at(x, line);
            counted.add(colours[at], stretched);
            colours[at] = texel.colour;
            places[at] = texel.along;
            depths[at] = texel.depth;
          });
}

/// The columns of `limits`, rows from `row_begin` to before `row_end`: walk() of each. Columns walk
/// side by side, row by row, so that memory is read and written in its order.
template <class Numbers, int sign>
void walk_columns(const Numbers& numbers, const WarpWork& work, const WalkLimits& limits,
                  int row_begin, int row_end, CountedPieces& counted) {
  const std::uint32_t* colours = work.warped.row_colours.data();
  const typename Numbers::Place* places = places_of<Numbers>(work.warped).data();
  const typename Numbers::Depth* depths = depths_of<Numbers>(work.warped).data();
  std::uint32_t* to_colours = work.warped.colours.data();
  float* to_depths = work.warped.depths_m.data();
  const WalkLimits rows = work.rows();
  // One row more, of nothing, ends the runs.
  for (int v = row_begin; sign * v <= sign * row_end; v += sign) {
    const bool is_row = v != row_end, follows = v != row_begin;
    const std::size_t first = work.at(limits.begin, (is_row ? v : v - sign) - work.extent.y_begin);
    const std::size_t first_before =
        work.at(limits.begin, (follows ? v - sign : v) - work.extent.y_begin);
    for (int x = limits.begin; x < limits.end; ++x) {
      const auto column = static_cast<std::size_t>(x - limits.begin);
      const std::size_t at = first + column, at_before = first_before + column;
      const std::uint32_t colour = is_row ? colours[at] : 0;
      const std::uint32_t colour_before = follows ? colours[at_before] : 0;
      if ((colour | colour_before) == 0) continue;
      const auto put = [&](int y, std::uint32_t put_colour, auto, auto depth, bool stretched) {
        const std::size_t to = work.at(x, y - work.place.y_begin);
        counted.add(to_colours[to], stretched);
        to_colours[to] = put_colour;
        to_depths[to] = numbers.metres(depth);
      };
      const WalkTexel<Numbers> texel{places[at], 0, depths[at], colour};
      const WalkTexel<Numbers> before{places[at_before], 0, depths[at_before], colour_before};
      step<Numbers, sign>(numbers, colour_before != 0, before, colour != 0, texel, rows, put);
    }
  }
}

/// The same in lanes, for floats and without counting.
template <int sign>
void step_columns(const FloatPlaces& numbers, const WarpWork& work, const WalkLimits& limits,
                  int row_begin, int row_end, Isa isa) {
  const int columns = limits.end - limits.begin;
  std::array<std::int32_t, kBandColumns> reached;
  std::array<std::uint32_t, kBandColumns> mixed;
  std::array<float, kBandColumns> across, depth;
  const std::array<float, kBandColumns> no_places{};
  const std::array<std::uint32_t, kBandColumns> no_colours{};
  const WalkLimits rows = work.rows();
  const StepRule rule{numbers.warp, numbers.most_m, sign, 0, false, false};
  for (int v = row_begin; sign * v <= sign * row_end; v += sign) {
    const auto row_of = [&](int row, bool is_there) {
      const std::size_t at = is_there ? work.at(limits.begin, row - work.extent.y_begin) : 0;
      struct RowPointers {
        const float *place, *depth;
        const std::uint32_t* colour;
      };
      return is_there ? RowPointers{work.warped.row_places.data() + at,
                                    work.warped.row_depths_m.data() + at,
                                    work.warped.row_colours.data() + at}
                      : RowPointers{no_places.data(), no_places.data(), no_colours.data()};
    };
    const auto now = row_of(v, v != row_end), before = row_of(v - sign, v != row_begin);
    step_texels({before.place, now.place, no_places.data(), no_places.data(), before.depth,
                 now.depth, before.colour, now.colour},
                rule, columns, {reached.data(), mixed.data(), across.data(), depth.data()}, isa);
    for (int i = 0; i < columns; ++i) {
      const auto column = static_cast<std::size_t>(i);
      const std::int32_t y = reached[column];
      if (y == kNoTexel) continue;
      const int x = limits.begin + i;
      if (y != kOtherStep) {
        if (y < rows.begin || y >= rows.end) continue;
        const std::size_t at = work.at(x, y - work.place.y_begin);
        work.warped.colours[at] = mixed[column];
        work.warped.depths_m[at] = depth[column];
        continue;
      }
      const auto put = [&](int to, std::uint32_t colour, float, float to_depth, bool) {
        const std::size_t at = work.at(x, to - work.place.y_begin);
        work.warped.colours[at] = colour;
        work.warped.depths_m[at] = to_depth;
      };
      step<FloatPlaces, sign>(
          numbers, before.colour[i] != 0, {before.place[i], 0, before.depth[i], before.colour[i]},
          now.colour[i] != 0, {now.place[i], 0, now.depth[i], now.colour[i]}, rows, put);
    }
  }
}

void clear_columns(const WarpWork& work, const WalkLimits& limits) {
  for (int y = 0; y < work.place.height; ++y) {
    std::fill_n(work.warped.colours.data() + work.at(limits.begin, y), limits.end - limits.begin,
                0u);
  }
}

template <class Numbers>
WarpCounts warp_in_two_passes(const Numbers& numbers, const WarpWork& work, bool counting,
                              ThreadPool& pool) {
  const int rows = work.extent.y_end - work.extent.y_begin;
  const int bands = (work.place.width + kBandColumns - 1) / kBandColumns;
  const auto row_texels =
      static_cast<std::size_t>(rows) * static_cast<std::size_t>(work.place.width);
  if (work.warped.row_colours.size() < row_texels) work.warped.row_colours.resize(row_texels);
  if (places_of<Numbers>(work.warped).size() < row_texels) {
    places_of<Numbers>(work.warped).resize(row_texels);
    depths_of<Numbers>(work.warped).resize(row_texels);
  }
  std::vector<CountedPieces> counted(static_cast<std::size_t>(rows + bands), {{}, counting});
  constexpr int kRows = 8;
  pool.for_each((rows + kRows - 1) / kRows, [&](int band) {
    for (int row = kRows * band; row < std::min(kRows * (band + 1), rows); ++row) {
      warp_rows(numbers, work, work.extent.y_begin + row, pool.isa(),
                counted[static_cast<std::size_t>(row)]);
    }
  });
  const WalkLimits columns = work.columns();
  const int split = walk_split(work.extent.y_begin, work.extent.y_end, work.warp.epipole_v);
  pool.for_each(bands, [&](int band) {
    const int begin = columns.begin + band * kBandColumns;
    const WalkLimits limits{begin, std::min(begin + kBandColumns, columns.end)};
    clear_columns(work, limits);
    CountedPieces& some = counted[static_cast<std::size_t>(rows + band)];
    if constexpr (std::is_same_v<Numbers, FloatPlaces>) {
      if (pool.isa() != Isa::scalar && !counting) {
        step_columns<1>(numbers, work, limits, work.extent.y_begin, split, pool.isa());
        step_columns<-1>(numbers, work, limits, work.extent.y_end - 1, split - 1, pool.isa());
        return;
      }
    }
    walk_columns<Numbers, 1>(numbers, work, limits, work.extent.y_begin, split, some);
    walk_columns<Numbers, -1>(numbers, work, limits, work.extent.y_end - 1, split - 1, some);
  });
  return total_of(counted);
}

// --- one pass ---

/// The texels that a row put into a column: two surfaces at the most, the first and the last. A
/// texel of the next row is a neighbour of the one whose depth is nearer.
template <class Numbers>
struct ColumnEnd {
  int row;
  int count;
  WalkTexel<Numbers> texels[2];
  bool goes_on[2];  ///< whether a texel of the next row was joined to it
};

template <class Numbers>
int nearer_end(const ColumnEnd<Numbers>& end, const WalkTexel<Numbers>& texel) {
  if (end.count == 1) return 0;
  const auto from_first = end.texels[0].depth - texel.depth;
  const auto from_last = end.texels[1].depth - texel.depth;
  return (from_first < 0 ? -from_first : from_first) < (from_last < 0 ? -from_last : from_last) ? 0
                                                                                                : 1;
}

/// A column's ends in the row before and in this one.
template <class Numbers>
struct ColumnEnds {
  ColumnEnd<Numbers> before, now;
};

/// What walks of rows put into a band of columns.
template <class Numbers, int sign>
struct ColumnFill {
  const Numbers& numbers;
  const WarpWork& work;
  CountedPieces& counted;

  auto put_at(int x, bool stretched_row) const {
    return [this, x, stretched_row](int y, std::uint32_t colour, auto, auto depth, bool stretched) {
      const std::size_t at = work.at(x, y - work.place.y_begin);
      counted.add(work.warped.colours[at], stretched_row || stretched);
      work.warped.colours[at] = colour;
      work.warped.depths_m[at] = numbers.metres(depth);
    };
  }

  /// Half a texel past each end that no texel was joined to, but for end number `but`.
  void end_runs(ColumnEnd<Numbers>& ends, int x, int but) const {
    for (int i = 0; i < ends.count; ++i) {
      if (i == but || ends.goes_on[i]) continue;
      ends.goes_on[i] = true;
      const WalkTexel<Numbers>& end = ends.texels[i];
      fill_flat<Numbers, sign>(end, end.along, end.along + sign * numbers.half_texel(end.depth),
                               work.rows(), put_at(x, false));
    }
  }

  void add(ColumnEnds<Numbers>& column, int x, int v, const WalkTexel<Numbers>& texel,
           bool stretched_row) const {
    if (column.now.count == 0 || column.now.row != v) {
      end_runs(column.before, x, -1);
      column.before = column.now;
      column.now.row = v;
      column.now.count = 0;
    }
    ColumnEnd<Numbers>& before = column.before;
    const auto put = put_at(x, stretched_row);
    int joined = before.count > 0 && before.row == v - sign ? nearer_end(before, texel) : -1;
    if (joined >= 0 && sign * texel.along < sign * before.texels[joined].along) joined = -1;
    end_runs(before, x, joined);
    if (joined >= 0) {
      const WalkTexel<Numbers>& end = before.texels[joined];
      fill_between<Numbers, sign>(end, texel, last_reached<Numbers, sign>(end.along),
                                  last_reached<Numbers, sign>(texel.along), work.rows(), put);
      before.goes_on[joined] = true;
    } else {
      const auto half = numbers.half_texel(texel.depth);
      fill_flat<Numbers, sign>(texel, texel.along - sign * half, texel.along, work.rows(), put);
    }
    const int place = column.now.count == 0 ? 0 : 1;
    column.now.texels[place] = texel;
    column.now.goes_on[place] = false;
    column.now.count = place + 1;
  }
};

template <class Numbers, int sign>
void warp_band_rows(const Numbers& numbers, const WarpWork& work, const WalkLimits& limits,
                    int row_begin, int row_end, Isa isa, CountedPieces& counted) {
  std::vector<ColumnEnds<Numbers>> ends(static_cast<std::size_t>(limits.end - limits.begin));
  const ColumnFill<Numbers, sign> fill{numbers, work, counted};
  typename RowOf<Numbers>::Type row;
  FloatSteps steps;
  for (int v = row_begin; sign * v < sign * row_end; v += sign) {
    put_row(numbers, work, Resampling::asymmetric, v, limits, isa, row, steps,
            [&](int x, const WalkTexel<Numbers>& texel, bool stretched) {
              fill.add(ends[static_cast<std::size_t>(x - limits.begin)], x, v, texel, stretched);
            });
  }
  for (int x = limits.begin; x < limits.end; ++x) {
    ColumnEnds<Numbers>& column = ends[static_cast<std::size_t>(x - limits.begin)];
    fill.end_runs(column.before, x, -1);
    fill.end_runs(column.now, x, -1);
  }
}

template <class Numbers>
WarpCounts warp_in_one_pass(const Numbers& numbers, const WarpWork& work, bool counting,
                            ThreadPool& pool) {
  const WalkLimits columns = work.columns();
  // Each band walks all rows, and puts what falls into it.
  const int bands = std::min(pool.threads(), work.place.width);
  const int split = walk_split(work.extent.y_begin, work.extent.y_end, work.warp.epipole_v);
  std::vector<CountedPieces> counted(static_cast<std::size_t>(bands), {{}, counting});
  pool.for_each(bands, [&](int band) {
    const auto border = [&](int i) { return columns.begin + work.place.width * i / bands; };
    const WalkLimits limits{border(band), border(band + 1)};
    clear_columns(work, limits);
    CountedPieces& some = counted[static_cast<std::size_t>(band)];
    warp_band_rows<Numbers, 1>(numbers, work, limits, work.extent.y_begin, split, pool.isa(), some);
    warp_band_rows<Numbers, -1>(numbers, work, limits, work.extent.y_end - 1, split - 1, pool.isa(),
                                some);
  });
  return total_of(counted);
}

template <class Numbers>
WarpCounts warp_by(const Numbers& numbers, const WarpWork& work, bool counting, ThreadPool& pool) {
  return work.resampling == Resampling::intertwined
             ? warp_in_one_pass(numbers, work, counting, pool)
             : warp_in_two_passes(numbers, work, counting, pool);
}

}  // namespace

float compensated_depth(const PreWarp& warp, float v, float place, float otherwise) {
  const float below = warp.k2 - place * warp.k3;
  return below != 0.0f ? (place - v) / below : otherwise;
}

std::optional<PlaneRectangle> warped_extent(const ReliefTexture& relief, const ReliefExtent& extent,
                                            glm::dvec3 eye) {
  if (!sees_front(relief, eye)) return std::nullopt;
  const PreWarp warp = pre_warp(relief, eye);
  struct Ends {
    double low, high;
  };
  const auto ends = [&](double begin, double end, double epipole) {
    Ends found{begin, end};
    bool is_first = true;
    for (const int code : {extent.least_code, extent.most_code}) {
      const double scale =
          warp.height_m / (warp.height_m + static_cast<double>(code) * depth_step(relief));
      for (const double border : {begin, end}) {
        const double place = epipole + (border - epipole) * scale;
        found.low = is_first ? place : std::fmin(found.low, place);
        found.high = is_first ? place : std::fmax(found.high, place);
        is_first = false;
      }
    }
    return found;
  };
  const Ends u = ends(extent.x_begin - 0.5, extent.x_end - 0.5, warp.epipole_u);
  const Ends v = ends(extent.y_begin - 0.5, extent.y_end - 0.5, warp.epipole_v);
  if (u.high - u.low > kMostStretch * relief.width ||
      v.high - v.low > kMostStretch * relief.height) {
    return std::nullopt;
  }
  const auto whole = [](double place) { return static_cast<int>(std::floor(place)); };
  const int x = whole(u.low) - 1, y = whole(v.low) - 1;
  return PlaneRectangle{x, y, whole(u.high) + 3 - x, whole(v.high) + 3 - y};
}

void warp_relief(const ReliefTexture& relief, const ReliefExtent& extent, glm::dvec3 eye,
                 const PlaneRectangle& place, Resampling resampling, PlaceNumbers numbers,
                 WarpedRelief& warped, ThreadPool& pool, WarpCounts* counts) {
  assert(sees_front(relief, eye));
  const PreWarp warp = pre_warp(relief, eye);
  const std::size_t texels =
      static_cast<std::size_t>(place.width) * static_cast<std::size_t>(place.height);
  warped.place = place;
  warped.colours.resize(texels);
  warped.depths_m.resize(texels);
  const WarpWork work{relief, extent, warp, place, resampling, warped};
  WarpCounts counted;
  if (numbers == PlaceNumbers::floats) {
    const float most_m = static_cast<float>(last_depth(relief.depth_bits)) * warp.step_m;
    counted = warp_by(FloatPlaces{warp, most_m}, work, counts != nullptr, pool);
  } else {
    const std::vector<FixedDepth> table = fixed_warp_table(warp, relief.depth_bits);
    const double share = static_cast<double>(warp.step_m) / warp.height_m;
    counted = warp_by(
        FixedPlaces{table.data(), last_depth(relief.depth_bits), warp.step_m,
                    std::llrint(warp.epipole_v * share * 0x1p40), std::llrint(share * 0x1p32)},
        work, counts != nullptr, pool);
  }
  if (counts != nullptr) *counts = counted;
}

}  // namespace softfocus
