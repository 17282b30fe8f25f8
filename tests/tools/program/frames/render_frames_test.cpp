// softfocus render --frames: a run's frames are those of single runs.

#include "tests/support/cli_refused.h"
#include "tests/support/frame_runs.h"

using namespace softfocus;

TEST_CASE("render: frames of one run are the files of single runs, byte by byte" *
          doctest::test_suite("threads")) {
  for (const std::string threads : {"1", "3"}) {
    for (const std::string method : {"two-pass", "accumulation"}) {
      CAPTURE(method);
      Words options = joined(kWideLens, {"--method", method});
      if (method == "accumulation") {
        options = {"--method", method, "--samples", "16", "--focus", "1.1", "--f-number", "1"};
      }
      const TemporaryDirectory directory, single;
      check_run(render("figures", directory.file("f_%02d.npy"),
                       joined(options, {"--frames", "2..8:3", "--threads", threads,
                                        "--depth-output", directory.file("d_%02d.pfm")})),
                0, "3 frames: 3 made");
      CHECK(directory.listing() == Words{"d_02.pfm", "d_05.pfm", "d_08.pfm", "f_%02d.npy.journal",
                                         "f_02.npy", "f_02.npy.json", "f_05.npy", "f_05.npy.json",
                                         "f_08.npy", "f_08.npy.json"});
      for (const std::string frame : {"2", "5", "8"}) {
        CHECK(run_program(render("figures", single.file("f_0" + frame + ".npy"),
                                 joined(options, {"--frame", frame, "--depth-output",
                                                  single.file("d_0" + frame + ".pfm")})))
                  .status == 0);
        for (const std::string& name :
             {"f_0" + frame + ".npy", "f_0" + frame + ".npy.json", "d_0" + frame + ".pfm"}) {
          CAPTURE(name);
          CHECK(same_files(directory.file(name), single.file(name)));
        }
      }
    }
  }
}

TEST_CASE("render: layers and reports of many frames are a file each") {
  const TemporaryDirectory directory;
  check_run(render("figures", directory.file("f_%d.png"),
                   {"--frames", "0..1", "--show", "pinhole", "--layers", "2", "--report",
                    directory.file("r_%d.txt")}),
            0, "2 frames: 2 made");
  CHECK(directory.listing() == Words{"f_%d.png.journal", "f_0.layer2.png", "f_0.png",
                                     "f_1.layer2.png", "f_1.png", "r_0.txt", "r_1.txt"});
}

TEST_CASE("render: keys of focus and f-number give the frames that their values give") {
  const TemporaryDirectory directory;
  check_run(render("figures", directory.file("f_%d.npy"),
                   {"--frames", "1..5", "--focus", "1:90cm 5:1.3m", "--f-number", "1:1, 5:2",
                    "--coc-scale", "3", "--max-coc", "12"}),
            0, "5 frames: 5 made");
  const Words of_third{"--focus",     "1.1", "--f-number", "1.5",
                       "--coc-scale", "3",   "--max-coc",  "12"};
  CHECK(read_file(directory.file("f_3.npy")) ==
        rendered("figures", joined(of_third, {"--frame", "3"})));
  // A single frame of the same keys, and of a smooth way, which has the same middle.
  for (const char* way : {"linear", "smooth"}) {
    CHECK(read_file(directory.file("f_3.npy")) ==
          rendered("figures", {"--frame", "3", "--focus", "1:90cm 5:1.3m", "--f-number", "1:1 5:2",
                               "--keyframes", way, "--coc-scale", "3", "--max-coc", "12"}));
  }
}

TEST_CASE("render: a scene's own keys are at work, and are overruled by options") {
  const TemporaryDirectory directory;
  const auto scene = [&](const std::string& focus) {
    write_file(directory.file("s.toml"),
               "[lens]\nf_number = 0.5\nmax_coc_px = 500\nfocus_m = " + focus + "\n" + kCube);
    return directory.file("s.toml");
  };
  const std::string fixed = rendered(scene("2.75"), {"--frame", "2"});
  const std::string by_option = rendered(scene("2.75"), {"--frame", "2", "--focus", "2"});
  CHECK(fixed != by_option);
  const std::string keyed = scene("[[0, 2.5], [4, 3]]");
  CHECK(rendered(keyed, {"--frame", "2"}) == fixed);
  CHECK(rendered(keyed, {"--frame", "2", "--focus", "2"}) == by_option);
  check_run(render(keyed, directory.file("f_%d.npy"), {"--frames", "1..2"}), 0, "2 frames: 2 made");
  CHECK(read_file(directory.file("f_2.npy")) == fixed);
}

