// softfocus golden, from end to end.

#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/cli_refused.h"
#include "tools/pictures/image_file.h"

using namespace softfocus;

namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

ProgramRun golden(const std::string& action, const std::string& folder, const Words& more = {}) {
  Words words{"golden", action, folder};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words);
}

/// A folder, with a blank in its name, of a golden `small` that passes.
std::string goldens_in(const TemporaryDirectory& directory) {
  std::string folder = directory.file("our goldens");
  const ProgramRun run =
      golden("add", folder, {"small", "--", "render", "figures", "--size", "48x32"});
  CHECK(run.err == "");
  REQUIRE(run.status == 0);
  CHECK(contains(run.out, "small: added, 0x"));
  return folder;
}

void replace_in(const std::string& file, const std::string& from, const std::string& to) {
  std::string text = read_file(file);
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  write_file(file, text.replace(at, from.size(), to));
}

bool is_there(const std::string& file) { return std::filesystem::exists(file); }

}  // namespace

TEST_CASE("golden: what stays passes; what changes fails, is shown, and can be accepted") {
  const TemporaryDirectory directory;
  const std::string folder = goldens_in(directory), manifest = folder + "/goldens.toml";
  CHECK(read_image_file(folder + "/small.png").image.width == 48);
  const ProgramRun same = golden("check", folder);
  CHECK(same.status == 0);
  CHECK(contains(same.out, "1 of 1 goldens pass"));
  CHECK(!is_there(folder + "/report/made/small.npy"));

  replace_in(manifest, "48x32", "48x32 --f-number 1");
  const ProgramRun changed = golden("check", folder);
  CHECK(changed.status == 1);
  CHECK(contains(changed.out, "FAILS small: "));
  CHECK(contains(changed.out, " of 1536 pixels differ"));
  CHECK(contains(changed.out, "golden accept '" + folder + "' small"));
  const std::string page = read_file(folder + "/report/index.html");
  CHECK(contains(page, "\"difference\":\"iVBOR"));
  CHECK(!contains(page, "href=\"goldens.css\""));
  CHECK(contains(read_file(folder + "/report/junit.xml"), "failures=\"1\" errors=\"0\""));
  const json found = json::parse(read_file(folder + "/report/results.json"));
  CHECK(found["fails"] == 1);
  CHECK(found["goldens"][0]["verdict"] == "fails");

  const std::string before = found["goldens"][0]["expected_hash"];
  CHECK(golden("accept", folder, {"small"}).status == 0);
  CHECK(contains(read_file(manifest), "was = [\"" + before + "\"]"));
  CHECK(contains(read_file(manifest), std::string{found["goldens"][0]["hash"]}));
  CHECK(golden("check", folder).status == 0);
  CHECK(contains(golden("accept", folder, {"--all"}).out, "nothing to accept"));

  // A picture that was made before the manifest said otherwise is made again.
  replace_in(manifest, "--f-number 1", "--f-number 1.2");
  CHECK(golden("check", folder).status == 1);
  replace_in(manifest, "--f-number 1.2", "--f-number 1.4");
  CHECK(golden("accept", folder, {"small"}).status == 0);
  CHECK(golden("check", folder).status == 0);
}

TEST_CASE("golden: a picture within its tolerance passes, and says by how much it does not") {
  const TemporaryDirectory directory;
  const std::string folder = goldens_in(directory), manifest = folder + "/goldens.toml";
  replace_in(manifest, "48x32", "48x32 --f-number 1.9");
  CHECK(golden("check", folder).status == 1);
  write_file(manifest, read_file(manifest) + "max_flip = 0.2\n");
  CHECK(golden("check", folder).status == 0);
  replace_in(manifest, "max_flip = 0.2", "max_flip = 0.0000001");
  const ProgramRun run = golden("check", folder, {"--json"});
  CHECK(run.status == 1);
  CHECK(contains(std::string{json::parse(run.out)["goldens"][0]["why"]}, "--max-flip 1e-07"));
  replace_in(manifest, "48x32", "32x32");
  CHECK(contains(golden("check", folder).out, "is 32x32 pixels, expected are 48x32"));
}

