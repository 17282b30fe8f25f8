#include <sys/stat.h>

#include "tests/support/cli_refused.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

using Words = std::vector<std::string>;

/// A render of `figures` with these options is wrong usage, and the line names them.
void check_option_refused(const Words& options, const Words& named) {
  const TemporaryDirectory directory;
  Words words{"render", "figures", "-o", directory.file("out.png")};
  words.insert(words.end(), options.begin(), options.end());
  check_refused(directory, words, 2, named);
}

}  // namespace

TEST_CASE("bad input: sizes of nothing, past the limit and of no sense") {
  for (const std::string size :
       {"0x0", "0x5", "5x0", "100000x100000", "16385x1", "-1x5", "axb", "5", "5x", "x5", "5x5x5",
        "5.5x5", "", " 5x5", "99999999999999999999x1"}) {
    check_option_refused({"--size", size}, {"--size", "'" + size + "'", "1 to 16384"});
  }
}

TEST_CASE("bad input: numbers that are none, infinite, too large or too small") {
  struct Case {
    const char* option;
    Words values;
  };
  const Words always{"nan", "inf", "-inf", "1e999", "one", "1k", "0x10", "", "1 2", "1,5"};
  for (const auto& [option, values] :
       {Case{"--focus", {"0", "-1", "1e10"}}, Case{"--focal-length", {"0", "-50", "1e10"}},
        Case{"--f-number", {"0", "-2", "1e10"}}, Case{"--coc-scale", {"-0.1", "1e10"}},
        Case{"--max-coc", {"-1", "1024.5"}}, Case{"--leak", {"-0.5", "1e10"}},
        Case{"--frame", {"-1", "1e10"}}, Case{"--threads", {"0", "-1", "257", "1.5"}}}) {
    Words all = always;
    all.insert(all.end(), values.begin(), values.end());
    for (const std::string& value : all) check_option_refused({option, value}, {option, value});
  }
}

TEST_CASE("bad input: an aperture of 0 points to the pinhole method") {
  check_option_refused({"--f-number", "0"}, {"--f-number '0'", "pinhole"});
}

TEST_CASE("bad input: a budget outside 0 to 1, or of a method that has none") {
  for (const char* value : {"-0.1", "1.5", "half"}) {
    check_option_refused({"--method", "importance-ordered", "--budget", value},
                         {"--budget", value, "0 to 1"});
  }
  check_option_refused({"--method", "one-pass", "--budget", "0.5"},
                       {"--budget", "one-pass", "importance-ordered"});
}

TEST_CASE("bad input: a focal length longer than the focus distance names both") {
  check_option_refused({"--focal-length", "3000", "--focus", "2"},
                       {"--focal-length 3000 mm", "--focus 2 m", "shorter"});
  check_option_refused({"--focal-length", "3000"}, {"--focal-length 3000 mm", "shorter"});
  check_option_refused({"--focus", "0.01"}, {"--focus 0.01 m", "shorter"});
}

TEST_CASE("bad input: a focal length longer than the distance that autofocus finds") {
  check_option_refused({"--focal-length", "900000", "--autofocus", "--size", "16x16"},
                       {"--focal-length", "shorter"});
}

TEST_CASE("bad input: circles past single precision") {
  check_option_refused({"--f-number", "1e-300", "--size", "16x16"}, {"--f-number"});
}

TEST_CASE("bad input: an unknown name is answered with the names there are") {
  check_option_refused({"--method", "three-pass"},
                       {"'three-pass'", "pinhole, two-pass, two-pass-single, one-pass"});
  check_option_refused({"--profile", "voodoo"}, {"'voodoo'", "ieee, d3d11, llvmpipe"});
  check_option_refused({"--show", "me"}, {"'me'", "image, pinhole, coc, depth"});
  check_option_refused({"--format", "gif"}, {"'gif'", "png, png-16, pfm, npy"});
  check_option_refused({"--format", "pgn"}, {"did you mean 'png'?"});
  const TemporaryDirectory directory;
  check_refused(directory, {"render", "figurines", "-o", directory.file("out.png")}, 1,
                {"figurines", "clutter, crossing, cube-room, dunes, figures, foliage"});
}

TEST_CASE("bad input: --focus and --autofocus exclude each other") {
  check_option_refused({"--focus", "2", "--autofocus"}, {"--focus", "--autofocus", "exclude"});
}

TEST_CASE("bad input: an autofocus pixel outside the picture, or none at all") {
  for (const std::string pixel : {"16,0", "0,16", "-1,0", "0,-1"}) {
    check_option_refused({"--size", "16x16", "--autofocus", pixel},
                         {"--autofocus " + pixel, "0,0 to 15,15"});
  }
  for (const std::string pixel : {"5", "5,", ",5", "5,5,5", "5;5", "5.5,5", "99999999999,0"}) {
    check_option_refused({"--autofocus", pixel}, {"--autofocus", "'" + pixel + "'", "X,Y"});
  }
}

