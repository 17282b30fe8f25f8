// chart from end to end. They check that times are there, not what they are.

#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tools/chart/subject.h"

using namespace softfocus;

namespace {

using nlohmann::json;

const Words kFiles{"best.csv",   "best.json",  "cache",       "chart.csv",
                   "chart.json", "index.html", "summary.csv", "summary.json"};

json report_in(const std::string& directory) {
  return report_of_page(read_file(directory + "/index.html"));
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

TEST_CASE("chart: writes its files, and goes on from what is there to the same results") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("new/chart");
  const ProgramRun first = run_program(small_chart(out));
  CHECK(first.status == 0);
  CHECK(first.err == "");
  CHECK(contains(first.out, "figures: noise of the truth, FLIP "));
  CHECK_FALSE(contains(first.out, "went on"));
  CHECK(listing_of(out) == kFiles);

  const json list = json::parse(read_file(out + "/chart.json"));
  REQUIRE(list.size() == 7);
  CHECK(list[0]["method"] == "pinhole");
  CHECK(list[1]["settings"] == json{{"max_coc_px", 1.0}, {"profile", "ieee"}});
  CHECK(list[4]["settings"] == json{{"max_coc_px", 4.0}, {"profile", "d3d11"}});
  CHECK(list[6]["settings"] ==
        json{{"max_coc_px", 4.0}, {"profile", "ieee"}, {"arithmetic", "fixed-8"}});
  for (const json& point : list) {
    CHECK(point["scene"] == "figures");
    CHECK(point["rounds"] == 3);
    CHECK(point["median_ms"] > 0.0);
    CHECK(point["filter_ms"] <= point["median_ms"]);
    CHECK(point["flip"] > 0.0);
    CHECK(point["hdr_flip"] > point["flip"]);
    CHECK(point["pinhole_frames"] ==
          point["median_ms"].get<double>() / list[0]["median_ms"].get<double>());
    CHECK(point["psnr_db"] > 10.0);
    CHECK(point["truth_samples"] == 128);
    CHECK(point["noise_floor_flip"] < point["flip"]);
  }
  CHECK(list[2]["psnr_db"] > list[0]["psnr_db"]);  // blurred is nearer to the truth than sharp
  CHECK(list[2]["flip"] != list[1]["flip"]);       // the settings count
  CHECK(list[4]["flip"] != list[2]["flip"]);
  CHECK(list[6]["flip"] != list[2]["flip"]);  // bytes are another picture, but hardly
  CHECK(list[6]["flip"].get<double>() ==
        doctest::Approx(list[2]["flip"].get<double>()).epsilon(0.2));

  const std::string csv = read_file(out + "/chart.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 8);
  CHECK(json::parse(read_file(out + "/best.json")).back()["budget"].is_null());
  CHECK(json::parse(read_file(out + "/summary.json")).size() == 10);
  CHECK(contains(read_file(out + "/index.html"), "</html>"));
  const json report = report_in(out);
  CHECK(report["parts"][0]["id"] == "chart");
  CHECK(report["pictures"].size() == 1 + 7 * 5);
  CHECK(report["command"] ==
        "softfocus chart --of depth-of-field --scenes figures --size 64x64 --rounds 3 --frame 0 "
        "--methods pinhole,two-pass --samples 128 --quick");

  const std::string truth = read_file(out + "/cache/figures.truth.npy");
  const ProgramRun second = run_program(small_chart(out));
  CHECK(second.status == 0);
  CHECK(second.out.starts_with("went on: 15 of 15 results were there already\n"));
  CHECK(json::parse(read_file(out + "/chart.json")) == list);
  CHECK(read_file(out + "/chart.csv") == csv);
  CHECK(read_file(out + "/cache/figures.truth.npy") == truth);
}

TEST_CASE("chart: what is missing or damaged is measured again, the rest is kept" *
          doctest::test_suite("long")) {
  const TemporaryDirectory directory;
  const std::string out = directory.file("chart");
  REQUIRE(run_program(small_chart(out)).status == 0);
  const json before = json::parse(read_file(out + "/chart.json"));
  std::filesystem::remove(out + "/cache/figures/pinhole.json");
  write_file(out + "/cache/figures/two-pass-r1.json", "{");
  const ProgramRun run = run_program(small_chart(out));
  CHECK(run.status == 0);
  CHECK(run.out.starts_with("went on: 13 of 15 results"));
  CHECK(json::parse(read_file(out + "/chart.json")) == before);

  const ProgramRun more = run_program(small_chart(out, {"--rounds", "4"}));
  CHECK(more.out.starts_with("went on: 8 of 15 results"));  // the truth and the errors
  CHECK(json::parse(read_file(out + "/chart.json"))[0]["rounds"] == 4);
  CHECK_FALSE(contains(run_program(small_chart(out, {"--again"})).out, "went on"));
}

TEST_CASE("chart: where circles are large, blurred is nearer to the truth than sharp, to the eye") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("chart"), scene = directory.file("mine.toml");
  write_file(scene, kCube + "[lens]\nf_number = 0.2\nfocus_m = 1.0\n");
  Words words = small_chart(out);
  words[2] = scene;
  REQUIRE(run_program(words).status == 0);
  const json list = json::parse(read_file(out + "/chart.json"));
  CHECK(list[2]["settings"]["max_coc_px"] == 4.0);
  CHECK(list[2]["flip"] < 0.7 * list[0]["flip"].get<double>());
}

TEST_CASE("chart: a scene that changed is measured anew") {
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

TEST_CASE("chart: a changed measure is noticed: what another measured is not taken") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("chart");
  const Words words = small_chart(out, {"--rounds", "0"});
  REQUIRE(run_program(words).status == 0);
  const std::string before = read_file(out + "/chart.csv");
  // As if the errors that are kept came from other measures.
  for (const auto& file : std::filesystem::recursive_directory_iterator{out + "/cache"}) {
    if (file.path().extension() != ".json") continue;
    std::string text = read_file(file.path().string());
    const std::size_t hash = text.find("measures 0x");
    REQUIRE(hash != text.npos);
    char& digit = text[hash + 11];
    digit = digit == '0' ? '1' : '0';
    const std::size_t flip = text.find("\"flip\": 0.");
    if (flip != text.npos) text[flip + 10] = '9';
    write_file(file.path().string(), text);
  }
  const ProgramRun run = run_program(words);
  CHECK(run.status == 0);
  CHECK_FALSE(contains(run.out, "went on"));
  CHECK(read_file(out + "/chart.csv") == before);
}

TEST_CASE("chart: two at once into one folder both succeed, and leave whole files") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("new/chart");
  const Words words{"chart",  "--scenes", "figures",   "--methods", "pinhole", "--quick",
                    "--size", "48x32",    "--samples", "128",       "-o",      out};
  auto other = std::async(std::launch::async, [&] { return run_program(words); });
  const ProgramRun one = run_program(words), two = other.get();
  for (const ProgramRun& run : {one, two}) {
    CHECK(run.status == 0);
    CHECK(run.err == "");
  }
  CHECK(listing_of(out) == kFiles);
  CHECK(listing_of(out + "/cache") == Words{"figures", "figures.truth.json", "figures.truth.npy"});
  CHECK(report_in(out)["parts"][0]["id"] == "chart");
  CHECK(run_program(words).out.starts_with("went on: 3 of 3"));
}

