// The emulation against real drivers, and the comparison against deliberate errors.

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "raster/numbers/profile.h"
#include "tests/support/gl_drivers.h"
#include "tools/crosscheck/cases.h"
#include "tools/files/profile_file.h"
#include "tools/gl/driver/driver.h"

using namespace softfocus;

namespace {

using Words = std::vector<std::string>;

ProgramRun crosscheck(const std::string& driver, const std::string& cases, const Words& more = {}) {
  Words words{"crosscheck", "--driver", driver, "--case", cases};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words);
}

// Of each stage a case, and each shader once.
Words few_cases() {
  Words words;
  for (const Case& one : quick_cases(true)) {
    words.insert(words.end(), {"--case", one.stage + '/' + one.name});
  }
  return words;
}

void check_all_equal(const std::string& driver, const Words& cases = {"--quick"}) {
  if (!has_driver(driver)) return;
  Words words{"crosscheck", "--driver", driver, "--json"};
  words.insert(words.end(), cases.begin(), cases.end());
  // Few cases are those of any driver.
  const bool has_samples = find_driver(driver)->has_samples;
  if (has_samples && cases != Words{"--quick"}) {
    words.insert(words.end(), {"--case", "samples/*-inside"});
  }
  const ProgramRun run = run_program(words);
  CHECK(run.status == 0);
  CHECK(run.err == "");
  std::set<std::string> stages;
  for (const auto& entry : nlohmann::json::parse(run.out)) {
    CAPTURE(entry.dump());
    CHECK(entry["driver"] == driver);
    CHECK(entry["profile"] == find_driver(driver)->profile);
    CHECK(entry["differing"] == 0);
    CHECK(entry["max_ulp"] == 0);
    CHECK(entry["values"] > 0);
    CHECK_FALSE(entry.contains("error"));
    stages.insert(entry["stage"]);
  }
  std::set<std::string> all{"store",          "bilinear-rgba16f",
                            "bilinear-rgba8", "mipmap",
                            "coverage",       "depth",
                            "attributes",     "scene",
                            "two-pass",       "one-pass",
                            "frame",          "two-pass-tiled",
                            "one-pass-tiled", "peel",
                            "blend",          "kernel",
                            "pyramid",        "bilateral",
                            "bloom",          "lens-flare",
                            "tone-map",       "velocity",
                            "reproject",      "motion-blur",
                            "reprojection",   "temporal",
                            "polygon",        "shadow",
                            "shadow-map",     "shadow-volume",
                            "relief",         "march",
                            "octahedral"};
  if (has_samples) all.insert("samples");
  CHECK(stages == all);
}

// llvmpipe-sse41's profile but for one key: that driver is the same on every x86 CPU.
std::string altered_profile(const TemporaryDirectory& directory, const std::string& key,
                            const std::string& value) {
  const ChosenProfile altered{"altered", "", find_profile("llvmpipe-sse41").value()};
  std::string text = profile_text(altered, "");
  const std::size_t begin = text.find('\n' + key + " = ") + 1;
  REQUIRE(begin != 0);
  const std::size_t end = text.find('\n', begin);
  const std::string line = key + " = " + value;
  REQUIRE(!text.substr(begin, end - begin).starts_with(line));
  text.replace(begin, end - begin, line);
  std::string name = directory.file("altered.toml");
  write_file(name, text);
  return name;
}

void check_profile_caught(const std::string& cases, const std::string& key,
                          const std::string& value) {
  CAPTURE(cases + ": " + key + " = " + value);
  const TemporaryDirectory directory;
  const ProgramRun run = crosscheck(
      "llvmpipe-sse41", cases, {"--profile", altered_profile(directory, key, value), "--json"});
  CHECK(run.status == 1);
  CHECK(run.err == "");
  std::uint64_t differing = 0;
  for (const auto& entry : nlohmann::json::parse(run.out)) {
    differing += entry["differing"].get<std::uint64_t>();
    CHECK(entry["profile"] == "altered");
  }
  CHECK(differing > 0);
}

// The project's shaders in a folder, one of them altered.
void write_shaders(const TemporaryDirectory& directory, const std::string& shader,
                   const std::string& from, const std::string& to) {
  CHECK(run_program({"shaders", "-o", directory.path()}).status == 0);
  std::string text = read_file(directory.file(shader));
  const std::size_t at = text.find(from);
  REQUIRE(at != text.npos);
  text.replace(at, from.size(), to);
  write_file(directory.file(shader), text);
}

