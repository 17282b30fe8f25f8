// What is in the chart's script and page. No test can say how they look.

#include "tools/chart/report/page.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "tests/support/chart_points.h"
#include "tests/support/run_program.h"
#include "tools/chart/pictures.h"
#include "tools/chart/report/gnuplot.h"
#include "tools/chart/report/plot.h"
#include "tools/chart/report/summary_plot.h"

using namespace softfocus;

namespace {

std::string page_of(const std::vector<ChartPanel>& panels) {
  const auto best = best_for_budgets(panels);
  const auto summary = summary_of(panels);
  const bool few = panels.size() <= kMostPanels;
  return chart_page({.subject = chart_subjects().front(),
                     .panels = panels,
                     .best = best,
                     .summary = summary,
                     .size = "64x64",
                     .machine = "a <CPU>",
                     .summary_svg = "<svg>summary</svg>",
                     .first_svg = few ? "<svg/>" : "",
                     .second_svg = few ? "<svg>hdr</svg>" : ""});
}

std::string page() {
  return page_of({test::chart_panel("figures"), test::chart_panel("a<b>&\"c")});
}

/// What stands after `before`, up to the next quote, each time.
std::vector<std::string> values_after(const std::string& text, const std::string& before) {
  std::vector<std::string> values;
  for (std::size_t at = 0; (at = text.find(before, at)) != text.npos;) {
    at += before.size();
    values.push_back(text.substr(at, text.find('"', at) - at));
  }
  return values;
}

}  // namespace

TEST_CASE("chart page: every link leads to a place in it, and every id is there once") {
  const std::string html = page();
  const auto links = values_after(html, "href=\"#"), ids = values_after(html, " id=\"");
  // One for each of 8 points. Each budget of the 2 scenes has two: the best by FLIP and by
  // HDR-FLIP.
  CHECK(links.size() == 8 + 2 * 2 * (kBudgets.size() + 1));
  for (const std::string& link : links) {
    CAPTURE(link);
    CHECK(std::count(ids.begin(), ids.end(), link) == 1);
  }
  CHECK(std::set<std::string>(ids.begin(), ids.end()).size() == ids.size());
}

TEST_CASE("chart page: it needs no other file, and every picture is told in words") {
  const std::string html = page();
  const auto sources = values_after(html, "src=\"");
  CHECK(sources.size() == 3 + 2 * (1 + 4 * 5));
  for (const std::string& source : sources) CHECK(source.starts_with("data:image/"));
  CHECK(values_after(html, " alt=\"").size() == sources.size());
  CHECK_FALSE(contains(html, "http"));
  CHECK(contains(html, "data:image/svg+xml;base64,PHN2Zy8+"));
}

TEST_CASE("chart page: names cannot break it") {
  const std::string html = page();
  CHECK(contains(html, "a&lt;b&gt;&amp;&quot;c"));
  CHECK_FALSE(contains(html, "a<b>"));
  CHECK(contains(html, "A &lt;title&gt;"));
  CHECK(contains(html, "a &lt;CPU&gt;"));
}

TEST_CASE("chart page: a row for each point and each noise, those on the front marked") {
  const std::string html = page();
  const std::string body = html.substr(html.find("id=\"results\""));
  CHECK(values_after(body, "<tr class=\"best").size() == 6);
  CHECK(values_after(body, "<td class=\"word").size() >= 3 * 10);
  CHECK(contains(html, "half its 512 samples against half"));
  CHECK(contains(html, "<td data-n=\"30.500000000\">30.50</td>"));
}

TEST_CASE("chart page: a point without pictures is in the table, without a link") {
  ChartPanel panel = test::chart_panel("figures");
  panel.points[1].pictures = {};
  const std::string html = page_of({panel});
  CHECK_FALSE(contains(html, "#figures-two-pass-r8\""));
  CHECK(contains(html, "#figures-two-pass-r16\""));
  CHECK(contains(html, "<td class=\"word\">two-pass</td><td class=\"word\">max-coc 8</td>"));
}

