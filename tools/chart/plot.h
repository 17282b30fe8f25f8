#pragma once
// The chart as a picture: a panel a scene, time across and FLIP upwards, drawn by gnuplot.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tools/chart/point.h"

namespace softfocus {

/// The script that draws the panels into FILE in the `terminal` "svg" or "pngcairo". Each method
/// has a colour and a shape, the same in all panels, with a line along its settings; the front is
/// a grey stair, the noise floor a broken line. Axes are logarithmic, that of FLIP the same in all
/// panels. Needs points with medians, one at least.
std::string plot_script(const std::vector<ChartPanel>& panels, std::string_view terminal,
                        const std::filesystem::path& file);

/// Points of one line: they differ in radius or in the number of samples alone. "two-pass",
/// "two-pass, d3d11".
std::string series_name(const ChartEntry& entry);

}  // namespace softfocus
