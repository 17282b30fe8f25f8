#include "scenes/relief/warp/resample.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <type_traits>
#include <utility>

#include "raster/threads/loops.h"
#include "scenes/relief/warp/resample_columns.h"

namespace softfocus {
namespace {

WarpCounts total_of(std::span<const CountedPieces> all) {
  WarpCounts total;
  for (const CountedPieces& some : all) {
    total.pieces += some.counts.pieces;
    total.overlaps += some.counts.overlaps;
    total.stretched += some.counts.stretched;
  }
  return total;
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
               typename RowOf<Numbers>::Type& row, CountedPieces& counted) {
  std::uint32_t* colours = work.warped.row_colours.data();
  typename Numbers::Place* places = places_of<Numbers>(work.warped).data();
  typename Numbers::Depth* depths = depths_of<Numbers>(work.warped).data();
  const int line = v - work.extent.y_begin;
  std::fill_n(colours + work.at(work.place.x_begin, line), work.place.width, 0u);
  put_row(numbers, work, work.resampling, v, work.columns(), isa, row,
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
void warp_columns(const Numbers& numbers, const WarpWork& work, const WalkLimits& limits,
                  int row_begin, int row_end, Isa isa, CountedPieces& counted) {
  const BandRow<Numbers> nothing{static_cast<std::size_t>(kBandColumns)};
  const auto row_of = [&](int v, bool is_there) {
    if (!is_there) return nothing.first_layer(0);
    const std::size_t at = work.at(limits.begin, v - work.extent.y_begin);
    return ColumnTexels<Numbers>{places_of<Numbers>(work.warped).data() + at,
                                 depths_of<Numbers>(work.warped).data() + at,
                                 work.warped.row_colours.data() + at};
  };
  // One row more, of nothing, ends the runs.
  for (int v = row_begin; sign * v <= sign * row_end; v += sign) {
    step_columns<Numbers, sign>(
        numbers, work, limits.begin, limits.end - limits.begin, row_of(v - sign, v != row_begin),
        row_of(v, v != row_end), isa, counted, [](int) { return false; }, [](int) {});
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
  for_each_band(pool, rows, kRows, [&](int first, int end) {
    typename RowOf<Numbers>::Type memory{work.relief.width};
    for (int row = first; row < end; ++row) {
      warp_rows(numbers, work, work.extent.y_begin + row, pool.isa(), memory,
                counted[static_cast<std::size_t>(row)]);
    }
  });
  const WalkLimits columns = work.columns();
  const HalfWalks walks =
      half_walks(work.extent.y_begin, work.extent.y_end, work.warp.epipole_v, work.warp.outwards);
  pool.for_each(bands, [&](int band) {
    const int begin = columns.begin + band * kBandColumns;
    const WalkLimits limits{begin, std::min(begin + kBandColumns, columns.end)};
    clear_columns(work, limits);
    CountedPieces& some = counted[static_cast<std::size_t>(rows + band)];
    warp_columns<Numbers, 1>(numbers, work, limits, walks.forward.begin, walks.forward.end,
                             pool.isa(), some);
    warp_columns<Numbers, -1>(numbers, work, limits, walks.backward.begin, walks.backward.end,
                              pool.isa(), some);
  });
  return total_of(counted);
}

// --- one pass ---

/// Rows into a band of columns, each at once.
template <class Numbers, int sign>
void warp_band_rows(const Numbers& numbers, const WarpWork& work, const WalkLimits& limits,
                    int row_begin, int row_end, Isa isa, CountedPieces& counted) {
  const int columns = limits.end - limits.begin;
  typename RowOf<Numbers>::Type row{work.relief.width};
  BandRow<Numbers> from{static_cast<std::size_t>(columns)}, to = from;
  for (int v = row_begin; sign * v <= sign * row_end; v += sign) {
    to.clear();
    std::int64_t covered = 0;
    if (v != row_end) {
      put_row(numbers, work, Resampling::asymmetric, v, limits, isa, row,
              [&](int x, const WalkTexel<Numbers>& texel, bool) {
                const auto column = static_cast<std::size_t>(x - limits.begin);
                covered += to.colours[1][column] != 0 ? 1 : 0;
                to.put(column, texel);
              });
    }
    counted.counts.overlaps += covered;
    for (int begin = 0; begin < columns; begin += kBandColumns) {
      const auto column_of = [&](int i) { return static_cast<std::size_t>(begin + i); };
      step_columns<Numbers, sign>(
          numbers, work, limits.begin + begin, std::min(kBandColumns, columns - begin),
          from.first_layer(begin), to.first_layer(begin), isa, counted,
          [&](int i) { return (from.colours[1][column_of(i)] | to.colours[1][column_of(i)]) != 0; },
          [&](int i) {
            step_two_layers<Numbers, sign>(numbers, work, from, to, column_of(i),
                                           {numbers, work, counted, limits.begin + begin + i});
          });
    }
    std::swap(from, to);
  }
}

template <class Numbers>
WarpCounts warp_in_one_pass(const Numbers& numbers, const WarpWork& work, bool counting,
                            ThreadPool& pool) {
  const WalkLimits columns = work.columns();
  // Each band walks all rows, and puts what falls into it.
  const int bands = std::min(pool.threads(), work.place.width);
  const HalfWalks walks =
      half_walks(work.extent.y_begin, work.extent.y_end, work.warp.epipole_v, work.warp.outwards);
  std::vector<CountedPieces> counted(static_cast<std::size_t>(bands), {{}, counting});
  pool.for_each(bands, [&](int band) {
    const auto border = [&](int i) { return columns.begin + work.place.width * i / bands; };
    const WalkLimits limits{border(band), border(band + 1)};
    clear_columns(work, limits);
    CountedPieces& some = counted[static_cast<std::size_t>(band)];
    warp_band_rows<Numbers, 1>(numbers, work, limits, walks.forward.begin, walks.forward.end,
                               pool.isa(), some);
    warp_band_rows<Numbers, -1>(numbers, work, limits, walks.backward.begin, walks.backward.end,
                                pool.isa(), some);
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
  Ends u{HUGE_VAL, -HUGE_VAL}, v = u;
  const auto widen = [](Ends& ends, double place) {
    ends.low = std::fmin(ends.low, place);
    ends.high = std::fmax(ends.high, place);
  };
  // Places go one way with the depth, and with the texel.
  for (const int code : {extent.least_code, extent.most_code}) {
    const double depth_m = static_cast<double>(code) * depth_step(relief);
    const WarpedPlace first =
        exact_place(warp, extent.x_begin - 0.5, extent.y_begin - 0.5, depth_m);
    const WarpedPlace last = exact_place(warp, extent.x_end - 0.5, extent.y_end - 0.5, depth_m);
    for (const WarpedPlace& place : {first, last}) {
      widen(u, place.u);
      widen(v, place.v);
    }
  }
  if (!(u.high - u.low <= kMostStretch * relief.width &&
        v.high - v.low <= kMostStretch * relief.height && std::fabs(u.low) < kFarthestPlace &&
        std::fabs(v.low) < kFarthestPlace)) {
    return std::nullopt;
  }
  const auto whole = [](double place) { return static_cast<int>(std::floor(place)); };
  const int x = whole(u.low) - 1, y = whole(v.low) - 1;
  return PlaneRectangle{x, y, whole(u.high) + 3 - x, whole(v.high) + 3 - y};
}

void warp_relief(const ReliefTexture& relief, const ReliefExtent& extent, glm::dvec3 eye,
                 const PlaneRectangle& place, const WarpRule& rule, WarpedRelief& warped,
                 ThreadPool& pool, WarpCounts* counts) {
  assert(sees_front(relief, eye) && rule.join_texels >= 2.0);
  const PreWarp warp = pre_warp(relief, eye);
  const std::size_t texels =
      static_cast<std::size_t>(place.width) * static_cast<std::size_t>(place.height);
  warped.place = place;
  warped.colours.resize(texels);
  warped.depths_m.resize(texels);
  const WarpWork work{relief, extent, warp, place, rule.resampling, warped};
  WarpCounts counted;
  if (rule.numbers == PlaceNumbers::floats) {
    const float most_m = static_cast<float>(last_depth(relief.depth_bits)) * warp.step_m;
    counted = warp_by(FloatPlaces{warp, most_m, static_cast<float>(rule.join_texels)}, work,
                      counts != nullptr, pool);
  } else {
    const std::vector<FixedDepth> table = fixed_warp_table(warp, relief.depth_bits);
    const DepthShares share = shares_of(warp, static_cast<double>(warp.step_m));
    counted = warp_by(FixedPlaces{table.data(), last_depth(relief.depth_bits), warp.step_m,
                                  std::llrint(share.v * 0x1p40), std::llrint(share.scale * 0x1p32),
                                  static_cast<std::int32_t>(rule.join_texels * 256.0)},
                      work, counts != nullptr, pool);
  }
  if (counts != nullptr) *counts = counted;
}

}  // namespace softfocus
