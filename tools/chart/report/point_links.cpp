#include "tools/chart/report/point_links.h"

#include "tools/report/html.h"

namespace softfocus {

std::string element_id(const ChartPanel& panel, const ChartPoint& point) {
  return html_text(panel.scene + "-" + entry_id(point.entry));
}

std::string method_link(const ChartPanel& panel, const ChartPoint& point) {
  std::string name = html_text(point.entry.method);
  if (point.pictures.empty()) return name;
  return "<a href=\"#" + element_id(panel, point) + "\">" + name + "</a>";
}

std::string full_name(const ChartPoint& point) {
  const std::string settings = settings_text(point.entry);
  return point.entry.method + (settings.empty() ? "" : ", " + settings);
}

}  // namespace softfocus
