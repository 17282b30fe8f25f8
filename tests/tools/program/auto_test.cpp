#include <cmath>

#include "dof/measure/flip.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"

using namespace softfocus;

namespace {

void check_refused_render(const Words& options, const Words& named) {
  const TemporaryDirectory directory;
  check_refused(directory, render("figures", directory.file("a.npy"), options), 2, named);
}

Words auto_with(Words options) {
  options.insert(options.begin(), {"--method", "auto"});
  return options;
}

ProgramRun render_at(const std::string& scene, const std::string& file, const std::string& size,
                     const Words& more) {
  Words words{"render", scene, "--size", size, "-o", file, "--json"};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words);
}

Picture picture_at(const std::string& file) {
  const std::string bytes = read_file(file);
  return decode_npy(std::as_bytes(std::span{bytes}));
}

// The words that ask for the choice by name.
Words asked_by_name(const nlohmann::json& choice) {
  Words words{"--method", choice["method"].get<std::string>(), "--multisample", "1"};
  if (choice.contains("max_coc_px")) {
    words.insert(words.end(), {"--max-coc", choice["max_coc_px"].dump()});
  }
  if (choice.contains("samples")) {
    words.insert(words.end(), {"--samples", choice["samples"].dump()});
  }
  return words;
}

}  // namespace

TEST_CASE("auto: the bytes are those of the method that it says it chose" *
          doctest::test_suite("long")) {
  std::string methods;
  struct Case {
    const char* scene;
    const char* error;
  };
  for (const Case& asked : {Case{"figures", "0.2"},
                            {"figures", "0.02"},
                            {"sphere-world", "0.05"},
                            {"lattice", "0.02"},
                            {"lattice", "0.01"}}) {
    const char* scene = asked.scene;
    const char* error = asked.error;
    CAPTURE(scene);
    CAPTURE(error);
    const TemporaryDirectory directory;
    const auto run = render_at(scene, directory.file("a.npy"), "128x128",
                               auto_with({"--max-error", error, "--no-verify"}));
    REQUIRE(run.status == 0);
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json["method"] == "auto");
    methods += json["choice"]["method"].get<std::string>() + " ";
    const auto fixed =
        render_at(scene, directory.file("b.npy"), "128x128", asked_by_name(json["choice"]));
    CHECK(fixed.status == 0);
    CHECK(read_file(directory.file("a.npy")) == read_file(directory.file("b.npy")));
  }
  CAPTURE(methods);  // or the claim would be about one of them
  CHECK(contains(methods, "pinhole"));
  CHECK(contains(methods, "two-pass"));
  CHECK(contains(methods, "filtered-views"));
  CHECK(contains(methods, "accumulation"));
}

TEST_CASE("auto: the same choice and bytes for any number of threads and on every vector unit" *
          doctest::test_suite("threads")) {
  const Words options = auto_with({"--max-error", "0.05", "--coc-scale", "4", "--no-verify"});
  const auto with = [&](const Words& more) {
    Words words = options;
    words.insert(words.end(), more.begin(), more.end());
    return rendered("lattice", words);
  };
  const std::string expected = with({"--threads", "1", "--isa", "scalar"});
  for (const Isa isa : available_isas()) {
    CHECK(with({"--threads", "3", "--isa", std::string{isa_name(isa)}}) == expected);
  }
}

TEST_CASE("auto: an error of 0.02 is kept to on every scene" * doctest::test_suite("long")) {
  for (const char* scene :
       {"figures", "sphere-world", "dunes", "lattice", "night-lights", "random:200"}) {
    CAPTURE(scene);
    const TemporaryDirectory directory;
    const auto run = render_at(scene, directory.file("a.npy"), "160x160", auto_with({}));
    REQUIRE(run.status == 0);
    CHECK(run.err == "");
    REQUIRE(render_at(scene, directory.file("truth.npy"), "160x160",
                      {"--method", "accumulation", "--samples", "384"})
                .status == 0);
    ThreadPool pool{2};
    const PixelMap flip = flip_map(picture_at(directory.file("truth.npy")).image,
                                   picture_at(directory.file("a.npy")).image, clamped_tone(), pool);
    CHECK(mean(flip) <= 1.1 * 0.02);
  }
}

TEST_CASE("auto: the pinhole's file where the lens blurs nothing") {
  const std::string pinhole = rendered("figures", {"--method", "pinhole"});
  CHECK(rendered("figures", auto_with({"--f-number", "200", "--max-error", "0"})) == pinhole);
  CHECK(rendered("figures", auto_with({"--max-time", "0"})) == pinhole);
}

