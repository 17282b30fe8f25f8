// chart from end to end. They check that times are there, not what they are.

#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tests/support/skip.h"
#include "tools/chart/gnuplot.h"

using namespace softfocus;

namespace {

using nlohmann::json;

const Words kFiles{"cache", "chart.csv", "chart.json", "chart.png", "chart.svg", "index.html"};

bool has_gnuplot() {
  try {
    check_gnuplot();
    return true;
  } catch (const std::runtime_error& error) {
    skip("gnuplot", error.what());
    return false;
  }
}

Words small_chart(const std::string& output, const Words& more = {}) {
  Words words{"chart",   "--scenes", "figures", "--methods", "pinhole,two-pass",
              "--quick", "--size",   "64x64",   "--samples", "128",
              "-o",      output};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Words listing_of(const std::string& directory) {
  Words names;
  for (const auto& entry : std::filesystem::directory_iterator{directory}) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void check_refused_chart(const Words& options, const Words& named, int status = 2) {
  const TemporaryDirectory directory;
  Words words{"chart", "--size", "64x64", "-o", directory.file("out")};
  words.insert(words.end(), options.begin(), options.end());
  check_refused(directory, words, status, named);
}

}  // namespace

TEST_CASE("chart: writes five files, and goes on from what is there to the same results") {
  if (!has_gnuplot()) return;
  const TemporaryDirectory directory;
  const std::string out = directory.file("new/chart");
  const ProgramRun first = run_program(small_chart(out));
  CHECK(first.status == 0);
  CHECK(first.err == "");
  CHECK(contains(first.out, "figures: noise of the truth, FLIP "));
  CHECK_FALSE(contains(first.out, "went on"));
  CHECK(listing_of(out) == kFiles);

  const json list = json::parse(read_file(out + "/chart.json"));
  REQUIRE(list.size() == 10);
  CHECK(list[0]["method"] == "pinhole");
  CHECK(list[1]["settings"] == json{{"max_coc_px", 0.25}, {"profile", "ieee"}});
  CHECK(list[6]["settings"] == json{{"max_coc_px", 4.0}, {"profile", "d3d11"}});
  CHECK(list[9]["settings"] ==
        json{{"max_coc_px", 4.0}, {"profile", "ieee"}, {"arithmetic", "fixed-8"}});
  for (const json& point : list) {
    CHECK(point["scene"] == "figures");
    CHECK(point["rounds"] == 3);
    CHECK(point["median_ms"] > 0.0);
    CHECK(point["filter_ms"] <= point["median_ms"]);
    CHECK(point["flip"] > 0.0);
    CHECK(point["psnr_db"] > 10.0);
    CHECK(point["truth_samples"] == 128);
    CHECK(point["noise_floor_flip"] < point["flip"]);
  }
  CHECK(list[3]["psnr_db"] > list[0]["psnr_db"]);  // blurred is nearer to the truth than sharp
  CHECK(list[3]["flip"] != list[0]["flip"]);       // the settings count
  CHECK(list[6]["flip"] != list[3]["flip"]);
  CHECK(list[9]["flip"] != list[3]["flip"]);  // bytes are another picture, but hardly
  CHECK(list[9]["flip"].get<double>() ==
        doctest::Approx(list[3]["flip"].get<double>()).epsilon(0.2));

  const std::string csv = read_file(out + "/chart.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 11);
  CHECK(read_file(out + "/chart.png").starts_with("\x89PNG"));
  CHECK(contains(read_file(out + "/chart.svg"), "</svg>"));
  CHECK(contains(read_file(out + "/index.html"), "</html>"));

  const std::string truth = read_file(out + "/cache/figures.truth.npy");
  const ProgramRun second = run_program(small_chart(out));
  CHECK(second.status == 0);
  CHECK(second.out.starts_with("went on: 21 of 21 results were there already\n"));
  CHECK(json::parse(read_file(out + "/chart.json")) == list);
  CHECK(read_file(out + "/chart.csv") == csv);
  CHECK(read_file(out + "/cache/figures.truth.npy") == truth);
}

TEST_CASE("chart: what is missing or damaged is measured again, the rest is kept") {
  if (!has_gnuplot()) return;
  const TemporaryDirectory directory;
  const std::string out = directory.file("chart");
  REQUIRE(run_program(small_chart(out)).status == 0);
  const json before = json::parse(read_file(out + "/chart.json"));
  std::filesystem::remove(out + "/cache/figures/pinhole.json");
  write_file(out + "/cache/figures/two-pass-r1.json", "{");
  const ProgramRun run = run_program(small_chart(out));
  CHECK(run.status == 0);
  CHECK(run.out.starts_with("went on: 19 of 21 results"));
  CHECK(json::parse(read_file(out + "/chart.json")) == before);

  const ProgramRun more = run_program(small_chart(out, {"--rounds", "4"}));
  CHECK(more.out.starts_with("went on: 11 of 21 results"));  // the truth and the errors
  CHECK(json::parse(read_file(out + "/chart.json"))[0]["rounds"] == 4);
  CHECK_FALSE(contains(run_program(small_chart(out, {"--again"})).out, "went on"));
}

TEST_CASE("chart: where circles are large, blurred is nearer to the truth than sharp, to the eye") {
  if (!has_gnuplot()) return;
  const TemporaryDirectory directory;
  const std::string out = directory.file("chart"), scene = directory.file("mine.toml");
  write_file(scene, kCube + "[lens]\nf_number = 0.2\nfocus_m = 1.0\n");
  Words words = small_chart(out);
  words[2] = scene;
  REQUIRE(run_program(words).status == 0);
  const json list = json::parse(read_file(out + "/chart.json"));
  CHECK(list[3]["settings"]["max_coc_px"] == 4.0);
  CHECK(list[3]["flip"] < 0.7 * list[0]["flip"].get<double>());
}

TEST_CASE("chart: a scene that changed is measured anew") {
  if (!has_gnuplot()) return;
  const TemporaryDirectory directory;
  const std::string out = directory.file("chart"), scene = directory.file("mine.toml");
  const Words words{"chart",  "--scenes", scene,       "--methods", "pinhole", "--quick",
                    "--size", "48x32",    "--samples", "128",       "-o",      out};
  write_file(scene, kCube);
  REQUIRE(run_program(words).status == 0);
  const auto flip = [&] { return json::parse(read_file(out + "/chart.json"))[0]["flip"]; };
  const json before = flip();
  write_file(scene, kCube + "[lens]\nf_number = 0.2\nfocus_m = 1.0\n");
  const ProgramRun run = run_program(words);
  CHECK(run.status == 0);
  CHECK(flip() > before);
  // The sharp picture is the same, and so are its times.
  CHECK(run.out.starts_with("went on: 1 of 3 results"));
}

TEST_CASE("chart: bad input is refused before anything is there") {
  check_refused_chart({"--scenes", "no-such-scene"}, {"no-such-scene", "cube-room"}, 1);
  check_refused_chart({"--scenes", "figures,,cube-room"}, {"--scenes", "a comma between"});
  check_refused_chart({"--scenes", "figures,figures"}, {"--scenes", "twice"});
  check_refused_chart({"--methods", "pinhole,three-pass"},
                      {"--methods 'three-pass'", "two-pass", "accumulation"});
  check_refused_chart({"--methods", "ray-traced"}, {"--methods 'ray-traced'"});
  check_refused_chart({"--methods", ""}, {"--methods"});
  check_refused_chart({"--samples", "127"}, {"--samples '127'", "multiple of 16"});
  check_refused_chart({"--samples", "130"}, {"--samples '130'", "multiple of 16"});
  check_refused_chart({"--rounds", "0"}, {"--rounds '0'", "1 to 100"});
  check_refused_chart({"figures"}, {"unexpected argument 'figures'"});
  const TemporaryDirectory directory;
  check_refused(directory, {"chart", "--size", "0x64", "-o", directory.file("out")}, 2,
                {"--size '0x64'"});
  check_refused(directory, {"chart", "--quick"}, 2, {"-o is missing"});
}

TEST_CASE("chart: two scenes of one name are refused") {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory.file("a"));
  for (const char* file : {"mine.toml", "a/mine.toml"}) write_file(directory.file(file), kCube);
  check_refused(
      directory,
      {"chart", "--scenes", directory.file("mine.toml") + "," + directory.file("a/mine.toml"), "-o",
       directory.file("out")},
      2, {"--scenes", "called mine too"});
}

TEST_CASE("chart: a place that cannot be written to is told before anything is measured") {
  if (!has_gnuplot()) return;
  const TemporaryDirectory directory;
  write_file(directory.file("file"), "");
  check_refused(directory, small_chart(directory.file("file")), 1, {directory.file("file"), "-o"});
  check_refused(directory, small_chart("/dev/null/chart"), 1, {"/dev/null/chart", "-o"});
}

TEST_CASE("chart: without gnuplot the package is named") {
  const TemporaryDirectory directory;
  const std::string path = std::getenv("PATH") != nullptr ? std::getenv("PATH") : "";
  ::setenv("PATH", directory.path().c_str(), 1);
  check_refused(directory, small_chart(directory.file("out")), 1, {"gnuplot-nox"});
  ::setenv("PATH", path.c_str(), 1);
}

TEST_CASE("chart: the help names every option") {
  const ProgramRun run = run_program({"chart", "--help"});
  CHECK(run.status == 0);
  for (const char* option : {"-o,--output DIR", "--scenes A,B,...", "--methods A,B,...",
                             "--size WxH", "--quick", "--samples N", "--rounds N", "--frame N",
                             "--scene-path DIR", "--threads N", "--isa NAME", "--again"}) {
    CAPTURE(option);
    CHECK(contains(run.out, std::string{"  "} + option));
  }
}
