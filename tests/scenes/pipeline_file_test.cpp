#include "scenes/load/pipeline_file.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/images/texel.h"
#include "raster/shaders/shader_error.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/parse_expression.h"
#include "tests/support/scene_test_files.h"
#include "tests/support/skip.h"
#include "tests/support/test_images.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

constexpr const char* kRoot = SOFTFOCUS_TEST_DATA "/../../";

/// A pipeline's files.
struct Files {
  TemporaryDirectory directory;

  std::string write(const std::string& name, const std::string& text) const {
    write_file(directory.file(name), text);
    return directory.file(name);
  }
  /// The pipeline's file, with a shader of that main() beside it.
  std::string pipeline(const std::string& toml, const std::string& head,
                       const std::string& main) const {
    write("a.frag", "#version 330\n" + head + "\nout vec4 colour;\nvoid main() {" + main + "}\n");
    return write("a.toml", toml);
  }
};

Image result_of(const Method& method, const DofInput& input, int threads = 1) {
  ThreadPool pool(threads);
  return apply(method, input, pool);
}

/// What a pipeline makes of a random picture.
Image drawn(const OpenedPipeline& opened, const Image& picture, const DofSettings& settings = {}) {
  ThreadPool pool(2);
  Image result = make_image(Format::rgba16f, picture.width, picture.height);
  run_pipeline(opened.pipeline, {picture, settings, {}}, result, pool);
  return result;
}

float red_at(const Image& image, int x, int y) { return load_texel(image, x, y).x; }

