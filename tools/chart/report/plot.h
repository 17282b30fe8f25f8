#pragma once
// The chart as a picture: a panel a scene, time across and an error upwards, drawn by gnuplot.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tools/chart/point.h"

namespace softfocus {

/// The script that draws the panels into FILE in the `terminal` "svg" or "pngcairo". Each method
/// has a colour and a shape, the same in all panels, with a line along its settings; the front
/// of time against that error is a grey stair, the noise floor a broken line. Axes are
/// logarithmic, each panel's its own. Needs points with medians, one at least.
std::string plot_script(const std::vector<ChartPanel>& panels, const RankedError& error,
                        std::string_view terminal, const std::filesystem::path& file);

}  // namespace softfocus
