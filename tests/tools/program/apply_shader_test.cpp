// softfocus apply --shader, end to end.

#include "raster/shaders/glsl/glsl.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tests/support/scene_test_files.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

constexpr const char* kRoot = SOFTFOCUS_TEST_DATA "/../../";

/// A picture with depth, and shaders beside it.
struct Shaders {
  TemporaryDirectory directory;
  std::string picture = directory.file("picture.npy");

  Shaders() { CHECK(run_program(render("figures", picture, {"--show", "pinhole"})).status == 0); }
  std::string shader(const std::string& name, const std::string& text) const {
    write_file(directory.file(name), text);
    return directory.file(name);
  }
  Words apply(const std::string& shader, const std::string& output, const Words& more) const {
    Words words{"apply", picture, "--shader", shader, "-o", directory.file(output)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// The texels of what `apply` makes: an NPY's without its head.
  std::string applied(const std::string& shader, const Words& more = {}) const {
    const ProgramRun run = run_program(apply(shader, "out.npy", more));
    CAPTURE(run.err);
    REQUIRE(run.status == 0);
    return texels(directory.file("out.npy"));
  }
  static std::string texels(const std::string& file) {
    const std::string all = read_file(file);
    return all.substr(all.find('\n') + 1);
  }
};

std::string number_in(const std::string& json, const std::string& key) {
  const auto at = json.find("\"" + key + "\": ");
  REQUIRE(at != json.npos);
  const std::size_t begin = at + key.size() + 4;
  return json.substr(begin, json.find_first_of(",\n", begin) - begin);
}

}  // namespace

TEST_CASE("apply --shader: two_pass.frag has the bits of --method two-pass") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Shaders all;
  const std::string filtered = all.directory.file("filtered.npy");
  const ProgramRun run = run_program(
      render("figures", filtered, {"--method", "two-pass", "--max-coc", "7.5", "--json"}));
  REQUIRE(run.status == 0);
  const std::string shader =
      all.shader("two_pass.frag",
                 "#version 400\n" + read_file(std::string{kRoot} + "dof/two_pass/two_pass.frag"));
  const Words lens{
      "--include", std::string{kRoot} + "dof",
      "--set",     "radius_at_infinity_px=" + number_in(run.out, "radius_at_infinity_px"),
      "--set",     "focus_m=" + number_in(run.out, "focus_m"),
      "--set",     "max_coc_px=7.5",
      "--set",     "leak=1",
      "--set",     "taps=7"};
  Words across = lens, down = lens;
  across.insert(across.end(), {"--set", "direction=1,0"});
  down.insert(down.end(), {"--set", "direction=0,1"});
  const ProgramRun first = run_program(all.apply(shader, "across.npy", across));
  CAPTURE(first.err);
  REQUIRE(first.status == 0);
  Words second{"apply", all.directory.file("across.npy"), "--shader", shader,
               "-o",    all.directory.file("down.npy")};
  second.insert(second.end(), down.begin(), down.end());
  REQUIRE(run_program(second).status == 0);
  CHECK(Shaders::texels(all.directory.file("down.npy")) == Shaders::texels(filtered));
}

TEST_CASE("apply --shader: macros by --define") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Shaders all;
  const std::string shader = all.shader(
      "mine.frag", "#ifdef RED\nvoid main() { gl_FragColor = vec4(RED, 0, 0, 1); }\n#endif\n");
  CHECK(all.applied(shader, {"--define", "RED"}) == all.applied(shader, {"--define", "RED=1"}));
  CHECK(all.applied(shader, {"--define", "RED"}) != all.applied(shader, {"--define", "RED=2"}));
  check_refused(all.directory, all.apply(shader, "none.npy", {"--define", "=2"}), 2,
                {"--define '=2': the name has to be"});
  check_refused(all.directory, all.apply(shader, "none.npy", {"--include", "nowhere"}), 2,
                {"--include 'nowhere': there is no such folder"});
  check_refused(all.directory,
                {"apply", all.picture, "--effect", "bloom", "--define", "RED", "-o",
                 all.directory.file("none.npy")},
                2, {"--define and --include are of --shader"});
  check_refused(all.directory,
                all.apply(SOFTFOCUS_TEST_DATA "/wgsl.spv", "none.npy", {"--define", "RED"}), 1,
                {"wgsl.spv: it is SPIR-V", "for GLSL and HLSL"});
  // Beside a text that takes them it is not.
  const ProgramRun both = run_program(
      all.apply(SOFTFOCUS_TEST_DATA "/wgsl.spv", "both.npy",
                {"--shader", shader, "--define", "RED", "--texture", "noise=" + all.picture}));
  CHECK(!contains(both.err, "SPIR-V"));
}

