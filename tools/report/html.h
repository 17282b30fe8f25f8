#pragma once
// Pieces of HTML: text, cells, pictures.

#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

/// Text as HTML takes it, in quotes too.
std::string html_text(std::string_view text);

std::string decimals(double value, int places);

/// "0.85", "12.3", "1230".
std::string ms_text(double ms);

/// A cell that sorts by its number. NaN and infinity show as a dash.
std::string number_cell(double value, const std::string& text);
std::string number_cell(double value, int places);

/// A cell of HTML that sorts as text.
std::string word_cell(const std::string& html);

/// A table's head: names of columns, those of text first, then those of numbers.
struct Column {
  std::string name;
  bool word = false;
};
std::string table_head(const std::vector<Column>& columns);

/// In a box that scrolls if the screen is narrower.
std::string table_of(const std::string& id, const std::string& head, const std::string& rows);

/// A plot (the text of an SVG file), as wide as the page; narrow screens scroll it.
std::string plot_image(std::string_view svg, const std::string& alt);

}  // namespace softfocus
