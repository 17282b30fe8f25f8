#pragma once
// The page's tables.

#include <string>
#include <vector>

#include "tools/chart/point.h"
#include "tools/chart/report/best.h"
#include "tools/chart/report/summary.h"

namespace softfocus {

/// A row for each point and for each scene's noise; the front is marked.
std::string points_table(const std::vector<ChartPanel>& panels);

/// A row for each scene and budget. The panels are those that `best` points into.
std::string best_table(const std::vector<ChartPanel>& panels,
                       const std::vector<BestForBudget>& best);

/// A row for each contender.
std::string summary_table(const std::vector<SummaryRow>& summary);

}  // namespace softfocus
