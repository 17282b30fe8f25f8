#pragma once
// gnuplot, a program that draws charts (Debian's package gnuplot-nox), run with a script of ours.

#include <string>
#include <string_view>

namespace softfocus {

/// Throws std::runtime_error, which says how to get it, where gnuplot cannot be run or does not
/// know the kinds of pictures that are wanted.
void check_gnuplot();

/// Runs a script. Throws std::runtime_error if gnuplot does not like it; what it says goes to
/// standard error.
void run_gnuplot(std::string_view script);

/// A text as gnuplot takes it, in quotes.
std::string gnuplot_quoted(std::string_view text);

}  // namespace softfocus