TEST_CASE("golden: scenes, shaders and other programs make pictures, beside the manifest") {
  const TemporaryDirectory directory;
  const std::string folder = directory.file("g");
  std::filesystem::create_directory(folder);
  write_file(folder + "/tint.frag",
             "#version 330\nuniform sampler2D picture;\nin vec2 uv;\nout vec4 colour;\n"
             "void main() { colour = vec4(texture(picture, uv).rgb * 0.5, 1.0); }\n");
  REQUIRE(run_program({"render", "figures", "--size", "24x16", "-o", folder + "/in.png"}).status ==
          0);
  std::filesystem::copy_file(folder + "/in.png", folder + "/copy.png");
  write_file(folder + "/goldens.toml",
             "[[golden]]\nname = \"tint\"\nshader = \"tint.frag\"\ninput = \"in.png\"\n"
             "[[golden]]\nname = \"scene\"\nscene = \"lattice\"\noptions = \"--size 24x16\"\n"
             "picture = \"scene.exr.png\"\n"
             "[[golden]]\nname = \"copy\"\ncommand = \"cp in.png {out}\"\npicture = \"copy.png\"\n"
             "[[golden]]\nname = \"none\"\ncommand = \"true {out}\"\n"
             "[[golden]]\nname = \"bad\"\ncommand = \"echo it is bad >&2; exit 3 {out}\"\n");
  const ProgramRun run = golden("check", folder);
  CHECK(run.status == 1);
  CHECK(contains(run.out, "NEW tint: "));
  CHECK(contains(run.out, "NEW scene: "));
  CHECK(!contains(run.out, "copy: "));
  CHECK(contains(run.out,
                 "BREAKS none: its command, run in '" + folder + "', writes no file at {out}"));
  CHECK(contains(run.out, "', ends with status 3: it is bad"));
  CHECK(contains(run.out, "1 of 5 goldens pass"));
  CHECK(golden("accept", folder, {"--all"}).status == 0);
  CHECK(golden("check", folder, {"tint", "scene", "copy"}).status == 0);
  CHECK(is_there(folder + "/scene.exr.png"));
  CHECK(!contains(read_file(folder + "/goldens.toml"), "exit 3 {out}\"\nhash"));
}

TEST_CASE("golden: a check that was interrupted goes on where it was") {
  const TemporaryDirectory directory;
  const std::string folder = goldens_in(directory), manifest = folder + "/goldens.toml";
  const std::string unfinished = folder + "/report/unfinished.jsonl";
  std::filesystem::copy_file(folder + "/small.png", folder + "/last.png");
  // The first counts how often it is made, the second ends the program.
  write_file(manifest,
             "[[golden]]\nname = \"counted\"\npicture = \"small.png\"\n"
             "command = \"echo made >> count; cp small.png {out}\"\n"
             "[[golden]]\nname = \"last\"\npicture = \"last.png\"\n"
             "command = \"test -e go || kill -9 $PPID; cp small.png {out}\"\n");
  CHECK(golden("check", folder, {"--jobs", "1"}).status != 0);
  CHECK(is_there(unfinished));
  write_file(unfinished, read_file(unfinished) + "{\"key");  // and a line that it was writing
  write_file(folder + "/go", "");
  CHECK(golden("check", folder, {"--jobs", "1", "--resume"}).status == 0);
  CHECK(read_file(folder + "/count") == "made\n");
  CHECK(!is_there(unfinished));
  std::filesystem::remove(folder + "/go");
  std::filesystem::remove(folder + "/count");
  CHECK(golden("check", folder, {"--jobs", "1"}).status != 0);
  replace_in(manifest, "test -e go || kill -9 $PPID; ", "");
  // The manifest is another one now: all are made again.
  CHECK(golden("check", folder, {"--resume"}).status == 0);
  CHECK(read_file(folder + "/count") == "made\nmade\n");
  CHECK(!is_there(unfinished));
}

