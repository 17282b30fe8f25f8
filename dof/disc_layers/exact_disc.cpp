#include "dof/disc_layers/exact_disc.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace softfocus {
namespace {

// Half the part of a row of pixels' height that lies in a disc, at each of 16 heights.
constexpr int kHeights = 16;
std::array<double, kHeights> half_widths(double radius_px, int dy) {
  std::array<double, kHeights> widths{};
  for (int i = 0; i < kHeights; ++i) {
    const double y = dy - 0.5 + (i + 0.5) / kHeights;
    const double square = radius_px * radius_px - y * y;
    widths[static_cast<std::size_t>(i)] = square > 0.0 ? std::sqrt(square) : 0.0;
  }
  return widths;
}

}  // namespace

ExactDisc exact_disc(double radius_px) {
  ExactDisc disc;
  for (int dy = 0;; ++dy) {
    const std::array<double, kHeights> widths = half_widths(radius_px, dy);
    const double least = *std::min_element(widths.begin(), widths.end());
    const double largest = *std::max_element(widths.begin(), widths.end());
    if (largest == 0.0) return disc;
    const int whole = static_cast<int>(std::floor(least - 0.5));
    const int outer = std::max(static_cast<int>(std::ceil(largest - 0.5)), 0);
    disc.rows.push_back({whole, outer, disc.covers.size()});
    double row = whole < 0 ? 0.0 : 2.0 * whole + 1.0;
    for (int dx = whole + 1; dx <= outer; ++dx) {
      double cover = 0.0;
      for (const double width : widths) {
        cover += dx == 0 ? std::fmin(2.0 * width, 1.0)
                         : std::fmax(std::fmin(width - dx + 0.5, 1.0), 0.0);
      }
      disc.covers.push_back(cover / kHeights);
      row += (dx == 0 ? 1.0 : 2.0) * cover / kHeights;
    }
    disc.area += dy == 0 ? row : 2.0 * row;
  }
}

}  // namespace softfocus