std::string error_of(const std::string& file) {
  try {
    read_pipeline(file);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("the pipelines of our own GLSL have the bits of two-pass") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Method& ours = *find_method("two-pass");
  for (const char* name : {"two_pass.toml", "two_pass_tiled.toml"}) {
    const Method& by_glsl = *pipeline_method(kRoot + ("scenes/pipelines/" + std::string{name}));
    for (const char* profile : {"ieee", "d3d11"}) {
      for (const float max_coc : {0.5f, 1.0f, 3.5f, 16.0f, 40.0f}) {
        CAPTURE(name);
        CAPTURE(profile);
        CAPTURE(max_coc);
        const Image picture = random_scene_image(77, 41, 3);
        const DofInput input{picture,
                             {.coc = {15.0f, 2.0f}, .max_coc_px = max_coc, .leak = 0.7f},
                             *find_profile(profile)};
        CHECK(equal(result_of(by_glsl, input, 2), result_of(ours, input)));
      }
    }
  }
}

TEST_CASE("an expression is what its text says") {
  const std::vector<std::string> names{"width", "focus_m"};
  const std::vector<double> values{7.0, 2.5};
  struct Case {
    const char* text;
    double value;
  };
  for (const Case& of : {Case{"3", 3.0},
                         {".5", 0.5},
                         {"1e-3", 1e-3},
                         {"1 + 2 * 3", 7.0},
                         {"(1 + 2) * 3", 9.0},
                         {"7 - 2 - 1", 4.0},
                         {"8 / 4 / 2", 1.0},
                         {"-2 - -3", 1.0},
                         {"7 % 3", 1.0},
                         {"-1 % 3", 2.0},
                         {"ceil(width / 2) - 1", 3.0},
                         {"floor(focus_m)", 2.0},
                         {"max(width, min(focus_m, 100))", 7.0},
                         {"min(width, focus_m)", 2.5},
                         {"sqrt(width + 2)", 3.0},
                         {"abs(focus_m - width)", 4.5},
                         {"exp2(3)", 8.0},
                         {"sin_degrees(30) + cos_degrees(60)", 1.0}}) {
    CAPTURE(of.text);
    CHECK(std::fabs(evaluate(parse_expression(of.text, names), values) - of.value) < 1e-15);
  }
}

TEST_CASE("an expression that is none says what is wrong") {
  const std::vector<std::string> names{"width"};
  const auto error = [&](const std::string& text) -> std::string {
    try {
      parse_expression(text, names);
    } catch (const ExpressionError& fault) {
      return fault.what();
    }
    return "";
  };
  CHECK(error("") == "'': a number or a name is missing");
  CHECK(error("1 +") == "'1 +': a number or a name is missing");
  CHECK(error("(1") == "'(1': a ')' is missing");
  CHECK(error("1 2") == "'1 2': '2' is left over");
  CHECK(error("widht") == "'widht': there is no 'widht'; there are width");
  CHECK(error("min(1)") == "'min(1)': a ',' is missing");
  CHECK(error("1e") == "'1e': '1e' is no number");
  CHECK(error("$") == "'$': '$' is not known");
  CHECK(error("pow(1, 2)").starts_with("'pow(1, 2)': there is no function 'pow'; there are floor"));
  CHECK(error(std::string(100, '(') + "1") ==
        "'" + std::string(100, '(') + "1': it is nested too deeply");
}

TEST_CASE("a pass reads what its inputs name, or what was drawn last") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  const Image picture = random_scene_image(9, 5, 1);
  const auto centre = [&](const std::string& toml, const std::string& head, const std::string& main,
                          const DofSettings& settings = {}) {
    return red_at(drawn(read_pipeline(files.pipeline(toml, head, main)), picture, settings), 4, 2);
  };
  const glm::vec4 texel = load_texel(picture, 4, 2);
  const std::string pass = "[[pass]]\nshader = \"a.frag\"\n";
  const std::string fetch = "colour = texelFetch(s, ivec2(gl_FragCoord.xy), 0);";
  CHECK(centre(pass, "uniform sampler2D s;", fetch) == texel.x);
  CHECK(centre(pass, "uniform sampler2D depth;",
               "colour = texelFetch(depth, ivec2(gl_FragCoord.xy), 0);") == texel.w);
  const DofSettings from_1_to_1000{.coc = {}, .frame = {.near_m = 1.0, .far_m = 1000.0}};
  CHECK(
      centre(pass + "inputs = { s = \"buffer_depth\" }\n", "uniform sampler2D s;", fetch,
             from_1_to_1000) ==
      doctest::Approx(std::fmin(std::fmax(1000.0 * (texel.w - 1.0) / (texel.w * 999.0), 0.0), 1.0))
          .epsilon(1e-3));
  // Twice one more than before; the first pass again, by its name.
  const std::string more = "colour = texelFetch(s, ivec2(gl_FragCoord.xy), 0) + vec4(1.0);";
  const auto half = [](float value) {
    return half_to_float(float_to_half(value, HalfRounding::nearest_even));
  };
  CHECK(centre(pass + pass, "uniform sampler2D s;", more) == half(half(texel.x + 1.0f) + 1.0f));
  CHECK(centre(pass + "name = \"first\"\n" + pass + pass + "inputs = { s = \"first\" }\n",
               "uniform sampler2D s;", more) == half(half(texel.x + 1.0f) + 1.0f));
  CHECK(centre(pass + pass + "inputs = { s = \"picture\" }\n", "uniform sampler2D s;", more) ==
        half(texel.x + 1.0f));
  // Turns go on from turns.
  CHECK(centre(pass + "turns = 3\nformat = \"rgba32f\"\nuniforms = { step = \"turn\" }\n",
               "uniform sampler2D s; uniform float step;",
               "colour = texelFetch(s, ivec2(gl_FragCoord.xy), 0) + vec4(step);") ==
        half((texel.x + 0.0f + 1.0f) + 2.0f));
}

TEST_CASE("several outputs are inputs by their names, in formats of their own") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  files.write("two.frag",
              "#version 330\nlayout(location = 0) out vec4 a;\nlayout(location = 1) out vec4 b;\n"
              "void main() { a = vec4(0.3); b = vec4(0.3); }\n");
  const std::string toml =
      "[[pass]]\nshader = \"two.frag\"\noutputs = [\"coarse\", \"fine\"]\n"
      "format = [\"rgba8\", \"rgba32f\"]\n[[pass]]\nshader = \"a.frag\"\nformat = \"rgba32f\"\n";
  const OpenedPipeline opened = read_pipeline(
      files.pipeline(toml, "uniform sampler2D coarse, fine;",
                     "float a = texelFetch(coarse, ivec2(0), 0).x * 255.0;"
                     "colour = vec4(texelFetch(fine, ivec2(0), 0).x == 0.3 && a > 76.999 && "
                     "a < 77.001 ? 1.0 : 0.0);"));
  CHECK(red_at(drawn(opened, random_scene_image(4, 3, 1)), 1, 1) == 1.0f);
}

