// GLSL as it is found: versions, conventions, includes, and errors that name the user's lines.

#include <doctest/doctest.h>

#include <map>
#include <string>
#include <thread>
#include <vector>

#include "raster/shaders/glsl/glsl.h"
#include "tests/support/sanitizers.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

using TextFiles = std::map<std::string, std::string>;

CompiledGlsl compiled_with(GlslSource source, const TextFiles& files = {}) {
  if (source.name.empty()) source.name = "mine.frag";
  return compile_glsl(source, [&](const std::string& path) -> std::optional<std::string> {
    const auto found = files.find(path);
    return found == files.end() ? std::nullopt : std::optional(found->second);
  });
}

CompiledGlsl compiled_text(const std::string& text, ShaderStage stage = ShaderStage::fragment) {
  GlslSource source;
  source.stage = stage;
  source.text = text;
  return compiled_with(source);
}

std::string error_with(const GlslSource& source, const TextFiles& files = {}) {
  try {
    compiled_with(source, files);
  } catch (const ShaderError& error) {
    return error.what();
  }
  return "none";
}

std::string error_of_text(const std::string& text) {
  GlslSource source;
  source.text = text;
  return error_with(source);
}

GlslConvention convention_of(const std::string& text, ShaderStage stage = ShaderStage::fragment) {
  return compiled_text(text, stage).convention;
}

/// Strings of OpName that are there.
bool has_name(const CompiledGlsl& shader, const std::string& name) {
  for (std::size_t i = 5; i < shader.words.size();) {
    const std::uint32_t count = shader.words[i] >> 16, op = shader.words[i] & 0xffff;
    if (count == 0) return false;
    constexpr std::uint32_t kOpName = 5;
    if (op == kOpName && name == reinterpret_cast<const char*>(&shader.words[i + 2])) return true;
    i += count;
  }
  return false;
}

bool has_line(const CompiledGlsl& shader, std::uint32_t line) {
  for (std::size_t i = 5; i < shader.words.size(); i += shader.words[i] >> 16) {
    constexpr std::uint32_t kOpLine = 8;
    if ((shader.words[i] & 0xffff) == kOpLine && shader.words[i + 2] == line) return true;
    if (shader.words[i] >> 16 == 0) return false;
  }
  return false;
}

constexpr const char* kOldBody =
    "varying vec2 v;\nuniform sampler2D t;\n"
    "void main() { gl_FragColor = texture2D(t, v); }\n";
constexpr const char* kNewBody =
    "in vec2 v;\nuniform sampler2D t;\nout vec4 o;\n"
    "void main() { o = texture(t, v); }\n";

}  // namespace

TEST_CASE("GLSL of every version becomes SPIR-V 1.0, a line of it the user's") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  for (const char* const version : {"110", "120"}) {
    CAPTURE(version);
    const auto shader = compiled_text("#version " + std::string(version) + "\n" + kOldBody);
    REQUIRE(shader.words.size() > 5);
    CHECK(shader.words[0] == 0x07230203);
    CHECK(shader.words[1] == 0x10000);
    CHECK(has_line(shader, 4));
    CHECK(has_name(shader, "gl_FragColor"));
  }
  for (const char* const version : {"130", "140", "150", "150 core", "150 compatibility", "330",
                                    "330 core", "400", "410", "420", "430", "440", "450", "460"}) {
    CAPTURE(version);
    const auto shader = compiled_text("#version " + std::string(version) + "\n" + kNewBody);
    CHECK(shader.words[1] == 0x10000);
    CHECK(has_line(shader, 5));
    CHECK(has_name(shader, "v"));
    CHECK(shader.convention == GlslConvention::plain);
  }
  for (const char* const version : {"300 es", "310 es", "320 es"}) {
    CAPTURE(version);
    CHECK(has_line(compiled_text("#version " + std::string(version) +
                                 "\nprecision mediump float;\n" + kNewBody),
                   6));
  }
  CHECK(
      has_line(compiled_text(std::string("#version 100\nprecision lowp float;\n") + kOldBody), 5));
}

TEST_CASE("a text without a version is GLSL 1.10, or ES 1.00 if it has precisions") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  CHECK(has_name(compiled_text(kOldBody), "v"));
  CHECK(has_name(compiled_text(std::string("precision highp float;\n") + kOldBody), "v"));
  const std::string error = error_of_text("void main() {\n  gl_FragColor = vec4(1u);\n}\n");
  CHECK(error.starts_with("mine.frag:2: 'unsigned literal': not supported"));
  CHECK(error.ends_with("(no #version: taken as GLSL 1.10)"));
  // An engine puts the precisions in front.
  CHECK(error_of_text(
            "uniform highp float a;\nvoid main() { float b = a; gl_FragColor = vec4(b); }\n") ==
        "none");
}