void check_shader_caught(const std::string& cases, const std::string& shader,
                         const std::string& from, const std::string& to) {
  CAPTURE(cases + ": " + to);
  const TemporaryDirectory directory;
  write_shaders(directory, shader, from, to);
  // Stores that truncate notice more.
  const ProgramRun run =
      crosscheck("emulated", cases, {"--shaders", directory.path(), "--profile", "llvmpipe"});
  CHECK(run.status == 1);
  CHECK(run.err == "");
}

}  // namespace

TEST_CASE("crosscheck: llvmpipe and its profile give the same bits" * doctest::test_suite("long")) {
  check_all_equal("llvmpipe");
}
TEST_CASE("crosscheck: llvmpipe held to SSE4.1 and its profile give the same bits" *
          doctest::test_suite("long")) {
  check_all_equal("llvmpipe-sse41", few_cases());
}
TEST_CASE("crosscheck: softpipe and its profile give the same bits" * doctest::test_suite("long")) {
  check_all_equal("softpipe");
}
TEST_CASE("crosscheck: lavapipe and its profile, which is llvmpipe's, give the same bits" *
          doctest::test_suite("long")) {
  if (!has_driver("lavapipe")) return;
  const std::string renderer = crosscheck("lavapipe", "store/rgba8-around-every-byte").out;
  if (contains(renderer, " Mesa 22.")) return check_all_equal("lavapipe", few_cases());
  // Later ones do not look for sides that are powers of two where textures repeat, and add an
  // offset to alpha by a pixel's place among 2x2, which zink cannot forbid.
  const ProgramRun run = crosscheck("lavapipe", "*", {"--quick", "--json"});
  std::size_t compared = 0;
  for (const auto& entry : nlohmann::json::parse(run.out)) {
    CAPTURE(entry.dump());
    const std::string name = entry["case"];
    if (name.find("repeat") != name.npos || name.find("alpha-") != name.npos) continue;
    ++compared;
    CHECK(entry["differing"] == 0);
  }
  CHECK(compared > 60);
}

TEST_CASE("crosscheck: our GLSL on the emulated GPU gives the bits of its C++ form") {
  check_all_equal("emulated");
}
TEST_CASE("crosscheck: our GLSL on the emulated GPU gives its C++ form's bits by any profile" *
          doctest::test_suite("long")) {
  if (!has_driver("emulated")) return;
  for (const NamedProfile& profile : profiles()) {
    if (profile.name == "ieee") continue;  // the test before
    CAPTURE(profile.name);
    Words words{"crosscheck", "--driver", "emulated", "--profile", std::string{profile.name}};
    const Words cases = few_cases();
    words.insert(words.end(), cases.begin(), cases.end());
    const ProgramRun run = run_program(words);
    CHECK(run.status == 0);
    CHECK(run.err == "");
  }
}

TEST_CASE("crosscheck: another rounding, contraction or rule in a profile is caught" *
          doctest::test_suite("long")) {
  if (!has_driver("llvmpipe-sse41")) return;
  check_profile_caught("store/rgba16f-around-every-half", "half_store", "\"nearest-even\"");
  check_profile_caught("store/rgba8-around-every-byte", "unorm_store", "\"half-up\"");
  check_profile_caught("bilinear-rgba16f/37x19-clamp", "lerp", "\"fused\"");
  check_profile_caught("bilinear-rgba8/37x19-clamp", "texture_unit", "\"softpipe\"");
  check_profile_caught("mipmap/generate-rgba16f-100x37", "lerp", "\"fused\"");
  check_profile_caught("mipmap/trilinear-rgba16f-clamp", "lerp", "\"fused\"");
  check_profile_caught("coverage/centre-aligned-20000", "fill_rule", "\"lower-left\"");
  check_profile_caught("coverage/inside-20000", "subpixel_bits", "7");
  check_profile_caught("coverage/across-edges-4000", "guard_band", "2");
  check_profile_caught("depth/inside", "interpolation", "\"fused\"");
  check_profile_caught("attributes/inside", "interpolation", "\"fused\"");
  check_profile_caught("attributes/inside-odd-size", "viewport", "\"fused\"");
  check_profile_caught("attributes/across-edges", "clipping", "\"plain\"");
  check_profile_caught("scene/figures-128x96-frame7", "half_store", "\"nearest-even\"");
  check_profile_caught("two-pass/random-64x64-radius4", "half_store", "\"nearest-even\"");
  check_profile_caught("one-pass/random-64x64-radius4", "half_store", "\"nearest-even\"");
  check_profile_caught("frame/figures-128x96-frame7-two-pass", "half_store", "\"nearest-even\"");
}

