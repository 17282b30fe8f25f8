#include "tools/stress/stress_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "tools/cli/option_values.h"
#include "tools/report/html.h"
#include "tools/stress/curve_svg.h"
#include "tools/stress/stress_report.h"

namespace softfocus {
namespace {

constexpr std::string_view kAtlasStyle = R"(
:root { color-scheme: light dark; --back: #ffffff; --text: #1c1c1e; --faint: #5c5c63;
  --line: #d4d4d8; --band: #f3f3f5; --link: #0b57a8; --limit: #b3261e; --own: #0b57a8; }
@media (prefers-color-scheme: dark) { :root { --back: #17171a; --text: #ececf0; --faint: #a9a9b2;
  --line: #3c3c43; --band: #222227; --link: #8ec1ff; --limit: #ff8a80; --own: #8ec1ff; } }
body { margin: 0 auto; max-width: 1640px; padding: 1.5rem; background: var(--back);
  color: var(--text); font: 16px/1.5 system-ui, sans-serif; }
h1, h2, h3 { line-height: 1.2; }
h2 { margin-top: 2.5rem; border-top: 1px solid var(--line); padding-top: 1.5rem; }
h3 { margin: 0 0 .3rem; font-size: 1rem; }
p { max-width: 50rem; }
a { color: var(--link); }
.scroll { overflow-x: auto; }
table { border-collapse: separate; border-spacing: 2px; font-size: .8rem; }
th { text-align: left; font-weight: 600; white-space: nowrap; padding: .2rem .4rem; }
thead th { vertical-align: bottom; }
thead span { writing-mode: vertical-rl; transform: rotate(180deg); }
td { text-align: center; white-space: nowrap; padding: .15rem .4rem; }
td a { color: inherit; text-decoration: none; }
td a:hover, td a:focus-visible { text-decoration: underline; }
.g0 { background: #1a7f4b; color: #ffffff; } .g1 { background: #8fd3a8; color: #10301c; }
.g2 { background: #d3ecb9; color: #1f2d10; } .w1 { background: #ffe08a; color: #3a2c00; }
.w2 { background: #f6a45c; color: #3b1c00; } .w3 { background: #d6493a; color: #ffffff; }
.w4 { background: #7d1420; color: #ffffff; } .none { color: var(--faint); }
.key span { padding: .1rem .5rem; margin-right: .3rem; }
.methods { display: grid; grid-template-columns: repeat(auto-fill, minmax(430px, 1fr)); gap: 1rem; }
.method { border: 1px solid var(--line); padding: .7rem; }
.method:target { outline: 3px solid var(--link); }
.method p { margin: 0 0 .4rem; color: var(--faint); font-size: .85rem; }
.row { display: flex; flex-wrap: wrap; gap: .5rem; margin-bottom: .5rem; }
figure { margin: 0; width: min-content; }
figcaption { color: var(--faint); font-size: .8rem; }
img, .truth { display: block; width: 128px; height: 128px; outline: 1px solid var(--line);
  image-rendering: pixelated; }
.curve { display: block; width: 100%; max-width: 430px; }
text { fill: var(--faint); font: 11px system-ui, sans-serif; }
.axis { stroke: var(--faint); fill: none; } .grid { stroke: var(--line); }
.limit { stroke: var(--limit); stroke-width: 1.5; stroke-dasharray: 5 3; }
.other { stroke: var(--line); fill: none; }
.noise { stroke: var(--faint); fill: none; stroke-dasharray: 1 3; }
.own { stroke: var(--own); stroke-width: 2; fill: none; }
.right { fill: var(--own); } .wrong { fill: var(--limit); }
)";

/// Colours of the table, by how far from the limit.
struct Grade {
  double up_to;  ///< the worst value over the limit
  const char* colour;
  const char* meaning;
};
constexpr std::array kGrades{Grade{0.1, "g0", "a tenth of the limit at most"},
                             Grade{0.5, "g1", "half the limit at most"},
                             Grade{1.0, "g2", "within the limit"},
                             Grade{2.0, "w1", "up to twice the limit"},
                             Grade{5.0, "w2", "up to five times"},
                             Grade{20.0, "w3", "up to twenty times"},
                             Grade{std::numeric_limits<double>::infinity(), "w4", "more"}};

const Grade& grade_of(double ratio) {
  return *std::find_if(kGrades.begin(), kGrades.end(),
                       [&](const Grade& grade) { return ratio <= grade.up_to; });
}

std::string text_of(std::string_view view) { return html_text(view); }

std::string cell_id(const StressResult& result, const StressCurve& curve) {
  return std::string{result.of.name} + "-" + curve.method;
}

std::string table_cell(const StressResult& result, const StressCurve& curve) {
  if (!curve.can_run) {
    return "<td class=\"none\" title=\"the case is a picture; this method needs a scene\">"
           "\u2013</td>";
  }
  const double ratio = worst_ratio(result, curve);
  const std::string worst = std::isfinite(ratio)
                                ? "worst: " + short_number(ratio) + " times the limit"
                                : "no limit holds";
  return std::string{"<td class=\""} + grade_of(ratio).colour + "\" title=\"" + worst +
         "\"><a href=\"#" + cell_id(result, curve) + "\">" + failing_text(result, curve) +
         "</a></td>";
}

std::string atlas_table(const StressFindings& findings) {
  std::string html = "<div class=\"scroll\"><table><thead><tr><th>case</th><th>fails by</th>";
  for (const StressCurve& curve : findings.results.front().curves) {
    html += "<th scope=\"col\"><span>" + html_text(curve.method) + "</span></th>";
  }
  html += "</tr></thead><tbody>\n";
  for (const StressResult& result : findings.results) {
    const StressCase& of = result.of;
    html += "<tr><th scope=\"row\"><a href=\"#" + text_of(of.name) + "\">" + text_of(of.name) +
            "</a></th><td>" + text_of(of.parameter.name) + ", " + text_of(of.parameter.unit) +
            "</td>";
    for (const StressCurve& curve : result.curves) html += table_cell(result, curve);
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string colour_key() {
  std::string html = "<p class=\"key\">The worst value of the sweep: ";
  for (const Grade& grade : kGrades) {
    html += std::string{"<span class=\""} + grade.colour + "\">" + grade.meaning + "</span>";
  }
  return html + "</p>\n";
}

std::string atlas_figure(const std::string& png, const std::string& alt,
                         const std::string& caption) {
  return "<figure><img loading=\"lazy\" alt=\"" + html_text(alt) +
         "\" src=\"data:image/png;base64," + png + "\"><figcaption>" + html_text(caption) +
         "</figcaption></figure>";
}

/// The truth once in the page, for all methods of the case to show.
std::string shared_truth(const StressResult& result) {
  return "<svg width=\"0\" height=\"0\" aria-hidden=\"true\"><defs><image id=\"truth-" +
         std::string{result.of.name} +
         "\" width=\"128\" height=\"128\" href=\"data:image/png;base64," + result.truth +
         "\"/></defs></svg>\n";
}

std::string truth_again(const StressResult& result) {
  return "<figure><svg class=\"truth\" viewBox=\"0 0 128 128\" role=\"img\" aria-label=\"The "
         "truth\"><use "
         "href=\"#truth-" +
         std::string{result.of.name} + "\"/></svg><figcaption>the truth</figcaption></figure>";
}

std::string method_section(const StressResult& result, const StressCurve& curve) {
  const std::string on = curve.method + " on " + std::string{result.of.name};
  return "<section class=\"method\" id=\"" + cell_id(result, curve) + "\"><h3>" +
         html_text(curve.method) + (first_failure(result, curve) ? " fails: " : " ") +
         failing_text(result, curve) + "</h3>\n" + curve_svg(result, curve) +
         "<div class=\"row\">" +
         atlas_figure(curve.pictures.picture, "Picture by " + on, "the picture") +
         truth_again(result) +
         atlas_figure(curve.pictures.error, "Map of the FLIP error of " + on, "its error") +
         "</div></section>\n";
}

std::string case_section(const StressResult& result) {
  const StressCase& of = result.of;
  const std::string name{of.name};
  std::string html = "<h2 id=\"" + name + "\">" + name + ": " + text_of(of.title) + "</h2>\n<p>" +
                     text_of(of.must_hold) + " Measured: " + text_of(of.measured) + ", " +
                     text_of(of.unit) + ". Limit " + short_number(of.limit) + ": " +
                     text_of(of.why_limit) + ".";
  if (result.views > 0) {
    html += " The truth is the mean of " + std::to_string(result.views) +
            " views of the lens; the dotted line is one half of them against the other.";
  } else {
    html += " The truth is calculated.";
  }
  html += "</p>\n<div class=\"row\">" +
          atlas_figure(result.sharp, "The sharp picture of " + name, "the sharp picture") +
          atlas_figure(
              result.truth, "The truth of " + name,
              "the truth at " + std::string{of.parameter.name} + " " + short_number(result.shown)) +
          "</div>\n" + shared_truth(result) + curve_backdrop(result) + "<div class=\"methods\">\n";
  for (const StressCurve& curve : result.curves) {
    if (curve.can_run) html += method_section(result, curve);
  }
  return html + "</div>\n";
}

}  // namespace

double worst_ratio(const StressResult& result, const StressCurve& curve) {
  double worst = 0.0;
  for (const double value : curve.values) {
    if (result.of.limit > 0.0) {
      worst = std::max(worst, value / result.of.limit);
    } else if (!holds(result.of, value)) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return worst;
}

std::string stress_page(const StressFindings& findings, const StressOptions& options) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Where depth-of-field methods fail</title>\n<style>";
  html += kAtlasStyle;
  html +=
      "</style>\n</head>\n<body>\n<h1>Where depth-of-field methods fail</h1>\n<p>Each method on "
      "each case at " +
      size_text({options.size_px, options.size_px}) +
      ", all at equal settings, with no circle cut but in the case of largest circles. "
      "accumulation has 64 views of the lens; auto chooses for itself. A cell tells from which "
      "severity on the method fails: the parameter stands beside the case. \u2013: the method "
      "needs a scene, and the case is a picture.</p>\n";
  html += colour_key() + atlas_table(findings);
  html +=
      "<p>In the curves the broken line is the limit; red points do not hold; the other methods "
      "are grey. In the maps of errors black is right and pale yellow is wrong (FLIP). Dark "
      "pictures are brightened, with their truth.</p>\n";
  for (const StressResult& result : findings.results) html += case_section(result);
  return html + "</body>\n</html>\n";
}

}  // namespace softfocus
