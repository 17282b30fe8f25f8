// A pipeline wherever a method is named, end to end.

#include "raster/shaders/glsl/glsl.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tests/support/gl_drivers.h"
#include "tests/support/scene_test_files.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

using nlohmann::json;

const std::string kTwoPass = SOFTFOCUS_TEST_DATA "/../../scenes/pipelines/two_pass.toml";

std::string texels(const std::string& file) {
  const std::string all = read_file(file);
  return all.substr(all.find('\n') + 1);
}

/// A pipeline with a parameter, and its shader.
std::string write_brighter(const TemporaryDirectory& directory) {
  write_file(directory.file("brighter.frag"),
             "#version 330\nuniform sampler2D picture;\nuniform float gain;\nout vec4 colour;\n"
             "void main() { colour = gain * texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }\n");
  write_file(directory.file("brighter.toml"),
             "[parameters.gain]\ndefault = 1\nrange = [0, 8]\n\n[[pass]]\n"
             "shader = \"brighter.frag\"\n");
  return directory.file("brighter.toml");
}

}  // namespace

TEST_CASE("render and refocus by a pipeline of two-pass's GLSL give two-pass's picture") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const TemporaryDirectory directory;
  const std::string sharp = directory.file("sharp.npy"), a = directory.file("a.npy"),
                    b = directory.file("b.npy");
  for (const Words& more : {Words{"--max-coc", "7.5"}, Words{"--max-coc", "3", "--frame", "2"}}) {
    for (const auto& [method, file] :
         {std::pair{std::string{"two-pass"}, a}, std::pair{kTwoPass, b}}) {
      Words words = render("figures", file, {"--method", method});
      words.insert(words.end(), more.begin(), more.end());
      CHECK(run_program(words).status == 0);
    }
    CHECK(texels(a) == texels(b));
  }
  REQUIRE(run_program(render("figures", sharp, {"--show", "pinhole"})).status == 0);
  for (const auto& [method, file] :
       {std::pair{std::string{"two-pass"}, a}, std::pair{kTwoPass, b}}) {
    CHECK(run_program({"refocus", sharp, "--method", method, "--focus", "3", "--blur-at-infinity",
                       "9", "-o", file})
              .status == 0);
  }
  CHECK(texels(a) == texels(b));
}

TEST_CASE("a pipeline's parameter by --set, by the method's name, and as an option") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const TemporaryDirectory directory;
  const std::string pipeline = write_brighter(directory), sharp = directory.file("sharp.npy");
  REQUIRE(run_program(render("figures", sharp, {"--show", "pinhole"})).status == 0);
  const std::string twice = directory.file("twice.npy"), same = directory.file("same.npy"),
                    refocused = directory.file("refocused.npy");
  CHECK(run_program({"apply", sharp, "--pipeline", pipeline, "-o", same}).status == 0);
  CHECK(texels(same) == texels(sharp));
  CHECK(run_program({"apply", sharp, "--pipeline", pipeline, "--set", "gain=2", "-o", twice})
            .status == 0);
  CHECK(texels(twice) != texels(sharp));
  for (const Words& words :
       {Words{"refocus", sharp, "--method", pipeline + ":gain=2"},
        Words{"refocus", sharp, "--method", pipeline, "--gain", "2"},
        Words{"refocus", sharp, "--gain=2", "--method=" + pipeline},
        Words{"refocus", sharp, "--method", pipeline + ":gain=1", "--gain", "2"},
        Words{"apply", sharp, "--gain", "2", "--pipeline", pipeline}}) {
    Words whole = words;
    whole.insert(whole.end(), {"-o", refocused});
    CAPTURE(words.back());
    CHECK(run_program(whole).status == 0);
    CHECK(texels(refocused) == texels(twice));
  }
  for (const auto& [words, named] :
       {std::pair{Words{"--gain", "9"}, Words{"gain=9", "from 0 to 8"}},
        std::pair{Words{"--gian", "2"}, Words{"unknown option '--gian'"}},
        std::pair{Words{"--gain"}, Words{"unknown option '--gain'"}}}) {
    Words whole{"refocus", sharp, "--method", pipeline, "-o", directory.file("no.npy")};
    whole.insert(whole.end(), words.begin(), words.end());
    check_refused(directory, whole, 2, named);
  }
}

