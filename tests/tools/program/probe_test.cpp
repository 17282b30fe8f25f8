#include <doctest/doctest.h>

#include "raster/numbers/profile.h"
#include "tests/support/gl_drivers.h"
#include "tools/files/profile_file.h"
#include "tools/gl/driver/driver.h"

using namespace softfocus;

namespace {

// All but the name and the summary.
void check_same_arithmetic(const Profile& a, const Profile& b) {
  CHECK(a.half_store == b.half_store);
  CHECK(a.unorm_store == b.unorm_store);
  CHECK(a.denormals == b.denormals);
  CHECK(a.texture_unit == b.texture_unit);
  CHECK(a.bilinear_weights == b.bilinear_weights);
  CHECK(a.bilinear_filter == b.bilinear_filter);
  CHECK(a.lerp == b.lerp);
  CHECK(a.viewport == b.viewport);
  CHECK(a.guard_band == b.guard_band);
  CHECK(a.clipping == b.clipping);
  CHECK(a.coverage == b.coverage);
  CHECK(a.subpixel_bits == b.subpixel_bits);
  CHECK(a.fill_rule == b.fill_rule);
  CHECK(a.attributes == b.attributes);
  CHECK(a.interpolation == b.interpolation);
}

// Probes into a file and reads it back; its text is returned.
std::string check_probe_finds(const Profile& profile, const std::string& driver) {
  const TemporaryDirectory directory;
  const std::string file = directory.file("probed.toml");
  const ProgramRun run = run_program({"probe", "--driver", driver, "-o", file});
  CHECK(run.status == 0);
  CHECK(run.out + run.err == "");
  const ChosenProfile probed = load_profile(file);
  CHECK(probed.name == driver + "-probed");
  check_same_arithmetic(probed.profile, profile);
  return read_file(file);
}

std::string check_probe_finds_profile(const std::string& driver) {
  return check_probe_finds(find_profile(find_driver(driver)->profile).value(), driver);
}

// One method a driver: crosscheck has all of them on each.
void check_render_on_gl(const std::string& driver, const std::string& method) {
  if (!has_driver(driver)) return;
  const TemporaryDirectory directory;
  const std::string profile{find_driver(driver)->profile};
  const auto render = [&](const std::string& option, const std::string& value,
                          const std::string& name) {
    const ProgramRun run =
        run_program({"render", "cube-room", "--size", "96x64", "--method", method, "--max-coc", "6",
                     "--multisample", "1", option, value, "-o", directory.file(name)});
    CHECK(run.status == 0);
    CHECK(run.err == "");
    return read_file(directory.file(name));
  };
  CHECK(render("--gl", driver, "a.npy") == render("--profile", profile, "b.npy"));
}

}  // namespace

TEST_CASE("probe: experiments on llvmpipe find its profile, and the file says what it rests on" *
          doctest::test_suite("long")) {
  if (!has_driver("llvmpipe")) return;
  const std::string text = check_probe_finds_profile("llvmpipe");
  CHECK(text.starts_with("# Probed by softfocus "));
  CHECK(contains(text, "# - floats stored as halves: toward zero (differing values: "));
  CHECK(contains(text, "# - bilinear weights between two texels of a half texture: "));
  CHECK(contains(text, "# - a * b + c in a shader: rounded twice"));
  CHECK(contains(text, "\nhalf_store = \"toward-zero\" "));
}
TEST_CASE("probe: experiments on llvmpipe held to SSE4.1 find its profile" *
          doctest::test_suite("long")) {
  if (has_driver("llvmpipe-sse41")) check_probe_finds_profile("llvmpipe-sse41");
}
TEST_CASE("probe: experiments on the emulated GPU find its profile") {
  if (!has_driver("emulated")) return;
  Profile profile;
  profile.guard_band = 4.0f;  // the widest that is tried
  check_probe_finds(profile, "emulated");
}
TEST_CASE("probe: experiments on lavapipe find llvmpipe's profile" * doctest::test_suite("long")) {
  if (has_driver("lavapipe")) check_probe_finds_profile("lavapipe");
}
TEST_CASE("probe: experiments on softpipe find its profile, and print it without -o") {
  if (!has_driver("softpipe")) return;
  const ProgramRun run = run_program({"probe", "--driver", "softpipe"});
  CHECK(run.status == 0);
  CHECK(run.err == "");
  const TemporaryDirectory directory;
  write_file(directory.file("printed.toml"), run.out);
  check_same_arithmetic(load_profile(directory.file("printed.toml")).profile,
                        find_profile("softpipe").value());
}

TEST_CASE("a profile's file gives back every known profile") {
  const TemporaryDirectory directory;
  for (const NamedProfile& known : profiles()) {
    const std::string file = directory.file("profile.toml");
    const ChosenProfile chosen{std::string{known.name}, std::string{known.summary}, known.profile};
    write_file(file, profile_text(chosen, "a heading\nof two lines"));
    const ChosenProfile back = load_profile(file);
    CHECK(back.name == known.name);
    CHECK(back.summary == known.summary);
    check_same_arithmetic(back.profile, known.profile);
  }
}

