#include "tools/chart/page.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "tools/bench/timing.h"
#include "tools/files/base64.h"

namespace softfocus {
namespace {

constexpr std::string_view kPageStyle = R"(
:root { color-scheme: light dark; --back: #ffffff; --text: #1c1c1e; --faint: #5c5c63;
  --line: #d4d4d8; --band: #f3f3f5; --link: #0b57a8; --best: #fdf3d0; }
@media (prefers-color-scheme: dark) { :root { --back: #17171a; --text: #ececf0; --faint: #a9a9b2;
  --line: #3c3c43; --band: #222227; --link: #8ec1ff; --best: #3d3513; } }
body { margin: 0 auto; max-width: 1560px; padding: 1.5rem; background: var(--back);
  color: var(--text); font: 16px/1.5 system-ui, sans-serif; }
h1, h2, h3 { line-height: 1.2; }
h2 { margin-top: 2.5rem; border-top: 1px solid var(--line); padding-top: 1.5rem; }
h3 { margin: 0 0 .3rem; font-size: 1.05rem; }
p { max-width: 50rem; }
a { color: var(--link); }
img { display: block; max-width: 100%; }
.chart { background: #ffffff; border: 1px solid var(--line); }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .875rem; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .6rem; border-bottom: 1px solid var(--line); text-align: right;
  white-space: nowrap; }
th { position: sticky; top: 0; background: var(--band); vertical-align: bottom; }
th button { all: unset; cursor: pointer; text-decoration: underline dotted; }
th button:focus-visible { outline: 2px solid var(--link); }
.word { text-align: left; }
tr.best td { background: var(--best); }
.points { display: grid; grid-template-columns: repeat(auto-fill, minmax(440px, 1fr)); gap: 1rem; }
.point { border: 1px solid var(--line); padding: .8rem; }
.point:target { outline: 3px solid var(--link); }
.point p { margin: 0 0 .5rem; color: var(--faint); font-size: .875rem; }
.row { display: flex; flex-wrap: wrap; gap: .5rem; margin-bottom: .5rem; }
figure { margin: 0; width: min-content; }
figcaption { color: var(--faint); font-size: .8rem; }
.overview, .crop { max-width: none; }
.overview { width: 205px; }
.crop { image-rendering: pixelated; width: 132px; height: 132px; }
)";

/// A click on a heading sorts by its column, and again the other way round. A cell that has a
/// number keeps it in data-n; cells without one come last.
constexpr std::string_view kPageScript = R"(
const table = document.querySelector('#results'), body = table.tBodies[0];
table.querySelectorAll('th button').forEach((button, column) => {
  button.addEventListener('click', () => {
    const heading = button.parentElement;
    const up = heading.getAttribute('aria-sort') !== 'ascending';
    table.querySelectorAll('th').forEach(other => other.removeAttribute('aria-sort'));
    heading.setAttribute('aria-sort', up ? 'ascending' : 'descending');
    const value = row => {
      const cell = row.cells[column];
      if (heading.classList.contains('word')) return cell.textContent;
      return 'n' in cell.dataset ? Number(cell.dataset.n) : NaN;
    };
    const order = (a, b) => {
      if (typeof a === 'string') return up ? a.localeCompare(b) : b.localeCompare(a);
      if (isNaN(a) || isNaN(b)) return isNaN(a) - isNaN(b);
      return up ? a - b : b - a;
    };
    [...body.rows].sort((a, b) => order(value(a), value(b))).forEach(row => body.append(row));
  });
});
)";

std::string decimals(double value, int places) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", places, value);
  return text.data();
}

std::string ms_text(double ms) { return decimals(ms, ms < 10.0 ? 2 : ms < 100.0 ? 1 : 0); }

/// A cell that sorts by its number. NaN and infinity show as a dash.
std::string number_cell(double value, const std::string& text) {
  if (!std::isfinite(value)) return "<td>\u2013</td>";
  return "<td data-n=\"" + decimals(value, 9) + "\">" + text + "</td>";
}

std::string flip_cell(double flip) { return number_cell(flip, decimals(flip, 4)); }

std::string word_cell(const std::string& html) { return "<td class=\"word\">" + html + "</td>"; }

std::string element_id(const ChartPanel& panel, const ChartPoint& point) {
  return html_text(panel.scene + "-" + entry_id(point.entry));
}

std::string full_name(const ChartPoint& point) {
  const std::string settings = settings_text(point.entry);
  return point.entry.method + (settings.empty() ? "" : ", " + settings);
}

std::string data_image(const std::string& png, const std::string& alt, const char* attributes) {
  return "<img " + std::string{attributes} + " alt=\"" + html_text(alt) +
         "\" src=\"data:image/png;base64," + png + "\">";
}

std::string figure(const std::string& png, const std::string& alt, const std::string& caption,
                   const char* attributes = "class=\"overview\" loading=\"lazy\"") {
  return "<figure>" + data_image(png, alt, attributes) + "<figcaption>" + html_text(caption) +
         "</figcaption></figure>\n";
}

std::string heading_cell(const char* name, bool word = false) {
  return std::string{word ? "<th class=\"word\" scope=\"col\">" : "<th scope=\"col\">"} +
         "<button type=\"button\">" + name + "</button></th>";
}

std::string table_head() {
  std::string head = "<thead><tr>";
  for (const char* word : {"scene", "method", "settings"}) head += heading_cell(word, true);
  for (const char* number : {"frame, ms", "filter, ms", "PSNR, dB", "SSIM", "FLIP", "silhouette",
                             "near", "focus", "far", "rounds"}) {
    head += heading_cell(number);
  }
  return head + "</tr></thead>\n";
}

std::string error_cells(const ChartErrors& errors) {
  std::string cells = number_cell(errors.psnr_db, decimals(errors.psnr_db, 2)) +
                      number_cell(errors.ssim, decimals(errors.ssim, 4)) + flip_cell(errors.flip);
  for (const double flip : errors.flip_by_region) cells += flip_cell(flip);
  return cells;
}

std::string table_row(const ChartPanel& panel, const ChartPoint& point) {
  std::optional<double> filter_ms;
  if (!point.times.filter_ms.empty()) filter_ms = spread_of(point.times.filter_ms).median;
  const auto rounds = static_cast<double>(point.times.frame_ms.size());
  return std::string{point.on_front ? "<tr class=\"best\">" : "<tr>"} +
         word_cell(html_text(panel.scene)) +
         word_cell("<a href=\"#" + element_id(panel, point) + "\">" +
                   html_text(point.entry.method) + "</a>") +
         word_cell(html_text(settings_text(point.entry))) +
         number_cell(point.median_ms, ms_text(point.median_ms)) +
         (filter_ms ? number_cell(*filter_ms, ms_text(*filter_ms)) : number_cell(NAN, "")) +
         error_cells(point.errors) + number_cell(rounds, decimals(rounds, 0)) + "</tr>\n";
}

std::string floor_row(const ChartPanel& panel) {
  return "<tr>" + word_cell(html_text(panel.scene)) + word_cell("noise of the truth") +
         word_cell("half its " + std::to_string(panel.truth_samples) + " samples against half") +
         number_cell(NAN, "") + number_cell(NAN, "") + error_cells(panel.noise_floor) +
         number_cell(NAN, "") + "</tr>\n";
}

std::string table(const std::vector<ChartPanel>& panels) {
  std::string rows;
  for (const ChartPanel& panel : panels) {
    for (const ChartPoint& point : panel.points) rows += table_row(panel, point);
    rows += floor_row(panel);
  }
  return "<div class=\"scroll\"><table id=\"results\">\n" + table_head() + "<tbody>\n" + rows +
         "</tbody></table></div>\n";
}

std::string point_section(const ChartPanel& panel, const ChartPoint& point) {
  const std::string name = full_name(point) + " on " + panel.scene;
  const ChartPictures& pictures = point.pictures;
  const std::string place = std::to_string(point.worst.side) + " pixels at " +
                            std::to_string(point.worst.x) + ", " + std::to_string(point.worst.y);
  constexpr const char* kCrop = "class=\"crop\" loading=\"lazy\"";
  return "<section class=\"point\" id=\"" + element_id(panel, point) + "\">\n<h3>" +
         html_text(full_name(point)) + "</h3>\n<p>" + ms_text(point.median_ms) + " ms, FLIP " +
         decimals(point.errors.flip, 4) +
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

std::string scene_section(const ChartPanel& panel) {
  std::string html = "<h2 id=\"scene-" + html_text(panel.scene) + "\">" + html_text(panel.scene) +
                     "</h2>\n<p>" + html_text(panel.title) + "</p>\n<div class=\"row\">" +
                     figure(panel.truth_picture, "Ground truth of " + panel.scene,
                            "the truth: " + std::to_string(panel.truth_samples) +
                                " points of the lens; FLIP of one half of them against the other " +
                                decimals(panel.noise_floor.flip, 4)) +
                     "</div>\n<div class=\"points\">\n";
  for (const ChartPoint& point : panel.points) html += point_section(panel, point);
  return html + "</div>\n";
}

std::string introduction(const ChartMade& made) {
  return "<p>Each method of depth of field on each scene at " + html_text(made.size) +
         ": how long a whole frame takes, from the drawing to the result, and how far it is from "
         "the ground truth, the mean of pictures from thousands of points of the lens. Medians; "
         "the contenders were run in turn. " +
         html_text(made.machine) +
         ".</p>\n<p>FLIP is what an eye sees when the two pictures alternate: 0 is the same, 1 as "
         "different as can be. In the maps black is right and pale yellow is wrong. The stair "
         "joins what is best for its time, the rows in colour in the table: nothing is both faster "
         "and nearer to the truth. The broken line is the noise of the truth itself: below it no "
         "difference means anything. The rings are auto, which chooses from the others.</p>\n";
}

}  // namespace

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

std::string chart_page(const std::vector<ChartPanel>& panels, std::string_view svg,
                       const ChartMade& made) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Depth of field: speed against accuracy</title>\n<style>";
  html += kPageStyle;
  html += "</style>\n</head>\n<body>\n<h1>Depth of field: speed against accuracy</h1>\n" +
          introduction(made) +
          "<img class=\"chart\" alt=\"Time of a frame against FLIP, a panel for each scene; the "
          "table below has the numbers\" src=\"data:image/svg+xml;base64," +
          base64(std::as_bytes(std::span{svg})) + "\">\n<h2>All numbers</h2>\n" +
          "<p>A click on a heading sorts. FLIP also by region: at silhouettes, nearer than the "
          "focus, in focus, and beyond.</p>\n" +
          table(panels);
  for (const ChartPanel& panel : panels) html += scene_section(panel);
  html += "<script>";
  html += kPageScript;
  return html + "</script>\n</body>\n</html>\n";
}

}  // namespace softfocus
