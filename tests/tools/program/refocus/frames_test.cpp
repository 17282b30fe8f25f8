// softfocus refocus of many pictures: the frames of single runs, whatever stops a run.

#include "tests/support/cli_refused.h"
#include "tests/support/frame_runs.h"

using namespace softfocus;

namespace {

/// Pinhole pictures of figures and their depths: c_0001.npy and d_0001.pfm, and so on.
void draw_frames(const TemporaryDirectory& directory, int count, const char* size = kSize) {
  const ProgramRun run =
      run_program({"render", "figures", "--size", size, "--show", "pinhole", "--frames",
                   "1.." + std::to_string(count), "-o", directory.file("c_%04d.npy"),
                   "--depth-output", directory.file("d_%04d.pfm")});
  CHECK(run.status == 0);
  std::filesystem::remove(directory.file("c_%04d.npy.journal"));
}

Words refocus(const TemporaryDirectory& directory, const std::string& output,
              const Words& more = {}) {
  return joined(joined({"refocus", directory.file("c_%04d.npy"), directory.file("d_%04d.pfm"), "-o",
                        directory.file(output)},
                       kWideLens),
                more);
}

std::string name_of_frame(const std::string& start, int frame) {
  return start + "000" + std::to_string(frame);
}

void cut(const std::string& file) { std::filesystem::resize_file(file, 200); }

}  // namespace

TEST_CASE("refocus: frames of one run are the files of single runs, byte by byte" *
          doctest::test_suite("threads")) {
  const TemporaryDirectory directory;
  draw_frames(directory, 4);
  for (const char* threads : {"1", "3"}) {
    check_run(refocus(directory, "o_%04d.png", {"--threads", threads, "--again"}), 0,
              "4 frames: 4 made");
    for (int frame = 1; frame <= 4; ++frame) {
      const Words single = joined(
          {"refocus", directory.file(name_of_frame("c_", frame) + ".npy"),
           directory.file(name_of_frame("d_", frame) + ".pfm"), "-o", directory.file("single.png")},
          kWideLens);
      CHECK(run_program(single).status == 0);
      CHECK(same_files(directory.file(name_of_frame("o_", frame) + ".png"),
                       directory.file("single.png")));
    }
  }
}

TEST_CASE("refocus: a glob's files are taken by their numbers, and --frames takes some") {
  const TemporaryDirectory directory;
  draw_frames(directory, 4);
  check_run(refocus(directory, "o_%04d.png"), 0, "4 frames: 4 made");
  Words words = refocus(directory, "g_%d.png", {"--frames", "2..4:2"});
  words[1] = directory.file("c_*.npy");
  words[2] = directory.file("d_?00[0-9].pfm");
  check_run(words, 0, "2 frames: 2 made");
  CHECK(same_files(directory.file("g_2.png"), directory.file("o_0002.png")));
  CHECK(same_files(directory.file("g_4.png"), directory.file("o_0004.png")));
  CHECK(!std::filesystem::exists(directory.file("g_1.png")));
}

TEST_CASE("refocus: one picture with keys of focus is refocused frame by frame") {
  const TemporaryDirectory directory;
  draw_frames(directory, 1);
  const Words lens{"--f-number", "1", "--coc-scale", "3", "--max-coc", "12"};
  const auto of = [&](const std::string& output, const Words& more) {
    return joined(joined({"refocus", directory.file("c_0001.npy"), directory.file("d_0001.pfm"),
                          "-o", directory.file(output)},
                         lens),
                  more);
  };
  check_run(of("o_%d.png", {"--frames", "1..3", "--focus", "1:1 3:1.5"}), 0, "3 frames: 3 made");
  CHECK(run_program(of("single.png", {"--focus", "1.25"})).status == 0);
  CHECK(same_files(directory.file("o_2.png"), directory.file("single.png")));
}

