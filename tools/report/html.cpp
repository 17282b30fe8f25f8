#include "tools/report/html.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <span>

#include "tools/files/base64.h"

namespace softfocus {

std::string html_text(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&': html += "&amp;"; break;
      case '<': html += "&lt;"; break;
      case '>': html += "&gt;"; break;
      case '"': html += "&quot;"; break;
      default: html += c;
    }
  }
  return html;
}

std::string decimals(double value, int places) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", places, value);
  return text.data();
}

std::string ms_text(double ms) { return decimals(ms, ms < 10.0 ? 2 : ms < 100.0 ? 1 : 0); }

std::string number_cell(double value, const std::string& text) {
  if (!std::isfinite(value)) return "<td>\u2013</td>";
  return "<td data-n=\"" + decimals(value, 9) + "\">" + text + "</td>";
}

std::string number_cell(double value, int places) {
  return number_cell(value, decimals(value, places));
}

std::string word_cell(const std::string& html) { return "<td class=\"word\">" + html + "</td>"; }

std::string table_head(const std::vector<Column>& columns) {
  std::string head = "<thead><tr>";
  for (const Column& column : columns) {
    head += column.word ? "<th class=\"word\" scope=\"col\">" : "<th scope=\"col\">";
    head += "<button type=\"button\">" + column.name + "</button></th>";
  }
  return head + "</tr></thead>\n";
}

std::string table_of(const std::string& id, const std::string& head, const std::string& rows) {
  return "<div class=\"scroll\"><table id=\"" + id + "\">\n" + head + "<tbody>\n" + rows +
         "</tbody></table></div>\n";
}

std::string plot_image(std::string_view svg, const std::string& alt) {
  return "<div class=\"scroll\"><img class=\"chart\" alt=\"" + html_text(alt) +
         "\" src=\"data:image/svg+xml;base64," +
         base64(std::as_bytes(std::span{svg.data(), svg.size()})) + "\"></div>\n";
}

}  // namespace softfocus