TEST_CASE("values, parameters and sizes reach the shader") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  const Image picture = random_scene_image(9, 5, 1);
  const DofSettings settings{
      .coc = {15.0f, 2.5f},
      .max_coc_px = 7.0f,
      .leak = 0.5f,
      .frame = {.near_m = 0.25, .far_m = 64.0, .aperture_radius_m = 0.125, .number = 30.0}};
  const std::string parameters =
      "[parameters.strength]\ndefault = 2\nrange = [0, 4]\n"
      "[parameters.count]\ndefault = 3\nrange = [1, 9]\nwhole = true\n";
  const auto shown = [&](const std::string& head, const std::string& value,
                         const std::string& more = "", const std::string& set = "") {
    OpenedPipeline opened =
        read_pipeline(files.pipeline(parameters + "[[pass]]\nshader = \"a.frag\"\n" + more, head,
                                     "colour = vec4(" + value + ");"));
    set_parameters(opened.pipeline, set);
    return red_at(drawn(opened, picture, settings), 0, 0);
  };
  CHECK(shown("uniform float radius_at_infinity_px;", "radius_at_infinity_px") == 15.0f);
  CHECK(shown("uniform float focus_m;", "focus_m") == 2.5f);
  CHECK(shown("uniform float max_coc_px;", "max_coc_px") == 7.0f);
  CHECK(shown("uniform float leak;", "leak") == 0.5f);
  CHECK(shown("uniform float near_m, far_m;", "near_m + far_m") == 64.25f);
  CHECK(shown("uniform float cameraNear, cameraFar;", "cameraNear + cameraFar") == 64.25f);
  CHECK(shown("uniform float aperture_radius_m;", "aperture_radius_m") == 0.125f);
  CHECK(shown("uniform int frame; uniform float seconds;", "float(frame) + seconds") == 30.5f);
  CHECK(shown("uniform vec2 resolution;", "resolution.x * 16.0 + resolution.y") == 149.0f);
  CHECK(shown("uniform float strength; uniform int count;", "strength + float(count)") == 5.0f);
  CHECK(shown("uniform float strength; uniform int count;", "strength + float(count)", "",
              "strength=0.5:count=9") == 9.5f);
  CHECK(shown("uniform vec2 texel;", "texel.x * 9.0 + texel.y * 5.0",
              "uniforms = { texel = [\"1 / width\", \"1 / height\"] }\n") == 2.0f);
  CHECK(shown("uniform float focus_m;", "focus_m", "uniforms = { focus_m = 9 }\n") == 9.0f);
  // A pass of half the size, rounded up, and one that shows how large it was.
  const std::string again = "[[pass]]\nshader = \"b.frag\"\n";
  files.write("b.frag",
              "#version 330\nuniform sampler2D s;\nout vec4 colour;\nvoid main() {\n"
              "  ivec2 size = textureSize(s, 0);\n  colour = vec4(size.x * 16 + size.y);\n}\n");
  CHECK(shown("", "0.0", "scale = 0.5\n" + again) == 5.0f * 16.0f + 3.0f);
  CHECK(shown("", "0.0", "width = \"2 * width\"\nheight = 4\n" + again) == 18.0f * 16.0f + 4.0f);
}

TEST_CASE("a pass has macros, and folders for what it includes") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  std::filesystem::create_directory(files.directory.file("lib"));
  files.write("lib/sum.glsl", "#define SUM (float(A) + B + float(C))\n");
  const OpenedPipeline opened =
      read_pipeline(files.pipeline("[[pass]]\nshader = \"a.frag\"\ninclude = [\"lib\"]\n"
                                   "defines = { A = 2, B = \"0.5\", C = true }\n",
                                   "#include \"sum.glsl\"", "colour = vec4(SUM);"));
  CHECK(red_at(drawn(opened, random_scene_image(3, 3, 1)), 0, 0) == 3.5f);
  CHECK(std::any_of(opened.files.begin(), opened.files.end(),
                    [](const std::string& file) { return file.ends_with("lib/sum.glsl"); }));
  const auto error_with = [&](const std::string& keys) {
    return error_of(files.pipeline("[[pass]]\nshader = \"a.frag\"\n" + keys, "", ""));
  };
  CHECK(contains(error_with("defines = { A = 0.5 }\n"), "a.toml:3: pass.defines.A: is no text; "));
  CHECK(contains(error_with("defines = { \"1x\" = 1 }\n"), "a.toml:3: pass.defines.1x: the name "));
  CHECK(contains(error_with("include = [\"nowhere\"]\n"),
                 "a.toml:3: pass.include: 'nowhere' is no folder"));
}

