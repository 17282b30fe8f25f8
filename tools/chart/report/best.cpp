#include "tools/chart/report/best.h"

#include "tools/chart/front.h"

namespace softfocus {
namespace {

/// Null if none is within the budget.
const ChartPoint* best_within(const ChartPanel& panel, double budget, double ChartErrors::*error) {
  const ChartPoint* best = nullptr;
  for (const ChartPoint& point : panel.points) {
    if (point.pinhole_frames > budget) continue;
    const double own = point.errors.*error;
    if (best == nullptr || own < best->errors.*error ||
        (own == best->errors.*error && point.median_ms < best->median_ms)) {
      best = &point;
    }
  }
  return best;
}

}  // namespace

std::vector<BestForBudget> best_for_budgets(const std::vector<ChartPanel>& panels) {
  std::vector<BestForBudget> list;
  for (const ChartPanel& panel : panels) {
    const auto add = [&](double budget) {
      for (std::size_t i = 0; i < panel.ranked.size(); ++i) {
        const ChartPoint* point = best_within(panel, budget, panel.ranked[i].value);
        if (point != nullptr) list.push_back({panel.scene, budget, i, panel.ranked[i], point});
      }
    };
    if (has_times(panel)) {
      for (const double budget : kBudgets) add(budget);
    }
    add(kAnyTime);
  }
  return list;
}

}  // namespace softfocus
