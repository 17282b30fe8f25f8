// softfocus render with effects that make frames from those before.

#include "tests/support/cli_refused.h"
#include "tests/support/frame_runs.h"

using namespace softfocus;

namespace {

/// cube-room, whose cubes move, so small that it is fast.
Words small(const std::string& output, const Words& more) {
  return joined({"render", "cube-room", "-o", output, "--size", "64x48", "--show", "pinhole"},
                more);
}

const Words kAntiAliased{"--effect", "temporal-aa:warm-up=2"};

}  // namespace

TEST_CASE("render: frames with a history go on where a run stopped, with the bits of one run") {
  const TemporaryDirectory whole, stopped;
  check_run(small(whole.file("f_%d.npy"), joined(kAntiAliased, {"--frames", "3..8"})), 0,
            "6 frames: 6 made");
  check_run(small(stopped.file("f_%d.npy"), joined(kAntiAliased, {"--frames", "3..8"})), 0,
            "6 frames: 6 made");
  for (const char* frame : {"5", "8"}) {
    std::filesystem::remove(stopped.file(std::string{"f_"} + frame + ".npy"));
  }
  check_run(small(stopped.file("f_%d.npy"), joined(kAntiAliased, {"--frames", "3..8"})), 0,
            "6 frames: 2 made, 4 were there");
  for (const char* frame : {"5", "8"}) {
    const std::string name = std::string{"f_"} + frame + ".npy";
    CHECK(same_files(whole.file(name), stopped.file(name)));
  }
}

TEST_CASE("render: shards of frames with a history have the bits of one run") {
  const TemporaryDirectory whole, shards;
  const Words options{"--effect", "refresh:groups=3", "--frames", "0..3"};
  check_run(small(whole.file("f_%d.npy"), options), 0, "4 frames: 4 made");
  for (const char* shard : {"1/2", "2/2"}) {
    check_run(small(shards.file("f_%d.npy"), joined(options, {"--shard", shard})), 0,
              "2 frames: 2 made");
  }
  for (const char* name : {"f_0.npy", "f_1.npy", "f_2.npy", "f_3.npy"}) {
    CHECK(same_files(whole.file(name), shards.file(name)));
  }
}

TEST_CASE("render: a run that begins elsewhere makes frames with a history anew") {
  const TemporaryDirectory directory;
  const Words options{"--effect", "temporal-aa"};
  check_run(small(directory.file("f_%d.npy"), joined(options, {"--frames", "0..3"})), 0,
            "4 frames: 4 made");
  check_run(small(directory.file("f_%d.npy"), joined(options, {"--frames", "2..3"})), 0,
            "2 frames: 2 made");
}

TEST_CASE("render: one frame with its warm-up is the last of a run of as many frames") {
  const TemporaryDirectory directory;
  check_run(small(directory.file("f_%d.npy"), {"--frames", "4..7", "--effect", "temporal-aa"}), 0,
            "4 frames: 4 made");
  const std::string one = directory.file("one.npy");
  CHECK(run_program(small(one, {"--frame", "7", "--effect", "temporal-aa:warm-up=3"})).status == 0);
  CHECK(same_files(one, directory.file("f_7.npy")));
}

TEST_CASE("render: an effect that does not go with the rest is refused, with a reason") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("a.npy");
  const auto refused = [&](const Words& options, const std::string& reason) {
    const ProgramRun run = run_program(small(out, options));
    CHECK(run.status == 2);
    CHECK(run.err.find(reason) != std::string::npos);
  };
  refused({"--effect", "bloom", "--effect", "temporal-aa"},
          "temporal-aa is part of the drawing; name it before all other effects");
  refused({"--effect", "refresh", "--effect", "temporal-aa"}, "give one");
  refused({"--effect", "temporal-aa:new=0"}, "0.001 to 1");
  const ProgramRun lens = run_program({"render", "cube-room", "-o", out, "--size", "32x32",
                                       "--method", "accumulation", "--effect", "temporal-aa"});
  CHECK(lens.status == 2);
  CHECK(lens.err.find("--method accumulation draws the scene itself") != std::string::npos);
  REQUIRE(run_program(small(out, {})).status == 0);
  const ProgramRun applied =
      run_program({"apply", out, "-o", directory.file("b.npy"), "--effect", "refresh"});
  CHECK(applied.status == 2);
  CHECK(applied.err.find("makes frames of a scene from those before") != std::string::npos);
}