TEST_CASE("golden: what cannot be is refused, and nothing is left behind") {
  const TemporaryDirectory directory;
  const std::string nowhere = directory.file("none");
  check_refused(directory, {"golden", "check", nowhere}, 2, {"goldens.toml"});
  check_refused(directory, {"golden", "chek", nowhere}, 2, {"chek", "check"});
  check_refused(directory, {"golden", "add", nowhere, "a"}, 2, {"add", "--"});
  check_refused(directory, {"golden", "add", nowhere, "a/b", "--", "render", "figures"}, 2,
                {"name"});
  const std::string folder = goldens_in(directory);
  check_refused(directory, {"golden", "check", folder, "smal"}, 2, {"'smal'", "small"});
  check_refused(directory, {"golden", "accept", folder}, 2, {"--all"});
  check_refused(directory, {"golden", "check", folder, "--all"}, 2, {"--all", "accept"});
  check_refused(directory, {"golden", "add", folder, "small", "--", "render", "figures"}, 2,
                {"small", "accept"});
  check_refused(directory, {"golden", "check", folder, "--jobs", "0"}, 2, {"--jobs"});
  const ProgramRun bad = golden("add", folder, {"bad", "--", "render", "nosuch"});
  CHECK(bad.status == 2);
  CHECK(contains(bad.err, "golden 'bad'"));
  CHECK(!contains(read_file(folder + "/goldens.toml"), "bad"));
}

TEST_CASE("golden: opacity and all bits of a program's picture count, and are kept") {
  const TemporaryDirectory directory;
  const std::string folder = directory.file("g");
  std::filesystem::create_directory(folder);
  REQUIRE(
      run_program({"render", "figures", "--size", "24x16", "-o", directory.file("a.npy")}).status ==
      0);
  const Image image = read_image_file(directory.file("a.npy")).image;
  const auto write_png = [&](const std::string& name, float opacity) {
    const std::vector<float> alpha(24 * 16, opacity);
    const Bytes bytes = encode_png(image, alpha);
    write_file(folder + "/" + name, std::span<const std::byte>{bytes});
  };
  write_png("now.png", 1.0f);
  write_png("right.png", 1.0f);
  write_file(folder + "/goldens.toml",
             "[[golden]]\nname = \"v\"\ncommand = \"cp now.png {out}\"\npicture = "
             "\"right.png\"\n");
  CHECK(golden("check", folder).status == 0);
  write_png("now.png", 0.5f);
  CHECK(golden("check", folder).status == 1);
  CHECK(golden("accept", folder, {"v"}).status == 0);
  CHECK(read_file(folder + "/right.png") == read_file(folder + "/now.png"));
  CHECK(golden("check", folder).status == 0);
  // What fails is not taken.
  replace_in(folder + "/goldens.toml", "{out}", "{out}; exit 3");
  CHECK(golden("check", folder).status == 1);
  CHECK(contains(golden("accept", folder, {"--all"}).out, "nothing to accept"));
  CHECK(golden("accept", folder, {"v"}).status == 2);
}

TEST_CASE("golden: one command at a time writes into a report") {
  const TemporaryDirectory directory;
  const std::string folder = goldens_in(directory);
  // It checks the folder that it is checked in.
  write_file(folder + "/goldens.toml",
             "[[golden]]\nname = \"inner\"\npicture = \"small.png\"\n"
             "command = \"softfocus golden check . && cp small.png {out}\"\n");
  const ProgramRun run = golden("check", folder);
  CHECK(run.status == 1);
  CHECK(contains(run.out, "another golden command writes there"));
}

TEST_CASE("golden: nothing of the user's lies where checks write") {
  const TemporaryDirectory directory;
  const std::string folder = goldens_in(directory);
  check_refused(directory, {"golden", "check", folder, "-o", folder + "/."}, 2,
                {"-o", "own folder"});
  replace_in(folder + "/goldens.toml", "\"small.png\"", "\"report/made/small.png\"");
  std::filesystem::create_directories(folder + "/report/made");
  std::filesystem::copy_file(folder + "/small.png", folder + "/report/made/small.png");
  check_refused(directory, {"golden", "check", folder}, 2, {"'small'", "report", "elsewhere"});
  CHECK(is_there(folder + "/report/made/small.png"));
  // A folder that is no check's own keeps what is in it.
  replace_in(folder + "/goldens.toml", "report/made/", "");
  const std::string mine = directory.file("mine");
  std::filesystem::create_directories(mine + "/made");
  write_file(mine + "/made/treasure", "x");
  CHECK(golden("check", folder, {"-o", mine}).status == 0);
  CHECK(is_there(mine + "/made/treasure"));
}
