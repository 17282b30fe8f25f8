#include "scenes/lens_views/ray_traced.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

void check_refused_render(const Words& options, const Words& named) {
  const TemporaryDirectory directory;
  check_refused(directory, render("figures", directory.file("a.npy"), options), 2, named);
}

Words accumulation_with(Words options) {
  options.insert(options.begin(), {"--method", "accumulation"});
  return options;
}

}  // namespace

TEST_CASE("ground truth: one sample is the pinhole's file, more are none of the filters'") {
  const std::string pinhole = rendered("figures", {"--method", "pinhole"});
  CHECK(rendered("figures", accumulation_with({"--samples", "1"})) == pinhole);
  const std::string more = rendered("figures", accumulation_with({"--samples", "12"}));
  CHECK(more != pinhole);
  CHECK(more != rendered("figures", {"--method", "two-pass", "--max-coc", "16"}));
}

TEST_CASE("ground truth: the bytes are the same for 1, 2 and 3 threads" *
          doctest::test_suite("threads")) {
  Words methods{"accumulation"};
  if (ray_traced_missing().empty()) methods.emplace_back("ray-traced");
  for (const std::string& method : methods) {
    const auto with_threads = [&](const std::string& threads) {
      return rendered("figures", {"--method", method, "--samples", "11", "--threads", threads});
    };
    const std::string one = with_threads("1");
    CHECK(with_threads("2") == one);
    CHECK(with_threads("3") == one);
  }
}

TEST_CASE("ground truth: the lens's options count, the filter's do not") {
  const auto with = [](Words options) {
    options.insert(options.end(), {"--samples", "9"});
    return rendered("figures", accumulation_with(options));
  };
  const std::string plain = with({});
  for (const Words& options :
       {Words{"--f-number", "4"}, Words{"--focus", "1.3"}, Words{"--coc-scale", "2"},
        Words{"--aperture-blades", "5"}, Words{"--jitter"}, Words{"--autofocus", "2,2"}}) {
    CAPTURE(options[0]);
    CHECK(with(options) != plain);
  }
  CHECK(with({"--max-coc", "1"}) == plain);
  CHECK(with({"--leak", "0"}) == plain);
  CHECK(with({"--f-number", "1", "--coc-scale", "0.5"}) == plain);  // the scene's is 2
}

TEST_CASE("ground truth: the report says how many samples there were and how they agreed") {
  const auto fixed = rendered_json("figures", accumulation_with({"--samples", "20"}));
  CHECK(fixed["method"] == "accumulation");
  CHECK(fixed["sampling"]["samples"] == 20);
  CHECK(fixed["sampling"]["jitter"] == false);
  CHECK(fixed["sampling"]["aperture_blades"] == 0);
  CHECK(!fixed["sampling"].contains("half_set_rms"));
  const auto until = rendered_json("figures", accumulation_with({"--until", "0.02", "--jitter"}));
  CHECK(until["sampling"]["samples"] >= 16);
  CHECK(until["sampling"]["half_set_rms"] <= 0.02);
  CHECK(!rendered_json("figures", {}).contains("sampling"));
  CHECK(!rendered_json("figures", {"--method", "surface-splatting"}).contains("sampling"));

  const TemporaryDirectory directory;
  const std::string report = directory.file("report.txt");
  rendered("figures", {"--method", "two-pass"});
  CHECK(run_program(render("figures", directory.file("a.npy"),
                           accumulation_with({"--until", "0.02", "--report", report})))
            .status == 0);
  CHECK(contains(read_file(report), "Half-sets differ by"));
}

TEST_CASE("ground truth: samples by tile are told by their mean and by their most") {
  const auto by_tile = rendered_json("figures", accumulation_with({"--samples", "auto:24"}));
  CHECK(by_tile["sampling"]["samples"] == 24);
  CHECK(by_tile["sampling"]["most_samples"] == 24);
  CHECK(by_tile["sampling"]["mean_samples"] >= 8);
  CHECK(by_tile["sampling"]["mean_samples"] <= 24);
  const auto views = rendered_json("figures", {"--method", "filtered-views", "--samples", "auto"});
  CHECK(views["sampling"]["most_samples"] == 32);
  CHECK(!rendered_json("figures", accumulation_with({"--samples", "9"}))["sampling"].contains(
      "mean_samples"));
}

TEST_CASE("ground truth: samples by tile are refused where they cannot be") {
  check_refused_render(accumulation_with({"--samples", "auto", "--until", "0.1"}),
                       {"--until", "--samples auto", "exclude"});
  for (const char* value : {"auto:", "auto:0", "auto:65537", "auto64", "automatic"}) {
    check_refused_render(accumulation_with({"--samples", value}), {"--samples", "auto:64"});
  }
  check_refused_render({"--method", "two-pass", "--samples", "auto"}, {"--samples", "two-pass"});
}

TEST_CASE("ground truth: an error that is not reached is told, and the picture is there") {
  for (const auto& [samples, said] :
       {std::pair{"32", "the half-sets differ by 0."}, std::pair{"8", "from 16 samples on"}}) {
    const TemporaryDirectory directory;
    const ProgramRun run =
        run_program(render("figures", directory.file("a.npy"),
                           accumulation_with({"--samples", samples, "--until", "1e-7"})));
    CHECK(run.status == 0);
    CHECK(is_one_line(run.err));
    CHECK(contains(run.err, "--until 1e-07"));
    CHECK(contains(run.err, said));
    CHECK(directory.listing() == Words{"a.npy", "a.npy.json"});
  }
}

TEST_CASE("ground truth: bad input") {
  for (const char* value : {"0", "-1", "65537", "1.5", "many", "", "1e3"}) {
    check_refused_render(accumulation_with({"--samples", value}), {"--samples", "1 to 65536"});
  }
  for (const char* value : {"0", "-1", "nan", "inf", "little", ""}) {
    check_refused_render(accumulation_with({"--until", value}), {"--until", "above 0"});
  }
  for (const char* value : {"1", "2", "65", "-3", "5.5", "round"}) {
    check_refused_render(accumulation_with({"--aperture-blades", value}),
                         {"--aperture-blades", "from 3 to 64"});
  }
  for (const Words& option : {Words{"--samples", "4"}, Words{"--jitter"}, Words{"--until", "0.1"},
                              Words{"--aperture-blades", "5"}}) {
    check_refused_render(option, {option[0], "disc-layers", "accumulation"});
  }
  check_refused_render(accumulation_with({"--gl", "llvmpipe"}), {"--gl", "accumulation"});
  check_refused_render({"--method", "raytraced"},
                       {"'raytraced'", "warped-accumulation, ray-traced"});
}

TEST_CASE("ground truth: without Embree, ray-traced says how to get it") {
  if (ray_traced_missing().empty()) return skip("", "built with Embree");
  check_refused_render({"--method", "ray-traced"}, {"ray-traced", "Embree", "libembree-dev"});
}
