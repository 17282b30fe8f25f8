// render --shutter, and `shutter` in a scene's [camera].

#include "scenes/lens_views/lens_view_method.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"

using namespace softfocus;

namespace {

// The words for a scene whose camera goes around.
Words open_for(const char* frames, const Words& more = {}) {
  Words words{"--method", "accumulation", "--samples", "16", "--shutter", frames};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

const Words kStill{"--method", "accumulation", "--samples", "16"};

void check_shutter_refused(const Words& more, const Words& named) {
  const TemporaryDirectory directory;
  Words words{"render", "figures", "--size", kSize, "-o", directory.file("a.png")};
  words.insert(words.end(), more.begin(), more.end());
  check_refused(directory, words, 2, named);
}

}  // namespace

TEST_CASE("--shutter 0 is the instant, to the byte") {
  CHECK(rendered("sphere-world", open_for("0"), "a.png") ==
        rendered("sphere-world", kStill, "a.png"));
  CHECK(rendered("sphere-world", open_for("2")) != rendered("sphere-world", kStill));
}

TEST_CASE("--shutter stands in the report and in the picture's notes, if it is open") {
  const nlohmann::json open = rendered_json("sphere-world", open_for("0.5"));
  CHECK(open["sampling"]["shutter_frames"] == 0.5);
  CHECK_FALSE(rendered_json("sphere-world", kStill)["sampling"].contains("shutter_frames"));
  const TemporaryDirectory directory;
  CHECK(run_program(render("sphere-world", directory.file("a.npy"), open_for("0.5"))).status == 0);
  CHECK(contains(read_file(directory.file("a.npy.json")), "\"shutter_frames\": 0.5"));
}

TEST_CASE("--shutter: shards join to the file of one run, and only with their like") {
  const TemporaryDirectory directory;
  const auto run = [&](const char* name, const char* frames, const Words& more) {
    CHECK(
        run_program(render("sphere-world", directory.file(name), open_for(frames, more))).status ==
        0);
    return directory.file(name);
  };
  const std::string one = run("1.sum", "2", {"--shard", "1/2"});
  const std::string two = run("2.sum", "2", {"--shard", "2/2"});
  const std::string other = run("other.sum", "1", {"--shard", "2/2"});
  const std::string joined = directory.file("joined.png");
  CHECK(run_program({"join", one, two, "-o", joined}).status == 0);
  CHECK(read_file(joined) == read_file(run("whole.png", "2", {})));
  const ProgramRun refused = run_program({"join", one, other, "-o", joined});
  CHECK(refused.status == 1);
  CHECK(contains(refused.err, "shutter_frames"));
}

TEST_CASE("--shutter: each frame of many is what it is alone") {
  const TemporaryDirectory directory;
  CHECK(run_program(
            render("sphere-world", directory.file("a%d.png"), open_for("1", {"--frames", "3..4"})))
            .status == 0);
  CHECK(
      run_program(render("sphere-world", directory.file("b.png"), open_for("1", {"--frame", "4"})))
          .status == 0);
  CHECK(read_file(directory.file("a4.png")) == read_file(directory.file("b.png")));
}

TEST_CASE("a scene's shutter counts where none is given, for the methods that have one") {
  const TemporaryDirectory directory;
  const std::string cube = "spin_degrees_per_frame = [0, 20, 0]\n";
  const std::string still = directory.file("still.toml"), open = directory.file("open.toml");
  write_file(still, kCube + cube);
  write_file(open, "[camera]\nshutter = 0.5\n" + kCube + cube);
  CHECK(rendered(open, kStill) == rendered(still, open_for("0.5")));
  CHECK(rendered(open, open_for("0")) == rendered(still, kStill));
  const std::string instant = directory.file("instant.npy");
  CHECK(run_program(render(open, instant, {"--method", "two-pass"})).status == 0);
  CHECK(read_file(instant) == rendered(still, {"--method", "two-pass"}));
}

TEST_CASE("--shutter: methods of one instant refuse it, and so does what is no time") {
  for (const char* method : {"two-pass", "pinhole", "filtered-views", "surface-splatting"}) {
    check_shutter_refused({"--method", method, "--shutter", "0.5"},
                          {"--shutter", method, "one instant", "accumulation"});
  }
  check_shutter_refused({"--method", "auto", "--shutter", "0.5"}, {"--shutter", "accumulation"});
  if (find_lens_view_method("ray-traced")->missing.empty()) {
    check_shutter_refused({"--method", "ray-traced", "--shutter", "1"}, {"--shutter", "instant"});
  }
  for (const char* value : {"-1", "64.5", "nan", "half", ""}) {
    check_shutter_refused({"--method", "accumulation", "--shutter", value},
                          {"--shutter", "from 0 to 64"});
  }
}

TEST_CASE("a scene's shutter is a time of 0 to 64 frames") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.toml"), "[camera]\nshutter = -0.5\n" + kCube);
  const ProgramRun run =
      run_program({"render", directory.file("a.toml"), "-o", directory.file("a.png")});
  CHECK(run.status == 1);
  CHECK(contains(run.err, "a.toml:2: "));
  CHECK(contains(run.err, "shutter"));
}

TEST_CASE("a scene whose shutter is open is not shown at one instant without a word") {
  const auto said = [](const char* scene, const Words& words) {
    const TemporaryDirectory directory;
    const ProgramRun run = run_program(render(scene, directory.file("a.npy"), words));
    CHECK(run.status == 0);
    return contains(run.err, "shutter is open for 0.5 frames") &&
           contains(run.err, "--effect motion-blur") && contains(run.err, "--method accumulation");
  };
  CHECK(said("windmill", {"--method", "two-pass"}));
  CHECK_FALSE(said("windmill", {"--method", "two-pass", "--effect", "motion-blur"}));
  CHECK_FALSE(said("windmill", {"--method", "accumulation", "--samples", "4"}));
  CHECK_FALSE(said("windmill", {"--show", "pinhole"}));
  CHECK_FALSE(said("figures", {"--method", "two-pass"}));
}
