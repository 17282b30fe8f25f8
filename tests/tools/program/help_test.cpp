#include <algorithm>
#include <filesystem>
#include <sstream>

#include "tests/support/cli_render.h"
#include "tools/info/words.h"
#include "tools/options/method_options.h"
#include "tools/stress/cases/stress_case.h"

using namespace softfocus;

TEST_CASE("help names every option of every subcommand, with units") {
  const auto names_all = [](const char* command, const Words& options) {
    const ProgramRun run = run_program({command, "--help"});
    CHECK(run.status == 0);
    CHECK(run.err == "");
    for (const std::string& option : options) {
      CAPTURE(option);
      CHECK(contains(run.out, "  " + option));
    }
  };
  names_all("render", {"SCENE",
                       "-o,--output FILE",
                       "--format FORMAT",
                       "--depth-output FILE",
                       "--size WxH",
                       "--show image|pinhole|coc|depth",
                       "--shadows none|projected",
                       "--map KEY=VALUE,...",
                       "--shadow-darkness X",
                       "--soft N",
                       "--light-radius METRES",
                       "--light-angle DEGREES",
                       "--soften-terminators facets|normals|fade",
                       "--layers K",
                       "--frame N",
                       "--scene-path DIR",
                       "--method NAME",
                       "--focus METRES",
                       "--focal-length MM",
                       "--f-number N",
                       "--coc-scale S",
                       "--autofocus [X,Y]",
                       "--max-coc PIXELS",
                       "--leak A",
                       "--budget SHARE",
                       "--samples N",
                       "--jitter",
                       "--until ERROR",
                       "--shutter FRAMES",
                       "--aperture-blades N",
                       "--shard I/N",
                       "--profile NAME",
                       "--threads N",
                       "--isa NAME",
                       "--report FILE",
                       "--json",
                       "-v,--verbose"});
  names_all("join", {"PARTS", "-o,--output FILE", "--format FORMAT", "--check"});
  names_all("refocus", {"COLOUR",
                        "DEPTH",
                        "-o,--output FILE",
                        "--layer NAME",
                        "--depth-layer NAME",
                        "--depth-encoding NAME",
                        "--near METRES",
                        "--far METRES",
                        "--scale S",
                        "--offset O",
                        "--baseline METRES",
                        "--focal-px PIXELS",
                        "--depth-along axis|ray",
                        "--missing NUMBER",
                        "--mask FILE",
                        "--holes background|near|far|infinity|refuse",
                        "--upsample colour|nearest",
                        "--mend-edges",
                        "--unmix-edges",
                        "--mend-bands",
                        "--focus METRES",
                        "--focus-at X,Y",
                        "--focus-nearest",
                        "--focus-range NEAR..FAR",
                        "--sensor NAME|WxHmm",
                        "--fov DEGREES",
                        "--blur-at-infinity PIXELS",
                        "--method NAME",
                        "--max-error E"});
  names_all("inspect",
            {"FILES", "-o,--output FILE", "--depth-encoding NAME", "--focus METRES", "--json"});
  names_all("relief", {"ACTION",
                       "INPUT",
                       "-o,--output FILE",
                       "--texels WxH",
                       "--depth-bits 8|16",
                       "--projection NAME",
                       "--normals",
                       "--unlit",
                       "--light X,Y,Z",
                       "--moving-light",
                       "--approach F",
                       "--levels N",
                       "--schedule NAME",
                       "--aside renewals|warps",
                       "--update-frames N",
                       "--slice-ms X",
                       "--predict",
                       "--yaw DEGREES",
                       "--pitch DEGREES",
                       "--distance D",
                       "--show PART",
                       "--traced",
                       "--height-field",
                       "--colour FILE",
                       "--height M",
                       "--empty VALUE",
                       "--box",
                       "--resampling NAME",
                       "--fixed",
                       "--frames N",
                       "--every N",
                       "--tolerance TEXELS",
                       "--join TEXELS",
                       "--turns N",
                       "--cache MB",
                       "--regions N",
                       "--texels-per-pixel K",
                       "--zoom Z",
                       "--no-sprites",
                       "--rival octahedral",
                       "--views N",
                       "--hemisphere",
                       "--parallax N",
                       "--runs N",
                       "--threads N",
                       "--isa NAME"});
  names_all("lens",
            {"--focus METRES", "--focal-length MM", "--f-number N", "--coc-scale S",
             "--fov DEGREES", "--height PIXELS", "--max-coc-film MM", "--at METRES ...", "--json"});
  names_all("compare", {"A", "B", "--diff OUT", "--diff-ulps OUT", "--hdr", "--pixels-per-degree N",
                        "--regions", "--depth FILE", "--focus METRES", "--focal-length MM",
                        "--f-number N", "--coc-scale S", "--fov DEGREES", "--point PIXELS",
                        "--flicker FRAME ...", "--against FRAME ...", "--json"});
  names_all("selftest", {"--threads N", "--isa NAME", "--quick", "--json", "--print"});
  names_all("scenes", {"--scene-path DIR"});
  names_all("methods", {});
  names_all("profiles", {});
}