TEST_CASE("what reads no lens is told apart") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  const std::string pass = "[[pass]]\nshader = \"a.frag\"\n";
  const auto reads = [&](const std::string& toml, const std::string& head,
                         const std::string& main) {
    return reads_lens(read_pipeline(files.pipeline(toml, head, main)).pipeline);
  };
  CHECK(!reads(pass, "uniform float seconds;", "colour = vec4(seconds);"));
  CHECK(reads(pass, "uniform float focus_m;", "colour = vec4(focus_m);"));
  CHECK(reads(pass + "uniforms = { a = \"2 * leak\" }\n", "uniform float a;", "colour = vec4(a);"));
}

TEST_CASE("a pipeline that is at fault names its file, its line and what would be right") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  const auto error = [&](const std::string& toml,
                         const std::string& head = "uniform sampler2D s; uniform vec2 v;",
                         const std::string& main = "colour = texture(s, v);") {
    const std::string text = error_of(files.pipeline(toml, head, main));
    CAPTURE(text);
    const std::string folder = files.directory.file("");
    REQUIRE(text.starts_with(folder));
    return text.substr(folder.size());
  };
  const std::string pass = "[[pass]]\nshader = \"a.frag\"\n";
  CHECK(error("") == "a.toml:1: pass: is missing; [[pass]] with shader = \"FILE\" would be right");
  CHECK(error("[[pass]]\n") ==
        "a.toml:1: pass.shader: is missing; the name of a fragment shader would be right");
  CHECK(error("[[pass]]\nshader = \"b.frag\"\n").starts_with("a.toml:2: pass.shader: "));
  CHECK(error(pass + "uniforms = { w = 1 }\n") ==
        "a.toml:3: pass.uniforms.w: the shader has no uniform of that name; there are v");
  CHECK(error(pass + "uniforms = { v = [1, 2, 3] }\n") ==
        "a.toml:3: pass.uniforms.v: has 3 numbers; 2 would be right");
  CHECK(error(pass + "uniforms = { v = \"1 +\" }\n") ==
        "a.toml:3: pass.uniforms.v: '1 +': a number or a name is missing");
  CHECK(error(pass + "inputs = { s = \"pikture\" }\n") ==
        "a.toml:3: pass.inputs.s: 'pikture' is not there; there are previous, picture, depth and "
        "buffer_depth; did you mean 'picture'?");
  CHECK(error(pass + "inputs = { t = \"picture\" }\n") ==
        "a.toml:3: pass.inputs.t: the shader has no texture of that name; there are s");
  CHECK(error(pass + "colour = 1\n").starts_with("a.toml:3: pass.colour: "));
  CHECK(error(pass + "format = \"rgb\"\n").starts_with("a.toml:3: pass.format: "));
  CHECK(error("[parameters.width]\ndefault = 1\n" + pass).starts_with("a.toml:1: "));
  CHECK(error("[parameters.a]\ndefault = 9\nrange = [0, 1]\n" + pass) ==
        "a.toml:2: parameters.a.default: 9 is out of range; a number from 0 to 1 would be right");
  CHECK(error("[textures]\nnoise = \"noise.png\"\n" + pass)
            .starts_with("a.toml:2: textures.noise: "));
  CHECK(error(pass, "uniform sampler2D s, t;",
              "colour = texture(s, vec2(0)) + texture(t, vec2(0));") ==
        "a.toml:1: the shader reads textures 's' and 't'; their sources in [pass.inputs] would be "
        "right");
  CHECK(error(pass, "", "colour = vec4(x);") == "a.frag:4: 'x': undeclared identifier");
}

