#pragma once
// Texels that rows put into columns, moved within the columns, from row to row.

#include <algorithm>
#include <array>
#include <vector>

#include "scenes/relief/warp/resample_rows.h"

namespace softfocus {

/// Columns that a task takes.
inline constexpr int kBandColumns = 64;

/// The texels that a row put into some columns, from the first on. A colour of 0 is none.
template <class Numbers>
struct ColumnTexels {
  const typename Numbers::Place* place;
  const typename Numbers::Depth* depth;
  const std::uint32_t* colour;

  WalkTexel<Numbers> at(int i) const { return {place[i], 0, depth[i], colour[i]}; }
};

/// Texels of a column's walk, into the warped picture.
template <class Numbers>
struct ColumnPut {
  const Numbers& numbers;
  const WarpWork& work;
  CountedPieces& counted;
  int x;

  void operator()(int y, std::uint32_t colour, typename Numbers::Place,
                  typename Numbers::Depth depth, bool stretched) const {
    const std::size_t at = work.at(x, y - work.place.y_begin);
    counted.add(work.warped.colours[at], stretched);
    work.warped.colours[at] = colour;
    work.warped.depths_m[at] = numbers.metres(depth);
  }
};

/// One step of `count` columns from `x_begin` on, kBandColumns at the most, from a row's texels to
/// the next row's. `is_other(i)` leaves a column to `other(i)`.
template <class Numbers, int sign, class IsOther, class Other>
void step_columns(const Numbers& numbers, const WarpWork& work, int x_begin, int count,
                  const ColumnTexels<Numbers>& from, const ColumnTexels<Numbers>& to, Isa isa,
                  CountedPieces& counted, const IsOther& is_other, const Other& other) {
  const WalkLimits rows = work.rows();
  const auto step_alone = [&](int i) {
    step<Numbers, sign>(numbers, from.colour[i] != 0, from.at(i), to.colour[i] != 0, to.at(i), rows,
                        ColumnPut<Numbers>{numbers, work, counted, x_begin + i});
  };
  if constexpr (std::is_same_v<Numbers, FloatPlaces>) {
    if (isa != Isa::scalar && !counted.wanted) {
      std::array<std::int32_t, kBandColumns> reached;
      std::array<std::uint32_t, kBandColumns> colours;
      std::array<float, kBandColumns> across, depths;
      step_texels({from.place, to.place, from.place, to.place, from.depth, to.depth, from.colour,
                   to.colour},
                  {numbers.warp, numbers.most_m, sign, 0, false, false}, count,
                  {reached.data(), colours.data(), across.data(), depths.data()}, isa);
      for (int i = 0; i < count; ++i) {
        if (is_other(i)) {
          other(i);
          continue;
        }
        const auto column = static_cast<std::size_t>(i);
        const std::int32_t y = reached[column];
        if (y == kNoTexel) continue;
        if (y == kOtherStep) {
          step_alone(i);
        } else if (y >= rows.begin && y < rows.end) {
          const std::size_t at = work.at(x_begin + i, y - work.place.y_begin);
          work.warped.colours[at] = colours[column];
          work.warped.depths_m[at] = depths[column];
        }
      }
      return;
    }
  }
  for (int i = 0; i < count; ++i) {
    if (is_other(i)) {
      other(i);
    } else {
      step_alone(i);
    }
  }
}

/// The texels that a row put into a band's columns: the first of each, and the last if there were
/// more.
template <class Numbers>
struct BandRow {
  explicit BandRow(std::size_t columns)
      : places{{std::vector<typename Numbers::Place>(columns),
                std::vector<typename Numbers::Place>(columns)}},
        depths{{std::vector<typename Numbers::Depth>(columns),
                std::vector<typename Numbers::Depth>(columns)}},
        colours{{std::vector<std::uint32_t>(columns), std::vector<std::uint32_t>(columns)}} {}
  std::array<std::vector<typename Numbers::Place>, 2> places;
  std::array<std::vector<typename Numbers::Depth>, 2> depths;
  std::array<std::vector<std::uint32_t>, 2> colours;

  void clear() {
    for (std::vector<std::uint32_t>& of : colours) std::fill(of.begin(), of.end(), 0u);
  }
  void put(std::size_t column, const WalkTexel<Numbers>& texel) {
    const std::size_t layer = colours[0][column] == 0 ? 0 : 1;
    places[layer][column] = texel.along;
    depths[layer][column] = texel.depth;
    colours[layer][column] = texel.colour;
  }
  WalkTexel<Numbers> at(std::size_t layer, std::size_t column) const {
    return {places[layer][column], 0, depths[layer][column], colours[layer][column]};
  }
  ColumnTexels<Numbers> first_layer(int begin) const {
    return {places[0].data() + begin, depths[0].data() + begin, colours[0].data() + begin};
  }
};

/// The step of a column into which a row put two surfaces. Each texel is joined to the one of the
/// row before whose depth is nearer, unless it moved behind it or too far away.
template <class Numbers, int sign>
void step_two_layers(const Numbers& numbers, const WarpWork& work, const BandRow<Numbers>& from,
                     const BandRow<Numbers>& to, std::size_t column,
                     const ColumnPut<Numbers>& put) {
  constexpr std::size_t kNone = 2;
  const WalkLimits rows = work.rows();
  std::array<std::size_t, 2> joined{kNone, kNone};
  std::array<bool, 2> goes_on{};
  for (std::size_t layer = 0; layer < 2 && to.colours[layer][column] != 0; ++layer) {
    const WalkTexel<Numbers> texel = to.at(layer, column);
    typename Numbers::Depth nearest{};
    for (std::size_t end = 0; end < 2 && from.colours[end][column] != 0; ++end) {
      const auto step_of_depth = from.depths[end][column] - texel.depth;
      const auto away = step_of_depth < 0 ? -step_of_depth : step_of_depth;
      if (joined[layer] != kNone && away >= nearest) continue;
      joined[layer] = end;
      nearest = away;
    }
    if (joined[layer] != kNone) {
      const auto way = sign * (texel.along - from.places[joined[layer]][column]);
      if (way < 0 || way > numbers.join_texels) joined[layer] = kNone;
    }
    if (joined[layer] != kNone) goes_on[joined[layer]] = true;
  }
  for (std::size_t end = 0; end < 2 && from.colours[end][column] != 0; ++end) {
    if (goes_on[end]) continue;
    step<Numbers, sign>(numbers, true, from.at(end, column), false, {}, rows, put);
  }
  for (std::size_t layer = 0; layer < 2 && to.colours[layer][column] != 0; ++layer) {
    const bool is_joined = joined[layer] != kNone;
    step<Numbers, sign>(numbers, is_joined, from.at(is_joined ? joined[layer] : 0, column), true,
                        to.at(layer, column), rows, put);
  }
}

}  // namespace softfocus
