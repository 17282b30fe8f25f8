// Shapes of control flow that lanes can get wrong, in GLSL, against the interpreter of a pixel.

#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <limits>
#include <optional>

#include "raster/shaders/glsl/glsl.h"
#include "raster/shaders/shader.h"
#include "tests/support/shader_checks.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

CompiledGlsl compiled_flow(const std::string& text) {
  return compile_glsl({.name = "flow.frag", .text = text},
                      [](const std::string&) { return std::optional<std::string>{}; });
}

/// The first difference of a main() with `int x`, the column, and `float s`, which is stored.
std::string difference_of(const std::string& body, const std::string& functions = "") {
  if (!missing_glsl().empty()) return {};
  const std::string text = "#version 450\nlayout(location = 0) out vec4 result;\n" + functions +
                           "\nvoid main() {\n  int x = int(gl_FragCoord.x), k = 0;\n"
                           "  float s = 0.0;\n" +
                           body + "\n  result = vec4(s, float(k), 0.0, 1.0);\n}\n";
  return test::check_shader(compiled_flow(text).words, 1).difference;
}

}  // namespace

TEST_CASE("what stands behind a jump that all pixels take is not run") {
  // i is the same for all pixels, and others have a way out of the same scope that is not.
  CHECK(difference_of(R"(
    for (int i = 0; i < 6; ++i) {
      if (i > 0) {
        if (i == 2) continue;
        s += 0.5;
      }
      k++;
      if (x > 3) {
        if (x > i * 8) continue;
        s += 4.0;
      }
      s += 1.0;
    })") == "");
}

TEST_CASE("a counter is the same for all pixels until some leave the loop") {
  CHECK(difference_of(R"(
    while (true) {
      k++;
      if (k > x) break;
      s += 1.0;
      if (k > 12) break;
    })") == "");
}

TEST_CASE("a jump out of an inner scope that all take does not hide one out of an outer") {
  CHECK(difference_of(R"(
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 4; ++j) {
        if (j > 0) {
          if (j == 2) break;
          s += 0.5;
        }
        if (i == 4) return;
        if (x > 9) {
          if (x > i * 8) break;
          s += 4.0;
        }
        k += j;
      }
      s += float(k);
      result = vec4(s, 1.0, 2.0, float(i));
    })") == "");
}

TEST_CASE("a case falls into the next after a switch of its own") {
  CHECK(difference_of(R"(
    switch (x & 3) {
      case 0:
        switch (x & 4) { case 0: s += 1.0; case 4: s += 2.0; }
      case 1: s += 10.0; break;
      default: s -= 1.0;
      case 2: k = 7;
    })") == "");
}

TEST_CASE("a case calls a function with a switch, and falls") {
  CHECK(difference_of(R"(
    for (int i = 0; i < 4; ++i) {
      switch ((x + i) & 3) {
        case 0: s += f(x);
        case 3: s += 100.0; if (x > 40) break;
        case 1: if (i == 2) continue; k += i; break;
      }
      s += 0.25;
    })",
                      "float f(int n) { switch (n & 7) { case 1: case 2: return 3.0; "
                      "case 4: n = 5; default: break; } return float(n); }") == "");
}

TEST_CASE("two values that change places in each turn of a loop") {
  CHECK(difference_of(R"(
    int a = 1, b = x;
    for (int i = 0; i < (x & 7); ++i) { int t = a; a = b; b = t; if (b > 20) break; b += a & 3; }
    k = a; s = float(b);)") == "");
}

TEST_CASE("pixels that a function in a loop kills are not stored") {
  CHECK(difference_of(R"(
    for (int i = 0; i < 5; ++i) { s += f(x, i); if (s > 30.0) break; }
    k = 3;)",
                      "float f(int x, int i) { for (int j = 0; j < 3; ++j) { "
                      "if (j == (x & 3)) { if (i * 9 > x + 20) discard; return float(x); } } "
                      "return 1.0; }") == "");
}

TEST_CASE("a component of an input by an index") {
  CHECK(difference_of("s = gl_FragCoord[x & 1] + gl_FragCoord[x - 3];") == "");
}

TEST_CASE("what is returned early, out of loops, from within a case") {
  CHECK(difference_of("s = f(x) + f(x * 5 + 1); k = int(f(3));",
                      R"(float f(int n) {
                           float sum = 0.0;
                           for (int i = 0; i < 7; ++i) {
                             switch (i) {
                               case 3: if (n > 20) return sum; break;
                               case 4: for (int j = 0; j < n; ++j) if (j == 9) return -sum;
                               default: sum += 0.5; continue;
                             }
                             sum *= 2.0;
                           }
                           return sum;
                         })") == "");
}

TEST_CASE("a choice by the opposite of a condition takes the other side") {
  CHECK(difference_of(R"(
    bool low = x < 20, odd = (x & 1) == 1;
    s = mix(1.0, 2.0, !low) + mix(10.0, 20.0, !odd);
    k = int(mix(vec2(3.0, 4.0), vec2(5.0, 6.0), bvec2(!odd, !low)).y);)") == "");
}

TEST_CASE("the size of a mip level is that of the turn's own level") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const UserShader shader = make_shader(compiled_flow(R"(#version 450
uniform sampler2D t;
layout(location = 0) out vec4 result;
void main() {
  ivec2 sum = ivec2(0), last = ivec2(0);
  for (int level = 0; level < 4; ++level) {
    sum += textureSize(t, level);
    for (int i = 0; i < 2; ++i) last += textureSize(t, level) * (i + level);
  }
  result = vec4(sum, last);
}
)")
                                            .words);
  Texture texture = make_texture(make_image(Format::rgba16f, 8, 4));
  generate_mipmaps(texture, {});
  const ShaderTexture textures[] = {{.texture = &texture}};
  Image found = make_image(Format::rgba32f, 40, 1);
  const ImageView view = found;
  ThreadPool pool{1};
  run_shader(compile_shader(shader, shader.uniforms.words),
             {.textures = textures, .targets = {&view, 1}}, pool);
  // 8x4, 4x2, 2x1 and 1x1, each by 2 level + 1.
  CHECK(load_texel(found, 39, 0) == glm::vec4{15.0f, 8.0f, 37.0f, 22.0f});
}

TEST_CASE("differences where neighbours are elsewhere do not depend on what ran before") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const UserShader shader = make_shader(compiled_flow(R"(#version 450
uniform sampler2D t;
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 result;
float helper(float p) {
  if (int(gl_FragCoord.x * 7.0 + gl_FragCoord.y * 3.0) % 3 == 0) {
    return texture(t, vec2(p, uv.y)).g;
  }
  return p * 0.7 + 0.1;
}
void main() {
  float r = 0.0, s = 0.0;
  for (int i = 0; i < 4; ++i) {
    if (gl_FragCoord.x > 200.0 && i > 1) continue;
    if (int(gl_FragCoord.x * gl_FragCoord.y * 0.37 + float(i)) % 5 == 2) {
      float v = helper(uv.x + float(i) * 0.1);
      s += dFdx(v) + texture(t, vec2(v, 0.3)).r;
      r += v;
    }
  }
  result = vec4(r, s, 0.0, 1.0);
}
)")
                                            .words);
  test::Random random{5};
  Texture texture = test::random_texture(Format::rgba16f, 64, random);
  generate_mipmaps(texture, {});
  const ShaderTexture textures[] = {
      {.texture = &texture, .sampler = {.filter = Filter::trilinear}}};
  const ShaderProgram program = compile_shader(shader, shader.uniforms.words);
  std::optional<Image> first;
  for (const Isa isa : available_isas()) {
    for (const int threads : {1, 2, 7}) {
      for (const int lanes : {32, 128, 0}) {
        Image found = make_image(Format::rgba32f, 333, 77);
        const ImageView view = found;
        ThreadPool pool{threads, isa};
        run_shader(program, {.textures = textures, .targets = {&view, 1}, .lanes = lanes}, pool);
        if (!first) first = found;
        CAPTURE(isa_name(isa));
        CAPTURE(threads);
        CAPTURE(lanes);
        CHECK(test::first_difference(found, *first) == "");
      }
    }
  }
}