TEST_CASE("auto: it says what it chose and why, in the report, with -v and in JSON") {
  const auto json = rendered_json("lattice", auto_with({"--max-error", "0.1"}));
  const auto& choice = json["choice"];
  CHECK(choice["max_error"] == 0.1);
  CHECK(choice["meets_goal"] == true);
  CHECK(choice["predicted_error"] <= 0.1);
  CHECK(choice["predicted_ms"] >= 0.0);
  CHECK(contains(choice["reason"].get<std::string>(), "of the picture is out of focus"));
  CHECK(choice["traits"]["nearest_px"] < 0.0);
  CHECK(json["stages_ms"]["choose"] >= 0.0);
  CHECK_FALSE(rendered_json("lattice", {}).contains("choice"));
  CHECK_FALSE(rendered_json("lattice", {})["stages_ms"].contains("choose"));

  const TemporaryDirectory directory;
  const std::string report = directory.file("report.txt");
  const ProgramRun run = run_program(
      render("lattice", directory.file("a.npy"), auto_with({"--report", report, "-v"})));
  CHECK(run.status == 0);
  for (const char* line : {"\nMethod                  auto\n", "\nChosen                  ",
                           "\nBecause                 ", "\nPredicted error         ",
                           "\nPredicted time          ", "\nchoose "}) {
    CAPTURE(line);
    CHECK(contains(read_file(report), line));
    CHECK(contains(run.err, line));
  }
}

TEST_CASE("auto: a choice is checked if it is asked for, and then says what was measured") {
  const auto checked = rendered_json("near-fence", auto_with({"--verify"}));
  CHECK(checked["choice"]["measured_error"] <= 0.02);
  CHECK(checked["stages_ms"]["check"] > 0.0);
  const auto unchecked = rendered_json("near-fence", auto_with({"--no-verify"}));
  CHECK(unchecked["choice"]["measured_error"].is_null());
  CHECK_FALSE(unchecked["stages_ms"].contains("check"));
}

TEST_CASE("auto: with --max-time the predicted time is kept to") {
  for (const char* ms : {"0.05", "1", "100"}) {
    const auto choice = rendered_json("lattice", auto_with({"--max-time", ms}))["choice"];
    CHECK(choice["predicted_ms"] <= std::stod(ms));
    CHECK(choice["max_time_ms"] == std::stod(ms));
    CHECK_FALSE(choice.contains("max_error"));
  }
}

TEST_CASE("auto: --max-coc bounds the radius of what it chooses") {
  for (const char* error : {"0.3", "0.1", "0.05"}) {
    const auto choice = rendered_json("lattice", auto_with({"--coc-scale", "8", "--max-coc", "4",
                                                            "--max-error", error}))["choice"];
    CHECK((!choice.contains("max_coc_px") || choice["max_coc_px"] <= 4.0));
  }
}

TEST_CASE("auto: an error that nothing keeps to is told, and the picture is there" *
          doctest::test_suite("long")) {
  const TemporaryDirectory directory;
  const auto run_with = [&](Words more) {
    // Few triangles: thousands of views are drawn.
    more.insert(more.begin(), {"--max-error", "0", "--coc-scale", "6"});
    return run_program(render("cube-room", directory.file("a.npy"), auto_with(more)));
  };
  const ProgramRun run = run_with({});
  CHECK(run.status == 0);
  CHECK(is_one_line(run.err));
  CHECK(contains(run.err, "--max-error 0: not kept to; accumulation, 2048 samples shows an error"));
  const ProgramRun unchecked = run_with({"--no-verify"});
  CHECK(is_one_line(unchecked.err));
  CHECK(contains(unchecked.err, "--max-error 0: no method is predicted to keep to it"));
  CHECK(directory.listing() == Words{"a.npy", "a.npy.json"});
}

TEST_CASE("auto: maps and the pinhole's picture need no choice") {
  for (const char* show : {"pinhole", "coc", "depth"}) {
    CHECK(rendered("figures", auto_with({"--show", show})) ==
          rendered("figures", {"--show", show}));
    CHECK_FALSE(rendered_json("figures", auto_with({"--show", show})).contains("choice"));
  }
}

TEST_CASE("auto: bad input") {
  for (const char* value : {"-0.1", "1.5", "nan", "little", ""}) {
    check_refused_render(auto_with({"--max-error", value}), {"--max-error", "0 to 1"});
  }
  for (const char* value : {"-1", "inf", "soon", ""}) {
    check_refused_render(auto_with({"--max-time", value}), {"--max-time", "milliseconds"});
  }
  check_refused_render(auto_with({"--max-time", "8", "--max-error", "0.1"}),
                       {"--max-error", "--max-time", "exclude"});
  check_refused_render(auto_with({"--verify", "--no-verify"}), {"--verify", "exclude"});
  check_refused_render(auto_with({"--verify", "--max-time", "8"}), {"--verify", "--max-time"});
  check_refused_render({"--verify"}, {"--verify", "disc-layers", "--method auto"});
  check_refused_render({"--max-error", "0.1"}, {"--max-error", "disc-layers", "--method auto"});
  check_refused_render({"--method", "pinhole", "--max-time", "8"}, {"--max-time", "pinhole"});
  check_refused_render(auto_with({"--gl", "llvmpipe"}), {"--gl", "auto", "exclude"});
  for (const Words& option : {Words{"--samples", "4"}, Words{"--jitter"}, Words{"--until", "0.1"},
                              Words{"--aperture-blades", "5"}}) {
    check_refused_render(auto_with(option), {option[0], "auto", "--method accumulation"});
  }
  check_refused_render({"--method", "automatic"}, {"'automatic'", "accumulation", "auto"});
}