TEST_CASE("refocus: what is there is not made again, unless what it is made from has changed") {
  const TemporaryDirectory directory;
  draw_frames(directory, 4);
  const Words words = refocus(directory, "o_%04d.png");
  const std::string output = directory.file("o_0002.png");
  check_run(words, 0, "4 frames: 4 made");
  const auto written = std::filesystem::last_write_time(output);
  CHECK(contains(check_run(words, 0, "4 frames: 0 made, 4 were there"),
                 "softfocus: 4 of 4 frames are there\n"));
  CHECK(std::filesystem::last_write_time(output) == written);
  const std::string again_made_one = "4 frames: 1 made, 3 were there";

  const auto later = [](const std::string& file) {
    std::filesystem::last_write_time(
        file, std::filesystem::last_write_time(file) + std::chrono::seconds{1});
  };
  later(directory.file("d_0003.pfm"));
  check_run(words, 0, again_made_one);
  later(directory.file("c_0002.npy.json"));  // the notes of a picture are read too
  check_run(words, 0, again_made_one);
  later(output);
  check_run(words, 0, again_made_one);
  std::filesystem::remove(output);
  check_run(words, 0, again_made_one);
  check_run(joined(words, {"--threads", "1", "--isa", "scalar"}), 0,
            "4 frames: 0 made, 4 were there");
  check_run(joined(words, {"--again"}), 0, "4 frames: 4 made");
  check_run(joined(words, {"--leak", "0"}), 0, "4 frames: 4 made");
  check_run(words, 0, "4 frames: 4 made");
}

TEST_CASE("refocus: of other keys, only frames with another focus are made again") {
  const TemporaryDirectory directory;
  draw_frames(directory, 1);
  const auto of = [&](const std::string& focus) {
    return Words{"refocus",  directory.file("c_0001.npy"),
                 "-o",       directory.file("o_%d.png"),
                 "--frames", "1..5",
                 "--focus",  focus};
  };
  check_run(of("1:2 3:3 5:4"), 0, "5 frames: 5 made");
  check_run(of("1:2m 3:3m 5:5m"), 0, "5 frames: 2 made, 3 were there");
}

TEST_CASE("refocus: shards make all frames together, which a whole run finds") {
  const TemporaryDirectory directory;
  draw_frames(directory, 5);
  check_run(refocus(directory, "o_%04d.png", {"--shard", "1/2"}), 0, "3 frames: 3 made");
  check_run(refocus(directory, "o_%04d.png", {"--shard", "2/2"}), 0, "2 frames: 2 made");
  check_run(refocus(directory, "o_%04d.png"), 0, "5 frames: 0 made, 5 were there");
  check_run(refocus(directory, "o_%04d.png", {"--shard", "6/9"}), 0, "0 frames: 0 made");
}

TEST_CASE("refocus: a bad frame is one line, and the others are made") {
  const TemporaryDirectory directory;
  draw_frames(directory, 4);
  const std::string bad = directory.file("c_0002.npy");
  const std::string good_bytes = read_file(bad);
  cut(bad);
  std::filesystem::remove(bad + ".json");
  const Words words = refocus(directory, "o_%04d.png");
  const std::string said = check_run(words, 1, "4 frames: 3 made, 1 failed (2)");
  // Whichever frame is made first says what is believed of the depth.
  CHECK(std::count(said.begin(), said.end(), '\n') == 3);
  CHECK(contains(said, ": the depth is "));
  CHECK(contains(said, "softfocus: frame 2: cannot read '" + bad + "'"));
  CHECK(!std::filesystem::exists(directory.file("o_0002.png")));
  CHECK(std::filesystem::exists(directory.file("o_0004.png")));
  const ProgramRun json = run_program(joined(words, {"--json"}));
  const auto report = nlohmann::json::parse(json.out);
  CHECK(report["frames"] == 4);
  CHECK(report["there"] == 3);
  CHECK(report["failed"][0]["frame"] == 2);
  CHECK(report["failed"][0]["file"] == bad);
  write_file(bad, good_bytes);
  check_run(words, 0, "4 frames: 1 made, 3 were there");
}