TEST_CASE("apply --shader: the same bits on every unit, and by threads") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Shaders all;
  const std::string shader = all.shader("mix.frag", R"(#version 330
uniform sampler2D picture;
in vec2 uv;
out vec4 colour;
void main() {
  vec4 sum = vec4(0.0);
  for (int i = -3; i <= 3; ++i) {
    if (uv.x * 9.0 < float(i)) continue;
    sum += texture(picture, uv + vec2(sin(float(i) + uv.y), cos(uv.x * float(i))) * 0.02);
    if (sum.r > 2.0) break;
  }
  colour = pow(abs(sum), vec4(0.7)) + vec4(dFdx(uv.y * uv.x), dFdy(exp(uv.x)), atan(uv.y, uv.x), 0.0);
}
)");
  const std::string expected = all.applied(shader, {"--threads", "1"});
  CHECK(all.applied(shader, {"--threads", "3"}) == expected);
  for (const char* isa : {"scalar", "baseline", "avx2", "avx512"}) {
    const ProgramRun run = run_program(all.apply(shader, "unit.npy", {"--isa", isa}));
    if (run.status != 0) continue;  // not of this processor
    CHECK(Shaders::texels(all.directory.file("unit.npy")) == expected);
  }
}

TEST_CASE(
    "apply --shader: a plain shader has the picture's rows from the top, Shadertoy's from below") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Shaders all;
  const std::string before = Shaders::texels(all.picture);
  const std::string same = all.shader("same.frag", R"(#version 330
uniform sampler2D picture;
out vec4 colour;
void main() { colour = texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }
)");
  CHECK(all.applied(same) == before);
  const auto row_of = [](const std::string& texels, int row) {
    return texels.substr(static_cast<std::size_t>(row) * 48 * 8, 48 * 8);
  };
  const std::string place = all.applied(all.shader("place.frag", R"(#version 330
in vec2 uv;
out vec4 colour;
void main() { colour = vec4(uv, 0.0, 0.0); }
)"));
  // Column 10 and row 7 of 48x32: u = 10.5 / 48 = 0x3300 and v = 7.5 / 32 = 0x3380.
  CHECK(row_of(place, 7).substr(10 * 8, 4) == std::string{"\0\x33\x80\x33", 4});
  const std::string white = all.shader("white.frag", R"(#version 330
out vec4 colour;
void main() { colour = vec4(gl_FragCoord.y < 1.0 ? 1.0 : 0.0); }
)");
  const std::string toy = all.shader("toy.frag",
                                     "void mainImage(out vec4 c, in vec2 at) {\n"
                                     "  c = vec4(at.y < 1.0 ? 1.0 : 0.0);\n}\n");
  const std::string plain = all.applied(white), below = all.applied(toy);
  CHECK(row_of(plain, 0).substr(0, 6) == std::string{"\0\x3C\0\x3C\0\x3C", 6});
  CHECK(row_of(plain, 31).substr(0, 6) == std::string(6, '\0'));
  CHECK(row_of(below, 31).substr(0, 6) == std::string{"\0\x3C\0\x3C\0\x3C", 6});
  CHECK(row_of(below, 0).substr(0, 6) == std::string(6, '\0'));
  // The depth stays.
  CHECK(row_of(below, 3).substr(6, 2) == row_of(before, 3).substr(6, 2));
}