TEST_CASE("crosscheck: another order of operations in a shader is caught") {
  if (!has_driver("emulated")) return;
  // 1/512 texel: one step of an 8-bit weight for every other sample.
  check_shader_caught("bilinear-rgba8/64x32-repeat", "sample.frag", "at.xy",
                      "at.xy + vec2(1.0 / 32768.0, 0.0)");
  check_shader_caught("two-pass/lens-leak-0.3", "weights.glsl", "gather.colour / gather.weight",
                      "gather.colour * (1.0 / gather.weight)");
  check_shader_caught("two-pass/random-64x64-radius4", "two_pass.frag", "here - d * direction",
                      "here + d * direction");
  check_shader_caught("one-pass/random-64x64-radius4", "one_pass.frag", "int i = 0; i < taps; ++i",
                      "int i = taps - 1; i >= 0; --i");
  // A tile's reach without its neighbours', or without those across its corners.
  check_shader_caught("two-pass-tiled/islands-60x40-tiles5", "tile_reach.frag", "dx <= farthest",
                      "dx <= 0");
  check_shader_caught("one-pass-tiled/islands-60x40-tiles5", "tile_reach.frag", "!diagonal && ",
                      "");
  check_shader_caught("scene/figures-128x96-frame7", "lighting.glsl",
                      "(a.x * b.x + a.y * b.y) + a.z * b.z", "a.x * b.x + (a.y * b.y + a.z * b.z)");
  check_shader_caught("frame/figures-128x96-frame7-two-pass", "weights.glsl",
                      "depth_m - focus_m) / depth_m", "depth_m - focus_m) * (1.0 / depth_m)");
  check_shader_caught("relief/figures 97x61", "relief_map.frag", "u * 256.0 + 0.5", "u * 256.0");
  check_shader_caught("march/figures 97x61*", "relief_march.frag", "depth_m * way + 0.5",
                      "depth_m * way");
  check_shader_caught("octahedral/figures 97x61*", "octahedral.frag", "1.0 - after",
                      "0.999 - after");
  check_shader_caught("reprojection/forward-61x43", "forward_reproject.vert", "order) / 131072.0",
                      "order) / -131072.0");
  check_shader_caught("attributes/inside", "interpolate.vert", "in_window = linear_value",
                      "in_window = 1.0000002 * linear_value");
}

TEST_CASE("crosscheck: another order of operations in doubles is caught" *
          doctest::test_suite("long")) {
  if (!has_driver("emulated")) return;
  check_shader_caught("shadow-map/figures 97x61*", "map_side.frag", "double(gl_FragCoord.x)",
                      "double(gl_FragCoord.x - 0.5)");
  check_shader_caught("shadow-map/figures 97x61*", "map_side.frag", "most < raised ? most : raised",
                      "raised");
  check_shader_caught("shadow-map/figures 97x61*", "map_lookup.frag", "kernel / 2", "kernel");
  check_shader_caught("shadow-volume/near-fence 65x41 z-fail", "volume.frag", "q * of_w - finite",
                      "q * of_w");
}

TEST_CASE("crosscheck: a difference is told with its pixel, both values and a picture") {
  if (!has_driver("llvmpipe-sse41")) return;
  const TemporaryDirectory directory;
  const TemporaryDirectory pictures;
  const std::string folder = pictures.file("made/by it");
  const ProgramRun run = crosscheck("llvmpipe-sse41", "two-pass/lens-*",
                                    {"--quick", "--diff", folder, "--profile",
                                     altered_profile(directory, "half_store", "\"nearest-even\"")});
  CHECK(run.status == 1);
  CHECK(contains(run.out, "first at pixel "));
  CHECK(contains(run.out, "driver "));
  CHECK(contains(run.out, ", emulation "));
  CHECK(contains(run.out, "0 of 2 cases equal"));
  Words files;
  for (const std::string name : {"fractional-radius", "leak-0.3"}) {
    for (const char* ending : {".driver.npy", ".emulation.npy", ".png"}) {
      files.push_back("llvmpipe-sse41.two-pass.lens-" + name + ending);
    }
  }
  CHECK(std::filesystem::exists(folder));
  std::vector<std::string> written;
  for (const auto& entry : std::filesystem::directory_iterator{folder}) {
    written.push_back(entry.path().filename().string());
  }
  std::sort(written.begin(), written.end());
  CHECK(written == files);
  CHECK(read_file(folder + '/' + files[2]).starts_with("\x89PNG"));
  // The values say what the count says.
  const ProgramRun compared =
      run_program({"compare", folder + '/' + files[0], folder + '/' + files[1], "--json"});
  CHECK(compared.status == 1);
  const auto differing = nlohmann::json::parse(compared.out)["differing"].get<int>();
  CHECK(contains(run.out, ' ' + std::to_string(differing) + " of 9216"));
}

