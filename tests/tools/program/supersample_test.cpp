// render --supersample and --multisample, from end to end.

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "dof/halve.h"
#include "raster/images/texel.h"
#include "raster/shaders/glsl/glsl.h"
#include "tests/support/cli_refused.h"
#include "tools/pictures/image_file.h"

using namespace softfocus;

namespace {

using Words = std::vector<std::string>;

nlohmann::json drawn(const std::string& size, const std::string& output, const Words& more) {
  Words words{"render", "figures", "--size", size, "-o", output, "--json"};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramRun run = run_program(words);
  REQUIRE(run.status == 0);
  CHECK(run.err == "");
  return nlohmann::json::parse(run.out);
}

// That render refuses these words of an option, naming `named`.
void check_refused_option(const std::string& option, Words words, const Words& named) {
  const TemporaryDirectory pictures;
  words.insert(words.begin(), {"render", "figures", "-o", pictures.file("a.npy"), option});
  check_refused(pictures, words, 2, named);
}

double flip(const std::string& a, const std::string& b) {
  return nlohmann::json::parse(run_program({"compare", a, b, "--json"}).out)["flip"];
}

}  // namespace

TEST_CASE("render: --supersample 2 halves a picture of twice the size") {
  const TemporaryDirectory pictures;
  const std::string ours = pictures.file("ours.npy"), large = pictures.file("large.npy");
  ThreadPool pool{1};
  for (const Words& more : {Words{"--autofocus", "20,30"}, Words{"--show", "pinhole"},
                            Words{"--method", "disc-layers", "--profile", "llvmpipe"}}) {
    CAPTURE(more.back());
    Words twice = more;
    if (more.front() == "--autofocus") twice = {"--autofocus", "41,61", "--max-coc", "10"};
    Words once = more;
    once.insert(once.end(), {"--supersample", "2"});
    if (more.front() == "--autofocus") once.insert(once.end(), {"--max-coc", "5"});
    const auto report = drawn("64x48", ours, once);
    CHECK(report["supersample"] == 2);
    if (more.front() == "--autofocus") CHECK(report["lens"]["max_coc_px"] == 5.0);
    drawn("128x96", large, twice);
    const Profile profile = more.back() == "llvmpipe" ? *find_profile("llvmpipe") : Profile{};
    CHECK(hash_image(read_image_file(ours).image) ==
          hash_image(halve(read_image_file(large).image, profile, pool)));
  }
}

TEST_CASE("render: edges in focus are nearer to those of views from all over a pixel") {
  const TemporaryDirectory pictures;
  const std::string truth = pictures.file("truth.npy"), ours = pictures.file("ours.npy");
  const Words lens{"--coc-scale", "0"};
  Words with{"--method", "accumulation", "--samples", "256", "--jitter"};
  with.insert(with.end(), lens.begin(), lens.end());
  drawn("96x96", truth, with);
  drawn("96x96", ours, {"--coc-scale", "0", "--multisample", "1"});
  const double jagged = flip(ours, truth);
  drawn("96x96", ours, {"--coc-scale", "0", "--multisample", "1", "--supersample", "2"});
  CHECK(flip(ours, truth) < 0.6 * jagged);
}

TEST_CASE("render: --multisample makes edges in focus smooth, more samples smoother") {
  const TemporaryDirectory pictures;
  const std::string truth = pictures.file("truth.npy"), ours = pictures.file("ours.npy");
  drawn("96x96", truth,
        {"--coc-scale", "0", "--method", "accumulation", "--samples", "256", "--jitter"});
  for (const char* method : {"pinhole", "disc-layers", "two-pass"}) {
    CAPTURE(method);
    const auto error = [&](const char* samples) {
      const auto report =
          drawn("96x96", ours, {"--coc-scale", "0", "--method", method, "--multisample", samples});
      CHECK(report["multisample"] == std::stoi(samples));
      return flip(ours, truth);
    };
    const double jagged = error("1"), four = error("4");
    CHECK(four < 0.7 * jagged);
    CHECK(error("8") < four);
  }
}