TEST_CASE("apply --shader: a Shadertoy that changes nothing gives a PNG's own codes") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const TemporaryDirectory directory;
  const std::string picture = directory.file("picture.png"), same = directory.file("same.png");
  const std::string toy = directory.file("toy.frag");
  write_file(toy,
             "void mainImage(out vec4 c, in vec2 at) {\n"
             "  c = texture(iChannel0, at / iResolution.xy);\n}\n");
  REQUIRE(run_program(render("figures", picture)).status == 0);
  REQUIRE(run_program({"apply", picture, "--shader", toy, "-o", same}).status == 0);
  const auto codes = [](const std::string& file) {
    const std::string bytes = read_file(file);
    return decode_png(std::as_bytes(std::span{bytes})).image.bytes;
  };
  CHECK(codes(same) == codes(picture));
}

TEST_CASE("apply --shader: what is wrong is one line, with the shader's or the option's") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Shaders all;
  const std::string tinted =
      all.shader("tinted.frag",
                 "#version 330\nuniform vec3 tint;\nuniform sampler2D a, b;\n"
                 "out vec4 c;\nvoid main() {\n"
                 "  c = texture(a, vec2(0.5)) + texture(b, vec2(0.5)) * vec4(tint, 1.0);\n}\n");
  const std::string wrong =
      all.shader("wrong.frag", "#version 330\nout vec4 c;\nvoid main() {\n  c = vec4(x);\n}\n");
  const std::string endless =
      all.shader("endless.frag",
                 "#version 330\nout vec4 c;\nvoid main() {\n  float s = 0.0;\n"
                 "  for (int i = 0; i >= 0; i += 0) s += 1.0;\n  c = vec4(s);\n}\n");
  const auto refused = [&](const std::string& shader, const Words& more, int status,
                           const std::vector<std::string>& said) {
    check_refused(all.directory, all.apply(shader, "no.npy", more), status, said);
  };
  refused(wrong, {}, 1, {"wrong.frag:4: 'x'"});
  refused(endless, {}, 1, {"endless.frag:5: ", "budget"});
  refused(tinted, {"--set", "tnit=1"}, 2, {"--set 'tnit=1'", "did you mean 'tint'"});
  refused(tinted, {"--set", "tint=1,2"}, 2, {"3 numbers"});
  refused(tinted, {"--set", "tint=red"}, 2, {"'red' is no number"});
  refused(tinted, {"--set", "tint"}, 2, {"NAME=VALUE"});
  refused(tinted, {"--texture", "c=" + all.picture}, 2, {"a, b"});
  refused(tinted, {}, 2, {"'a' and 'b'", "--texture"});
  refused(all.directory.file("none.frag"), {}, 1, {"none.frag"});
  const std::string counted = all.shader("counted.frag",
                                         "#version 330\nuniform int n;\nuniform uint m;\n"
                                         "out vec4 c;\nvoid main() { c = vec4(n, m, 0, 0); }\n");
  for (const char* number : {"n=1e20", "n=2147483648", "n=0.5", "n=nan", "m=-1"}) {
    refused(counted, {"--set", number}, 2, {number, "whole number of 32 bits"});
  }
  CHECK(run_program(all.apply(counted, "yes.npy", {"--set", "n=-2147483648"})).status == 0);
  const std::string flat =
      all.shader("flat.frag",
                 "#version 330\nuniform sampler2D a;\nuniform sampler2D b;\nout vec4 c;\n"
                 "void main() { c = texture(a, vec2(0.5)) * texture(b, vec2(0.5)); }\n");
  const std::string before = read_file(all.picture);
  CHECK(run_program(all.apply(flat, "one.npy", {"--texture", "b=" + all.picture})).status == 0);
  const std::string one = all.directory.file("one.npy"), kept = read_file(one);
  for (const std::string& output : {one, flat}) {
    const Words words{"apply",    all.picture, "--shader", flat,       "--texture",
                      "b=" + one, "-o",        output,     "--format", "npy"};
    const ProgramRun run = run_program(words);
    CHECK(run.status == 2);
    CHECK(contains(run.err, "a shader's file"));
  }
  CHECK(read_file(one) == kept);
  CHECK(read_file(all.picture) == before);
}

