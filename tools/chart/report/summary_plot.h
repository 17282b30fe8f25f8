#pragma once
// The summary over all scenes as a picture, drawn by gnuplot.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tools/chart/report/summary.h"

namespace softfocus {

/// The script that draws the summary into FILE in the `terminal` "svg" or "pngcairo".
///
/// With times: four panels, the median and the worst ratio of FLIP and of HDR-FLIP, over the
/// median time in frames of the pinhole. A line joins the settings of a method.
///
/// Without: two panels, FLIP and HDR-FLIP, a line for each series at its best setting, from its
/// median to its worst, with a mark at the 90th percentile; the least median on top.
std::string summary_script(const std::vector<SummaryRow>& summary, std::string_view terminal,
                           const std::filesystem::path& file);

/// Whether the rows have times.
bool has_times(const std::vector<SummaryRow>& summary);

}  // namespace softfocus
