#pragma once
// The chart as a report (tools/report/report.h).

#include <string>
#include <vector>

#include "tools/chart/point.h"
#include "tools/chart/report/summary.h"
#include "tools/chart/subject.h"
#include "tools/files/json.h"

namespace softfocus {

struct ChartPage {
  const ChartSubject& subject;
  const std::vector<ChartPanel>& panels;
  const std::vector<BestForBudget>& best;  ///< of these panels
  const std::vector<SummaryRow>& summary;
  std::string size;     ///< "1024x1024"
  std::string command;  ///< that measures this
  std::string machine;  ///< machine_key()
};

/// The plots, the tables, and the pictures of the points that have some. A point's row leads to
/// its pictures. With more than kMostPanels scenes there is no panel a scene and no row a point.
Json chart_report(const ChartPage& page);

}  // namespace softfocus
