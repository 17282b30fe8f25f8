// HLSL, and SPIR-V with separate textures and samplers, as its compilers and those of WGSL make it.

#include <doctest/doctest.h>

#include <bit>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "raster/images/sliced_texture.h"
#include "raster/shaders/glsl/glsl.h"
#include "raster/shaders/shader.h"
#include "tests/support/sanitizers.h"
#include "tests/support/shader_checks.h"
#include "tests/support/skip.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

UserShader shader_of(const std::string& name, const std::string& text) {
  return make_shader(compile_glsl({.name = name, .text = text}, [](const std::string& path) {
                       return path == "tint.hlsli"
                                  ? std::optional<std::string>{"static const float kTint = 0.5;\n"}
                                  : std::nullopt;
                     }).words);
}

std::string error_of_hlsl(const std::string& text) {
  try {
    shader_of("mine.hlsl", text);
  } catch (const ShaderError& error) {
    return error.what();
  }
  return "";
}

std::vector<std::string> uniform_names(const UserShader& shader) {
  std::vector<std::string> names;
  for (const ShaderUniform& of : shader.uniforms.all) names.push_back(of.name);
  std::sort(names.begin(), names.end());
  return names;
}

void set_number(const UserShader& shader, std::vector<std::uint32_t>& words,
                const std::string& name, std::uint32_t index, float value) {
  const ShaderUniform* of = find_uniform(shader, name);
  CAPTURE(name);
  REQUIRE(of != nullptr);
  words[of->first + index] = std::bit_cast<std::uint32_t>(value);
}

/// What the shader draws, with its only texture and these uniforms.
Image drawn_by(const UserShader& shader, const std::vector<std::uint32_t>& words,
               const Texture& texture) {
  Image found = make_image(Format::rgba32f, 20, 6);
  const ImageView view = found;
  ThreadPool pool{1};
  const ShaderTexture one{.texture = &texture};
  run_shader(compile_shader(shader, words), {.textures = {&one, 1}, .targets = {&view, 1}}, pool);
  return found;
}

Texture noise() {
  Random random{4};
  Texture texture = random_texture(Format::rgba16f, 8, random);
  generate_mipmaps(texture, {});
  return texture;
}

}  // namespace

TEST_CASE("a pixel shader in HLSL has the bits of the same one in GLSL") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const UserShader hlsl = shader_of("mine.hlsl", R"(#include "tint.hlsli"
Texture2D picture : register(t0);
SamplerState smooth : register(s0);
cbuffer Parameters : register(b0) {
  float gain;
  float3 tint;
};
float2 shift;
struct Input {
  float4 place : SV_Position;
  float2 uv : TEXCOORD0;
};
float4 main(Input input) : SV_Target0 {
  float4 colour = picture.Sample(smooth, input.uv * 3.0 + shift) * gain;
  colour += picture.SampleLevel(smooth, input.uv, 1.0);
  colour += picture.Load(int3(int2(input.place.xy) % 8, 0));
  uint width, height;
  picture.GetDimensions(width, height);
  return colour * float4(tint, kTint) + float(width);
}
)");
  const UserShader glsl = shader_of("mine.frag", R"(#version 450
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 result;
uniform sampler2D picture;
uniform float gain;
uniform vec3 tint;
uniform vec2 shift;
void main() {
  vec4 colour = texture(picture, uv * 3.0 + shift) * gain;
  colour += textureLod(picture, uv, 1.0);
  colour += texelFetch(picture, ivec2(gl_FragCoord.xy) % 8, 0);
  result = colour * vec4(tint, 0.5) + float(textureSize(picture, 0).x);
}
)");
  const std::vector<std::string> names{"gain", "picture", "shift", "tint"};
  CHECK(uniform_names(hlsl) == names);
  CHECK(uniform_names(glsl) == names);
  const Texture texture = noise();
  const auto drawn = [&](const UserShader& shader) {
    std::vector<std::uint32_t> words = shader.uniforms.words;
    set_number(shader, words, "gain", 0, 1.5f);
    for (std::uint32_t i = 0; i < 3; ++i) {
      set_number(shader, words, "tint", i, 0.25f + static_cast<float>(i));
    }
    set_number(shader, words, "shift", 1, 0.375f);
    return drawn_by(shader, words, texture);
  };
  CHECK(first_difference(drawn(hlsl), drawn(glsl)) == "");
}

TEST_CASE("HLSL of D3D9 has its samplers with their textures") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Texture texture = noise();
  const UserShader glsl =
      shader_of("mine.frag",
                "#version 450\nlayout(location = 0) in vec2 uv;\n"
                "layout(location = 0) out vec4 c;\nuniform sampler2D t;\n"
                "void main() { c = texture(t, uv) + textureLod(t, uv, 2.0); }\n");
  const Image expected = drawn_by(glsl, glsl.uniforms.words, texture);
  for (const char* type : {"sampler", "sampler2D"}) {
    const UserShader old =
        shader_of("mine.hlsl", std::string{type} +
                                   " t : register(s0);\n"
                                   "float4 main(float2 uv : TEXCOORD0) : COLOR {\n"
                                   "  return tex2D(t, uv) + tex2Dlod(t, float4(uv, 0, 2));\n}\n");
    CHECK(uniform_names(old) == std::vector<std::string>{"t"});
    CHECK(first_difference(drawn_by(old, old.uniforms.words, texture), expected) == "");
  }
}