TEST_CASE(
    "render: --multisample has the same bits in a file, in a pipe, and without a vector unit") {
  const TemporaryDirectory pictures;
  const std::string rows = pictures.file("rows.npy"), other = pictures.file("other.npy");
  // Shadows, glass and a method that peels are drawn whole.
  for (const Words& of :
       {Words{"figures", "--method", "two-pass"}, Words{"foliage", "--method", "pinhole"},
        Words{"glass", "--method", "disc-layers"},
        Words{"cube-room", "--method", "layered", "--shadows", "projected"}}) {
    CAPTURE(of.front());
    Words words{"render"};
    words.insert(words.end(), of.begin(), of.end());
    // Several rows of tiles, with some that show nothing below some that show edges.
    words.insert(words.end(), {"--size", "70x200", "--multisample", "4", "-q"});
    const auto with = [&](const Words& more) {
      Words all = words;
      all.insert(all.end(), more.begin(), more.end());
      return run_program(all);
    };
    REQUIRE(with({"-o", rows}).status == 0);
    const ProgramRun whole = with({"-o", "-", "--format", "npy"});
    REQUIRE(whole.status == 0);
    CHECK(whole.out == read_file(rows));
    REQUIRE(with({"-o", other, "--isa", "scalar", "--threads", "1"}).status == 0);
    CHECK(read_file(other) == read_file(rows));
  }
}

TEST_CASE("render: --multisample makes edges smooth in shadow, and of materials with shaders") {
  const TemporaryDirectory pictures;
  const std::string truth = pictures.file("truth.npy"), ours = pictures.file("ours.npy");
  write_file(pictures.file("red.frag"),
             "#version 330\nout vec4 c;\nvoid main() { c = vec4(1, 0, 0, 1); }\n");
  write_file(pictures.file("shaders.toml"),
             "background = [0.1, 0.2, 0.3]\n[camera]\nposition = [0, 1, 2]\ntarget = [0, 0, 0]\n"
             "[material.m]\nfragment = \"red.frag\"\n"
             "[[object]]\nshape = \"torus\"\nring_radius = 0.5\ntube_radius = 0.2\n"
             "material = \"m\"\n");
  for (const Words& of :
       {Words{"cube-room", "--shadows", "projected"}, Words{pictures.file("shaders.toml")}}) {
    CAPTURE(of.front());
    const auto render = [&](const std::string& output, const Words& more) {
      Words words{"render"};
      words.insert(words.end(), of.begin(), of.end());
      words.insert(words.end(), {"--size", "96x96", "--coc-scale", "0", "-q", "-o", output});
      words.insert(words.end(), more.begin(), more.end());
      const ProgramRun run = run_program(words);
      CAPTURE(run.err);
      REQUIRE(run.status == 0);
    };
    if (of.size() == 1 && !missing_glsl().empty()) continue;
    render(truth, {"--method", "accumulation", "--samples", "256", "--jitter"});
    render(ours, {"--method", "disc-layers", "--multisample", "1"});
    const double jagged = flip(ours, truth);
    render(ours, {"--method", "disc-layers", "--multisample", "8"});
    // Edges of shadows themselves keep stairs.
    CHECK(flip(ours, truth) < (of.size() > 1 ? 0.85 : 0.4) * jagged);
  }
}

TEST_CASE("render: where there is no room for a row of each sample, a pixel has one") {
  if (!missing_glsl().empty()) return;
  const TemporaryDirectory pictures;
  write_file(pictures.file("red.frag"),
             "#version 330\nout vec4 c;\nvoid main() { c = vec4(1, 0, 0, 1); }\n");
  const std::string scene = pictures.file("shaders.toml"), picture = pictures.file("a.npy");
  write_file(scene,
             "[camera]\nposition = [0, 1, 2]\ntarget = [0, 0, 0]\n"
             "[material.m]\nfragment = \"red.frag\"\n"
             "[[object]]\nshape = \"cube\"\nmaterial = \"m\"\n");
  const Words tall{"render", scene, "--size", "4x4100", "-o", picture, "--method", "two-pass"};
  Words words = tall;
  words.emplace_back("--json");
  const ProgramRun run = run_program(words);
  REQUIRE(run.status == 0);
  CHECK(nlohmann::json::parse(run.out)["multisample"] == 1);
  words = tall;
  words.insert(words.end(), {"--multisample", "4"});
  const ProgramRun refused = run_program(words);
  CHECK(refused.status == 2);
  CHECK(refused.err.find("--multisample") != refused.err.npos);
  CHECK(refused.err.find("16384") != refused.err.npos);
}

TEST_CASE("render: the largest circle is that of what shows between pixels' centres, too") {
  const TemporaryDirectory pictures;
  const std::string scene = pictures.file("strand.toml");
  // Before a wall in focus, a strand a third of a pixel wide, between the columns of centres.
  write_file(scene,
             "[camera]\nposition = [0, 0, 2]\ntarget = [0, 0, 0]\nfov_degrees = 40\n"
             "[lens]\nfocus_m = 2\ncoc_scale = 10\n[material.m]\nlit = false\n"
             "[[object]]\nshape = \"cube\"\nsize = 9\nposition = [0, 0, -4.5]\nmaterial = \"m\"\n"
             "[[object]]\nshape = \"cube\"\nscale = [0.004, 9, 0.004]\nposition = [0, 0, 1]\n"
             "material = \"m\"\n");
  const auto most = [&](const char* samples) {
    const ProgramRun run = run_program({"render", scene, "--size", "64x64", "--multisample",
                                        samples, "-o", pictures.file("a.npy"), "--json"});
    CAPTURE(run.err);
    REQUIRE(run.status == 0);
    return nlohmann::json::parse(run.out)["lens"]["max_coc_px"].get<double>();
  };
  CHECK(most("1") < 1.5);
  CHECK(most("4") > 4.0);
}