TEST_CASE("the compatibility profile's built-ins are inputs and uniforms by their names") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const auto shader = compiled_text(
      "void main() {\n"
      "  gl_Position = ftransform();\n"
      "  gl_TexCoord[0] = gl_TextureMatrix[0] * gl_MultiTexCoord0;\n"
      "  gl_FrontColor = gl_Color;\n"
      "}\n",
      ShaderStage::vertex);
  for (const char* const name : {"gl_Vertex", "gl_ModelViewProjectionMatrix", "gl_TexCoord",
                                 "gl_MultiTexCoord0", "gl_FrontColor", "gl_Color"}) {
    CAPTURE(name);
    CHECK(has_name(shader, name));
  }
}

TEST_CASE(
    "a file may have a byte-order mark, CRLF, no-break spaces, spliced lines, a comment first") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const auto shader = compiled_text(
      "\xEF\xBB\xBF/* mine */\r\n#version 300 es\r\nprecision highp float;\r\n"
      "out vec4 o;\r\n#define TWO 1.0 + \\\r\n 1.0\r\nvoid main() {\r\n"
      "\xC2\xA0 o =\xC2\xA0vec4(TWO);\r\n}\r\n");
  CHECK(has_line(shader, 8));
  CHECK(has_line(compiled_text("#version 330\nout vec4 o;\n#define A \\\n 1.0\nvoid main() {\n"
                               "  // a comment goes on \\\n  o = vec4(A);\n}\n"),
                 7));
  CHECK(has_line(compiled_text("/* goes \\\n on */\nprecision highp float;\nvoid main() {\n"
                               "  // goes on \\\n  gl_FragColor = vec4(1.0);\n}\n"),
                 6));
  CHECK(error_of_text(std::string("void main() {}\n\0", 16)) ==
        "mine.frag:2: a byte of value 0; this is no text");
  CHECK(error_of_text("\xFF\xFEv") == "mine.frag:1: the text is UTF-16; it would have to be UTF-8");
}

TEST_CASE("words that a later version reserves are names in an earlier one") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  CHECK(has_name(compiled_text("#version 330\nout vec4 o;\nvoid main() {\n"
                               "  float sample = 1.0;\n  o = vec4(sample);\n}\n"),
                 "sample"));
  CHECK(has_name(compiled_text("uniform sampler2D t;\nvoid main() {\n"
                               "  vec4 texture = texture2D(t, vec2(0.0));\n"
                               "  gl_FragColor = texture + texture2D(t, texture.xy);\n}\n"),
                 "texture"));
}

TEST_CASE("an extension that glslang has only in a later version is had") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  CHECK(has_name(compiled_text("#version 150\n#extension GL_ARB_gpu_shader5 : require\n"
                               "uniform uint u;\nout vec4 o;\nvoid main() {\n"
                               "  uint carry;\n  o = vec4(float(uaddCarry(u, 1u, carry)));\n}\n"),
                 "carry"));
  const auto older = compiled_text(
      "#version 130\n#extension GL_ARB_arrays_of_arrays : require\n"
      "void main() { float a[2][2]; a[1][0] = 1.0; gl_FragColor = vec4(a[1][0]); }\n");
  CHECK(has_name(older, "a"));
  CHECK(older.text.starts_with("#version 130\n#extension GL_ARB_arrays_of_arrays : require\n"));
  // For drivers one within #if stands before all code, too.
  const auto guarded = compiled_text(
      "#ifdef GL_OES_standard_derivatives\n#extension GL_OES_standard_derivatives : enable\n"
      "#endif\nprecision mediump float;\nvoid main() { gl_FragColor = vec4(1.0); }\n");
  const std::size_t condition = guarded.text.find("#ifdef GL_OES_standard_derivatives\n");
  CHECK(condition < guarded.text.find("#extension GL_OES_standard_derivatives"));
  CHECK(guarded.text.find("\n#endif\n", condition) < guarded.text.find("precision"));
}

TEST_CASE("texture2D() and its kin are there in core profiles before 4.20, as drivers have them") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  for (const char* const version : {"150", "150 core", "330", "330 core", "400", "410 core"}) {
    CAPTURE(version);
    for (const char* const read : {"texture2D(t, vec2(0.5))", "texture2DProj(t, vec3(0.5))",
                                   "texture2DLod(t, vec2(0.5), 1.0)"}) {
      CAPTURE(read);
      const std::string text = "// a comment\n#version " + std::string(version) +
                               "\nuniform sampler2D t;\nout vec4 o;\nvoid main() {\n  o = " + read +
                               ";\n}\n";
      CHECK(error_of_text(text) == "none");
      CHECK(has_line(compiled_text(text), 6));
      CHECK(compiled_text(text).text.find("compatibility") == std::string::npos);
    }
  }
  CHECK(error_of_text("#version 420\nuniform sampler2D t;\nout vec4 o;\nvoid main() {\n  o = "
                      "texture2D(t, vec2(0.5));\n}\n")
            .starts_with("mine.frag:5: 'texture2D'"));
}

