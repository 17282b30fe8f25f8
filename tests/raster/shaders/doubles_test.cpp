// Numbers of binary64 in shaders.

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "raster/images/texel.h"
#include "raster/shaders/draw_shaders.h"
#include "raster/shaders/glsl/glsl.h"
#include "raster/shaders/shader_kernels.h"
#include "tests/support/shader_checks.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

std::uint32_t low_of(double x) {
  return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(x));
}
std::uint32_t high_of(double x) {
  return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(x) >> 32);
}

/// The bits of an operation's double; `op` is that of the low word.
std::uint64_t folded(ShaderOp op, double x, double y = 0.0) {
  const auto high = static_cast<ShaderOp>(static_cast<int>(op) + 1);
  const auto word = [&](ShaderOp of) {
    return std::uint64_t{fold_shader_op(of, low_of(x), high_of(x), low_of(y), high_of(y))};
  };
  return word(high) << 32 | word(op);
}
std::int32_t signed_of(double x) {
  return static_cast<std::int32_t>(
      fold_shader_op(ShaderOp::signed_of_double, low_of(x), high_of(x), 0, 0));
}
float float_of(double x) {
  return std::bit_cast<float>(fold_shader_op(ShaderOp::float_of_double, low_of(x), high_of(x), 0));
}

std::vector<std::uint32_t> compiled_doubles(const std::string& text,
                                            ShaderStage stage = ShaderStage::fragment) {
  return compile_glsl({.stage = stage, .name = "doubles", .text = text},
                      [](const std::string&) { return std::optional<std::string>{}; })
      .words;
}

/// The first difference of a main() with `int x`, the column, a double d that is no float, and
/// `double s`, which is stored as three floats that have all of its bits.
std::string difference_with_doubles(const std::string& body, const std::string& functions = "") {
  const std::string text =
      "#version 450\nlayout(location = 0) out vec4 result;\n" + functions +
      "\nvoid main() {\n  int x = int(gl_FragCoord.x), k = 0;\n"
      "  double d = double(x - 9) / 7.0lf, s = 0.0lf;\n" +
      body +
      "\n  uvec2 words = unpackDouble2x32(s);\n"
      "  result = vec4(float(words.x & 0xFFFFu), float(words.x >> 16),\n"
      "                float(words.y & 0xFFFFFu), float(words.y >> 20) + 4096.0 *"
      " float(k & 0xFFF));\n}\n";
  return test::check_shader(compiled_doubles(text), 1).difference;
}

