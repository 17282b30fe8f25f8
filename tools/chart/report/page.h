#pragma once
// The chart as one page of HTML that needs no other file.

#include <string>
#include <vector>

#include "tools/chart/point.h"
#include "tools/chart/report/best.h"
#include "tools/chart/report/summary.h"
#include "tools/chart/subject.h"

namespace softfocus {

struct ChartPage {
  const ChartSubject& subject;
  const std::vector<ChartPanel>& panels;
  const std::vector<BestForBudget>& best;  ///< of these panels
  const std::vector<SummaryRow>& summary;
  std::string size;         ///< "1024x1024"
  std::string machine;      ///< machine_key()
  std::string summary_svg;  ///< the file's text
  std::string
      first_svg;  ///< of the first error; empty where there are too many scenes, or no times
  std::string second_svg;  ///< likewise
};

/// The plots, the tables, and the pictures of the points that have some. A point's row leads to
/// its pictures. With more than kMostPanels scenes the table of all points is left out.
std::string chart_page(const ChartPage& page);

}  // namespace softfocus