TEST_CASE("crosscheck: a shader that the driver refuses fails its cases, and the rest still runs") {
  for (const char* driver : {"llvmpipe", "emulated"}) {
    CAPTURE(driver);
    if (!has_driver(driver)) continue;
    const TemporaryDirectory directory;
    write_shaders(directory, "two_pass.frag", "void main()", "void main(");
    const ProgramRun run = crosscheck(driver, "*/one-pixel", {"--shaders", directory.path()});
    CHECK(run.status == 2);
    CHECK(contains(run.out, "two-pass/one-pixel"));
    CHECK(contains(run.out,
                   "failed: " + directory.file("two_pass.frag") + ":"));  // the line in the file
    CHECK(contains(run.out, "one-pass/one-pixel"));
    CHECK(contains(run.out, "1 failed"));
  }
}

TEST_CASE("crosscheck: the emulated GPU names the file that a shader includes, and its line") {
  if (!has_driver("emulated")) return;
  const TemporaryDirectory directory;
  write_shaders(directory, "weights.glsl", "gather.colour / gather.weight", "gather.colour / none");
  const std::string text = read_file(directory.file("weights.glsl"));
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("/ none")),
                     '\n');
  const ProgramRun run =
      crosscheck("emulated", "two-pass/one-pixel", {"--shaders", directory.path()});
  CHECK(run.status == 2);
  CHECK(contains(run.out, "failed: " + directory.file("weights.glsl") + ":" + std::to_string(line) +
                              ": 'none': undeclared"));
}

TEST_CASE("crosscheck: a driver that is not there is told in one line, and the others run") {
  if (!has_driver("llvmpipe")) return;
  const ProgramRun run = run_program({"crosscheck", "--driver", "gpu", "--profile", "llvmpipe",
                                      "--driver", "llvmpipe", "--case", "store/rgba8-random"});
  if (run.err.empty()) {
    skip("", "a GPU is here: nothing was missing");
    return;
  }
  CHECK(run.status == 2);
  CHECK(is_one_line(run.err));
  CHECK(contains(run.err, "driver gpu: "));
  CHECK(contains(run.out, "1 of 2 cases equal, 1 not run"));
}

TEST_CASE("crosscheck: without an EGL driver that is said in one line") {
  if (!has_driver("llvmpipe")) return;
  const EnvironmentVariable none{"__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json"};
  const ProgramRun run = crosscheck("llvmpipe", "store/*");
  CHECK(run.status == 2);
  CHECK(is_one_line(run.err));
  CHECK(contains(run.err, "driver llvmpipe: "));
  const ProgramRun probe = run_program({"probe"});
  CHECK(probe.status == 2);
  CHECK(is_one_line(probe.err));
}

// The file by which Vulkan's loader finds lavapipe on Debian.
std::string lavapipe_file() {
  for (const char* name : {"lvp_icd.json", "lvp_icd.x86_64.json", "lvp_icd.aarch64.json"}) {
    std::string file = std::string{"/usr/share/vulkan/icd.d/"} + name;
    if (std::filesystem::exists(file)) return file;
  }
  return {};
}

TEST_CASE("crosscheck: lavapipe is found in the loader's folders or by the user's variable") {
  if (!has_driver("lavapipe")) return;
  const std::string there = lavapipe_file();
  if (there.empty()) return skip("driver", "lavapipe is not where Debian has it");
  const TemporaryDirectory data;
  const EnvironmentVariable folders{"XDG_DATA_DIRS", data.path().c_str()};
  const EnvironmentVariable home{"XDG_DATA_HOME", "/nonexistent"};
  const std::string one = "store/rgba8-around-every-byte";
  const ProgramRun none = crosscheck("lavapipe", one);
  CHECK(none.status == 2);
  CHECK(is_one_line(none.err));
  CHECK(contains(none.err, "driver lavapipe: no lvp_icd*.json in /nonexistent/vulkan/icd.d, " +
                               data.path() + "/vulkan/icd.d, "));
  CHECK(contains(none.err, "; Debian's package mesa-vulkan-drivers has it"));
  {
    const EnvironmentVariable named{"VK_ICD_FILENAMES", there.c_str()};
    CHECK(crosscheck("lavapipe", one).status == 0);
  }
  const std::filesystem::path folder = data.file("vulkan/icd.d");
  std::filesystem::create_directories(folder);
  write_file((folder / "lvp_icd.other.json").string(), read_file(there));
  CHECK(crosscheck("lavapipe", one).status == 0);
}

