#include "tools/chart/report/page.h"

#include <algorithm>
#include <cmath>

#include "tools/chart/pictures.h"
#include "tools/chart/report/page_style.h"
#include "tools/chart/report/page_tables.h"
#include "tools/chart/report/point_links.h"
#include "tools/chart/report/summary_plot.h"
#include "tools/report/html.h"

namespace softfocus {
namespace {

std::string data_image(const std::string& png, const std::string& alt, const char* attributes) {
  return "<img " + std::string{attributes} + " alt=\"" + html_text(alt) +
         "\" src=\"data:image/png;base64," + png + "\">";
}

std::string figure(const std::string& png, const std::string& alt, const std::string& caption,
                   const char* attributes = "class=\"overview\" loading=\"lazy\"") {
  return "<figure>" + data_image(png, alt, attributes) + "<figcaption>" + html_text(caption) +
         "</figcaption></figure>\n";
}

std::string times_text(const ChartPoint& point) {
  if (std::isnan(point.median_ms)) return "";
  return ms_text(point.median_ms) + " ms, ";
}

std::string error_text(const RankedError& error, const ChartPoint& point) {
  return std::string{error.title} + " " + decimals(point.errors.*error.value, error.places);
}

std::string point_section(const ChartPanel& panel, const ChartPoint& point) {
  const std::string name = full_name(point) + " on " + panel.scene;
  const ChartPictures& pictures = point.pictures;
  const std::string place = std::to_string(point.worst.side) + " pixels at " +
                            std::to_string(point.worst.x) + ", " + std::to_string(point.worst.y);
  constexpr const char* kCrop = "class=\"crop\" loading=\"lazy\"";
  return "<section class=\"point\" id=\"" + element_id(panel, point) + "\">\n<h3>" +
         html_text(full_name(point)) + "</h3>\n<p>" + times_text(point) +
         error_text(panel.ranked[0], point) + ", " + error_text(panel.ranked[1], point) +
         (point.on_front ? ": nothing is both faster and nearer to the truth" : "") +
         "</p>\n<div class=\"row\">" +
         figure(pictures.picture, "Picture by " + name, "the picture") +
         figure(pictures.error, "Map of the FLIP error of " + name, "its error") +
         "</div>\n<div class=\"row\">" +
         figure(pictures.worst, "Worst part of the picture by " + name, "worst: " + place, kCrop) +
         figure(pictures.worst_truth, "The ground truth of that part", "the truth there", kCrop) +
         figure(pictures.worst_error, "Map of the FLIP error of that part", "the error there",
                kCrop) +
         "</div>\n</section>\n";
}

std::string truth_caption(const ChartPage& page, const ChartPanel& panel) {
  if (page.subject.truth_of != nullptr) return "the truth, calculated";
  return "the truth: " + std::to_string(panel.truth_samples) + " " +
         std::string{page.subject.sample} + "; FLIP of one half of them against the other " +
         decimals(panel.noise_floor.flip, 4);
}

std::string scene_section(const ChartPage& page, const ChartPanel& panel) {
  std::string html =
      "<h2 id=\"scene-" + html_text(panel.scene) + "\">" + html_text(panel.scene) + "</h2>\n<p>" +
      html_text(panel.title) + "</p>\n<div class=\"row\">" +
      figure(panel.truth_picture, "Ground truth of " + panel.scene, truth_caption(page, panel)) +
      "</div>\n<div class=\"points\">\n";
  for (const ChartPoint& point : panel.points) {
    if (!point.pictures.empty()) html += point_section(panel, point);
  }
  return html + "</div>\n";
}

std::string introduction(const ChartPage& page) {
  std::string html = "<p>Each method on " + std::to_string(page.panels.size()) +
                     (page.panels.size() == 1 ? " scene" : " scenes") + " at " +
                     html_text(page.size) + ": how far its picture is from the ground truth, " +
                     std::string{page.subject.truth};
  if (has_times(page.summary)) {
    html +=
        ", and how long a whole frame takes, from the drawing to the result. Times are "
        "medians; the contenders were run in turn. A pinhole frame is the time of the scene's "
        "sharp picture";
  }
  return html + ". " + html_text(page.machine) + ".</p>\n<p>" + std::string{page.subject.measure} +
         " FLIP is what an eye sees when the two pictures alternate: 0 is the same, 1 as "
         "different as can be. It cuts light to 1, as a screen does; HDR-FLIP is the largest FLIP "
         "over all exposures, and sees highlights.</p>\n";
}

std::string summary_part(const ChartPage& page) {
  std::string html = "<h2>All scenes</h2>\n<p>";
  if (has_times(page.summary)) {
    html +=
        "The ratio is a contender's error over the least error that any contender reaches in "
        "its time or less: 1 is the best for its time. ";
  }
  return html + "In colour: each method at the setting with its least " +
         std::string{page.summary.front().ranked[0].title} +
         ", scene by scene. 90 %: nine scenes of ten have at most this.</p>\n" +
         plot_image(page.summary_svg,
                    "Each method over all scenes; the table below has the "
                    "numbers") +
         summary_table(page.summary);
}

std::string chart_part(const ChartPage& page) {
  if (page.first_svg.empty()) return "";
  const RankedErrors& ranked = page.panels.front().ranked;
  return "<h2>Scene by scene</h2>\n<p>The stair joins what is best for its time: nothing is both "
         "faster and nearer to the truth. The broken line is the noise of the truth itself: below "
         "it no difference means anything. The rings are auto, which chooses from the "
         "others.</p>\n" +
         plot_image(page.first_svg, "Time of a frame against " + std::string{ranked[0].title} +
                                        ", a panel for each scene; the table below has the "
                                        "numbers") +
         plot_image(page.second_svg, "Time of a frame against " + std::string{ranked[1].title} +
                                         ", a panel for each scene");
}

std::string best_part(const ChartPage& page) {
  return "<h2>Best within a budget</h2>\n<p>The method and setting with the least error of those "
         "that take at most so many pinhole frames.</p>\n" +
         best_table(page.panels, page.best);
}

std::string numbers_part(const ChartPage& page) {
  if (page.panels.size() > kMostPanels) {
    return "<h2>All numbers</h2>\n<p>They are in chart.csv and chart.json.</p>\n";
  }
  return "<h2>All numbers</h2>\n<p>A click on a heading sorts. Errors also by region: at "
         "silhouettes, nearer than the focus, in focus, and beyond. Rows in colour are best for "
         "their time.</p>\n" +
         points_table(page.panels);
}

std::string pictures_part(const ChartPage& page) {
  std::string html = "<h2>Pictures</h2>\n<p>" + pictured_text(page.panels) +
                     " In the maps black is right and pale yellow is wrong.</p>\n";
  for (const ChartPanel& panel : page.panels) {
    if (!panel.truth_picture.empty()) html += scene_section(page, panel);
  }
  return html;
}

}  // namespace

std::string chart_page(const ChartPage& page) {
  const std::string heading = std::string{page.subject.title} + ": speed against accuracy";
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>" +
      heading + "</title>\n<style>";
  html += kPageStyle;
  html += "</style>\n</head>\n<body>\n<h1>" + heading + "</h1>\n" + introduction(page) +
          summary_part(page) + chart_part(page) + best_part(page) + numbers_part(page) +
          pictures_part(page) + "<script>";
  html += kPageScript;
  return html + "</script>\n</body>\n</html>\n";
}

}  // namespace softfocus
