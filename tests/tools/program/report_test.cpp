#include "tests/support/cli_render.h"

using namespace softfocus;

TEST_CASE("render: --report writes the times without and with depth of field, and the cost") {
  const TemporaryDirectory directory;
  const ProgramRun run = run_program(
      render("figures", directory.file("a.png"), {"--report", directory.file("report.txt")}));
  CHECK(run.status == 0);
  CHECK(run.out + run.err == "");
  CHECK(directory.listing() == Words{"a.png", "report.txt"});
  const std::string report = read_file(directory.file("report.txt"));
  for (const std::string_view line :
       {"\nScene                   figures", "\nResolution              48 x 32 pixels\n",
        "\nTriangles               ", "\nMethod                  disc-layers\n",
        "\nFocus distance          ", "\nFilter size             ", "milliseconds",
        "frames per second", "\nWithout depth of field", "\nWith depth of field",
        "\nCost of depth of field", "\nload ", "\ndraw ", "\nfocus ", "\nfilter ", "\nencode ",
        "\nwrite "}) {
    CAPTURE(line);
    CHECK(contains(report, line));
  }
}

TEST_CASE("render: the report of a picture without depth of field names no cost of it") {
  const TemporaryDirectory directory;
  const std::string report = directory.file("report.txt");
  run_program(render("figures", directory.file("a.png"), {"--report", report, "--show", "depth"}));
  CHECK(contains(read_file(report), "Without depth of field"));
  CHECK_FALSE(contains(read_file(report), "Cost"));
}

TEST_CASE("render: --json gives the times of all stages, and they add up") {
  const auto json = rendered_json("figures", {});
  for (const char* stage : {"load", "draw", "focus", "filter", "encode", "write"}) {
    CHECK(json["stages_ms"][stage] >= 0.0);
  }
  const double draw = json["stages_ms"]["draw"];
  const double focus = json["stages_ms"]["focus"], filter = json["stages_ms"]["filter"];
  const double cost = json["cost_of_depth_of_field_ms"];
  CHECK(cost == focus + filter);
  CHECK(json["without_depth_of_field"]["ms"] == draw);
  CHECK(json["with_depth_of_field"]["ms"] == draw + cost);
}

TEST_CASE("render: -v says what was chosen on standard error, where nothing is said without") {
  const TemporaryDirectory directory;
  const ProgramRun run = run_program(render("figures", directory.file("a.png"), {"-v"}));
  CHECK(run.out == "");
  CHECK(contains(run.err, "disc-layers"));
  CHECK(contains(run.err, "Focus distance"));
}