TEST_CASE("chart: without rounds there are errors and no times, for random scenes too") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("chart");
  const Words words{"chart",     "--scenes", "random:3..4", "--methods", "two-pass", "--quick",
                    "--size",    "48x32",    "--samples",   "128",       "--rounds", "0",
                    "--threads", "2",        "-o",          out};
  const ProgramRun run = run_program(words);
  CHECK(run.status == 0);
  CHECK(run.err == "");
  CHECK(contains(run.out, "FLIP over 2 scenes"));
  CHECK(listing_of(out) == kFiles);
  CHECK(report_in(out)["parts"][0]["id"] == "summary");  // no plot of times before it
  const json list = json::parse(read_file(out + "/chart.json"));
  REQUIRE(list.size() == 14);  // the pinhole is always there
  CHECK(list[0]["scene"] == "random:3");
  CHECK(list[0]["method"] == "pinhole");
  CHECK(list[13]["scene"] == "random:4");
  for (const json& point : list) {
    for (const char* name : {"median_ms", "pinhole_frames", "filter_ms", "on_front"}) {
      CHECK(point[name].is_null());
    }
    CHECK(point["rounds"] == 0);
  }
  CHECK(json::parse(read_file(out + "/summary.json"))[0]["scenes"] == 2);
  CHECK(std::filesystem::exists(out + "/cache/random-3/pinhole.json"));
  CHECK(run_program(words).out.starts_with("went on: 16 of 16"));
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
  check_refused_chart({"--rounds", "101"}, {"--rounds '101'", "0 to 100"});
  check_refused_chart({"--scenes", "random:9..3"}, {"--scenes 'random:9..3'", "random:64..127"});
  check_refused_chart({"--scenes", "figures,random:two"}, {"random:two"}, 1);
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