TEST_CASE("apply --texture: a strip of slices for a sampler3D, six squares for a samplerCube") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Shaders all;
  // The first slice or face is red, the others are green.
  const auto strip = [&](const char* name, int count) {
    write_file(all.directory.file(name), test::png_bytes(count, 1));
    return all.directory.file(name);
  };
  const std::string two = strip("two.png", 2), six = strip("six.png", 6);
  const std::string body =
      "texture(lut, vec3(0.5, 0.5, 0.75)).g, texture(sky, vec3(1.0, 0.0, 0.0)).r,\n"
      "         texture(sky, vec3(-1.0, 0.0, 0.0)).r, 1.0);\n}\n";
  const std::string uniforms = "uniform sampler3D lut;\nuniform samplerCube sky;\n";
  const std::string plain = all.shader(
      "plain.frag", "#version 330\n" + uniforms + "out vec4 c;\nvoid main() {\n  c = vec4(" + body);
  const std::string toy =
      all.shader("toy.frag", "precision highp sampler3D;\n" + uniforms +
                                 "void mainImage(out vec4 c, in vec2 at) {\n  c = vec4(" + body);
  for (const std::string& shader : {plain, toy}) {
    const std::string texels =
        all.applied(shader, {"--texture", "lut=" + two, "--texture", "sky=" + six});
    CHECK(texels.substr(0, 6) == std::string{"\0\x3C\0\x3C\0\0", 6});
  }
  const auto refused = [&](const Words& more, const std::vector<std::string>& said) {
    check_refused(all.directory, all.apply(plain, "no.npy", more), 1, said);
  };
  refused({"--texture", "sky=" + six},
          {"plain.frag", "'lut' is a sampler3D", "--texture lut=FILE"});
  refused({"--texture", "lut=" + two, "--texture", "sky=" + two},
          {"'sky' is a samplerCube", "2 x 1 texels", "six squares in a row"});
}

TEST_CASE("apply --shader: HLSL") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Shaders all;
  const std::string same =
      all.shader("same.hlsl",
                 "Texture2D picture;\nSamplerState smooth;\nfloat gain;\n"
                 "float4 main(float4 at : SV_Position, float2 uv : TEXCOORD0) : SV_Target {\n"
                 "  return picture.Sample(smooth, uv) * gain;\n}\n");
  CHECK(all.applied(same, {"--set", "gain=1"}) == Shaders::texels(all.picture));
  check_refused(all.directory, all.apply(same, "no.npy", {"--set", "smooth=1"}), 2,
                {"there are gain"});
}

TEST_CASE("apply --shader: of several shaders a setting is for those that have it") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Shaders all;
  const auto scaled = [&](const char* name) {
    return all.shader(std::string{name} + ".frag",
                      "#version 330\nuniform sampler2D p;\nuniform float " + std::string{name} +
                          ";\nout vec4 c;\nvoid main() {\n  c = texelFetch(p, "
                          "ivec2(gl_FragCoord.xy), 0) * " +
                          name + ";\n}\n");
  };
  const std::string twice = scaled("twice"), half = scaled("half_of");
  CHECK(all.applied(twice, {"--shader", half, "--set", "twice=2", "--set", "half_of=0.5"}) ==
        Shaders::texels(all.picture));
  check_refused(all.directory, all.apply(twice, "no.npy", {"--shader", half, "--set", "thrice=2"}),
                2, {"twice, half_of"});
}

TEST_CASE("apply --shader: the bits of a NaN are the same on every processor") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Shaders all;
  const std::string shader = all.shader("nan.frag", R"(#version 330
uniform float zero;
out vec4 colour;
void main() {
  float a = zero / zero, b = -a, c = sqrt(zero - 1.0), d = intBitsToFloat(0x7FC12345);
  bool same = floatBitsToInt(a) == 0x7FC00000 && floatBitsToUint(b) == 0x7FC00000u &&
              floatBitsToInt(c) == 0x7FC00000 && floatBitsToInt(d * gl_FragCoord.x) == 0x7FC00000;
  colour = vec4(same ? 1.0 : 0.0);
}
)");
  CHECK(all.applied(shader).substr(0, 2) == std::string{"\0\x3C", 2});
}
