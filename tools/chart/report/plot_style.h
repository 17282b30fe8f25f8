#pragma once
// What the plots have in common: size, margins, axes, and a colour and a shape for each series.

#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

/// Room around a panel's axes for what is written there, in pixels.
inline constexpr int kLeft = 92, kRight = 16, kTop = 44, kBottom = 58;

/// Of positive numbers on a logarithmic axis.
struct PlotRange {
  double least = 1e30;
  double most = 0.0;
};

void widen(PlotRange& range, double value);

/// "[a:b]" with some room on both sides.
std::string range_text(const PlotRange& range);

/// Marks at 1, 2 and 5 times the powers of ten.
std::string log_tics();

/// Width and height of a plot, in pixels.
struct PlotSize {
  int width;
  int height;
};

/// The beginning of a script: draws into FILE in the `terminal` "svg" or "pngcairo".
std::string plot_head(std::string_view terminal, const std::string& file, const PlotSize& size);

/// A panel's axes, in pixels from the left and from below.
struct PlotBox {
  int left, right, bottom, top;
};
std::string margins(const PlotBox& box, const PlotSize& size);

/// " with linespoints ..." for the series of that number. auto's points are rings around those of
/// what it chose.
std::string series_style(const std::string& series, std::size_t number);

inline constexpr int kKeyColumns = 5;

/// The height of a key of so many lines, in pixels.
int key_height(std::size_t lines);

/// A line of the key: " with lines ..." and its name.
struct KeyLine {
  std::string style;
  std::string name;
};

/// The key, at the bottom of the plot.
std::string key_script(const std::vector<KeyLine>& lines, const PlotSize& size);

}  // namespace softfocus
