#include "dof/disc_layers/disc_ladder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace softfocus {
namespace {

// The areas of a disc in a column of pixels and in the column's middle pixel.
struct ColumnArea {
  double all, middle;
};
ColumnArea column_area(double radius, int dx) {
  constexpr int kSteps = 16;
  ColumnArea area{0.0, 0.0};
  for (int i = 0; i < kSteps; ++i) {
    const double x = dx - 0.5 + (i + 0.5) / kSteps;
    const double square = radius * radius - x * x;
    if (square <= 0.0) continue;
    const double height = 2.0 * std::sqrt(square);
    area.all += height / kSteps;
    area.middle += std::fmin(height, 1.0) / kSteps;
  }
  return area;
}

// In a column all pixels but the ends weigh the same, as the middle one does. Then rows are
// like columns: the outermost columns are a row's ends.
std::vector<LadderSpan> disc_spans(double radius) {
  std::vector<LadderSpan> spans;
  for (int dx = 0;; ++dx) {
    const ColumnArea area = column_area(radius, dx);
    if (area.all == 0.0) return spans;
    const double half = 0.5 * (area.all - area.middle);
    int whole = static_cast<int>(half / area.middle);
    if (dx > 0) whole = std::min(whole, spans.back().whole);
    spans.push_back(
        {whole, static_cast<float>(area.middle), static_cast<float>(half - whole * area.middle)});
  }
}

// The mean of the variances along x and y.
double variance(const std::vector<LadderSpan>& spans) {
  double area = 0.0, moment = 0.0;
  for (std::size_t row = 0; row < spans.size(); ++row) {
    const double rows = row == 0 ? 1.0 : 2.0;
    const double dy = static_cast<double>(row);
    for (int dx = -spans[row].whole - 1; dx <= spans[row].whole + 1; ++dx) {
      const bool last = std::abs(dx) > spans[row].whole;
      const double weight = rows * static_cast<double>(last ? spans[row].end : spans[row].centre);
      area += weight;
      moment += weight * 0.5 * (dx * dx + dy * dy);
    }
  }
  return moment / area;
}

std::vector<LadderSpan> spans_of_variance(double wanted) {
  double low = 0.5, high = 2.0 * std::sqrt(wanted) + 1.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (variance(disc_spans(middle)) < wanted ? low : high) = middle;
  }
  return disc_spans(0.5 * (low + high));
}

// A disc's second moment along an axis is a quarter of its radius squared. In square pixels of
// a level, (1 - 4^-level) / 3 of it come with the size of the pixels: a twelfth by averaging
// 2x2 pixels level by level, a quarter by enlarging with weights of 3/4 and 1/4.
std::vector<LadderSpan> spans_of(double square, int level) {
  const double pixel = std::ldexp(1.0, -2 * level);
  return spans_of_variance(0.25 * square * pixel - (1.0 - pixel) / 3.0);
}

// The disc's sum over 1 everywhere, in the kernels' order of operations.
float area_of(const std::vector<LadderSpan>& spans) {
  float area = 0.0f;
  for (std::size_t dx = 0; dx < spans.size(); ++dx) {
    float whole = 1.0f;
    for (int dy = 1; dy <= spans[dx].whole; ++dy) whole += 1.0f + 1.0f;
    const float column = spans[dx].centre * whole + spans[dx].end * (1.0f + 1.0f);
    area += dx == 0 ? column : column + column;
  }
  return area;
}

double square_of(int rung) {
  return rung == 0 ? 0.0 : std::ldexp(rung % 2 == 1 ? 1.0 : 1.5, (rung - 1) / 2);
}

}  // namespace

std::vector<LevelRungs> make_ladder(float largest_px) {
  std::vector<LevelRungs> levels;
  const double largest = static_cast<double>(largest_px) * static_cast<double>(largest_px);
  int rung = 0;
  do {
    const int level = static_cast<int>(levels.size());
    LevelRungs& rungs = levels.emplace_back();
    const int end = kFineRungs + kLevelRungs * level;
    for (int first = rung; rung < end; ++rung) {
      const double square = square_of(rung), before = rung == 0 ? 0.0 : square_of(rung - 1);
      const RungStep step{static_cast<float>(before), static_cast<float>(1.0 / (square - before))};
      Rung& made = rungs.rungs.emplace_back();
      made.square = static_cast<float>(square);
      made.step = rung == first ? kAlways : step;
      made.spans = rung == 0 ? std::vector{LadderSpan{0, 1.0f, 0.0f}} : spans_of(square, level);
      made.area = area_of(made.spans);
    }
    const double last = square_of(rung - 1);
    rungs.beyond = {static_cast<float>(last), static_cast<float>(1.0 / (square_of(rung) - last))};
  } while (square_of(rung - 1) < largest);
  levels.back().beyond = kNever;
  return levels;
}

}  // namespace softfocus