TEST_CASE("bad input: options that are unknown, twice there or without their value") {
  check_option_refused({"--colour", "red"}, {"--colour", "--help"});
  check_option_refused({"figures"}, {"'figures'"});
  check_option_refused({"scenes"}, {"'scenes'"});
  check_option_refused({"--size", "3x3", "--size", "4x4"}, {"--size", "twice"});
  check_option_refused({"--focus"}, {"--focus", "needs a value; softfocus render --help"});
  check_option_refused({"--json=5"}, {"--json takes no value"});
  check_option_refused({"--no-verify=no"}, {"--no-verify takes no value"});
  check_option_refused({"--focus", "--json"}, {"--focus", "needs a value", "'--json'"});
  check_option_refused({"--scene-path", "/nowhere/at/all"}, {"--scene-path", "/nowhere/at/all"});
}

TEST_CASE("bad input: what a subcommand needs is missing") {
  const TemporaryDirectory directory;
  check_refused(directory, {"render"}, 2, {"SCENE"});
  check_refused(directory, {"render", "figures"}, 2, {"-o"});
  check_refused(directory, {"render", "figures", "-o"}, 2, {"-o"});
  check_refused(directory, {"render", "figures", "-o", ""}, 2, {"-o"});
  check_refused(directory, {"compare"}, 2, {"A"});
  check_refused(directory, {"compare", "a.png"}, 2, {"B"});
}

TEST_CASE("bad input: a subcommand that there is not") {
  const TemporaryDirectory directory;
  check_refused(
      directory, {"draw"}, 2,
      {"'draw'",
       "render, join, refocus, apply, inspect, scenes, methods, effects, candidates, profiles"});
  check_refused(directory, {"--draw"}, 2, {"'--draw'"});
  check_refused(directory, {"draw", "render", "figures"}, 2, {"'draw'"});
  check_refused(directory, {"scenes", "all"}, 2, {"'all'"});
  check_refused(directory, {"methods", "--all"}, 2, {"'--all'"});
}

TEST_CASE("bad input: lens values") {
  const TemporaryDirectory directory;
  const auto refused = [&](const Words& options, const Words& named) {
    Words words{"lens"};
    words.insert(words.end(), options.begin(), options.end());
    check_refused(directory, words, 2, named);
  };
  refused({"--focus", "0"}, {"--focus"});
  refused({"--f-number", "0"}, {"--f-number"});
  refused({"--focal-length", "3000"}, {"--focal-length 3000 mm"});
  refused({"--fov", "180"}, {"--fov", "'180'"});
  refused({"--fov", "0"}, {"--fov"});
  refused({"--height", "0"}, {"--height", "'0'", "16384"});
  refused({"--max-coc-film", "0"}, {"--max-coc-film"});
  refused({"--at", "1", "nan"}, {"--at", "'nan'"});
  refused({"--at", "0"}, {"--at", "'0'"});
  refused({"--at"}, {"--at", "needs a value"});
}

TEST_CASE("bad input: an output whose name has no format") {
  const TemporaryDirectory directory;
  for (const std::string name : {"out.jpg", "out", "png"}) {
    check_refused(directory, {"render", "figures", "-o", directory.file(name)}, 2,
                  {"-o", name, ".png, .exr, .tiff, .pfm, .hdr or .npy"});
  }
}

TEST_CASE("bad input: an output where nothing can be written") {
  const TemporaryDirectory directory;
  write_file(directory.file("file"), "");
  std::filesystem::create_directory(directory.file("folder.png"));
  std::filesystem::create_symlink("circle.png", directory.file("circle.png"));
  const std::string long_name = std::string(300, 'a') + ".png";
  for (const std::string& name :
       {std::string{"no/such/out.png"}, std::string{"file/out.png"}, std::string{"folder.png"},
        std::string{"circle.png"}, long_name}) {
    check_refused(directory, {"render", "figures", "-o", directory.file(name)}, 1, {name});
    check_refused(
        directory,
        {"render", "figures", "-o", directory.file("out.png"), "--report", directory.file(name)}, 1,
        {name});
  }
}

TEST_CASE("bad input: an output in a directory or over a file protected against writing") {
  // Nothing is protected against root, who becomes nobody.
  RunSetting setting;
  if (::geteuid() == 0) setting.user = 65534;
  if (run_program({"--version"}, setting).status != 0) {
    return skip("other-user", "run as root, and nobody else may run the program");
  }
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory.file("closed"));
  REQUIRE(::chmod(directory.file("closed").c_str(), 0500) == 0);
  write_file(directory.file("closed.png"), "mine");
  REQUIRE(::chmod(directory.file("closed.png").c_str(), 0400) == 0);
  if (setting.user) {
    for (const std::string& name :
         {directory.path(), directory.file("closed"), directory.file("closed.png")}) {
      REQUIRE(::chown(name.c_str(), *setting.user, *setting.user) == 0);
    }
  }
  check_refused(directory, {"render", "figures", "-o", directory.file("closed/out.png")}, 1,
                {"closed/out.png"}, setting);
  check_refused(directory, {"render", "figures", "-o", directory.file("closed.png")}, 1,
                {"closed.png"}, setting);
  CHECK(read_file(directory.file("closed.png")) == "mine");
}