TEST_CASE("an error names the user's file and line") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  CHECK(error_of_text("#version 330\nvoid main() {\n  f(\n").starts_with("mine.frag:4: "));
  CHECK(error_of_text("#version 330\nout vec4 o;\nvoid main() {\n  o = vec4(x);\n}\n") ==
        "mine.frag:4: 'x': undeclared identifier");
  CHECK(error_of_text("#version 330\n#error not so\nvoid main() {}\n")
            .starts_with("mine.frag:2: '#error': not so"));
  CHECK(error_of_text("#version 330\nvoid f() {}\n") ==
        "mine.frag: no function main(), mainImage() or transition()");
  for (const char* const version : {"999", "300", "330 es", "100 es", "330 coer", "es"}) {
    CAPTURE(version);
    CHECK(error_of_text("\n#version " + std::string(version) + "\nvoid main() {}\n") ==
          "mine.frag:2: #version " + std::string(version) +
              "; there are 100, 110 to 460, 300 es, 310 es and 320 es");
  }
  const std::string error =
      error_of_text("void mainImage(out vec4 c, in vec2 p) {\n  c = vec4(y);\n}\n");
  CHECK(error.starts_with("mine.frag:2: 'y': undeclared identifier"));
  CHECK(error.ends_with("(taken as shadertoy)"));
}

TEST_CASE("what SPIR-V has no line for is refused with that of the first word for it") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const std::string main = "void main() {}\n";
  CHECK(error_of_text("#version 430\n\nlayout(rgba8) uniform image2D i;\n"
                      "void main() { imageStore(i, ivec2(0), vec4(0)); }\n") ==
        "mine.frag:3: images that a shader writes are not supported");
  CHECK(error_of_text("#version 430\nlayout(std430) buffer B { float x[]; };\nout vec4 o;\n"
                      "void main() { o = vec4(x[0]); }\n")
            .starts_with("mine.frag:2: "));
}

TEST_CASE("an include is read beside the file that includes it, and errors name it") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  struct Dialect {
    const char *first, *second, *output;
  };
  const TextFiles files{
      {"shaders/parts/a.glsl", "#include \"../b.glsl\"\nfloat a() { return b(); }\n"},
      {"shaders/b.glsl", "float b() {\n  return 1.0;\n}\n"}};
  TextFiles broken = files;
  broken["shaders/b.glsl"] = "\nfloat b() {\n  return c0;\n}\n";
  for (const Dialect& dialect :
       {Dialect{"#version 120\n", "\n", "gl_FragColor"},
        Dialect{"#version 330\n", "out vec4 o;\n", "o"},
        Dialect{"#version 100\n", "precision mediump float;\n", "gl_FragColor"}}) {
    CAPTURE(dialect.first);
    GlslSource source;
    source.name = "shaders/mine.frag";
    source.defines["OUTPUT"] = dialect.output;
    source.text = std::string(dialect.first) + dialect.second +
                  "#include \"parts/a.glsl\"\nvoid main() {\n  OUTPUT = vec4(a());\n}\n";
    const CompiledGlsl shader = compiled_with(source, files);
    CHECK(shader.files == std::vector<std::string>{"shaders/parts/a.glsl", "shaders/b.glsl"});
    CHECK(error_with(source, broken).starts_with("shaders/b.glsl:3: 'c0': undeclared identifier"));
    source.text.replace(source.text.find("a());"), 5, "c1);");
    CHECK(error_with(source, files).starts_with("shaders/mine.frag:5: 'c1'"));
  }
}

TEST_CASE("an include is looked for beside its includer, and then in folders in their order") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  GlslSource source;
  source.name = "shaders/mine.frag";
  source.include_folders = {"one", "two/"};
  const TextFiles files{{"shaders/a", "#define A 1.0\n"},
                        {"one/a", "#error\n"},
                        {"one/b", "#include c\n"},
                        {"one/d", "#error\n"},
                        {"two/b", "#error\n"},
                        {"two/c", "#include \"d\"\n"},
                        {"two/d", "#define C 2.0\n"}};
  source.text = "#include \"a\"\n#include <b>\nvoid main() { gl_FragColor = vec4(A + C); }\n";
  CHECK(compiled_with(source, files).files ==
        std::vector<std::string>{"shaders/a", "one/b", "two/c", "two/d"});
}

TEST_CASE("an include that cannot be is an error where the preprocessor comes to it") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  GlslSource source;
  source.text = "#if 0\n#include \"none\"\n#endif\nvoid main() {}\n";
  CHECK(error_with(source) == "none");
  source.text = "\n#include \"none\"\nvoid main() {}\n";
  CHECK(error_with(source) == "mine.frag:2: #include none: cannot read none");
  source.text = "#error softfocus_missing_include\n#include \"none\"\n";
  CHECK(error_with(source).starts_with("mine.frag:1: '#error': softfocus_missing_include"));
  source.text = "#include \"/etc/passwd\"\nvoid main() {}\n";
  CHECK(error_with(source) == "mine.frag:1: #include /etc/passwd: the path must be relative");
  source.text = "#include \"a\"\nvoid main() {}\n";
  CHECK(error_with(source, {{"a", "\n#include \"a\"\n"}}) ==
        "a:2: #include a: the file includes itself");
  CHECK(error_with(source, {{"a", "#ifndef A\n#define A\n#include \"a\"\n#endif\n"}}) ==
        "a:3: #include a: the file includes itself");
  source.include_folders = {"lib"};
  CHECK(error_with(source) == "mine.frag:1: #include a: cannot read a or lib/a");
  TextFiles many;
  for (int i = 0; i < 40; ++i) {
    many[std::string("a") + std::string(static_cast<std::size_t>(i), 'a')] =
        "#include \"a" + std::string(static_cast<std::size_t>(i + 1), 'a') + "\"\n";
  }
  CHECK(error_with(source, many).find("too many files include others") != std::string::npos);
}

