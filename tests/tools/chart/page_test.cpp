// The contents of the chart's report. No test can say how it looks.

#include "tools/chart/report/page.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "tests/support/chart_points.h"
#include "tests/support/run_program.h"
#include "tools/chart/measure.h"
#include "tools/report/report.h"

using namespace softfocus;

namespace {

Json report_of(const std::vector<ChartPanel>& panels) {
  return chart_report({.subject = chart_subjects().front(),
                       .panels = panels,
                       .best = best_for_budgets(panels),
                       .summary = summary_of(panels),
                       .size = "64x64",
                       .command = "softfocus chart --scenes 'a b'",
                       .machine = "a <CPU>"});
}

const std::string kWild = "a<b>&\"c'\x01\n</script><!--<script>";

Json report() { return report_of({test::chart_panel("figures"), test::chart_panel(kWild)}); }

/// The members of that name, wherever they are.
std::vector<Json> members(const Json& json, const std::string& name) {
  std::vector<Json> found;
  if (const Json* own = json.find(name)) found.push_back(*own);
  for (const Json& value : json.values()) {
    for (Json& below : members(value, name)) found.push_back(std::move(below));
  }
  return found;
}

std::vector<std::string> texts(const Json& json, const std::string& name) {
  std::vector<std::string> found;
  for (const Json& member : members(json, name)) found.push_back(member.text());
  return found;
}

const Json& part(const Json& report, const std::string& id) {
  for (const Json& of : report.at("parts").values()) {
    if (of.at("id").text() == id) return of;
  }
  throw std::runtime_error("no part " + id);
}

/// A series of a panel as "x y, x y".
std::string points_of(const Json& panel, const std::string& series) {
  for (const Json& of : panel.at("series").values()) {
    if (of.at("name").text() != series) continue;
    std::string text;
    for (const Json& point : of.at("points").values()) {
      text +=
          (text.empty() ? "" : ", ") + json_text(point.at("x")) + " " + json_text(point.at("y"));
    }
    return text;
  }
  throw std::runtime_error("no series " + series);
}

const Json& panel(const Json& part, std::size_t index) {
  return part.at("plots").at("panels").at(index);
}

}  // namespace

TEST_CASE("chart report: every link leads to a place in it, and every id is there once") {
  const Json whole = report();
  const auto links = texts(whole, "to"), ids = texts(whole, "id");
  // One for each of 8 points, and in each of 2 plots. Each budget of the 2 scenes has two: the best
  // by FLIP and by HDR-FLIP.
  CHECK(links.size() == 3 * 8 + 2 * 2 * (kBudgets.size() + 1));
  for (const std::string& link : links) {
    CAPTURE(link);
    CHECK(std::count(ids.begin(), ids.end(), link) == 1);
  }
  CHECK(std::set<std::string>(ids.begin(), ids.end()).size() == ids.size());
}

TEST_CASE("chart report: its page needs no other file, and every picture is told in words") {
  const Json whole = report();
  const auto pictures = texts(whole, "picture");
  CHECK(pictures.size() == 2 * (1 + 4 * 5));
  for (const std::string& name : pictures) CHECK(whole.at("pictures").at(name).text().size() == 4);
  CHECK(members(whole, "caption").size() == pictures.size());
  CHECK(members(whole, "about").size() == pictures.size() + 2 * 2);  // and each panel
  const std::string html = report_page(whole);
  for (const char* outside : {"<link", "<script src", "@import", "url("}) {
    CHECK_FALSE(contains(html, outside));
  }
}

TEST_CASE("report page: names cannot break it") {
  const Json whole = report();
  const std::string html = report_page(whole), start = "id=\"results\">";
  const std::size_t place = html.find(start) + start.size();
  const std::string results = html.substr(place, html.find("</script>", place) - place);
  CHECK_FALSE(contains(results, "<"));
  const auto read = parse_json(results);
  REQUIRE(read);
  CHECK(json_text(*read) == json_text(whole));
  CHECK(contains(json_text(whole), "a<b>&\\\"c'\\u0001\\n</script><!--<script>"));
  CHECK(part(whole, "scene-" + kWild).at("text").at(0).text() == "A <title>");
  CHECK(whole.at("machine").text() == "a <CPU>");
}

TEST_CASE("report: a command is told as a shell takes it") {
  CHECK(command_text({"softfocus", "--scenes", "a,random:3"}) == "softfocus --scenes a,random:3");
  CHECK(command_text({"it's", "", "a b", "$x"}) == R"('it'\''s' '' 'a b' '$x')");
}

TEST_CASE("chart report: a row for each point and each noise, those on the front marked") {
  const Json rows = part(report(), "results").at("table").at("rows");
  CHECK(rows.values().size() == 2 * (4 + 1));
  CHECK(members(rows, "best").size() == 6);
  const std::size_t columns = part(report(), "results").at("table").at("columns").values().size();
  for (const Json& row : rows.values()) CHECK(row.at("cells").values().size() == columns);
  CHECK(rows.at(4).at("cells").at(2).text() == "half its 512 samples against half");
  CHECK(rows.at(1).at("cells").at(6).number() == 30.5);
  CHECK(rows.at(1).at("cells").at(10).is_null());  // no pixel is near
}