TEST_CASE("min, max and clamp give the number, if the other is NaN; NMin and so on are the same") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  GlslSource source{.name = "mine.frag"};
  source.text =
      "#version 330\nuniform float a, b, c;\nout vec4 colour;\n"
      "void main() { colour = vec4(min(a, b), max(a, b), clamp(a, b, c), 1.0); }\n";
  std::vector<std::uint32_t> words =
      compile_glsl(source, [](const std::string&) { return std::nullopt; }).words;
  const std::vector<std::uint32_t> as_glsl = words;
  int changed = 0;
  for (std::size_t i = 5; i < words.size(); i += words[i] >> 16) {
    constexpr std::uint32_t kExtInst = 12;
    if ((words[i] & 0xFFFF) != kExtInst) continue;
    const auto op = static_cast<GlslOp>(words[i + 4]);
    using enum GlslOp;
    const GlslOp to = op == float_min ? number_min : op == float_max ? number_max : number_clamp;
    words[i + 4] = static_cast<std::uint32_t>(to);
    ++changed;
  }
  REQUIRE(changed == 3);
  for (const auto& text : {as_glsl, words}) {
    const UserShader shader = make_shader(text);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    ThreadPool pool{1};
    const auto results = [&](float a, float b) {
      std::vector<std::uint32_t> uniforms = shader.uniforms.words;
      uniforms[find_uniform(shader, "a")->first] = std::bit_cast<std::uint32_t>(a);
      uniforms[find_uniform(shader, "b")->first] = std::bit_cast<std::uint32_t>(b);
      uniforms[find_uniform(shader, "c")->first] = std::bit_cast<std::uint32_t>(8.0f);
      std::array<float, 4> pixel{};
      const ImageView target = view_of(Format::rgba32f, pixel.data(), 1, 1);
      run_shader(compile_shader(shader, uniforms), {.targets = {&target, 1}}, pool);
      return pixel;
    };
    CHECK(results(1.0f, 2.0f) == std::array<float, 4>{1.0f, 2.0f, 2.0f, 1.0f});
    CHECK(results(nan, 2.0f) == std::array<float, 4>{2.0f, 2.0f, 2.0f, 1.0f});
    CHECK(results(1.0f, nan) == std::array<float, 4>{1.0f, 1.0f, 1.0f, 1.0f});
  }
}
