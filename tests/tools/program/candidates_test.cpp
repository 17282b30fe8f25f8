// candidates from end to end.

#include <fstream>

#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"

using namespace softfocus;
using nlohmann::json;

namespace {

Words candidates_of(const std::string& scene, const Words& more) {
  Words words{"candidates", scene, "--size", "64x48", "--coc-scale", "5"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

json measured(const Words& more) {
  const ProgramRun run = run_program(candidates_of("night-lights", more));
  CHECK(run.status == 0);
  CHECK(run.err == "");
  return json::parse(run.out);
}

const json& entry_of(const json& list, const std::string& candidate) {
  const auto& all = list["candidates"];
  const auto found = std::find_if(
      all.begin(), all.end(), [&](const json& entry) { return entry["candidate"] == candidate; });
  REQUIRE(found != all.end());
  return *found;
}

/// The mean FLIP of a picture of night-lights against 32 views, by render and compare.
double flip_of(const Words& method) {
  const TemporaryDirectory directory;
  const auto drawn = [&](const char* name, const Words& more) {
    Words words{"render", "night-lights",  "--size", "64x48", "--coc-scale",
                "5",      "--multisample", "1",      "-o",    directory.file(name)};
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(run_program(words).status == 0);
    return directory.file(name);
  };
  const std::string truth =
      drawn("truth.npy", {"--method", "accumulation", "--samples", "32", "--until", "1e-9"});
  const ProgramRun run = run_program({"compare", drawn("a.npy", method), truth, "--json"});
  return json::parse(run.out)["flip"];
}

}  // namespace

TEST_CASE("candidates: lists what auto chooses from, a line each, or as JSON") {
  const ProgramRun run = run_program(candidates_of("random:3", {}));
  CHECK(run.status == 0);
  CHECK(run.err == "");
  CHECK(run.out.starts_with("predicted ms  predicted FLIP  setting\n"));
  for (const char* part : {"pinhole", "two-pass", "disc-layers", "accumulation"}) {
    CHECK(contains(run.out, part));
  }
  const ProgramRun as_json = run_program(candidates_of("random:3", {"--json"}));
  const json list = json::parse(as_json.out);
  CHECK(list["scene"] == "random:3");
  CHECK(list["size"] == "64x48");
  CHECK(list["candidates"].size() + 1 ==
        static_cast<std::size_t>(std::count(run.out.begin(), run.out.end(), '\n')));
  for (const json& entry : list["candidates"]) CHECK(entry["flip"].is_null());
  CHECK_FALSE(list.contains("noise_floor_flip"));
}

TEST_CASE("candidates: --measure gives the error that render and compare give") {
  const json list = measured({"--measure", "32", "--json"});
  CHECK(list["truth_samples"] == 32);
  CHECK(list["noise_floor_flip"] > 0.0);
  CHECK(entry_of(list, "pinhole")["flip"] == flip_of({"--method", "pinhole"}));
  // One that needs object numbers too, and one that draws the scene.
  for (const std::string method : {"disc-layers:4", "object-identification:8"}) {
    const json& filter = entry_of(list, method);
    const std::string radius = filter["max_coc_px"].dump();
    CHECK(filter["flip"] ==
          flip_of({"--method", method.substr(0, method.find(':')), "--max-coc", radius}));
  }
  CHECK(entry_of(list, "surface-splatting")["flip"] == flip_of({"--method", "surface-splatting"}));
  CHECK(entry_of(list, "accumulation:8")["flip"] ==
        flip_of({"--method", "accumulation", "--samples", "8"}));
  // The truth itself and what has more samples than it cannot be measured against it.
  CHECK(entry_of(list, "accumulation:32")["flip"].is_null());
  CHECK(entry_of(list, "accumulation:64")["flip"].is_null());
}

TEST_CASE("candidates: --choose tells what auto takes, with the coefficients of a table too") {
  const TemporaryDirectory directory;
  const std::string table = directory.file("table.json");
  const auto taken = [&](const Words& more) {
    Words words{"--choose", "0.3", "--choose", "0.28", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return measured(words)["choices"];
  };
  const json own = taken({});
  REQUIRE(own.size() == 2);
  CHECK(own[0]["max_error"] == 0.3);
  CHECK(own[0]["meets_goal"] == true);
  CHECK(own[0]["measured_error"] <= 0.3);
  CHECK(own[1]["measured_error"] <= 0.28);
  CHECK(own[1]["candidate"] != "pinhole");
  // Its own table, by which nothing but 64 views is ever good enough.
  json dear;
  const json list = measured({"--json"});
  for (const json& entry : list["candidates"]) {
    dear[entry["candidate"].get<std::string>()] = json::array({9, 0, 0, 0, 0, 0, 0});
  }
  dear["accumulation:64"] = json::array({0, 0, 0, 0, 0, 0, 0});
  std::ofstream(table) << dear;
  const json other = taken({"--table", table});
  for (const json& choice : other) {
    CHECK(choice["candidate"] == "accumulation:64");
    CHECK(choice["predicted_error"] == 0.0);
  }
}

TEST_CASE("candidates: the same for any number of threads and every vector unit") {
  const json one = measured({"--measure", "32", "--json", "--threads", "1", "--isa", "scalar"});
  CHECK(measured({"--measure", "32", "--json", "--threads", "3"}) == one);
  const ProgramRun table = run_program(candidates_of("night-lights", {"--measure", "32"}));
  CHECK(table.out.starts_with("predicted ms  predicted FLIP  measured FLIP  setting\n"));
  CHECK(contains(table.out, "            -  "));  // not measured
}

TEST_CASE("candidates: bad input is refused in one line") {
  const TemporaryDirectory directory;
  const auto refused = [&](const Words& words, int status, const Words& named) {
    check_refused(directory, words, status, named);
  };
  for (const char* samples : {"16", "40", "65552", "many"}) {
    refused(candidates_of("figures", {"--measure", samples}), 2,
            {"--measure '" + std::string{samples} + "'", "a multiple of 16 from 32 to 65536"});
  }
  refused(candidates_of("figures", {"--choose", "2"}), 2, {"--choose '2'", "from 0 to 1"});
  const std::string table = directory.file("table.json");
  refused(candidates_of("figures", {"--table", table}), 1, {table});
  const auto refused_table = [&](const char* text, const Words& named) {
    std::ofstream(table) << text;
    refused(candidates_of("figures", {"--table", table}), 2, named);
  };
  refused_table("[1, 2]", {table, "no JSON object"});
  refused_table(R"({"two-pass:9": [0, 0, 0, 0, 0, 0, 0]})",
                {table, "two-pass:9", "lists its lines"});
  refused_table(R"({"two-pass:8": [0, 0, 0, 0, 0, 0]})", {table, "two-pass:8", "seven numbers"});
  refused_table(R"({"two-pass:8": [0, 0, 0, 0, 0, 0, -1]})", {"two-pass:8", "seven numbers"});
  refused_table(R"({"two-pass:8": "none"})", {"two-pass:8", "seven numbers"});
  refused({"candidates"}, 2, {"SCENE is missing"});
  refused(candidates_of("no-such-scene", {}), 1, {"no-such-scene", "cube-room"});
  refused(candidates_of("figures", {"--focus", "0.01"}), 2, {"--focus"});
}

TEST_CASE("candidates: the help has its own default size, and names random scenes as render's") {
  for (const char* command : {"candidates", "render"}) {
    CHECK(contains(run_program({command, "--help"}).out, "random:SEED"));
  }
  const std::string help = run_program({"candidates", "--help"}).out;
  CHECK(contains(help, "512x512"));
  CHECK_FALSE(contains(help, "1024x1024"));
  CHECK(contains(help, "what is printed is the same"));
}