TEST_CASE("render: --multisample of many frames gives each frame's own edges") {
  const TemporaryDirectory pictures;
  const auto render = [&](const Words& more) {
    Words words{"render",  "crossing",      "--size", "64x48", "--method",
                "layered", "--multisample", "4",      "-q"};
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(run_program(words).status == 0);
  };
  render({"--frames", "0..2", "-o", pictures.file("f_%d.npy")});
  for (const char* frame : {"0", "1", "2"}) {
    render({"--frame", frame, "-o", pictures.file("one.npy")});
    CHECK(read_file(pictures.file("one.npy")) ==
          read_file(pictures.file(std::string{"f_"} + frame + ".npy")));
  }
}

TEST_CASE("render: a pixel has four samples, and one where edges have no place") {
  const TemporaryDirectory pictures;
  const auto samples = [&](const Words& more) {
    return drawn("32x32", pictures.file("a.npy"), more)["multisample"].get<int>();
  };
  CHECK(samples({}) == 4);
  CHECK(samples({"--method", "pinhole"}) == 4);
  CHECK(samples({"--method", "layered", "--layers", "3"}) == 4);
  for (const Words& one :
       {Words{"--multisample", "1"}, Words{"--show", "depth"}, Words{"--method", "accumulation"},
        Words{"--method", "auto"}, Words{"--show", "pinhole"}, Words{"--profile", "llvmpipe"},
        Words{"--profile", "softpipe"}, Words{"--show", "pinhole", "--layers", "2"},
        Words{"--effect", "temporal-aa"}, Words{"--arithmetic", "fixed"}, Words{"--gl", "emulated"},
        Words{"--method", "generalised-diffusion", "--sharp-depths", "1:2"}}) {
    CAPTURE(one.back());
    CHECK(samples(one) == 1);
  }
  CHECK(samples({"--profile", "llvmpipe", "--multisample", "8"}) == 8);
  // Tall, without a vector unit.
  const ProgramRun run =
      run_program({"render", "figures", "--size", "4x4100", "--method", "two-pass", "--isa",
                   "scalar", "-o", pictures.file("a.npy"), "--json"});
  REQUIRE(run.status == 0);
  CHECK(nlohmann::json::parse(run.out)["multisample"] == 4);
}

TEST_CASE("render: --multisample refuses what has no place in it") {
  const auto refused = [](const Words& words, const Words& named) {
    check_refused_option("--multisample", words, named);
  };
  refused({"2"}, {"--multisample '2'", "1, 4 or 8"});
  refused({"4", "--method", "accumulation"}, {"--multisample", "accumulation", "--jitter"});
  refused({"4", "--method", "auto"}, {"--multisample", "auto", "name a method"});
  refused({"4", "--show", "depth"}, {"--multisample", "--show image or pinhole"});
  refused({"4", "--show", "pinhole", "--layers", "2"}, {"--multisample", "--layers"});
  refused({"4", "--gl", "emulated"}, {"--multisample", "--gl"});
  refused({"4", "--profile", "softpipe"}, {"--multisample", "softpipe"});
  refused({"4", "--method", "two-pass", "--arithmetic", "fixed"},
          {"--multisample", "--arithmetic"});
  refused({"4", "--effect", "temporal-aa"}, {"temporal-aa", "--multisample"});
  refused({"4", "--method", "generalised-diffusion", "--sharp-depths", "1:2"},
          {"--multisample", "--sharp-depths"});
}

TEST_CASE("render: --supersample refuses what has no place in it") {
  const auto refused = [](const Words& words, const Words& named) {
    check_refused_option("--supersample", words, named);
  };
  refused({"3"}, {"--supersample '3'", "1 or 2"});
  refused({"2", "--method", "accumulation"}, {"--supersample", "accumulation", "--jitter"});
  refused({"2", "--method", "auto"}, {"--supersample", "auto", "name a method"});
  refused({"2", "--show", "pinhole", "--layers", "2"}, {"--supersample", "--layers"});
  refused({"2", "--show", "coc"}, {"--supersample", "--show image or pinhole"});
  refused({"2", "--size", "16384x16384"}, {"--supersample", "32768x32768", "--size"});
  refused({"2", "--max-coc", "1000"}, {"--supersample", "512"});
}