TEST_CASE("the program tells its version") {
  CHECK(run_program({"--version"}).out.starts_with("softfocus 0."));
}

TEST_CASE("without a subcommand there is the help, as wrong usage") {
  const ProgramRun run = run_program({});
  CHECK(run.status == 2);
  CHECK(run.out == "");
  for (const char* command : {"render", "scenes", "methods", "profiles", "lens", "compare", "bench",
                              "chart", "selftest"}) {
    CHECK(contains(run.err, std::string{"\n  "} + command));
  }
}

TEST_CASE("scenes, methods and profiles are listed a line each, by name") {
  const auto lists = [](const char* command, const Words& names) {
    const ProgramRun run = run_program({command});
    CHECK(run.status == 0);
    for (const std::string& name : names) {
      CAPTURE(name);
      CHECK(contains("\n" + run.out, "\n" + name + " "));
    }
    CHECK(std::count(run.out.begin(), run.out.end(), '\n') ==
          static_cast<std::ptrdiff_t>(names.size()));
  };
  lists("scenes", {"bright-edges", "canopy", "clutter", "crossing", "cube-room", "dunes", "figures",
                   "foliage", "glass", "grazing-floor", "interior", "lattice", "near-fence",
                   "night-lights", "portrait", "sphere-world", "windmill", "random:SEED"});
  lists("methods", all_methods());
  lists("profiles", {"ieee", "d3d11", "llvmpipe", "llvmpipe-sse41", "softpipe", "swiftshader"});
}

TEST_CASE("scenes lists those of --scene-path with their titles") {
  const TemporaryDirectory directory;
  write_file(directory.file("mine.toml"), "title = \"My own\"\n" + kCube);
  CHECK(contains(run_program({"scenes", "--scene-path", directory.path()}).out,
                 "mine           My own\n"));
}

TEST_CASE("help: words of the field say where they are, and there they are") {
  const std::string methods = "\n" + run_program({"methods"}).out;
  const std::string effects = "\n" + run_program({"effects"}).out;
  for (const Word& word : words()) {
    std::istringstream places{std::string{word.places} + ","};
    for (std::string place; places >> std::ws && std::getline(places, place, ',');) {
      CAPTURE(place);
      if (place.starts_with("docs/")) {
        CHECK(
            std::filesystem::exists(std::filesystem::path{SOFTFOCUS_TEST_DATA} / "../.." / place));
        continue;
      }
      std::istringstream rest{place};
      std::string program, command, option, value;
      rest >> program >> command >> option >> value;
      CHECK(program == "softfocus");
      const ProgramRun help = run_program({command, "--help"});
      CHECK(help.status == 0);
      CHECK(contains(help.out, option));
      if (option == "--method" && !value.empty()) CHECK(contains(methods, "\n" + value + " "));
      if (option == "--effect") CHECK(contains(effects, "\n" + value + " "));
      if (option == "--cases") {
        const auto cases = stress_cases();
        CHECK(std::any_of(cases.begin(), cases.end(),
                          [&](const StressCase& one) { return one.name == value; }));
      }
    }
  }
}

TEST_CASE("help: a word is found by any of its names, or by a part of one") {
  const auto helps = [](const Words& asked, const char* expected) {
    Words arguments{"help"};
    arguments.insert(arguments.end(), asked.begin(), asked.end());
    const ProgramRun run = run_program(arguments);
    CHECK(run.status == 0);
    CHECK(contains(run.out, expected));
  };
  helps({"circle", "of", "confusion"}, "softfocus lens\n");
  helps({"coc"}, "docs/lens.md\n");
  helps({"Circles-of-Confusion"}, "docs/lens.md\n");
  helps({"hyperfocal"}, "hyperfocal distance\n");
  helps({"gather"}, "--method scatter\n");
  helps({"two-pass"}, "--method two-pass\n");
  helps({"warped-accumulation"}, "--method warped-accumulation\n");
  helps({"auto"}, "--method auto\n");
  helps({"bilateral"}, "softfocus apply --effect bilateral\n");
  helps({"render"}, "Usage: softfocus render");
  for (const char* unknown : {"no such thing", "on", "usion"}) {
    const ProgramRun run = run_program({"help", unknown});
    CHECK(run.status == 2);
    CHECK(contains(run.err, "'" + std::string{unknown} + "'"));
  }
}