TEST_CASE("Shadertoy's text is recognised and gets its uniforms") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const std::string toy =
      "void mainImage(out vec4 color, in vec2 at) {\n"
      "  vec2 uv = at / iResolution.xy + iChannelResolution[1].xy * iTime;\n"
      "  color = texture(iChannel0, uv) + texture2D(iChannel1, uv) * float(iFrame) + iMouse;\n}\n";
  const auto shader = compiled_text(toy);
  CHECK(shader.convention == GlslConvention::shadertoy);
  CHECK(has_name(shader, "iResolution"));
  CHECK(has_name(shader, "iChannelResolution"));
  CHECK_FALSE(has_name(shader, "iDate"));
  CHECK(has_line(shader, 3));
  CHECK(error_of_text("#if HW_PERFORMANCE == 1\n" + toy + "#endif\n") == "none");
  // Drivers let no function of ES 3.00 have that name.
  const std::size_t function = shader.text.find("vec4 texture2D(");
  CHECK(function != std::string::npos);
  CHECK(shader.text.find("#define texture2D softfocus_texture2D\n") < function);
  CHECK(error_of_text("#define texture2D texture\n" + toy) == "none");
  CHECK(shader.text.find("\nprecision highp sampler2D;\n") != std::string::npos);
  // A text that declares them, as other programs want it.
  CHECK(
      convention_of(
          "#version 330\nuniform vec3 iResolution; uniform float iTime;\n"
          "void mainImage(out vec4 c, in vec2 p) { c = vec4(p / iResolution.xy, iTime, 1); }\n") ==
      GlslConvention::shadertoy);
  GlslSource source;
  source.text = "void mainImage(out vec4 c, in vec2 p) { c = texture(iChannel2, vec3(1.0)); }\n";
  CHECK(error_with(source) != "none");
  source.samplers["iChannel2"] = "samplerCube";
  CHECK(error_with(source) == "none");
  source.defines = {{"HW_PERFORMANCE", "0"}, {"texture2D", "texture"}};
  CHECK(error_with(source) == "none");
}

TEST_CASE("three.js' passes are recognised, of both versions of GLSL") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const auto pass = compiled_text(
      "#include <common>\n#include <packing>\nvarying vec2 vUv;\nuniform sampler2D tDiffuse;\n"
      "uniform sampler2D tDepth;\nvoid main() {\n"
      "  float z = perspectiveDepthToViewZ(unpackRGBAToDepth(texture2D(tDepth, vUv)), 0.1, 10.0);\n"
      "  vec4 texture = textureLod(tDiffuse, vUv, 0.0);\n"
      "  gl_FragColor = saturate(texture * z * rand(vUv) + luminance(texture.rgb) * PI);\n"
      "  #include <colorspace_fragment>\n}\n");
  CHECK(pass.convention == GlslConvention::three);
  CHECK(has_name(pass, "pc_fragColor"));
  CHECK(has_line(pass, 9));
  const auto vertex = compiled_text(
      "varying vec2 vUv;\nvoid main() {\n  vUv = uv;\n"
      "  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);\n}\n",
      ShaderStage::vertex);
  CHECK(vertex.convention == GlslConvention::three);
  CHECK(has_name(vertex, "position"));
  const auto older = compiled_text(
      "uniform sampler2D texture;\nvarying vec2 vUv;\n#include <dithering_pars_fragment>\n"
      "#include <uv_pars_fragment>\n#include <tonemapping_pars_fragment>\n"
      "void main() {\n  gl_FragColor = texture2D(texture, vUv);\n  #include "
      "<dithering_fragment>\n}\n");
  CHECK(older.convention == GlslConvention::three);
  CHECK(has_name(older, "texture"));
  CHECK(error_of_text("varying vec2 vUv;\n#include <lights_pars_begin>\nvoid main() {}\n")
            .starts_with("mine.frag:2: #include lights_pars_begin: cannot read "));
  // No version has all of these.
  CHECK(convention_of("varying vec2 at;\nuniform sampler2D t;\nvoid main() {\n"
                      "  float[2] w = float[2](1.0, 2.0);\n"
                      "  gl_FragColor = textureLod(t, at, 0.0) * w[1] + texture2D(t, at);\n}\n") ==
        GlslConvention::three);
  // Of a desktop, though ES 3.00 has some of the words too.
  for (const char* text :
       {"uniform sampler3D noise;\nvarying vec2 p;\n"
        "void main() { gl_FragColor = texture3D(noise, vec3(p, 0.5)); }\n",
        "#extension GL_EXT_gpu_shader4 : enable\nuniform sampler2D t;\nvoid main() {\n"
        "  gl_FragColor = texture2D(t, gl_TexCoord[0].xy) * float(uint(1));\n}\n"}) {
    CHECK(error_of_text(text) == "none");
    CHECK(convention_of(text) == GlslConvention::plain);
  }
  GlslSource source;
  source.text =
      "#version 300 es\nout vec4 color;\nvoid main() { color = texture(tDiffuse, vUv); }\n";
  CHECK(error_with(source) != "none");
  source.convention = GlslConvention::three;
  CHECK(error_with(source) == "none");
}

