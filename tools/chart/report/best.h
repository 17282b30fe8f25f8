#pragma once
// The best method for each budget of time, scene by scene.

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "tools/chart/point.h"

namespace softfocus {

/// In frames of the scene's pinhole.
inline constexpr std::array kBudgets{1.25, 1.5, 2.0, 3.0, 5.0, 10.0, 50.0};
inline constexpr double kAnyTime = std::numeric_limits<double>::infinity();

struct BestForBudget {
  std::string scene;
  double budget;
  std::size_t rank;  ///< by which of the panel's errors: 0 or 1
  RankedError ranked;
  const ChartPoint* point;
};

/// The contender with the least error within each budget, and in any time; of equal ones the
/// fastest, then the first. Without times only that in any time. Budgets that hold none are left
/// out. The points are those of the panels.
std::vector<BestForBudget> best_for_budgets(const std::vector<ChartPanel>& panels);

}  // namespace softfocus
