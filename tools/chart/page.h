#pragma once
// The chart as one page of HTML that needs no other file.

#include <string>
#include <string_view>
#include <vector>

#include "tools/chart/point.h"

namespace softfocus {

/// What the page says of how it was made.
struct ChartMade {
  std::string size;     ///< "1024x1024"
  std::string machine;  ///< machine_key()
};

/// The chart (`svg`, the file's text), the table, and for each point its pictures. A row of
/// the table leads to the point's pictures.
std::string chart_page(const std::vector<ChartPanel>& panels, std::string_view svg,
                       const ChartMade& made);

/// Text as HTML takes it, in quotes too.
std::string html_text(std::string_view text);

}  // namespace softfocus