TEST_CASE("a pass of a size or a number that cannot be names its line when it runs") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  const Image picture = random_scene_image(9, 5, 1);
  const auto error = [&](const std::string& more, const std::string& head) -> std::string {
    const OpenedPipeline opened = read_pipeline(
        files.pipeline("[[pass]]\nshader = \"a.frag\"\n" + more, head, "colour = vec4(0.0);"));
    try {
      drawn(opened, picture);
    } catch (const ShaderError& fault) {
      return std::string{fault.what()}.substr(files.directory.file("").size());
    }
    return "";
  };
  CHECK(error("width = \"width - 9\"\n", "").starts_with("a.toml:1: the width is 0"));
  CHECK(error("width = 4\n", "") ==
        "a.toml:1: the last pass draws 4 x 5 pixels; the picture's size, 9 x 5, would be right");
  CHECK(error("turns = \"focus_m - focus_m\"\n", "").starts_with("a.toml:1: the number of turns"));
}

TEST_CASE("texels by the convention of a browser: codes, the lowest row first") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  const Image picture = random_scene_image(6, 4, 2);
  const auto row_0 = [&](const std::string& texels, int y) {
    const Image result =
        drawn(read_pipeline(files.pipeline(texels + "[[pass]]\nshader = \"a.frag\"\n",
                                           "uniform sampler2D depth;",
                                           "colour = vec4(gl_FragCoord.y < 1.0 ? 0.5 : 0.0);")),
              picture);
    return red_at(result, 3, y);
  };
  CHECK(row_0("", 0) == 0.5f);
  CHECK(row_0("", 3) == 0.0f);
  CHECK(row_0("texels = \"srgb\"\n", 0) == 0.0f);
  CHECK(row_0("texels = \"srgb\"\n", 3) == doctest::Approx(srgb8_to_linear(128)).epsilon(1e-3));
  const auto same = [&](const std::string& name) {
    return drawn(
        read_pipeline(files.pipeline(
            "texels = \"srgb\"\n[[pass]]\nshader = \"a.frag\"\n", "uniform sampler2D " + name + ";",
            "colour = vec4(texelFetch(" + name + ", ivec2(gl_FragCoord.xy), 0).r);")),
        picture);
  };
  CHECK(red_at(same("picture"), 2, 1) ==
        doctest::Approx(load_texel(picture, 2, 1).x).epsilon(0.02));
  // Above 1 m a depth is 1 in codes.
  const Image depths = same("depth");
  for (int y = 0; y < 4; ++y) {
    CHECK((red_at(depths, 2, y) == 1.0f) == (load_texel(picture, 2, y).w >= 1.0f));
    CHECK(load_texel(depths, 2, y).w == load_texel(picture, 2, y).w);
  }
}

TEST_CASE("a method by a path lasts, and by its settings is another") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  const std::string file =
      files.pipeline("[parameters.a]\ndefault = 1\nrange = [0, 2]\n[[pass]]\nshader = \"a.frag\"\n",
                     "uniform float a;", "colour = vec4(a);");
  const Method* const method = pipeline_method(file);
  CHECK(pipeline_method(file) == method);
  CHECK(method->name == file);
  const Method* const other = pipeline_method(file + ":a=1.5");
  CHECK(other != method);
  CHECK(other->pipeline->hash != method->pipeline->hash);
  const Image picture = random_scene_image(3, 3, 1);
  CHECK(red_at(result_of(*method, {picture, {}, {}}), 1, 1) == 1.0f);
  CHECK(red_at(result_of(*other, {picture, {}, {}}), 1, 1) == 1.5f);
  CHECK(scene_error_of([&] { pipeline_method(file + ":a=3"); }) ==
        file + ": 'a=3': a number from 0 to 2 would be right");
  CHECK(scene_error_of([&] { pipeline_method(file + ":b=3"); }) ==
        file + ": there is no parameter 'b'; there are a");
  CHECK(files_of(*method) == std::vector<std::string>{file, files.directory.file("a.frag")});
  CHECK(is_pipeline_name("a.toml"));
  CHECK(is_pipeline_name("a.toml:b=1"));
  CHECK(!is_pipeline_name("two-pass"));
}