TEST_CASE("crosscheck: bad options are refused with what would be right") {
  const auto refused = [](const Words& more, std::string_view part) {
    Words words{"crosscheck"};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun run = run_program(words);
    CAPTURE(run.err);
    CHECK(run.status == 2);
    CHECK(run.out == "");
    CHECK(is_one_line(run.err));
    CHECK(contains(run.err, part));
  };
  refused({"--driver", "voodoo"},
          "there are llvmpipe, llvmpipe-sse41, softpipe, lavapipe, emulated, gpu");
  refused({"--driver", "gpu"}, "softfocus probe --driver gpu makes one");
  refused({"--profile", "voodoo"}, "there are ieee, ");
  refused({"--profile", "./none.toml"}, "./none.toml: no such file");
  refused({"--diff", "/dev/null/none"}, "--diff: cannot make the folder '/dev/null/none'");
  refused({"--diff", ""}, "give the name of a folder");
  refused({"--shaders", "/nonexistent"}, "there is no such folder");
  const TemporaryDirectory empty;
  refused({"--shaders", empty.path()}, "has none of the shaders that softfocus shaders lists");
  write_file(empty.file("twopass.frag"), "void main() {}");
  refused({"--shaders", empty.path()}, "twopass.frag: stands in for none of the shaders");
  refused({"--driver", "llvmpipe", "--driver", "gpu"}, "--driver gpu needs --profile");
  const TemporaryDirectory unwritable;  // for root too: the name is taken by a folder
  std::filesystem::create_directory(unwritable.file("picture.png"));
  refused({"--diff", unwritable.path()}, "--diff: ");
  refused({"--fast"}, "unknown option '--fast'");
}

TEST_CASE(
    "crosscheck: a case is compared if a pattern matches it; one that matches none is refused") {
  if (!has_driver("emulated")) return;
  const ProgramRun two = crosscheck("emulated", "two-pass/one-pixel",
                                    {"--case", "one-pass/one-pix*", "--case", "*-pass/one-pixel"});
  CHECK(contains(two.out, "2 of 2 cases equal"));
  const ProgramRun run = crosscheck("emulated", "two-pass/one-pixel", {"--case", "store"});
  CHECK(run.status == 2);
  CHECK(is_one_line(run.err));
  CHECK(contains(run.err, "--case 'store' matches no case"));
}

TEST_CASE("crosscheck: a driver for which nothing was to be compared does not count as equal") {
  if (!has_driver("softpipe")) return;
  const ProgramRun run = crosscheck("softpipe", "coverage/inside-1000000", {"--json"});
  CHECK(run.status == 2);
  CHECK(is_one_line(run.err));
  const auto entries = nlohmann::json::parse(run.out);
  REQUIRE(entries.size() == 1);
  CHECK(entries[0]["differing"].is_null());
  CHECK(entries[0].contains("error"));
}

TEST_CASE("crosscheck: a shader that includes itself is told, and the rest still runs") {
  if (!has_driver("emulated")) return;
  const TemporaryDirectory directory;
  write_file(directory.file("two_pass.frag"), "#include \"two_pass.frag\"\n");
  const ProgramRun run = crosscheck("emulated", "*/one-pixel", {"--shaders", directory.path()});
  CHECK(run.status == 2);
  CHECK(contains(run.out, "two_pass.frag: includes itself"));
  CHECK(contains(run.out, "one-pass/one-pixel"));
}

TEST_CASE("crosscheck: what the user's environment says to Mesa does not change a driver") {
  if (!has_driver("llvmpipe")) return;
  const EnvironmentVariable performance{"GALLIVM_PERF", "no_aos_sampling,no_quad_lod"};
  const EnvironmentVariable version{"MESA_GL_VERSION_OVERRIDE", "2.1"};
  CHECK(crosscheck("llvmpipe", "bilinear-rgba8/64x32-repeat").status == 0);
}