TEST_CASE("HLSL is recognised by its semantics, whatever its file's name") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const std::string text = "float4 main(float4 at : SV_POSITION) : SV_TARGET { return at; }\n";
  const UserShader shader = shader_of("mine.frag", text);
  CHECK(load_texel(drawn_by(shader, shader.uniforms.words, noise()), 2, 3).x == 2.5f);
  CHECK_NOTHROW(shader_of("mine.frag", "float4 main() : SV_Target0 { return 1; }\n"));
  CHECK_THROWS_AS(shader_of("mine.frag", "#version 330\n" + text), ShaderError);
}

TEST_CASE("HLSL has its definitions, and comments that go on") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const auto error_with = [](const std::string& text, const std::string& value) {
    try {
      compile_glsl({.name = "mine.hlsl", .text = text, .defines = {{"RED", value}}},
                   [](const std::string&) { return std::nullopt; });
    } catch (const ShaderError& error) {
      return std::string{error.what()};
    }
    return std::string{"none"};
  };
  const std::string text =
      "float4 main() : SV_Target {\n  // goes on \\\n  is no code\n  return float4(RED, 0, 0, "
      "1);\n}\n";
  CHECK(error_with(text, "1.0") == "none");
  CHECK(error_with(text, "none").starts_with("mine.hlsl:4: 'none'"));
}

TEST_CASE("an error of HLSL names its line, and what glslang's stack cannot hold is refused") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  CHECK(
      error_of_hlsl("float4 main() : SV_Target {\n  return nothing;\n}\n").find("mine.hlsl:2: ") ==
      0);
  CHECK(error_of_hlsl("float4 shade() : SV_Target { return 1; }\n") ==
        "mine.hlsl: no function main()");
  CHECK(error_of_hlsl("#include \"none.hlsli\"\nfloat4 main() : SV_Target { return 1; }\n")
            .find("mine.hlsl:1: #include none.hlsli: cannot read") == 0);
  const auto deep = [](const std::string& open, const std::string& close) {
    std::string text = "float4 main() : SV_Target { float x = 1; ";
    for (int i = 0; i < fewer(40000); ++i) text += open;
    text += "x";
    for (int i = 0; i < fewer(40000); ++i) text += close;
    return text + "; return x; }";
  };
  CHECK(error_of_hlsl(deep("(", ")")) != "");
  CHECK(error_of_hlsl(deep("if (x > 0) ", "")) != "");
  CHECK(error_of_hlsl(deep("-", "")) != "");
  CHECK(error_of_hlsl(deep("{ if (x > 0) { x += 1; } else ", " = 1; }")) != "");
  std::string chain = "float4 main() : SV_Target { float x = 1; if (x > 1) { x = 2; }";
  for (int i = 0; i < fewer(20000); ++i) chain += " else if (x > 3) { x = 4; }";
  CHECK(error_of_hlsl(chain + " return x; }") != "");
  // A table, and branches one behind the other, are not deep.
  std::string flat = "static const float2 kPoints[200] = {";
  for (int i = 0; i < 200; ++i) flat += "float2(-0.25, (0.5 + 1.0)), ";
  flat += "};\nfloat4 main() : SV_Target { float x = 1;";
  for (int i = 0; i < 200; ++i) flat += " if (x > 3) { x = -(x + 4); } else { x += 1; }";
  CHECK(error_of_hlsl(flat + " return x + kPoints[0].x; }") == "");
}

TEST_CASE(
    "a constant that is computed of specialised ones has the value of what they are preset to") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const auto text = [](const std::string& value) {
    return "#version 450\nlayout(constant_id = 0) const int n = 5;\n"
           "layout(constant_id = 1) const bool on = true;\n"
           "layout(constant_id = 2) const uint u = 0xFFFFFFF0u;\n"
           "const int sides = (n * 3 - 1) / 4;\nconst ivec3 v = ivec3(n, -n, n << 2) % 4;\n"
           "layout(location = 0) out vec4 c;\n"
           "void main() {\n  float all[sides];\n  for (int i = 0; i < all.length(); ++i) all[i] = "
           "1.0;\n"
           "  c = vec4(" +
           value + ");\n}\n";
  };
  for (const auto& one :
       {std::pair{"all.length(), v.z, on && n > 4 ? 7 : 8, n == 5 ? 1 : 2",
                  glm::vec4{3.0f, 0.0f, 7.0f, 1.0f}},
        std::pair{"u >> 28, u / 16u > 3u ? 1 : 0, -n, ~n", glm::vec4{15.0f, 1.0f, -5.0f, -6.0f}}}) {
    CAPTURE(one.first);
    const UserShader shader = shader_of("mine.frag", text(one.first));
    const Image image = drawn_by(shader, shader.uniforms.words, noise());
    CHECK(load_texel(image, 0, 0) == one.second);
  }
}

TEST_CASE("a module as of WGSL: a wrapped uniform, a sampler for itself, an entry point's name") {
  std::ifstream file(SOFTFOCUS_TEST_DATA "/wgsl.spv", std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  const UserShader shader = make_shader(spirv_words(std::as_bytes(std::span{bytes})));
  CHECK(uniform_names(shader) == std::vector<std::string>{"light.colour", "light.gain", "picture"});
  CHECK(shader.uniforms.texture_count == 1);
  std::vector<std::uint32_t> words = shader.uniforms.words;
  set_number(shader, words, "light.gain", 0, 2.0f);
  set_number(shader, words, "light.colour", 1, 0.5f);
  Texture texture = make_texture(make_image(Format::rgba16f, 1, 1));
  clear_image(texture.levels[0], glm::vec4{3.0f}, {});
  const Image image = drawn_by(shader, words, texture);
  CHECK(load_texel(image, 3, 3) == glm::vec4{0.0f, 3.0f, 0.0f, 6.0f});
}