TEST_CASE("gl-transitions are recognised, and their parameters read") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const auto shader = compiled_text(
      "uniform float size; // = 0.5\nuniform vec2 at /* = vec2(1.0, -2) */;\n"
      "uniform bool hard; // = true\nuniform ivec2 none; // no default\n"
      "vec4 transition(vec2 uv) {\n"
      "  return mix(getFromColor(uv), getToColor(uv + at * size), progress * ratio);\n}\n");
  CHECK(shader.convention == GlslConvention::gl_transitions);
  REQUIRE(shader.parameters.size() == 3);
  CHECK(shader.parameters[0].name == "size");
  CHECK(shader.parameters[0].value == std::vector<double>{0.5});
  CHECK(shader.parameters[1].name == "at");
  CHECK(shader.parameters[1].value == std::vector<double>{1, -2});
  CHECK(shader.parameters[2].value == std::vector<double>{1});
}

TEST_CASE("libretro's files are recognised, both forms, a stage at a time") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const std::string glsl =
      "#pragma parameter GAIN \"Gain\" 1.0 0.5 2.0 0.05\n#if defined(VERTEX)\n"
      "attribute vec4 VertexCoord;\nuniform mat4 MVPMatrix;\n"
      "void main() { gl_Position = MVPMatrix * VertexCoord; }\n#elif defined(FRAGMENT)\n"
      "#ifdef PARAMETER_UNIFORM\nuniform float GAIN;\n#endif\n"
      "void main() { gl_FragColor = vec4(GAIN); }\n#endif\n";
  const auto fragment = compiled_text(glsl);
  CHECK(fragment.convention == GlslConvention::libretro);
  CHECK(has_name(fragment, "GAIN"));
  CHECK(has_line(fragment, 10));
  REQUIRE(fragment.parameters.size() == 1);
  CHECK(fragment.parameters[0].label == "Gain");
  CHECK(fragment.parameters[0].most == 2);
  CHECK(fragment.parameters[0].step == 0.05);
  CHECK(has_name(compiled_text(glsl, ShaderStage::vertex), "VertexCoord"));
  const std::string slang =
      "#version 450\nlayout(push_constant) uniform Push { vec4 SourceSize; float GAIN; } params;\n"
      "layout(std140, set = 0, binding = 0) uniform UBO { mat4 MVP; } global;\n"
      "#pragma stage vertex\nlayout(location = 0) in vec4 Position;\n"
      "void main() { gl_Position = global.MVP * Position; }\n"
      "#pragma stage fragment\nlayout(location = 0) out vec4 FragColor;\n"
      "void main() {\n  FragColor = params.SourceSize * params.GAIN;\n}\n";
  CHECK(has_line(compiled_text(slang), 10));
  CHECK(has_name(compiled_text(slang, ShaderStage::vertex), "Position"));
}

TEST_CASE("definitions reach the text, and nothing but definitions") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  GlslSource source;
  source.text = "void main() { gl_FragColor = vec4(SIZE); }\n";
  source.defines["SIZE"] = "2.0";
  CHECK(error_with(source) == "none");
  using namespace std::string_literals;
  for (const std::string& value :
       {"2.0\n#error"s, "/*"s, "1 // x"s, "\""s, "a\\"s, std::string(1, '\0')}) {
    source.defines["SIZE"] = value;
    CHECK(error_with(source) ==
          "mine.frag: the definition 'SIZE': the value has to be a line without a backslash, a "
          "comment and half a string");
  }
  for (const char* const name : {"1x", "", "A(x)", "a b"}) {
    source.defines = {{name, ""}};
    CHECK(error_with(source).find(
              "': the name has to be of letters, digits and _, and begin with no digit") !=
          std::string::npos);
  }
}

TEST_CASE("what is recognised and put around a text heeds its definitions") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const auto error_of = [](const std::string& text, const std::string& name,
                           const std::string& value) {
    GlslSource source;
    source.text = text;
    source.defines = {{name, value}};
    return error_with(source);
  };
  CHECK(error_of("void mainImage(out vec4 c, in vec2 p) { c = vec4(T); }\n", "T", "iTime") ==
        "none");
  CHECK(error_of("void mainImage(out vec4 c, in vec2 p) { c = vec4(iTime); }\n", "iTime", "1.0") ==
        "none");
  CHECK(error_of("#if defined(VERTEX)\n#elif defined(FRAGMENT)\nvoid main() {}\n#endif\n",
                 "PARAMETER_UNIFORM", "1") == "none");
  // Drivers see definitions before conditions and extensions of the text.
  GlslSource source;
  source.text =
      "#ifndef TAPS\n#define TAPS 5\n#endif\n#extension GL_ARB_gpu_shader5 : enable\n"
      "void main() { gl_FragColor = vec4(TAPS); }\n";
  source.defines = {{"TAPS", "9"}};
  const std::string text = compiled_with(source).text;
  CHECK(text.find("#define TAPS 9") < text.find("#ifndef TAPS"));
}