TEST_CASE("render: raw video is the colours of the frames' PNG files, in order") {
  for (const char* format : {"rgb24", "rgb48le"}) {
    const TemporaryDirectory directory;
    std::string frames;
    for (const char* frame : {"0", "1", "2"}) {
      run_program(
          render("figures", directory.file("a.rgb"), {"--format", format, "--frame", frame}));
      frames += read_file(directory.file("a.rgb"));
    }
    CHECK(frames.size() == 3u * kWidth * kHeight * (std::string{format} == "rgb24" ? 3 : 6));
    for (const char* threads : {"1", "4"}) {
      const ProgramRun run = run_program(
          render("figures", "-", {"--format", format, "--frames", "0..2", "--threads", threads}));
      CHECK(run.status == 0);
      CHECK(run.err == "softfocus: 3 frames: 3 made\n");
      CHECK(run.out == frames);
    }
  }
}

TEST_CASE("render: a reader that has seen enough of a video ends it without a word") {
  const TemporaryDirectory directory;
  const std::string command =
      "( '" SOFTFOCUS_PROGRAM
      "' render figures --size 48x32 --frames 0..200000 --format rgb24 -o - 2>'" +
      directory.file("err") + "'; echo $? >'" + directory.file("status") +
      "' ) | head -c 10000 >'" + directory.file("out") + "'";
  CHECK(std::system(command.c_str()) == 0);
  CHECK(read_file(directory.file("out")).size() == 10000);
  CHECK(read_file(directory.file("status")) == "0\n");
  CHECK(read_file(directory.file("err")) == "");
}

TEST_CASE("render: a video that the disk has no room for ends with one line") {
  const ProgramRun run = run_program(
      render("figures", "-", {"--frames", "0..50", "--format", "rgb24", "--threads", "2"}),
      {.out_to = "/dev/full"});
  CHECK(run.status == 1);
  CHECK(contains(run.err, "softfocus: cannot write 'standard output': No space left on device"));
  CHECK(run.err.ends_with("softfocus: 51 frames: 0 made, 51 left\n"));
}

TEST_CASE("render: frames that cannot be right are refused before one is made") {
  const TemporaryDirectory directory;
  const auto refused = [&](const std::string& output, const Words& more, const Words& named) {
    check_refused(directory, render("figures", output == "-" ? "-" : directory.file(output), more),
                  2, named);
  };
  const std::string numbered = "f_%04d.png";
  refused("f.png", {"--frames", "1..3"}, {"-o", "f.png", "all frames would be one file"});
  refused(numbered, {}, {numbered, "--frames A..B"});
  refused(numbered, {"--frames", "3..1"}, {"--frames '3..1'", "1..48"});
  refused(numbered, {"--frames", "1..3", "--frame", "1"}, {"--frame and --frames"});
  refused(numbered, {"--frames", "1..3", "--report", directory.file("r.txt")}, {"--report"});
  refused(numbered, {"--frames", "1..3", "--report", directory.file(numbered)}, {"--report", "-o"});
  refused(numbered, {"--frames", "1..3", "--shard", "4/3"}, {"--shard '4/3'", "1/8"});
  refused("-", {"--frames", "1..3", "--shard", "1/3"}, {"--shard", "-o -"});
  refused("f.png", {"--again"}, {"--again", "--frames"});
  refused(numbered, {"--frames", "1..3", "--focus", "2:1 1:3"}, {"--focus", "increase"});
  refused(numbered, {"--frames", "1..3", "--focus", "1:2 x"}, {"--focus 'x'", "FRAME:VALUE"});
  refused(numbered, {"--frames", "1..3", "--f-number", "1:0"}, {"--f-number"});
  refused(numbered, {"--frames", "1..3", "--focus", "1:2 3:4cm"}, {"frame 3", "0.04 m"});
  refused(numbered, {"--frames", "1..3", "--keyframes", "cubic"}, {"linear, smooth"});
  refused(numbered, {"--frames", "1..3", "--focus", "1:2", "--autofocus"}, {"--autofocus"});
  // A name that leads to another frame's.
  std::filesystem::create_symlink("f_0002.png", directory.file("f_0001.png"));
  refused(numbered, {"--frames", "1..3"}, {"f_0002.png", "two"});
  write_file(directory.file("0.toml"), kCube);
  check_refused(directory,
                render(directory.file("0.toml"), directory.file("%d.toml"),
                       {"--frames", "0..2", "--format", "png"}),
                2, {"0.toml", "written over"});
}