TEST_CASE(
    "refocus: in a video the picture before stands for a bad frame, before the first the first") {
  const TemporaryDirectory directory;
  draw_frames(directory, 5);
  Words words = refocus(directory, "x", {"--format", "rgb24"});
  words[4] = "-";
  const std::string good = run_program(words).out;
  const std::size_t length = 3 * kWidth * kHeight;
  REQUIRE(good.size() == 5 * length);
  const auto frame = [&](std::size_t number) { return good.substr((number - 1) * length, length); };
  for (const char* name : {"c_0001.npy", "c_0004.npy"}) cut(directory.file(name));
  for (const char* threads : {"1", "4"}) {
    const ProgramRun run = run_program(joined(words, {"--threads", threads}));
    CHECK(run.status == 1);
    CHECK(run.err.ends_with("softfocus: 5 frames: 3 made, 2 failed (1, 4)\n"));
    CHECK((run.out == frame(2) + frame(2) + frame(3) + frame(3) + frame(5)));
  }
}

TEST_CASE("refocus: a frame of another size is a bad one in a video, and none in files") {
  const TemporaryDirectory directory, other;
  draw_frames(directory, 3);
  draw_frames(other, 3, "32x32");
  for (const char* name : {"c_0002.npy", "c_0002.npy.json", "d_0002.pfm"}) {
    std::filesystem::copy_file(other.file(name), directory.file(name),
                               std::filesystem::copy_options::overwrite_existing);
  }
  check_run(refocus(directory, "o_%d.png"), 0, "3 frames: 3 made");
  Words words = refocus(directory, "x", {"--format", "rgb24"});
  words[4] = "-";
  const ProgramRun run = run_program(words);
  CHECK(run.status == 1);
  CHECK(contains(run.err, "frame 2, '" + directory.file("c_0002.npy") + "': has another size"));
  CHECK(run.out.size() == 3u * 3 * kWidth * kHeight);
}

TEST_CASE("refocus: a full disk ends the run after three frames, and leaves none half-written") {
  const TemporaryDirectory directory;
  draw_frames(directory, 6);
  const std::vector<std::string> before = directory.listing();
  const ProgramRun run =
      run_program(refocus(directory, "o_%04d.npy", {"--threads", "1"}), {.file_size_limit = 2000});
  CHECK(run.status == 1);
  for (int frame = 1; frame <= 3; ++frame) {
    CHECK(contains(run.err, "softfocus: frame " + std::to_string(frame) + ", '" +
                                directory.file(name_of_frame("c_", frame)) +
                                ".npy': cannot write '" +
                                directory.file(name_of_frame("o_", frame))));
  }
  CHECK(contains(run.err, "stopped"));
  CHECK(run.err.ends_with("softfocus: 6 frames: 0 made, 3 failed (1, 2, 3), 3 left\n"));
  std::vector<std::string> after = before;
  after.emplace_back("o_%04d.npy.journal");
  std::sort(after.begin(), after.end());
  CHECK(directory.listing() == after);
  check_run(refocus(directory, "o_%04d.npy"), 0, "6 frames: 6 made");
  check_run(refocus(directory, "w_%04d.npy"), 0, "6 frames: 6 made");
  for (int frame = 1; frame <= 6; ++frame) {
    CHECK(same_files(directory.file(name_of_frame("o_", frame) + ".npy"),
                     directory.file(name_of_frame("w_", frame) + ".npy")));
  }
}