TEST_CASE("texture2D() in a core profile, whatever names it") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  using namespace std::string_literals;
  const std::string head = "uniform sampler2D t;\nin vec2 uv;\nout vec4 c;\n";
  for (const std::string& version : {""s, "#version 330\n"s, "#version 400\n"s}) {
    CHECK(error_of_text(version + head + "void main() { c = texture2D(t, uv); }\n") == "none");
    CHECK(error_of_text(version + head + "#define CAT(a, b) a##b\n" +
                        "void main() { c = CAT(texture, 2D)(t, uv); }\n") == "none");
    GlslSource source;
    source.text = version + head + "void main() { c = READ(t, uv); }\n";
    source.defines = {{"READ", "texture2D"}};
    CHECK(error_with(source) == "none");
  }
}

TEST_CASE("a version's functions are compiled or refused, whatever version has them") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  struct Call {
    const char* sampler;
    const char* call;
  };
  constexpr Call kCalls[] = {{"sampler1D", "texture1DLod(t, 0.5, 0.0)"},
                             {"sampler2D", "texture2DProj(t, vec3(1.0))"},
                             {"sampler2D", "texture2DLodEXT(t, vec2(0.5), 0.0)"},
                             {"sampler2D", "texture2DGradARB(t, vec2(0.5), vec2(0.0), vec2(0.0))"},
                             {"sampler2D", "texelFetch2D(t, ivec2(0), 0)"},
                             {"sampler2D", "textureQueryLOD(t, vec2(0.5))"},
                             {"sampler2DRect", "texture2DRectProj(t, vec3(1.0))"},
                             {"sampler2DArray", "texture2DArrayLod(t, vec3(0.5), 0.0)"},
                             {"sampler2DShadow", "shadow2DLod(t, vec3(0.5), 0.0)"},
                             {"sampler3D", "texture3DProj(t, vec4(0.5))"},
                             {"samplerCube", "textureCubeLod(t, vec3(0.5), 0.0)"},
                             {"sampler2D", "noise1(0.5)"},
                             {"sampler2D", "ftransform()"},
                             {"sampler2D", "min3(1.0, 2.0, 3.0)"},
                             {"sampler2D", "gl_Fog.density"},
                             {"sampler2D", "gl_LastFragData[0]"},
                             {"sampler2D", "interpolateAtCentroid(uv)"}};
  for (const char* const version :
       {"", "#version 110\n", "#version 130\n", "#version 140\n", "#version 150\n",
        "#version 330\n", "#version 400\n", "#version 420\n", "#version 460\n",
        "#version 300 es\nprecision highp float;\n", "#version 450 compatibility\n",
        "#version 330\n#extension GL_EXT_gpu_shader4 : enable\n"}) {
    for (const Call& of : kCalls) {
      const std::string error = error_of_text(
          std::string(version) + "uniform " + of.sampler +
          " t;\nin vec2 uv;\nout vec4 c;\nvoid main() { c = vec4(" + of.call + "); }\n");
      CAPTURE(error);
      CHECK((error == "none" || error.starts_with("mine.frag:")));
    }
  }
}