std::string refusal_of_doubles(const std::string& text, ShaderStage stage = ShaderStage::fragment) {
  try {
    const UserShader shader = make_shader(compiled_doubles(text, stage));
    compile_shader(shader, shader.uniforms.words);
  } catch (const ShaderError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("an operation on doubles rounds once, to binary64") {
  using enum ShaderOp;
  CHECK(folded(add_doubles, 0.1, 0.2) == 0x3FD3333333333334u);
  CHECK(folded(subtract_doubles, 1.0, 0x1p-54) == 0x3FF0000000000000u);
  CHECK(folded(multiply_doubles, 0.1, 0.1) == 0x3F847AE147AE147Cu);
  CHECK(folded(divide_doubles, 1.0, 3.0) == 0x3FD5555555555555u);
  CHECK(folded(divide_doubles, 0x1p-1022, 2.0) == 0x0008000000000000u);
  CHECK(folded(square_root_of_double, 2.0) == 0x3FF6A09E667F3BCDu);
  CHECK(folded(floor_of_double, -0.5) == std::bit_cast<std::uint64_t>(-1.0));
  CHECK(folded(round_even_double, 2.5) == std::bit_cast<std::uint64_t>(2.0));
  CHECK(folded(round_even_double, -0.25) == std::bit_cast<std::uint64_t>(-0.0));
  CHECK(float_of(0x1.000001p0) == 1.0f);
  CHECK(float_of(0x1.000001p0 + 0x1p-52) == 0x1.000002p0f);
  CHECK(float_of(1e300) == std::numeric_limits<float>::infinity());
}

TEST_CASE("a double is cut to an int, and beyond its range is the least") {
  CHECK(signed_of(-2147483648.75) == INT32_MIN);
  CHECK(signed_of(2147483647.75) == INT32_MAX);
  CHECK(signed_of(2147483648.0) == INT32_MIN);
  CHECK(signed_of(-1e300) == INT32_MIN);
  CHECK(signed_of(std::nan("")) == INT32_MIN);
  CHECK(signed_of(-3.75) == -3);
}

TEST_CASE("shaders of doubles have the machine's bits on every unit") {
  if (!missing_glsl().empty()) return skip("", missing_glsl());
  CHECK(difference_with_doubles("s = (d * 3.3lf - 0.7lf) / (d + 0.123lf);") == "");
  CHECK(difference_with_doubles("s = double(float(d)) + double(x) - double(uint(x) - 3u);") == "");
  CHECK(difference_with_doubles("k = int(d * 1e3lf) + int(uint(d * 3e8lf)); s = -d;") == "");
  CHECK(difference_with_doubles(
            "if (d < 0.5lf) s += d; if (d >= 0.0lf) k |= 1; if (d == 0.0lf) k |= 2;"
            "if (d != 1.0lf) k |= 4; if (!(d > 1.0lf)) k |= 8; if (d <= -1.0lf) k |= 16;") == "");
  CHECK(difference_with_doubles(
            "s = min(d, 0.3lf) + max(d, -0.2lf) + abs(d) + sign(d) + clamp(d, -0.5lf, 0.5lf);") ==
        "");
  CHECK(difference_with_doubles(
            "s = floor(d) + 3.0lf * ceil(d) + 7.0lf * trunc(d) + 16.0lf * roundEven(d * 2.5lf)"
            " + fract(d) + mod(d, 0.3lf);") == "");
  CHECK(difference_with_doubles("s = sqrt(abs(d)) + inversesqrt(abs(d) + 0.1lf)"
                                " + mix(d, 2.0lf, 0.3lf) + step(0.1lf, d)"
                                " + smoothstep(-1.0lf, 1.0lf, d) + fma(d, d, 0.1lf);") == "");
  CHECK(difference_with_doubles("int e; s = frexp(d, e) + ldexp(d, x - 1000); k = e;") == "");
  CHECK(difference_with_doubles(
            "s = x > 5 ? d : 1.0lf / d; k = isinf(s) ? 1 : isnan(s) ? 2 : 3;") == "");
  CHECK(difference_with_doubles("s = packDouble2x32(uvec2(x * 77777, 0x3FF00000 + x)) * d;") == "");
}

TEST_CASE("vectors, matrices, arrays and structures have doubles") {
  if (!missing_glsl().empty()) return skip("", missing_glsl());
  CHECK(difference_with_doubles(
            "dvec3 v = dvec3(d, 0.1lf, -d), w = v.zxy * 1.1lf; s = dot(v, w) + length(v)"
            " + cross(v, w).y + normalize(w + 0.3lf).x; v[x & 1] = 5.0lf; s += v[x % 3];") == "");
  CHECK(difference_with_doubles(
            "dmat2 m = dmat2(d, 0.1lf, 0.2lf, 1.0lf / 3.0lf); dvec2 v = m * dvec2(d, 2.0lf);"
            "s = v.x + (m * transpose(m))[1].x + determinant(m) + (2.0lf * m)[x & 1][0];") == "");
  CHECK(difference_with_doubles(
            "double a[5]; for (int i = 0; i < 5; ++i) a[i] = d * i; a[x % 7] += 0.1lf;"
            "Both b[2]; b[x & 1].v = dvec2(d, 0.7lf); b[0].i = x; s = a[x % 5] + b[x % 2].v.y"
            " + b[1].v.x; k = b[0].i;",
            "struct Both { int i; dvec2 v; };") == "");
  CHECK(difference_with_doubles(
            "double out_d; s = both(d, out_d) + out_d; while (k < x) { s += s * 0.1lf; k++;"
            "if (s > 4.0lf) break; } bvec2 is = lessThan(dvec2(d, s), dvec2(0.5lf));"
            "s = any(is) ? s : mix(dvec2(s), dvec2(d), is).x;",
            "double both(double a, out double b) { b = a * a; if (a < 0.3lf) return b;"
            " return a / 3.0lf; }") == "");
}

TEST_CASE("every NaN of a double has the same words") {
  if (!missing_glsl().empty()) return skip("", missing_glsl());
  const UserShader shader = make_shader(compiled_doubles(
      "#version 450\nlayout(location = 0) out vec4 result;\nvoid main() {\n"
      "  double zero = double(gl_FragCoord.x - 0.5);\n"
      "  uvec2 a = unpackDouble2x32(zero / zero), b = unpackDouble2x32(-(zero / zero));\n"
      "  result = vec4(a == uvec2(0u, 0x7FF80000u), a == b, 0.0, 1.0);\n}\n"));
  const ShaderProgram program = compile_shader(shader, shader.uniforms.words);
  Image image = make_image(Format::rgba32f, 1, 1);
  const ImageView view = image;
  ThreadPool pool{1};
  run_shader(program, {.targets = {&view, 1}}, pool);
  CHECK(load_texel(image, 0, 0) == glm::vec4{1.0f, 1.0f, 0.0f, 1.0f});
}

TEST_CASE("flat doubles go from a vertex shader to a fragment shader") {
  if (!missing_glsl().empty()) return skip("", missing_glsl());
  const ShaderPair pair = make_shader_pair(
      compiled_doubles("#version 450\nflat out dvec3 wide;\nflat out double more;\n"
                       "void main() {\n  wide = dvec3(0.1lf, 1.0lf / 3.0lf, 1e300lf);\n"
                       "  more = 7e-300lf;\n"
                       "  gl_Position = vec4(gl_VertexID == 1 ? 3 : -1,"
                       " gl_VertexID == 2 ? 3 : -1, 0, 1);\n}\n",
                       ShaderStage::vertex),
      compiled_doubles("#version 450\nflat in dvec3 wide;\nflat in double more;\n"
                       "layout(location = 0) out vec4 result;\nvoid main() {\n"
                       "  result = vec4(wide.x == 0.1lf, wide.y == 1.0lf / 3.0lf,"
                       " wide.z == 1e300lf, more == 7e-300lf);\n}\n"));
  const auto compiled = [](const UserShader& shader) {
    return std::make_shared<const ShaderProgram>(compile_shader(shader, shader.uniforms.words));
  };
  Image image = make_image(Format::rgba32f, 4, 4);
  RenderPass pass;
  pass.targets.colour[0] = &image;
  DrawState state;
  state.cull = Cull::none;
  state.depth.reset();
  ThreadPool pool{1};
  const std::vector<std::uint32_t> indices{0, 1, 2};
  draw_shaders(pass, state, indices, 3,
               {.vertex = compiled(pair.vertex), .fragment = compiled(pair.fragment)});
  finish(pass, pool);
  CHECK(load_texel(image, 2, 3) == glm::vec4{1.0f});
}

TEST_CASE("doubles that shaders cannot be given are refused by name") {
  if (!missing_glsl().empty()) return skip("", missing_glsl());
  CHECK(refusal_of_doubles("#version 450\nuniform double gain;\nout vec4 o;\n"
                           "void main() { o = vec4(float(gain)); }\n")
            .starts_with("uniform 'gain' is of doubles, which is not supported; use float"));
  CHECK(refusal_of_doubles("#version 450\nlayout(location = 0) in dvec2 place;\n"
                           "void main() { gl_Position = vec4(place, 0, 1); }\n",
                           ShaderStage::vertex)
            .starts_with("attributes of doubles are not supported: 'place'; use uvec2"));
}
