// The emulation against real drivers, and the comparison against deliberate errors.

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/gl_drivers.h"
#include "tools/gl/driver.h"

using namespace softfocus;

namespace {

using Words = std::vector<std::string>;

ProgramRun crosscheck(const std::string& driver, const std::string& cases, const Words& more = {}) {
  Words words{"crosscheck", "--driver", driver, "--case", cases};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words);
}

nlohmann::json quick_results(const std::string& driver) {
  const ProgramRun run = run_program({"crosscheck", "--driver", driver, "--quick", "--json"});
  CHECK(run.status == 0);
  CHECK(run.err == "");
  return nlohmann::json::parse(run.out);
}

void check_all_equal(const std::string& driver) {
  if (!has_driver(driver)) return;
  std::set<std::string> stages;
  for (const auto& entry : quick_results(driver)) {
    CAPTURE(entry.dump());
    CHECK(entry["driver"] == driver);
    CHECK(entry["profile"] == find_driver(driver)->profile);
    CHECK(entry["differing"] == 0);
    CHECK(entry["max_ulp"] == 0);
    CHECK(entry["values"] > 0);
    CHECK_FALSE(entry.contains("error"));
    stages.insert(entry["stage"]);
  }
  const std::set<std::string> all{
      "store", "bilinear-rgba16f", "bilinear-rgba8", "mipmap", "coverage", "depth", "attributes",
      "scene", "two-pass",         "one-pass",       "frame"};
  CHECK(stages == all);
}

// Whether llvmpipe is here and fuses, as the profile below does.
bool has_fused_llvmpipe() {
  if (!has_driver("llvmpipe")) return false;
  const bool fused = find_driver("llvmpipe")->profile == "llvmpipe";
  if (!fused) MESSAGE("skipped: no GL driver fuses on this CPU");
  return fused;
}

// A profile like the driver's but for one line.
std::string altered_profile(const TemporaryDirectory& directory, const std::string& from,
                            const std::string& to) {
  static const std::string kLlvmpipe =
      "name = \"altered\"\nhalf_store = \"toward-zero\"\nunorm_store = \"nearest-even\"\n"
      "denormals = \"flush\"\ntexture_unit = \"llvmpipe\"\nlerp = \"fused\"\n"
      "viewport = \"fused\"\nattributes = \"planes-from-origin\"\ninterpolation = \"fused\"\n"
      "guard_band = 1\nsubpixel_bits = 8\nfill_rule = \"upper-left\"\n";
  std::string text = kLlvmpipe;
  const std::size_t at = text.find(from);
  CHECK(at != text.npos);
  text.replace(at, from.size(), to);
  const std::string name = directory.file("altered.toml");
  write_file(name, text);
  return name;
}

void check_profile_caught(const std::string& cases, const std::string& from,
                          const std::string& to) {
  CAPTURE(cases + ": " + to);
  const TemporaryDirectory directory;
  const ProgramRun run =
      crosscheck("llvmpipe", cases, {"--profile", altered_profile(directory, from, to), "--json"});
  CHECK(run.status == 1);
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
  const ProgramRun run = crosscheck("llvmpipe", cases, {"--shaders", directory.path()});
  CHECK(run.status == 1);
  CHECK(run.err == "");
}

}  // namespace

TEST_CASE("crosscheck: llvmpipe and its profile give the same bits") {
  check_all_equal("llvmpipe");
}
TEST_CASE("crosscheck: llvmpipe held to SSE4.1 and its profile give the same bits") {
  check_all_equal("llvmpipe-sse41");
}
TEST_CASE("crosscheck: softpipe and its profile give the same bits") {
  check_all_equal("softpipe");
}

TEST_CASE("crosscheck: another rounding, contraction or rule in a profile is caught") {
  if (!has_fused_llvmpipe()) return;
  const std::string half = "half_store = \"toward-zero\"";
  const std::string nearest = "half_store = \"nearest-even\"";
  check_profile_caught("store/rgba16f-around-every-half", half, nearest);
  check_profile_caught("store/rgba8-around-every-byte", "unorm_store = \"nearest-even\"",
                       "unorm_store = \"half-up\"");
  check_profile_caught("bilinear-rgba16f/37x19-clamp", "lerp = \"fused\"", "lerp = \"unfused\"");
  check_profile_caught("bilinear-rgba8/37x19-clamp", "texture_unit = \"llvmpipe\"",
                       "texture_unit = \"softpipe\"");
  check_profile_caught("mipmap/generate-rgba16f-100x37", "lerp = \"fused\"", "lerp = \"unfused\"");
  check_profile_caught("mipmap/trilinear-rgba16f-clamp", "lerp = \"fused\"", "lerp = \"unfused\"");
  check_profile_caught("coverage/centre-aligned-20000", "upper-left", "lower-left");
  check_profile_caught("coverage/inside-20000", "subpixel_bits = 8", "subpixel_bits = 7");
  check_profile_caught("coverage/across-edges-5000", "guard_band = 1", "guard_band = 2");
  check_profile_caught("depth/inside", "interpolation = \"fused\"", "interpolation = \"unfused\"");
  check_profile_caught("attributes/inside", "interpolation = \"fused\"",
                       "interpolation = \"unfused\"");
  check_profile_caught("attributes/inside-odd-size", "viewport = \"fused\"",
                       "viewport = \"unfused\"");
  check_profile_caught("scene/figures-128x96-frame7", half, nearest);
  check_profile_caught("two-pass/random-64x64-radius4", half, nearest);
  check_profile_caught("one-pass/random-64x64-radius4", half, nearest);
  check_profile_caught("frame/figures-128x96-frame7-two-pass", half, nearest);
}