TEST_CASE("texts that would take a compiler's stack or memory are refused in a line") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  std::string sum = "uniform float x;\nvoid main() {\n  gl_FragColor = vec4(x";
  for (int i = 0; i < fewer(200'000); ++i) sum += "+x";
  CHECK(error_of_text(sum + ");\n}\n") ==
        "mine.frag:3: an expression of more than 2000 operators; it would have to be split");
  const auto nested = [](const std::string& open, const std::string& close) {
    std::string text = "void main() { gl_FragColor = vec4(";
    for (int i = 0; i < fewer(60'000); ++i) text += open;
    text += "1.0";
    for (int i = 0; i < fewer(60'000); ++i) text += close;
    return text + "); }\n";
  };
  CHECK(error_of_text(nested("(", ")")) != "none");
  CHECK(error_of_text(nested("-", "")) != "none");
  CHECK(error_of_text(nested("abs(", ")")) != "none");
  std::string blocks = "void main() { ";
  for (int i = 0; i < fewer(60'000); ++i) blocks += "if (true) {";
  CHECK(error_of_text(blocks) != "none");
  std::string table = "#version 330\nout vec4 o;\nconst float t[4000] = float[](0.0";
  for (int i = 1; i < 4000; ++i) table += ", -" + std::to_string(i) + ".0";
  CHECK(error_of_text(table + ");\nvoid main() { o = vec4(t[int(gl_FragCoord.x)]); }\n") == "none");
  CHECK(error_of_text(
            "float f(float x) { return f(x); }\nvoid main() { gl_FragColor = vec4(f(1.0)); }\n")
            .find("ecursion") != std::string::npos);
  CHECK(error_of_text(std::string(kMostGlslBytes + 1, ' '))
            .starts_with("mine.frag:1: the text is longer than 1024 KiB"));
  CHECK(error_of_text("#version 330\n#extension GL_ARB_bindless_texture : require\n"
                      "void main() {}\n") ==
        "mine.frag:2: GL_ARB_bindless_texture is not supported; a sampler is a uniform");
}

TEST_CASE("macros that grow without end are refused before they are expanded") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const auto doubled = [](const std::string& first, const std::string& between) {
    std::string text = "#version 330\nout vec4 o;\nuniform float x;\n#define A0 " + first + "\n";
    for (int i = 1; i <= 40; ++i) {
      const std::string before = "A" + std::to_string(i - 1);
      text += "#define A" + std::to_string(i) + " " + before + between + before + "\n";
    }
    return text;
  };
  const std::string too_many = "macros make more than 524288 words and signs of the text";
  const std::string too_deep =
      "mine.frag:45: an expression of more than 2000 operators; it would have to be split";
  CHECK(error_of_text(doubled("x", "+") + "void main() { o = vec4(A40); }\n") == too_deep);
  CHECK(error_of_text(doubled("{o = vec4(x);}", " ") + "void main() { A40 }\n") ==
        "mine.frag:45: " + too_many);
  CHECK(error_of_text(doubled("1", " ") + "#if A40\n#endif\nvoid main() {}\n").ends_with(too_many));
  std::string nested = "x";
  for (int i = 0; i < 40; ++i) nested = "J(f, (" + nested + "))";
  CHECK(error_of_text("#version 330\nout vec4 o;\nuniform float x;\n#define f(a) a + a\n"
                      "#define J(a, b) a b\nvoid main() { o = vec4(" +
                      nested + "); }\n") != "none");
  std::string called = "x";
  for (int i = 0; i < 40; ++i) called = "G(f, " + called + ")";
  CHECK(error_of_text("#version 330\nout vec4 o;\nuniform float x;\n#define f(a) (a + a)\n"
                      "#define G(n, b) n(b)\nvoid main() { o = vec4(" +
                      called + "); }\n") != "none");
  // Each names all others.
  std::string circle = "#version 330\n";
  for (int i = 0; i < 12; ++i) {
    circle += "#define A" + std::to_string(i);
    for (int k = 0; k < 12; ++k) circle += " A" + std::to_string(k);
    circle += "\n";
  }
  CHECK(error_of_text(circle + "void main() { A0 }\n").ends_with(too_many));
  // Brackets behind what a macro became call it again.
  const std::string again =
      "#version 330\nout vec4 o;\n#define A B\n#define B(x) ; ; ; ; A\nvoid main() { A";
  CHECK(error_of_text(again + "(1)(1)(1)(1); }\n").ends_with(too_many));
  // Too many for binary64, of an argument that is nothing.
  std::string beyond = "#version 330\n#define E\n#define G0(x) x x x x x x x x x x x x x x x x\n";
  for (int i = 1; i < 260; ++i) {
    beyond += "#define G" + std::to_string(i) + "(x)";
    for (int k = 0; k < 16; ++k) beyond += " G" + std::to_string(i - 1) + "(x)";
    beyond += "\n";
  }
  CHECK(error_of_text(beyond + "void main() { G259(E) }\n").ends_with(too_many));
  // Names that are made of words: CAT(A, 1) is A1.
  CHECK(error_of_text("#version 330\nout vec4 o;\n#define CAT(a, b) a##b\n#define A0 ;;;;\n"
                      "#define A1 CAT(A, 0) CAT(A, 0)\n#define A2 CAT(A, 1) CAT(A, 1)\n"
                      "#define A3 CAT(A, 2) CAT(A, 2)\nvoid main() { A3 }\n")
            .ends_with(too_many));
}

TEST_CASE("macros as shaders have them are no matter") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  std::string text =
      "#version 330\nout vec4 o;\nuniform float x;\n"
      "#define hash(p) fract(sin(dot(p, vec2(12.9898, 78.233))) * 43758.5453)\n"
      "#define noise(p) mix(mix(hash(p), hash(p + vec2(1, 0)), 0.5), hash(p + vec2(0, 1)), 0.5)\n"
      "#ifdef OTHER\n#define lerp mix\n#else\n#define mix_ lerp\n#define lerp mix\n#endif\n"
      "#define NAME(n) value##n\n#define STEP s += noise(vec2(s, x)); s *= 0.5;\n"
      "#define STEPS STEP STEP STEP STEP STEP STEP STEP STEP\n";
  // A blend mode for each channel, by its name.
  text +=
      "#define burn(a, b) ((b == 0.0) ? b : max((1.0 - ((1.0 - a) / b)), 0.0))\n"
      "#define dodge(a, b) ((b == 1.0) ? b : min(a / (1.0 - b), 1.0))\n"
      "#define vivid(a, b) ((b < 0.5) ? burn(a, (2.0 * b)) : dodge(a, (2.0 * (b - 0.5))))\n"
      "#define each(u, v, mode) vec3(mode(u.r, v.r), mode(u.g, v.g), mode(u.b, v.b))\n"
      "#define vivid_light(a, b) each(a, b, vivid)\n"
      "#define opacity(a, b, mode, o) (mode(a, b) * o + b * (1.0 - o))\n";
  for (int i = 0; i < 3000; ++i) text += "#define N" + std::to_string(i) + " (-1 + 2)\n";
  text +=
      "void main() {\n  float s = x, value2 = lerp(x, 1.0, 0.5);\n  STEPS STEPS STEPS STEPS\n"
      "  vec3 c = opacity(vec3(s), vec3(x), vivid_light, 0.5) + vivid_light(vec3(x), vec3(s));\n"
      "  o = vec4(s + c.r + NAME(2) + noise(vec2(noise(vec2(x)))));\n}\n";
  CHECK(error_of_text(text) == "none");
  // No macro is replaced within itself.
  CHECK(error_of_text("uniform sampler2D s;\nvarying vec2 at;\n#define TEXTURE texture2D\n"
                      "#define texture2D(c, d) TEXTURE(c, d)\n"
                      "void main() { gl_FragColor = texture2D(s, at) + TEXTURE(s, at); }\n") ==
        "none");
}

TEST_CASE("what glslang would take its stack or minutes for is refused with its line") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const std::string head = "#version 330\nout vec4 o;\nuniform float x;\nuniform vec4 v;\n";
  const auto repeated = [](const std::string& part, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += part;
    return text;
  };
  const std::string too_deep =
      "an expression of more than 2000 operators; it would have to be split";
  CHECK(error_of_text(head + "void main() { o = v" + repeated(".xyzw", 20'000) + "; }\n") ==
        "mine.frag:5: " + too_deep);
  CHECK(error_of_text("#if " + repeated("(", 50'000) + "1" + repeated(")", 50'000) +
                      "\n#endif\nvoid main() {}\n") == "mine.frag:1: " + too_deep);
  CHECK(error_of_text(head + "void main() { o = vec4(" + repeated("(x", 20) +
                      repeated(repeated("+x", 1500) + ")", 20) + "); }\n") ==
        "mine.frag:5: " + too_deep);
  std::string structures = head + "struct S0 { float a; };\n";
  std::string functions = head + "float f0() { return x; }\n";
  std::string cases = head + "void main() { switch (int(x)) {\n";
  for (int i = 1; i <= 2500; ++i) {
    const std::string own = std::to_string(i), other = std::to_string(i - 1);
    if (i <= 40) structures += "struct S" + own + " { S" + other + " a, b; };\n";
    functions += "float f" + own + "() { return f" + other + "(); }\n";
    cases += "case " + own + ": o = v; break;\n";
  }
  CHECK(error_of_text(structures + "void main() { S40 s; o = v; }\n") ==
        "mine.frag:22: structure S17 has more than 65536 members, with those of its members");
  CHECK(error_of_text(functions + "void main() { o = vec4(f2500()); }\n")
            .ends_with("more than 2000 functions"));
  CHECK(error_of_text(cases + "} }\n").ends_with("more than 2000 cases"));
  CHECK(error_of_text(head +
                      "void main() { float a[100000000], b[100000000]; o = vec4(a == b); }\n") ==
        "mine.frag: too many comparisons for arrays or structures of that size");
}

TEST_CASE("functions of ints are there in the oldest versions, as drivers have them") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  CHECK(error_of_text("#version 110\nuniform int n;\n"
                      "void main() { gl_FragColor = vec4(float(min(n, 4))); }\n") == "none");
  CHECK(error_of_text("#version 110\nvoid main() { gl_FragColor = vec4(nothing(4)); }\n")
            .find("'nothing'") != std::string::npos);
}

TEST_CASE("threads compile at once, each to the same words" * doctest::test_suite("threads")) {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const auto expected = compiled_text(kOldBody).words;
  std::vector<std::thread> threads;
  threads.reserve(4);
  std::vector<int> equal(4);
  for (int& count : equal) {
    threads.emplace_back([&] {
      for (int i = 0; i < 20; ++i)
        count += static_cast<int>(compiled_text(kOldBody).words == expected);
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(equal == std::vector<int>{20, 20, 20, 20});
}

TEST_CASE("what drivers take and old versions do not say: suffixes, constants by newer functions") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  CHECK(error_of_text("#version 110\nvoid main() { gl_FragColor = vec4(0.5f); }\n") == "none");
  CHECK(error_of_text("#version 120\n"
                      "void main() {\n"
                      "  const mat2 m = transpose(mat2(1.0, 2.0, 3.0, 4.0));\n"
                      "  gl_FragColor = vec4(m[0], m[1]);\n"
                      "}\n") == "none");
  // ES has no version of which it is true, and what is wrong stays the first error.
  const std::string error = error_of_text(
      "#version 300 es\nprecision highp float;\nuniform float f;\nout vec4 c;\n"
      "const float g = f;\nvoid main() { c = vec4(g); }\n");
  CHECK(error.starts_with("mine.frag:5: "));
}