TEST_CASE("a pipeline that cannot be is one line, and its files are no outputs") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const TemporaryDirectory directory;
  const std::string pipeline = write_brighter(directory), sharp = directory.file("sharp.npy");
  REQUIRE(run_program(render("figures", sharp, {"--show", "pinhole"})).status == 0);
  const auto refused = [&](const Words& words, const Words& named, int status = 2) {
    check_refused(directory, words, status, named);
  };
  const std::string out = directory.file("no.npy");
  refused(render("figures", out, {"--method", pipeline + ":gain=9"}),
          {"--method", "'gain=9'", "from 0 to 8"});
  refused(render("figures", out, {"--method", directory.file("none.toml")}), {"none.toml"});
  refused({"apply", sharp, "--pipeline", pipeline, "--set", "gian=2", "-o", out},
          {"--set 'gian=2'", "did you mean 'gain'"});
  refused({"apply", sharp, "--pipeline", pipeline, "--set", "gain=9", "-o", out},
          {"'gain=9'", "from 0 to 8"}, 1);
  refused({"apply", sharp, "--pipeline", kTwoPass, "-o", out}, {"reads the lens", "refocus"});
  refused({"chart", "--methods", "two-pass," + directory.file("none.toml"), "-o",
           directory.file("chart")},
          {"none.toml"});
  for (const std::string& file : {pipeline, directory.file("brighter.frag")}) {
    const std::string before = read_file(file);
    refused(
        {"render", "figures", "--size", kSize, "--method", pipeline, "--format", "npy", "-o", file},
        {"a file of the pipeline"});
    refused({"refocus", sharp, "--method", pipeline, "--format", "npy", "-o", file},
            {"a file of the pipeline"});
    CHECK(read_file(file) == before);
  }
  refused({"apply", sharp, "--pipeline", pipeline, "--format", "npy", "-o", pipeline},
          {"a shader's file"});
}

TEST_CASE("chart and stress have a pipeline beside the methods, anew when it changes") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const TemporaryDirectory directory;
  const std::string pipeline = write_brighter(directory), out = directory.file("chart");
  const Words chart{"chart",    "--scenes", "figures", "--methods", "pinhole," + pipeline,
                    "--quick",  "--size",   "64x64",   "--samples", "128",
                    "--rounds", "0",        "-o",      out};
  const auto errors = [&] {
    CHECK(run_program(chart).status == 0);
    std::vector<double> found;
    for (const json& point : json::parse(read_file(out + "/chart.json"))) {
      found.push_back(point["hdr_flip"].get<double>());
    }
    return found;
  };
  const std::vector<double> before = errors();
  REQUIRE(before.size() == 3);
  CHECK(before[0] == before[1]);  // a gain of 1 is the pinhole's picture
  CHECK(errors() == before);
  std::string text = read_file(pipeline);
  write_file(pipeline, text.replace(text.find("default = 1"), 11, "default = 2"));
  const std::vector<double> after = errors();
  CHECK(after[0] == before[0]);
  CHECK(after[1] != before[1]);

  const std::string atlas = directory.file("stress");
  CHECK(run_program({"stress", "--quick", "--size", "64", "--cases", "point-light", "--methods",
                     "two-pass," + kTwoPass, "-o", atlas})
            .status == 0);
  const json results = json::parse(read_file(atlas + "/stress.json"));
  for (const json& of : results) {
    if (of["method"] != kTwoPass) continue;
    const auto ours = std::find_if(results.begin(), results.end(), [&](const json& other) {
      return other["method"] == "two-pass" && other["parameter"] == of["parameter"];
    });
    REQUIRE(ours != results.end());
    CHECK((*ours)["value"] == of["value"]);
  }
}

