#include "tools/chart/report/gnuplot.h"

#include <stdexcept>

#include "tools/cli/platform.h"

namespace softfocus {

void check_gnuplot() {
  // A script that fails where gnuplot was built without one of the two.
  if (run_with_input("gnuplot", "set terminal svg\nset terminal pngcairo\n", Said::dropped)) return;
  throw std::runtime_error(
      "gnuplot, which draws the chart, cannot be run or knows no svg and pngcairo; install it "
      "(Debian: gnuplot-nox)");
}

void run_gnuplot(std::string_view script) {
  if (run_with_input("gnuplot", script, Said::shown)) return;
  throw std::runtime_error("gnuplot failed to draw the chart; what it said stands above");
}

std::string gnuplot_quoted(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    // In single quotes only the quote itself means something; a line's end ends the command.
    if (c == '\'') result += '\'';
    result += c == '\n' || c == '\r' ? ' ' : c;
  }
  return result + "'";
}

}  // namespace softfocus
