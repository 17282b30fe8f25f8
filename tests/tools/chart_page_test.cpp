// What is in the chart's script and page. No test can say how they look.

#include "tools/chart/page.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "tests/support/chart_points.h"
#include "tests/support/run_program.h"
#include "tools/chart/gnuplot.h"
#include "tools/chart/plot.h"

using namespace softfocus;

namespace {

std::string page() {
  return chart_page({test::chart_panel("figures"), test::chart_panel("a<b>&\"c")}, "<svg/>",
                    {"64x64", "a <CPU>"});
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
  CHECK(links.size() == 8);
  for (const std::string& link : links) {
    CAPTURE(link);
    CHECK(std::count(ids.begin(), ids.end(), link) == 1);
  }
  CHECK(std::set<std::string>(ids.begin(), ids.end()).size() == ids.size());
}

TEST_CASE("chart page: it needs no other file, and every picture is told in words") {
  const std::string html = page();
  const auto sources = values_after(html, "src=\"");
  CHECK(sources.size() == 1 + 2 * (1 + 4 * 5));
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
  CHECK(values_after(html, "<tr class=\"best").size() == 6);
  const std::string body = html.substr(html.find("<tbody>"), html.find("</tbody>"));
  CHECK(values_after(body, "<td class=\"word").size() >= 3 * 10);
  CHECK(contains(html, "half its 512 samples against half"));
  CHECK(contains(html, "<td data-n=\"30.500000000\">30.50</td>"));
}

TEST_CASE("chart plot: each series has one style, and the front and the noise are drawn") {
  const std::string script =
      plot_script({test::chart_panel("figures"), test::chart_panel("it's")}, "svg", "out.svg");
  CHECK(contains(script, "set terminal svg size "));
  CHECK(contains(script, "set output 'out.svg'"));
  CHECK(contains(script, "set title 'it''s'"));
  for (const char* series : {"pinhole", "two-pass", "accumulation"}) {
    CAPTURE(series);
    CHECK(contains(script, "title '" + std::string{series} + "'"));
  }
  CHECK(contains(script, "$p0_front << END\n6 0.2\n11 0.1\n700 0.01\n910 0.01\nEND\n"));
  CHECK(contains(script, "plot $p0_front with steps"));
  CHECK(contains(script, "$p1_1 << END\n11 0.1\n13.5 0.1\nEND\n"));
}

TEST_CASE("chart plot: an error of 0 is drawn at the least that there is") {
  ChartPanel panel = test::chart_panel("figures");
  for (ChartPoint& point : panel.points) point.errors.flip = 0.0;
  panel.noise_floor.flip = 0.0;
  const std::string script = plot_script({panel}, "svg", "out.svg");
  CHECK(contains(script, "6 1e-05\n"));
  CHECK(contains(script, "set yrange [7.69231e-06:1.3e-05]"));
}

TEST_CASE("gnuplot's quotes: a quote is doubled, a line's end is a blank") {
  CHECK(gnuplot_quoted("it's") == "'it''s'");
  CHECK(gnuplot_quoted("a\nb\\") == "'a b\\'");
}