TEST_CASE("crosscheck --pipeline: volumes, cubes and arrays of files are a driver's to the bit") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const TemporaryDirectory directory;
  write_file(directory.file("strip.png"), test::png_bytes(24, 4));
  write_file(directory.file("slices.frag"),
             "#version 330\nuniform sampler2D picture;\nuniform sampler3D lut;\n"
             "uniform sampler2DArray layers;\nuniform samplerCube sky;\nout vec4 c;\n"
             "void main() {\n  vec4 p = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);\n"
             "  c = texture(lut, p.rgb) + texture(layers, vec3(p.rg, 2.0));\n"
             "  c += textureLod(sky, normalize(p.rgb - 0.4), p.b);\n}\n");
  write_file(directory.file("slices.toml"),
             "[textures]\nstrip = \"strip.png\"\n[[pass]]\nshader = \"slices.frag\"\n"
             "inputs = { lut = { from = \"strip\", wrap = \"mirror\" }, layers = \"strip\", "
             "sky = { from = \"strip\", filter = \"trilinear\" } }\n");
  for (const char* driver : {"llvmpipe", "emulated"}) {
    if (!has_driver(driver)) continue;
    const ProgramRun run = run_program({"crosscheck", "--driver", driver, "--pipeline",
                                        directory.file("slices.toml"), "--quick", "--json"});
    CAPTURE(driver);
    CAPTURE(run.err);
    CHECK(run.status == 0);
    for (const json& of : json::parse(run.out)) {
      CAPTURE(of.dump());
      CHECK(of["values"] > 0);
      CHECK(of["differing"] == 0);
    }
  }
}

TEST_CASE("crosscheck --pipeline: a driver's inputs are the place in the picture, in each column") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const TemporaryDirectory directory;
  write_file(directory.file("inputs.frag"),
             "#version 330\nuniform sampler2D picture;\nin mat3 m;\nin mat2x3 n;\nin vec4 a[2];\n"
             "in float f;\nout vec4 c;\nvoid main() {\n"
             "  c = texture(picture, m[1].xy * a[1].wx + n[1].xy) + vec4(m[2], f) + a[0];\n"
             "  c += fwidth(texture(picture, n[0].yx * 3.7));\n}\n");
  write_file(directory.file("inputs.toml"),
             "[[pass]]\nshader = \"inputs.frag\"\nscale = 0.7\n[[pass]]\nshader = \"inputs.frag\"\n"
             "inputs = { picture = { from = \"previous\", filter = \"trilinear\" } }\n");
  for (const char* driver : {"llvmpipe", "llvmpipe-sse41", "softpipe", "emulated"}) {
    if (!has_driver(driver)) continue;
    const ProgramRun run = run_program(
        {"crosscheck", "--driver", driver, "--pipeline", directory.file("inputs.toml"), "--json"});
    CAPTURE(driver);
    CAPTURE(run.out);
    CHECK(run.status == 0);
    const json results = json::parse(run.out);
    CHECK(results.size() >= 4);
    for (const json& of : results) {
      CHECK(of["values"] > 0);
      CHECK(of["differing"] == 0);
    }
  }
}

TEST_CASE("crosscheck --pipeline and bench --vs: a driver runs the same GLSL to the same bits") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  if (!has_driver("llvmpipe")) return;
  const ProgramRun run = run_program(
      {"crosscheck", "--driver", "llvmpipe", "--pipeline", kTwoPass, "--quick", "--json"});
  CHECK(run.status == 0);
  const json results = json::parse(run.out);
  CHECK(results.size() == 6);
  for (const json& of : results) {
    CAPTURE(of.dump());
    CHECK(of["stage"] == "two_pass");
    CHECK(of["values"] > 0);
    CHECK(of["differing"] == 0);
  }
  const ProgramRun bench =
      run_program({"bench", "figures", "--size", "64x64", "--method", kTwoPass, "--vs", "llvmpipe",
                   "--profile", "llvmpipe", "--runs", "10"});
  CHECK(bench.status == 0);
  CHECK(contains(bench.out, "the pictures are equal to the bit"));
}