TEST_CASE("chart: writes over no file of its scenes, not by a link either") {
  const TemporaryDirectory directory;
  REQUIRE(run_program(render("figures", directory.file("m.png"))).status == 0);
  const std::string material = "newmtl red\nKd 1 0 0\nmap_Kd m.png\n";
  write_file(directory.file("chart.csv"), material);
  write_file(directory.file("m.obj"),
             "mtllib chart.csv\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Words words{"chart", "--scenes", "figures," + directory.file("m.obj"), "--quick", "-o"};
  const auto refused_into = [&](const std::string& output, const Words& named) {
    Words all = words;
    all.push_back(output);
    check_refused(directory, all, 2, named);
  };
  refused_into(directory.path(), {"-o '" + directory.file("chart.csv") + "'",
                                  "would write over a file of the scene m"});
  const TemporaryDirectory elsewhere;
  const std::string texture = read_file(directory.file("m.png"));
  std::filesystem::create_hard_link(directory.file("m.png"), elsewhere.file("best.csv"));
  refused_into(elsewhere.path(), {"-o '" + elsewhere.file("best.csv") + "'", "m.png"});
  CHECK(elsewhere.listing() == Words{"best.csv"});
  CHECK(read_file(directory.file("m.png")) == texture);
  CHECK(read_file(directory.file("chart.csv")) == material);
}

TEST_CASE("chart: a place that cannot be written to is told before anything is measured") {
  const TemporaryDirectory directory;
  write_file(directory.file("file"), "");
  check_refused(directory, small_chart(directory.file("file")), 1, {directory.file("file"), "-o"});
  check_refused(directory, small_chart("/dev/null/chart"), 1, {"/dev/null/chart", "-o"});
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

TEST_CASE("chart --of: another subject has its own truth, methods and page" *
          doctest::test_suite("long")) {
  const TemporaryDirectory directory;
  for (const ChartSubject& subject : chart_subjects().subspan(1)) {
    const std::string name{subject.name};
    CAPTURE(name);
    const std::string out = directory.file(name);
    const Words words{"chart",  "--of",  name, "--scenes", "crossing", "--quick",
                      "--size", "64x64", "-o", out,        "--rounds", "1"};
    REQUIRE(run_program(words).status == 0);
    CHECK(listing_of(out) == kFiles);
    const json report = report_in(out);
    CHECK(report["parts"][1]["id"] == (name == "impostors" ? "chart-outline-px"
                                       : name == "shadows" ? "chart-flip"
                                                           : "chart-hdr-flip"));
    const json list = json::parse(read_file(out + "/chart.json"));
    CHECK(list[0]["method"] == "pinhole");
    CHECK(list[0].contains("wrong_pixels") == (name == "shadows"));
    const std::size_t good = name == "bloom" ? 2 : list.size() - 1;
    if (name == "impostors") {
      CHECK(list[0]["flip"] == 0.0);
      CHECK(list[1]["renewals"] > 0.0);
    } else {
      CHECK(list[good]["flip"] < list[0]["flip"]);
    }
    CHECK(list[good]["settings"] == (name == "bloom"       ? json{{"levels", 6.0}}
                                     : name == "shadows"   ? json{{"size", 1024.0}}
                                     : name == "impostors" ? json{{"views", 6.0}}
                                                           : json{{"samples", 16}}));
    CHECK(report["title"] == std::string{subject.title} + ": speed against accuracy");
    CHECK_FALSE(contains(report.dump(), "of the lens"));
    CHECK(run_program(words).out.starts_with("went on: "));
  }
}

TEST_CASE("chart --of: what is no subject, and methods of another, are refused") {
  check_refused_chart({"--of", "fog"}, {"--of", "fog", "motion-blur"});
  check_refused_chart({"--of", "motion-blur", "--methods", "two-pass"},
                      {"--methods", "two-pass", "accumulation"});
  check_refused_chart({"--of", "bloom", "--samples", "256"}, {"--samples", "calculated"});
  check_refused_chart({"--of", "shadows", "--samples", "256"}, {"--samples", "calculated"});
  check_refused_chart({"--methods", "supersample"}, {"--methods", "supersample", "two-pass"});
}
