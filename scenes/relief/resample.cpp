#include "scenes/relief/resample.h"

#include <cassert>
#include <cmath>
#include <span>

#include "scenes/relief/resample_walk.h"

namespace softfocus {
namespace {

// Columns that a task takes at a time: a line of the cache has so many colours.
constexpr int kColumns = 16;

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

struct FixedRow {};

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
  walk_to_epipole(
      numbers, work.extent.x_begin, work.extent.x_end, work.warp.epipole_u, limits,
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

template <class Numbers>
void warp_rows(const Numbers& numbers, const WarpWork& work, int v, Isa isa,
               CountedPieces& counted) {
  typename RowOf<Numbers>::Type row;
  place_row(numbers, work, v, isa, row);
  std::uint32_t* colours = work.warped.row_colours.data();
  typename Numbers::Place* places = places_of<Numbers>(work.warped).data();
  typename Numbers::Depth* depths = depths_of<Numbers>(work.warped).data();
  const int line = v - work.extent.y_begin;
  std::fill_n(colours + work.at(work.place.x_begin, line), work.place.width, 0u);
  walk_row(numbers, work, v, row, work.columns(),
           [&](int x, std::uint32_t colour, auto across, auto depth, bool stretched) {
             const std::size_t at = work.at(x, line);
             counted.add(colours[at], stretched);
             const WalkTexel<Numbers> texel =
                 in_column(numbers, work.resampling, v, colour, across, depth);
             colours[at] = colour;
             places[at] = texel.along;
             depths[at] = texel.depth;
           });
}

template <class Numbers>
void warp_column(const Numbers& numbers, const WarpWork& work, int x, CountedPieces& counted) {
  const std::uint32_t* colours = work.warped.row_colours.data();
  const typename Numbers::Place* places = places_of<Numbers>(work.warped).data();
  const typename Numbers::Depth* depths = depths_of<Numbers>(work.warped).data();
  walk_to_epipole(
      numbers, work.extent.y_begin, work.extent.y_end, work.warp.epipole_v, work.rows(),
      [&](int v, WalkTexel<Numbers>& texel) {
        const std::size_t at = work.at(x, v - work.extent.y_begin);
        texel = {places[at], 0, depths[at], colours[at]};
        return colours[at] != 0;
      },
      [&](int y, std::uint32_t colour, auto, auto depth, bool stretched) {
        const std::size_t at = work.at(x, y - work.place.y_begin);
        counted.add(work.warped.colours[at], stretched);
        work.warped.colours[at] = colour;
        work.warped.depths_m[at] = numbers.metres(depth);
      });
}

template <class Numbers>
WarpCounts warp_in_two_passes(const Numbers& numbers, const WarpWork& work, bool counting,
                              ThreadPool& pool) {
  const int rows = work.extent.y_end - work.extent.y_begin;
  const int bands = (work.place.width + kColumns - 1) / kColumns;
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
  pool.for_each(bands, [&](int band) {
    const int begin = columns.begin + band * kColumns;
    const int end = std::min(begin + kColumns, columns.end);
    for (int y = 0; y < work.place.height; ++y) {
      std::fill_n(work.warped.colours.data() + work.at(begin, y), end - begin, 0u);
    }
    for (int x = begin; x < end; ++x) {
      warp_column(numbers, work, x, counted[static_cast<std::size_t>(rows + band)]);
    }
  });
  return total_of(counted);
}

// --- one pass ---

/// The texels of a column's last row that had some: two surfaces at the most, the first and the
/// last that the row put there. A later texel of the next row is a neighbour of the one whose depth
/// is nearer.
template <class Numbers>
struct ColumnEnd {
  int row = -2;
  int count = 0;
  WalkTexel<Numbers> texels[2] = {};
};

template <class Numbers>
const WalkTexel<Numbers>& nearer_end(const ColumnEnd<Numbers>& end,
                                     const WalkTexel<Numbers>& texel) {
  if (end.count == 1) return end.texels[0];
  const auto from_first = end.texels[0].depth - texel.depth;
  const auto from_last = end.texels[1].depth - texel.depth;
  const bool is_first =
      (from_first < 0 ? -from_first : from_first) < (from_last < 0 ? -from_last : from_last);
  return end.texels[is_first ? 0 : 1];
}

/// A column's ends in the row before and in this one.
template <class Numbers>
struct ColumnEnds {
  ColumnEnd<Numbers> before, now;
};

template <class Numbers, int sign>
void warp_band_rows(const Numbers& numbers, const WarpWork& work, const WalkLimits& limits,
                    int row_begin, int row_end, Isa isa, CountedPieces& counted) {
  std::vector<ColumnEnds<Numbers>> ends(static_cast<std::size_t>(limits.end - limits.begin));
  typename RowOf<Numbers>::Type row;
  for (int v = row_begin; sign * v < sign * row_end; v += sign) {
    place_row(numbers, work, v, isa, row);
    walk_row(numbers, work, v, row, limits,
             [&](int x, std::uint32_t colour, auto across, auto depth, bool stretched_row) {
               const WalkTexel<Numbers> texel =
                   in_column(numbers, Resampling::asymmetric, v, colour, across, depth);
               const auto put = [&](int y, std::uint32_t mixed, auto, auto mixed_depth,
                                    bool stretched_column) {
                 const std::size_t at = work.at(x, y - work.place.y_begin);
                 counted.add(work.warped.colours[at], stretched_row || stretched_column);
                 work.warped.colours[at] = mixed;
                 work.warped.depths_m[at] = numbers.metres(mixed_depth);
               };
               ColumnEnds<Numbers>& column = ends[static_cast<std::size_t>(x - limits.begin)];
               if (column.now.row != v) {
                 column.before = column.now;
                 column.now.row = v;
                 column.now.count = 0;
               }
               const auto half = numbers.half_texel(texel.depth);
               const WalkTexel<Numbers>* before =
                   column.before.row == v - sign ? &nearer_end(column.before, texel) : nullptr;
               if (before != nullptr && sign * texel.along >= sign * before->along) {
                 fill_between<Numbers, sign>(*before, texel, work.rows(), put);
               } else {
                 fill_flat<Numbers, sign>(texel, texel.along - sign * half, texel.along,
                                          work.rows(), put);
               }
               // Whether another row follows is not known yet; it will cover this.
               fill_flat<Numbers, sign>(texel, texel.along, texel.along + sign * half, work.rows(),
                                        put);
               column.now.texels[column.now.count == 0 ? 0 : 1] = texel;
               column.now.count = std::min(column.now.count + 1, 2);
             });
  }
}

template <class Numbers>
WarpCounts warp_in_one_pass(const Numbers& numbers, const WarpWork& work, bool counting,
                            ThreadPool& pool) {
  const WalkLimits columns = work.columns();
  const int bands = std::min(pool.threads(), (work.place.width + kColumns - 1) / kColumns);
  const double epipole = work.warp.epipole_v;
  const int row_begin = work.extent.y_begin, row_end = work.extent.y_end;
  const double last = std::fmin(std::fmax(epipole, row_begin - 1.0), row_end - 1.0);
  const int split = static_cast<int>(std::floor(last)) + 1;
  std::vector<CountedPieces> counted(static_cast<std::size_t>(bands), {{}, counting});
  pool.for_each(bands, [&](int band) {
    const auto border = [&](int i) { return columns.begin + work.place.width * i / bands; };
    const WalkLimits limits{border(band), border(band + 1)};
    for (int y = 0; y < work.place.height; ++y) {
      std::fill_n(work.warped.colours.data() + work.at(limits.begin, y), limits.end - limits.begin,
                  0u);
    }
    CountedPieces& some = counted[static_cast<std::size_t>(band)];
    warp_band_rows<Numbers, 1>(numbers, work, limits, row_begin, split, pool.isa(), some);
    warp_band_rows<Numbers, -1>(numbers, work, limits, row_end - 1, split - 1, pool.isa(), some);
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