TEST_CASE("a profile's file is refused with the line and what would be right") {
  const TemporaryDirectory directory;
  const auto refused = [&](const std::string& text, const std::string& part) {
    const std::string file = directory.file("bad.toml");
    write_file(file, text);
    const ProgramRun run =
        run_program({"render", "figures", "--profile", file, "-o", directory.file("picture.png")});
    CAPTURE(run.err);
    CHECK(run.status == 2);
    CHECK(is_one_line(run.err));
    CHECK(contains(run.err, file + part));
    CHECK(directory.listing() == std::vector<std::string>{"bad.toml"});
  };
  refused("", ":1: name: ");
  refused("name = 3\n", ":1: name: is a number; ");
  refused("name = \"a\"\nhalf_store = \"up\"\n", ":2: half_store: ");
  refused("name = \"a\"\nlerp = 1\n", ":2: lerp: is a number; ");
  refused("name = \"a\"\nsubpixel_bits = 9\n", ":2: subpixel_bits: 9 is out of range; ");
  refused("name = \"a\"\nguard_band = 0.5\n", ":2: guard_band: 0.5 is out of range; ");
  refused("name = \"a\"\ncolour = 1\n", ":2: colour: ");
  refused("name = \"a\"\ncoverage = \"scanlines\"\n", ":2: coverage: ");
  refused("name = \"a", ":1: is no TOML: ");
}

TEST_CASE("render: --profile takes a file") {
  const TemporaryDirectory directory;
  write_file(directory.file("truncating.toml"),
             "name = \"truncating\"\nhalf_store = \"toward-zero\"\n");
  const auto render = [&](const std::string& profile, const std::string& name) {
    const ProgramRun run = run_program(
        {"render", "figures", "--size", "48x32", "--profile", profile, "-o", directory.file(name)});
    CHECK(run.status == 0);
    return read_file(directory.file(name));
  };
  const std::string ieee = render("ieee", "a.npy");
  const std::string truncating = render(directory.file("truncating.toml"), "b.npy");
  CHECK(ieee.size() == truncating.size());
  CHECK(ieee != truncating);
}

TEST_CASE("render: --gl llvmpipe gives the bits of its profile" * doctest::test_suite("long")) {
  check_render_on_gl("llvmpipe", "one-pass");
}
TEST_CASE("render: --gl llvmpipe-sse41 gives the bits of its profile" *
          doctest::test_suite("long")) {
  check_render_on_gl("llvmpipe-sse41", "two-pass");
}
TEST_CASE("render: --gl softpipe gives the bits of its profile") {
  check_render_on_gl("softpipe", "pinhole");
}
TEST_CASE("render: --gl emulated gives the bits of its profile") {
  check_render_on_gl("emulated", "two-pass");
}
TEST_CASE("render: --gl lavapipe gives the bits of its profile" * doctest::test_suite("long")) {
  check_render_on_gl("lavapipe", "two-pass");
}

TEST_CASE("render: --gl and --profile exclude each other") {
  const ProgramRun run = run_program(
      {"render", "figures", "--gl", "llvmpipe", "--profile", "ieee", "-o", "never.png"});
  CHECK(run.status == 2);
  CHECK(is_one_line(run.err));
  CHECK(contains(run.err, "--gl and --profile exclude each other"));
}

TEST_CASE("shaders: lists them, and writes them out whole") {
  const ProgramRun list = run_program({"shaders"});
  CHECK(list.status == 0);
  for (const char* name : {"two_pass.frag\n", "two_pass_tiled.frag\n", "one_pass.frag\n",
                           "one_pass_tiled.frag\n", "tile_rows.frag\n", "tile_reach.frag\n"}) {
    CHECK(contains(list.out, name));
  }
  CHECK(contains(list.out, "surface.vert\n"));
  const TemporaryDirectory directory;
  CHECK(run_program({"shaders", "-o", directory.path()}).status == 0);
  CHECK(contains(read_file(directory.file("weights.glsl")), "float overlap("));
  CHECK(run_program({"shaders", "-o", directory.file("none")}).status == 2);
  CHECK(run_program({"shaders", "-o", ""}).status == 2);
}

TEST_CASE("shaders: a file of the user's own is not replaced") {
  const TemporaryDirectory directory;
  write_file(directory.file("two_pass.frag"), "mine");
  const ProgramRun run = run_program({"shaders", "-o", directory.path()});
  CHECK(run.status == 1);
  CHECK(is_one_line(run.err));
  CHECK(contains(run.err, "two_pass.frag: is there and differs"));
  CHECK(directory.listing() == std::vector<std::string>{"two_pass.frag"});
  CHECK(read_file(directory.file("two_pass.frag")) == "mine");
}
