#include "scenes/filtered_views/lens_cells.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>
#include <utility>

#include "scenes/lens_views/few_pixel_offsets.h"
#include "scenes/lens_views/lens_points.h"

namespace softfocus {
namespace {

// The sets of up to 256 points are parted after fewer.
constexpr int kRounds = 50;

// Views of full cells, and the most of cells with half as many points.
constexpr int kFewViews = 8;
constexpr int kMostSpreadViews = 32;
constexpr int kFewCellPoints = 16;
static_assert(kMostSpreadViews * kFewCellPoints <= kMostLensPointsOfSet);

double square(glm::dvec2 v) { return v.x * v.x + v.y * v.y; }

// The points, and the view of each.
struct Parted {
  std::vector<glm::dvec2> points;
  std::vector<std::size_t> cell_of;
  std::vector<glm::dvec2> views;
};

// Pairs of a point and a cell, the nearest first; a cell that is full takes no more.
void assign(Parted& parted, std::size_t per_cell) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  pairs.reserve(parted.points.size() * parted.views.size());
  for (std::size_t i = 0; i < parted.points.size(); ++i) {
    for (std::size_t cell = 0; cell < parted.views.size(); ++cell) {
      pairs.emplace_back(square(parted.points[i] - parted.views[cell]), i, cell);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::fill(parted.cell_of.begin(), parted.cell_of.end(), kNone);
  std::vector<std::size_t> taken(parted.views.size());
  for (const auto& [distance, i, cell] : pairs) {
    if (parted.cell_of[i] != kNone || taken[cell] == per_cell) continue;
    parted.cell_of[i] = cell;
    ++taken[cell];
  }
}

// Two points change places where that brings them nearer to their views. With points a and b of
// views A and B that is (a - b) (A - B) < 0.
bool exchange(Parted& parted) {
  bool changed = false;
  for (std::size_t i = 0; i < parted.points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const glm::dvec2 apart = parted.points[i] - parted.points[j];
      const glm::dvec2 views = parted.views[parted.cell_of[i]] - parted.views[parted.cell_of[j]];
      if (apart.x * views.x + apart.y * views.y >= -1e-12) continue;
      std::swap(parted.cell_of[i], parted.cell_of[j]);
      changed = true;
    }
  }
  return changed;
}

}  // namespace

int points_of_cell(int views) {
  return views <= kFewViews ? kMostCellPoints : views <= kMostSpreadViews ? kFewCellPoints : 1;
}

LensCells lens_cells(ApertureShape shape, int views, int per_cell, bool jitter) {
  assert(views >= 1 && per_cell >= 1);
  LensCells cells;
  cells.per_cell = per_cell;
  if (per_cell == 1) {
    cells.views = lens_points_for(shape, views);
    cells.points.assign(cells.views.size(), glm::dvec2{0.0});
    cells.in_pixel = view_offsets(jitter, cells.views);
    return cells;
  }
  Parted parted{few_lens_points(shape, views * per_cell), {}, few_lens_points(shape, views)};
  parted.cell_of.resize(parted.points.size());
  assign(parted, static_cast<std::size_t>(per_cell));
  for (int round = 0; round < kRounds && exchange(parted); ++round) {
  }
  cells.views = parted.views;
  cells.in_pixel = view_offsets(jitter, cells.views);
  for (std::size_t cell = 0; cell < parted.views.size(); ++cell) {
    for (std::size_t i = 0; i < parted.points.size(); ++i) {
      if (parted.cell_of[i] == cell) {
        cells.points.push_back(parted.points[i] - parted.views[cell]);
      }
    }
  }
  return cells;
}

double least_step_px(const LensCells& cells) {
  const bool jitter = std::any_of(cells.in_pixel.begin(), cells.in_pixel.end(),
                                  [](glm::dvec2 offset) { return offset != glm::dvec2{0.0}; });
  const std::size_t views = cells.views.size();
  if (jitter || views <= kFewViews) return 2.6 / std::sqrt(static_cast<double>(cells.per_cell));
  return views <= 2 * kFewViews ? 1.3 : 1.5;
}

std::span<const glm::dvec2> points_of(const LensCells& cells, int cell) {
  const auto count = static_cast<std::size_t>(cells.per_cell);
  return std::span{cells.points}.subspan(static_cast<std::size_t>(cell) * count, count);
}

}  // namespace softfocus