TEST_CASE("crosscheck: another order of operations in a shader is caught") {
  if (!has_driver("llvmpipe")) return;
  check_shader_caught("two-pass/lens-leak-0.3", "weights.glsl", "gather.colour / gather.weight",
                      "gather.colour * (1.0 / gather.weight)");
  check_shader_caught("two-pass/random-64x64-radius4", "two_pass.frag", "here - d * direction",
                      "here + d * direction");
  check_shader_caught("one-pass/random-64x64-radius4", "one_pass.frag", "int i = 0; i < taps; ++i",
                      "int i = taps - 1; i >= 0; --i");
  check_shader_caught("scene/figures-128x96-frame7", "lighting.glsl",
                      "(a.x * b.x + a.y * b.y) + a.z * b.z", "a.x * b.x + (a.y * b.y + a.z * b.z)");
  check_shader_caught("frame/figures-128x96-frame7-two-pass", "weights.glsl",
                      "depth_m - focus_m) / depth_m", "depth_m - focus_m) * (1.0 / depth_m)");
}

TEST_CASE("crosscheck: a difference is told with its pixel, both values and a picture") {
  if (!has_driver("llvmpipe")) return;
  const TemporaryDirectory directory;
  const TemporaryDirectory pictures;
  const ProgramRun run = crosscheck("llvmpipe", "two-pass/lens-*",
                                    {"--quick", "--diff", pictures.path(), "--profile",
                                     altered_profile(directory, "half_store = \"toward-zero\"",
                                                     "half_store = \"nearest-even\"")});
  CHECK(run.status == 1);
  CHECK(contains(run.out, "first at pixel "));
  CHECK(contains(run.out, "driver "));
  CHECK(contains(run.out, ", emulation "));
  CHECK(contains(run.out, "0 of 2 cases equal"));
  CHECK(pictures.listing() == Words{"llvmpipe.two-pass.lens-fractional-radius.png",
                                    "llvmpipe.two-pass.lens-leak-0.3.png"});
  CHECK(read_file(pictures.file(pictures.listing().front())).starts_with("\x89PNG"));
}

TEST_CASE("crosscheck: a shader that the driver refuses fails its cases, and the rest still runs") {
  if (!has_driver("llvmpipe")) return;
  const TemporaryDirectory directory;
  write_shaders(directory, "two_pass.frag", "void main()", "void main(");
  const ProgramRun run = crosscheck("llvmpipe", "*/one-pixel", {"--shaders", directory.path()});
  CHECK(run.status == 2);
  CHECK(contains(run.out, "two-pass/one-pixel"));
  CHECK(contains(run.out, "failed: two_pass.frag: "));
  CHECK(contains(run.out, "one-pass/one-pixel"));
  CHECK(contains(run.out, "1 failed"));
}

TEST_CASE("crosscheck: a driver that is not there is told in one line, and the others run") {
  if (!has_driver("llvmpipe")) return;
  const ProgramRun run = run_program({"crosscheck", "--driver", "gpu", "--profile", "llvmpipe",
                                      "--driver", "llvmpipe", "--case", "store/rgba8-random"});
  if (run.err.empty()) return;  // a GPU is here
  CHECK(run.status == 2);
  CHECK(is_one_line(run.err));
  CHECK(contains(run.err, "driver gpu: "));
  CHECK(contains(run.out, "1 of 1 cases equal"));
}

TEST_CASE("crosscheck: without an EGL driver that is said in one line") {
  if (!has_driver("llvmpipe")) return;
  const EnvironmentVariable none{"__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json"};
  const ProgramRun run = crosscheck("llvmpipe", "store/*");
  CHECK(run.status == 2);
  CHECK(is_one_line(run.err));
  CHECK(contains(run.err, "driver llvmpipe: "));
  const ProgramRun probe = run_program({"probe"});
  CHECK(probe.status == 1);
  CHECK(is_one_line(probe.err));
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
  refused({"--driver", "voodoo"}, "there are llvmpipe, llvmpipe-sse41, softpipe, gpu");
  refused({"--driver", "gpu"}, "softfocus probe --driver gpu makes one");
  refused({"--profile", "voodoo"}, "there are ieee, ");
  refused({"--profile", "./none.toml"}, "./none.toml: no such file");
  refused({"--diff", "/nonexistent"}, "there is no such folder");
  refused({"--shaders", "/nonexistent"}, "there is no such folder");
  refused({"--fast"}, "unknown option '--fast'");
}

TEST_CASE("crosscheck: a pattern that matches no case is refused") {
  if (!has_driver("llvmpipe")) return;
  const ProgramRun run = crosscheck("llvmpipe", "store");
  CHECK(run.status == 2);
  CHECK(is_one_line(run.err));
  CHECK(contains(run.err, "--case 'store' matches no case"));
}