TEST_CASE("bad input: a full disk, met while writing, leaves nothing and harms nothing") {
  const TemporaryDirectory directory;
  write_file(directory.file("old.npy"), "old");
  for (const rlim_t limit : {0u, 1u, 100u, 4096u, 130000u}) {
    // A picture of 128 x 128 has 131,200 bytes.
    for (const std::string name : {"new.npy", "old.npy"}) {
      check_refused(directory,
                    {"render", "figures", "--size", "128x128", "-o", directory.file(name)}, 1,
                    {name}, {.file_size_limit = limit});
    }
  }
  CHECK(read_file(directory.file("old.npy")) == "old");
}

TEST_CASE("bad input: a full disk met by the report takes the picture back too") {
  const TemporaryDirectory directory;
  if (!std::filesystem::exists("/dev/full")) return skip("full-device", "no /dev/full");
  check_refused(directory,
                {"render", "figures", "--size", "16x16", "-o", directory.file("out.png"),
                 "--report", "/dev/full"},
                1, {"/dev/full", "space"});
}

TEST_CASE("bad input: a full device, as a file and as standard output") {
  if (!std::filesystem::exists("/dev/full")) return skip("full-device", "no /dev/full");
  const TemporaryDirectory directory;
  check_refused(directory,
                {"render", "figures", "--size", "16x16", "-o", "/dev/full", "--format", "npy"}, 1,
                {"/dev/full", "space"});
  CHECK(std::filesystem::is_character_file("/dev/full"));
  const RunSetting full{.out_to = "/dev/full"};
  check_refused(directory, {"render", "figures", "--size", "16x16", "-o", "-"}, 1,
                {"standard output", "space"}, full);
  check_refused(directory, {"scenes"}, 1, {"standard output"}, full);
  check_refused(directory, {"lens"}, 1, {"standard output"}, full);
  check_refused(directory, {"--help"}, 1, {"standard output"}, full);
}

TEST_CASE("bad input: two outputs in one place") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("out.png");
  for (const std::string& other : {file, directory.file("./out.png")}) {
    check_refused(directory, {"render", "figures", "-o", file, "--report", other}, 2,
                  {"--report", "-o"});
  }
  check_refused(directory, {"render", "figures", "-o", "-", "--json"}, 2, {"--json", "-o -"});
}

TEST_CASE("bad input: a line is one line, even for a name with a newline in it") {
  const TemporaryDirectory directory;
  check_refused(directory, {"render", "a\nb\x1b[31m.toml", "-o", directory.file("out.png")}, 1,
                {"a?b?[31m.toml"});
  check_refused(directory, {"render", "figures", "-o", directory.file("no\nsuch/out.png")}, 1,
                {"no?such/out.png"});
}

TEST_CASE("bad input: a model or a texture that is a pipe, and a model of another format") {
  const TemporaryDirectory directory;
  REQUIRE(mkfifo(directory.file("m.obj").c_str(), 0600) == 0);
  check_refused(directory, {"render", directory.file("m.obj"), "-o", directory.file("out.png")}, 1,
                {"m.obj", "is a pipe or a device"});
  write_file(directory.file("m.fbx"), "glTF");
  check_refused(directory, {"render", directory.file("m.fbx"), "-o", directory.file("out.png")}, 1,
                {"m.fbx", ".stl files"});
}

TEST_CASE("bad input: two outputs that are one file through a link that leads nowhere yet") {
  const TemporaryDirectory directory;
  std::filesystem::create_symlink("out.npy", directory.file("link"));
  const std::string out = directory.file("out.npy");
  check_refused(directory, {"render", "figures", "-o", out, "--report", directory.file("link")}, 2,
                {"--report"});
  check_refused(directory,
                {"render", "figures", "-o", out, "--depth-output", directory.file("link")}, 2,
                {"--depth-output"});
  check_refused(directory,
                {"render", "figures", "--method", "pinhole", "--show", "pinhole", "-o", out,
                 "--layers", "2", "--report", directory.file("out.layer2.npy")},
                2, {"--report", "is where --layers writes"});
}

TEST_CASE("bad input: an output that is the sidecar of an input") {
  const TemporaryDirectory directory;
  const std::string picture = directory.file("a.npy");
  REQUIRE(run_program({"render", "figures", "--size", "16x16", "-o", picture}).status == 0);
  check_refused(directory,
                {"refocus", picture, "--depth-encoding", "metres", "-o",
                 directory.file("a.npy.json"), "--format", "png"},
                2, {"the picture's sidecar"});
}
