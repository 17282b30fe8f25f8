// stress from end to end.

#include <set>

#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"

using namespace softfocus;

namespace {

using nlohmann::json;

Words small_stress(const std::string& output, const Words& more = {}) {
  Words words{"stress",    "--quick",
              "--size",    "64",
              "--cases",   "near-edge,foliage,point-light,point-radius",
              "--methods", "pinhole,two-pass,ring-bucket,accumulation",
              "-o",        output};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  REQUIRE(place != std::string::npos);
  return text.replace(place, from.size(), to);
}

std::string some_record(const std::string& directory, const std::string& name) {
  for (const auto& entry : std::filesystem::directory_iterator{directory + "/cache"}) {
    if (entry.path().filename().string().starts_with(name)) return entry.path().string();
  }
  FAIL("no record of " << name);
  return {};
}

}  // namespace

TEST_CASE("stress: writes list, table and page, and goes on from what is there") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("new/atlas");
  const ProgramRun first = run_program(small_stress(out));
  CHECK(first.status == 0);
  CHECK(first.err == "");
  CHECK_FALSE(contains(first.out, "went on"));
  CHECK(contains(first.out, "pinhole: holds "));
  CHECK(contains(first.out, "near-edge (all)"));

  const std::string text = read_file(out + "/stress.json");
  const json list = json::parse(text);
  REQUIRE(list.size() > 20);
  for (const json& entry : list) {
    CHECK(entry.size() == 7);
    CHECK(entry["parameter"].size() == 3);
    CHECK(entry["limit"] > 0.0);
    const bool within = entry["value"].is_number() && entry["value"] <= entry["limit"];
    CHECK(entry["holds"] == within);
    const bool of_point = entry["case"] == "point-light" || entry["case"] == "point-radius";
    const bool drawn = entry["method"] == "accumulation";
    CHECK_FALSE((of_point && drawn));
  }
  CHECK(list[0]["method"] == "pinhole");
  CHECK(list[0]["case"] == "near-edge");
  CHECK(list[0]["parameter"] == json{{"name", "radius"}, {"value", 1.0}, {"unit", "px"}});
  CHECK(list[0]["unit"] == "of the contrast");
  CHECK(list[0]["holds"] == false);

  const std::string csv = read_file(out + "/stress.csv");
  CHECK(
      csv.starts_with("method,case,parameter,parameter_value,parameter_unit,value,unit,limit,"
                      "holds\npinhole,near-edge,radius,1.0,px,"));
  CHECK(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')) == list.size() + 1);
  const std::string page = read_file(out + "/index.html");
  CHECK(contains(page, "</html>"));
  const json report = report_of_page(page);
  for (const json& picture : report["pictures"]) CHECK(picture.get<std::string>().size() > 50);
  std::set<std::string> links, cards;
  for (const json& row : report["parts"][0]["table"]["rows"]) {
    for (const json& cell : row["cells"]) {
      if (cell.is_object()) links.insert(cell["to"].get<std::string>());
    }
  }
  for (const json& part : report["parts"]) {
    if (!part.contains("cards")) continue;
    CHECK(links.contains(part["id"].get<std::string>()));
    const json& series = part["plots"]["panels"][0]["series"];
    for (const json& card : part["cards"]) {
      CHECK(std::any_of(series.begin(), series.end(),
                        [&](const json& of) { return of["name"] == card["own"]; }));
      for (const json& figure : card["figures"][0]) {
        CHECK(report["pictures"].contains(figure["picture"].get<std::string>()));
      }
      cards.insert(card["id"].get<std::string>());
    }
  }
  for (const char* id : {"near-edge-two-pass", "point-light-ring-bucket", "foliage-accumulation"}) {
    CHECK(cards.contains(id));
    CHECK(links.contains(id));
  }

  const ProgramRun second = run_program(small_stress(out));
  CHECK(second.out.starts_with("went on: "));
  const std::string went_on = second.out.substr(0, second.out.find('\n'));
  int kept = 0, all = 0;
  CHECK(std::sscanf(went_on.c_str(), "went on: %d of %d", &kept, &all) == 2);
  CHECK(kept == all);
  CHECK(read_file(out + "/stress.json") == text);
  CHECK(read_file(out + "/stress.csv") == csv);
  CHECK(read_file(out + "/index.html") == page);
}