TEST_CASE("refocus: a run that is killed on a full disk loses nothing either") {
  const TemporaryDirectory directory;
  constexpr int kFrames = 12;
  draw_frames(directory, kFrames, "128x96");
  const Words words = refocus(directory, "o_%04d.png", {"--threads", "1"});
  // The disk has room for pictures, but for one line more of the journal at most.
  const std::string journal = directory.file("o_%04d.png.journal");
  constexpr std::size_t kRoom = 100'000;
  write_file(journal, std::string(kRoom - 150, 'x') + "\n");
  REQUIRE(signal_that_ended(words, SIGKILL,
                            [&] { return std::filesystem::exists(directory.file("o_0004.png")); },
                            {.file_size_limit = kRoom}) == SIGKILL);
  CHECK(read_file(journal).size() <= kRoom);
  CHECK(run_program(words).status == 0);
  check_run(refocus(directory, "w_%04d.png"), 0, "12 frames: 12 made");
  for (int frame = 1; frame <= kFrames; ++frame) {
    const std::string number = (frame < 10 ? "000" : "00") + std::to_string(frame) + ".png";
    CHECK(same_files(directory.file("o_" + number), directory.file("w_" + number)));
  }
}

TEST_CASE("refocus: a run that is killed goes on where it stopped, with the same files") {
  const TemporaryDirectory directory;
  constexpr int kFrames = 40;
  draw_frames(directory, kFrames, "128x96");
  const Words words = refocus(directory, "o_%04d.png", {"--threads", "2"});
  // As soon as some frames are there.
  const std::string journal = directory.file("o_%04d.png.journal");
  const auto lines = [&] {
    const std::string text = read_file(journal);
    return std::count(text.begin(), text.end(), '\n');
  };
  REQUIRE(signal_that_ended(words, SIGKILL, [&] { return lines() >= 3; }) == SIGKILL);
  const auto made = static_cast<int>(lines());
  REQUIRE(made >= 3);
  REQUIRE(made < kFrames);
  check_run(words, 0,
            "40 frames: " + std::to_string(kFrames - made) + " made, " + std::to_string(made) +
                " were there");
  check_run(refocus(directory, "w_%04d.png"), 0, "40 frames: 40 made");
  for (int frame = 1; frame <= kFrames; ++frame) {
    const std::string number = (frame < 10 ? "000" : "00") + std::to_string(frame) + ".png";
    CHECK(same_files(directory.file("o_" + number), directory.file("w_" + number)));
  }
}

TEST_CASE("refocus: frames that cannot be right are refused before one is made") {
  const TemporaryDirectory directory;
  draw_frames(directory, 3);
  const auto refused = [&](const std::string& output, const Words& more, const Words& named) {
    check_refused(directory, refocus(directory, output, more), 2, named);
  };
  refused("o.png", {}, {"-o", "o.png", "all frames would be one file", "frame_%04d.exr"});
  refused("c_%04d.npy", {}, {"c_0001.npy", "written over"});
  refused("c_%04d.npy.json", {"--format", "png"}, {"c_0001.npy.json", "written over"});
  refused("o_%d.png", {"--frames", "2..9"},
          {"COLOUR", "of 8 frames 6 have no file", "c_0004.npy", "and 1 more"});
  std::filesystem::remove(directory.file("d_0002.pfm"));
  refused("o_%d.png", {}, {"DEPTH", "of 3 frames 1 have no file", "d_0002.pfm"});
  const auto of_one = [&](const std::string& colour, const std::string& output, const Words& more,
                          const Words& named) {
    check_refused(directory,
                  joined({"refocus", directory.file(colour), "-o", directory.file(output)}, more),
                  2, named);
  };
  of_one("c_0001.npy", "o.png", {"--focus", "1:2 5:3"}, {"--focus", "--frames"});
  of_one("c_0001.npy", "o_%d.png", {}, {"o_%d.png", "--frames"});
  of_one("x_%d.npy", "o_%d.png", {}, {"COLOUR", "no such file"});
  of_one("x*.npy", "o_%d.png", {}, {"COLOUR", "no file fits"});
  of_one("c_%d_%d.npy", "o_%d.png", {}, {"COLOUR", "two numbers"});
  check_refused(directory, {"inspect", directory.file("c_0001.npy"), "--focus", "1:2"}, 2,
                {"--focus"});
}