TEST_CASE("chart page: with many scenes it shows the summary and the best, no row a point") {
  std::vector<ChartPanel> panels;
  for (std::size_t i = 0; i <= kMostPanels; ++i) {
    ChartPanel panel = test::chart_panel("random:" + std::to_string(i));
    panel.truth_picture.clear();
    for (ChartPoint& point : panel.points) point.pictures = {};
    panels.push_back(panel);
  }
  const std::string html = page_of(panels);
  CHECK_FALSE(contains(html, "id=\"results\""));
  CHECK(contains(html, "id=\"summary\""));
  CHECK(contains(html, "id=\"best\""));
  CHECK(contains(html, "They are in chart.csv"));
  CHECK(contains(html, "on the scene where its error is largest"));
  CHECK(values_after(html, "src=\"").size() == 1);
}

TEST_CASE("chart plot: each series has one style, and the front and the noise are drawn") {
  const std::string script = plot_script({test::chart_panel("figures"), test::chart_panel("it's")},
                                         kPictureErrors[0], "svg", "out.svg");
  CHECK(contains(script, "set terminal svg size "));
  CHECK(contains(script, "set output 'out.svg'"));
  CHECK(contains(script, "set title 'it''s'"));
  for (const char* series : {"pinhole", "two-pass", "accumulation"}) {
    CAPTURE(series);
    CHECK(contains(script, "title '" + std::string{series} + "'"));
  }
  CHECK(contains(script, "$p0_front << END\n6 0.2\n12 0.1\n700 0.01\n910 0.01\nEND\n"));
  CHECK(contains(script, "plot $p0_front with steps"));
  CHECK(contains(script, "$p1_1 << END\n12 0.1\n13.5 0.1\nEND\n"));
}

TEST_CASE("chart plot: HDR-FLIP has a front of its own") {
  ChartPanel panel = test::chart_panel("figures");
  panel.points[2].errors.hdr_flip = 0.05;
  const std::string script = plot_script({panel}, kPictureErrors[1], "svg", "out.svg");
  CHECK(contains(script, "$p0_front << END\n6 0.4\n12 0.2\n13.5 0.05\n700 0.02\n910 0.02\nEND\n"));
  CHECK(contains(script, "mean HDR-FLIP"));
}

TEST_CASE("chart plot: an error of 0 is drawn at the least that there is") {
  ChartPanel panel = test::chart_panel("figures");
  for (ChartPoint& point : panel.points) point.errors.flip = 0.0;
  panel.noise_floor.flip = 0.0;
  const std::string script = plot_script({panel}, kPictureErrors[0], "svg", "out.svg");
  CHECK(contains(script, "6 1e-05\n"));
  CHECK(contains(script, "set yrange [7.69231e-06:1.3e-05]"));
}

TEST_CASE("summary plot: ratios over times, and without times errors from median to worst") {
  ChartPanel panel = test::chart_panel("figures");
  const std::string with = summary_script(summary_of({panel}), "svg", "out.svg");
  CHECK(contains(with, "in frames of the pinhole"));
  CHECK(contains(with, "$s0_1 << END\n2 1\n2.25 1\nEND\n"));
  CHECK(contains(with, "Worst over the scenes: HDR-FLIP"));
  for (ChartPoint& point : panel.points) point.times = {};
  settle_points(panel);
  const std::string without = summary_script(summary_of({panel}), "svg", "out.svg");
  CHECK_FALSE(contains(without, "frames of the pinhole"));
  // From below: the pinhole, two-pass and accumulation.
  CHECK(contains(without, "$e0 << END\n3 0.01 0.01 0.01\n2 0.1 0.1 0.1\n1 0.2 0.2 0.2\nEND\n"));
}

TEST_CASE("gnuplot's quotes: a quote is doubled, a line's end is a blank") {
  CHECK(gnuplot_quoted("it's") == "'it''s'");
  CHECK(gnuplot_quoted("a\nb\\") == "'a b\\'");
}