TEST_CASE("chart report: a point without pictures is in the table, without a link") {
  ChartPanel without = test::chart_panel("figures");
  without.points[1].pictures = {};
  const Json whole = report_of({without});
  const auto links = texts(whole, "to");
  CHECK(std::count(links.begin(), links.end(), "figures-two-pass-r8") == 0);
  CHECK(std::count(links.begin(), links.end(), "figures-two-pass-r16") > 0);
  const Json cells = part(whole, "results").at("table").at("rows").at(1).at("cells");
  CHECK(cells.at(1).text() == "two-pass");
  CHECK(cells.at(2).text() == "max-coc 8");
}

TEST_CASE("chart report: with many scenes it has the summary and the best, no row a point") {
  std::vector<ChartPanel> panels;
  for (std::size_t i = 0; i <= kMostPanels; ++i) {
    ChartPanel one = test::chart_panel("random:" + std::to_string(i));
    one.truth_picture.clear();
    for (ChartPoint& point : one.points) point.pictures = {};
    panels.push_back(one);
  }
  const Json whole = report_of(panels);
  CHECK(part(whole, "results").find("table") == nullptr);
  CHECK(part(whole, "summary").find("table") != nullptr);
  CHECK(part(whole, "best").find("table") != nullptr);
  CHECK(contains(part(whole, "results").at("text").at(0).text(), "They are in chart.csv"));
  CHECK(contains(part(whole, "pictures").at("text").at(0).text(),
                 "on the scene where its error is largest"));
  CHECK(members(whole, "plots").size() == 1);
  CHECK(members(whole, "picture").empty());
}

TEST_CASE("chart plot: a series a method, and the front and the noise are drawn") {
  const Json of =
      part(report_of({test::chart_panel("figures"), test::chart_panel("it's")}), "chart");
  CHECK(panel(of, 1).at("title").text() == "it's");
  CHECK(points_of(panel(of, 0), "pinhole") == "6.0 0.2");
  CHECK(points_of(panel(of, 0), "accumulation") == "700.0 0.01");
  CHECK(points_of(panel(of, 0), "best for its time") ==
        "6.0 0.2, 12.0 0.1, 700.0 0.01, 700.0 0.01");
  CHECK(points_of(panel(of, 1), "two-pass") == "12.0 0.1, 13.5 0.1");
  CHECK(members(panel(of, 0), "kind").front().text() == "stair");
  // Names stand at what is on the front.
  CHECK(texts(panel(of, 0), "label") ==
        std::vector<std::string>{"pinhole", "two-pass, max-coc 8", "accumulation, 64 samples"});
}

TEST_CASE("chart plot: HDR-FLIP has a front of its own") {
  ChartPanel other = test::chart_panel("figures");
  other.points[2].errors.hdr_flip = 0.05;
  const Json of = panel(part(report_of({other}), "chart-hdr-flip"), 0);
  CHECK(points_of(of, "best for its time") ==
        "6.0 0.4, 12.0 0.2, 13.5 0.05, 700.0 0.02, 700.0 0.02");
  CHECK(contains(of.at("y").at("title").text(), "mean HDR-FLIP"));
}

TEST_CASE("chart plot: an error of 0 is drawn at the least that there is") {
  ChartPanel zero = test::chart_panel("figures");
  for (ChartPoint& point : zero.points) point.errors.flip = 0.0;
  zero.noise_floor.flip = 0.0;
  const Json of = panel(part(report_of({zero}), "chart"), 0);
  CHECK(of.at("y").at("log").boolean());
  for (const Json& y : members(of.at("series"), "y")) CHECK(y.number() == 1e-5);
}

TEST_CASE("summary plot: ratios over times, and without times errors from median to worst") {
  ChartPanel one = test::chart_panel("figures");
  const Json with = part(report_of({one}), "summary");
  CHECK(contains(panel(with, 0).at("x").at("title").text(), "in frames of the pinhole"));
  CHECK(points_of(panel(with, 0), "two-pass") == "2.0 1.0, 2.25 1.0");
  CHECK(panel(with, 3).at("title").text() == "Worst over the scenes: HDR-FLIP");
  for (ChartPoint& point : one.points) point.times = {};
  settle_points(one);
  const Json without = part(report_of({one}), "summary");
  // From above: accumulation, two-pass and the pinhole.
  CHECK(json_text(panel(without, 0).at("y").at("names")) ==
        R"(["accumulation","two-pass","pinhole"])");
  for (const char* series : {"median", "90th percentile", "worst scene"}) {
    CHECK(points_of(panel(without, 0), series) == "0.01 0, 0.1 1, 0.2 2");
  }
}