TEST_CASE("stress: the same bytes for any number of threads and every vector unit") {
  const TemporaryDirectory directory;
  const std::string one = directory.file("one"), two = directory.file("two");
  const auto run_on = [](const std::string& output, const Words& machine) {
    Words words{"stress",    "--quick",
                "--size",    "64",
                "--cases",   "largest-circle,point-light",
                "--methods", "two-pass,disc-layers",
                "-o",        output};
    words.insert(words.end(), machine.begin(), machine.end());
    CHECK(run_program(words).status == 0);
  };
  run_on(one, {"--threads", "1", "--isa", "scalar"});
  run_on(two, {"--threads", "3"});
  for (const char* file : {"/stress.json", "/stress.csv", "/index.html"}) {
    CHECK(read_file(one + file) == read_file(two + file));
  }
}

TEST_CASE("stress: values of another measure, and damaged ones, are measured again") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("atlas");
  const Words words{"stress",    "--quick",   "--size",  "64", "--cases",
                    "near-edge", "--methods", "pinhole", "-o", out};
  REQUIRE(run_program(words).status == 0);
  const std::string text = read_file(out + "/stress.json");
  const std::string record = some_record(out, "near-edge-0");
  const std::string kept = read_file(record);
  const auto went_on_after = [&](const std::string& changed) {
    write_file(record, changed);
    const ProgramRun run = run_program(words);
    CHECK(read_file(out + "/stress.json") == text);
    return run.out.substr(0, run.out.find('\n'));
  };
  CHECK(contains(went_on_after(kept), "went on: 2 of 2"));
  CHECK(contains(went_on_after(replaced(kept, "; measures 0x", "; measures 0xf")),
                 "went on: 1 of 2"));
  CHECK(contains(went_on_after("{"), "went on: 1 of 2"));
}

TEST_CASE("stress: --json prints what the file holds") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("atlas");
  const ProgramRun run = run_program({"stress", "--quick", "--size", "64", "--cases", "constant",
                                      "--methods", "scatter,auto", "--json", "-o", out});
  CHECK(run.status == 0);
  CHECK(run.out == read_file(out + "/stress.json"));
  CHECK(json::parse(run.out).size() >= 2);
}

TEST_CASE("stress: bad options are refused in one line, before anything is there") {
  const auto refused = [](const Words& options, const Words& named) {
    const TemporaryDirectory directory;
    Words words{"stress", "-o", directory.file("out")};
    words.insert(words.end(), options.begin(), options.end());
    check_refused(directory, words, 2, named);
  };
  refused({"--cases", "leaks"}, {"--cases 'leaks'", "leak-far", "resolution"});
  refused({"--methods", "three-pass"},
          {"--methods 'three-pass'", "two-pass", "accumulation", "auto"});
  refused({"--methods", "two-pass,,layers"}, {"--methods", "a comma between"});
  refused({"--cases", "plane,plane"}, {"--cases", "'plane' stands there twice"});
  refused({"--size", "63"}, {"--size '63'", "a multiple of 16 from 64 to 1024"});
  refused({"--size", "100"}, {"--size '100'", "a multiple of 16 from 64 to 1024"});
  refused({"--size", "64x64"}, {"--size '64x64'"});
  refused({"near-edge"}, {"unexpected argument 'near-edge'"});
  const TemporaryDirectory directory;
  check_refused(directory, {"stress", "--quick"}, 2, {"-o is missing"});
}

TEST_CASE("stress: a place that cannot be written to is told before anything is measured") {
  const TemporaryDirectory directory;
  write_file(directory.file("file"), "");
  check_refused(directory, small_stress(directory.file("file")), 1, {directory.file("file"), "-o"});
}

TEST_CASE("stress: the help names every option") {
  const ProgramRun run = run_program({"stress", "--help"});
  CHECK(run.status == 0);
  for (const char* option : {"-o,--output DIR", "--methods A,B,...", "--cases A,B,...", "--size N",
                             "--quick", "--json", "--threads N", "--isa NAME"}) {
    CAPTURE(option);
    CHECK(contains(run.out, std::string{"  "} + option));
  }
}
