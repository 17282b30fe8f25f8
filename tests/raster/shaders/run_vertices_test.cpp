// Vertex shaders over lanes against the interpreter of one vertex; and how stages are linked.

#include <doctest/doctest.h>

#include "raster/shaders/glsl/glsl.h"
#include "raster/shaders/link_shaders.h"
#include "tests/support/random.h"
#include "tests/support/skip.h"
#include "tests/support/spirv_oracle.h"

using namespace softfocus;

namespace {

UserShader shader_of(const std::string& text, ShaderStage stage) {
  const char* const name = stage == ShaderStage::vertex ? "test.vert" : "test.frag";
  return make_shader(
      compile_glsl({.stage = stage, .name = name, .text = text}, [](const std::string&) {
        return std::optional<std::string>{};
      }).words);
}

struct Vertex {
  float at[3];
  std::int32_t kind[2];
  float more[4];
};

constexpr const char* kVertex = R"(#version 450
layout(location = 0) in vec3 at;
layout(location = 1) in ivec4 kind;
layout(location = 2) in vec4 more;
layout(location = 3) in vec4 absent;
layout(location = 4) in ivec4 absent_kind;
layout(location = 0) out vec4 first;
layout(location = 1) flat out ivec2 second;
layout(location = 2) out float third;
layout(location = 2, component = 1) out vec2 fourth;
uniform mat4 turn;
uniform sampler2D heights;
void main() {
  vec4 sum = turn * vec4(at, 1.0);
  for (int i = 0; i < (kind.x & 7); ++i) sum = sum * 0.75 + more;
  sum.y += texelFetch(heights, kind.xy & 3, 0).x;
  gl_Position = sum;
  first = kind.y > 0 ? more : vec4(at, float(gl_VertexID));
  second = ivec2(kind.w + absent_kind.w, gl_InstanceID + kind.z);
  third = float(gl_VertexID % 5) + absent.w;
  fourth = sin(at.xy) + absent.xy;
})";

/// What link_shaders() complains of; "" if of nothing.
std::string link_error(UserShader& vertex, UserShader& fragment) {
  try {
    link_shaders(vertex, fragment);
  } catch (const ShaderError& caught) {
    return caught.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a vertex shader over lanes gives the bits of the interpreter of one vertex") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const UserShader shader = shader_of(kVertex, ShaderStage::vertex);
  test::Random random{5};
  std::vector<std::uint32_t> uniforms = shader.uniforms.words;
  const ShaderUniform& turn = *find_uniform(shader, "turn");
  for (std::uint32_t i = 0; i < turn.words; ++i) {
    uniforms[turn.first + i] =
        std::bit_cast<std::uint32_t>(static_cast<float>(random.whole(-9, 9)) / 3.0f);
  }
  Image image = make_image(Format::rgba32f, 4, 4);
  for (int i = 0; i < 16; ++i) {
    store_texel(image, i % 4, i / 4, {static_cast<float>(i) / 7.0f, 0, 0, 1}, {});
  }
  const Texture texture = make_texture(std::move(image));
  const std::vector<ShaderTexture> textures(shader.uniforms.texture_count, {&texture, {}});

  std::vector<Vertex> vertices(301);
  for (Vertex& vertex : vertices) {
    for (float& x : vertex.at) x = static_cast<float>(random.whole(-99, 99)) / 7.0f;
    for (float& x : vertex.more) x = static_cast<float>(random.whole(-99, 99)) / 9.0f;
    for (std::int32_t& x : vertex.kind) x = random.whole(-9, 9);
  }
  const auto attribute = [&](int location, int components, const void* first) {
    return VertexAttribute{location, components, static_cast<const std::byte*>(first),
                           sizeof(Vertex)};
  };
  const VertexAttribute attributes[] = {attribute(0, 3, vertices[0].at),
                                        attribute(1, 2, vertices[0].kind),
                                        attribute(2, 4, vertices[0].more)};
  const ShaderVarying varyings[] = {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 0},
                                    {1, 1}, {2, 0}, {2, 1}, {2, 2}, {7, 0}};
  constexpr std::size_t kCount = std::size(varyings);

  // The same, whether uniforms are known when the program is made or when it runs.
  const ShaderProgram program = compile_shader(shader, uniforms);
  std::vector<bool> is_late(uniforms.size());
  for (std::uint32_t i = 0; i < turn.words; ++i) is_late[turn.first + i] = true;
  const ShaderProgram late_program =
      compile_shader(shader, std::vector<std::uint32_t>(uniforms.size()), is_late);
  for (const bool is_late_one : {false, true})
    for (const Isa isa : available_isas()) {
      for (const int lanes : {32, 256}) {
        ThreadPool pool{3, isa};
        std::vector<glm::vec4> positions(vertices.size());
        std::vector<std::uint32_t> values(vertices.size() * kCount);
        run_vertices(is_late_one ? late_program : program,
                     {.vertex_count = 301,
                      .attributes = attributes,
                      .textures = textures,
                      .varyings = varyings,
                      .positions = positions,
                      .values = values,
                      .lanes = lanes,
                      .uniforms = uniforms},
                     pool);
        int differing = 0;
        for (std::size_t v = 0; v < vertices.size(); ++v) {
          const Vertex& vertex = vertices[v];
          test::OracleSettings settings{.uniforms = uniforms, .textures = textures};
          settings.input = [&](const SpirvDecorations& of, std::uint32_t part) -> std::uint32_t {
            if (of.builtin == static_cast<int>(SpirvBuiltin::vertex_id) ||
                of.builtin == static_cast<int>(SpirvBuiltin::vertex_index)) {
              return static_cast<std::uint32_t>(v);
            }
            if (of.builtin >= 0) return 0;
            const std::uint32_t one = std::bit_cast<std::uint32_t>(1.0f);
            if (of.location == 0) return std::bit_cast<std::uint32_t>(vertex.at[part]);
            if (of.location == 1 && part < 2) return static_cast<std::uint32_t>(vertex.kind[part]);
            if (of.location == 2) return std::bit_cast<std::uint32_t>(vertex.more[part]);
            if (of.location == 3) return part == 3 ? one : 0;
            return part == 3 ? 1 : 0;
          };
          const test::OracleResult expected = test::run_oracle(*shader.module, settings);
          for (int i = 0; i < 4; ++i) {
            differing += std::bit_cast<std::uint32_t>(positions[v][i]) !=
                         expected.position[static_cast<std::size_t>(i)];
          }
          for (std::size_t k = 0; k < kCount; ++k) {
            const auto location = static_cast<std::size_t>(varyings[k].location);
            const auto component = static_cast<std::size_t>(varyings[k].component);
            differing += values[v * kCount + k] != expected.outputs[location][component];
          }
        }
        CHECK(differing == 0);
      }
    }
}

TEST_CASE("varyings without a location are linked by name") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  UserShader vertex = shader_of(R"(#version 150
in vec3 position; in vec4 tint;
out vec2 uv; out vec4 unread; out Light { vec3 colour; float power; } light;
void main() {
  gl_Position = vec4(position, 1.0);
  uv = position.xy; unread = tint; light.colour = tint.rgb; light.power = 1.0;
})",
                                ShaderStage::vertex);
  UserShader fragment = shader_of(R"(#version 150
in Light { vec3 colour; float power; } lamp; in vec2 uv; in vec3 never;
out vec4 result;
void main() { result = vec4(uv, lamp.colour.x, lamp.power); })",
                                  ShaderStage::fragment);
  link_shaders(vertex, fragment);
  const auto location = [](const std::vector<ShaderPort>& ports, std::string_view name) {
    for (const ShaderPort& port : ports) {
      if (port.name == name) return port.location;
    }
    return -2;
  };
  const std::vector<ShaderPort> attributes = inputs_of(*vertex.module);
  CHECK(location(attributes, "position") >= 0);
  CHECK(location(attributes, "tint") >= 0);
  CHECK(location(attributes, "tint") != location(attributes, "position"));
  const std::vector<ShaderPort> from = outputs_of(*vertex.module), to = inputs_of(*fragment.module);
  for (const char* const name : {"uv", "Light.colour", "Light.power"}) {
    CAPTURE(name);
    CHECK(location(from, name) >= 0);
    CHECK(location(from, name) == location(to, name));
  }
  CHECK(location(from, "unread") >= 0);
  CHECK(location(to, "never") >= 0);
}

TEST_CASE("the compatibility profile's varyings are linked, too") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  UserShader vertex = shader_of(R"(#version 120
void main() {
  gl_Position = gl_Vertex;
  gl_FrontColor = gl_Color;
  gl_TexCoord[0] = gl_MultiTexCoord0;
  gl_TexCoord[1] = gl_MultiTexCoord0;
})",
                                ShaderStage::vertex);
  UserShader fragment = shader_of(R"(#version 120
void main() { gl_FragColor = gl_Color + gl_TexCoord[0]; })",
                                  ShaderStage::fragment);
  CHECK_NOTHROW(link_shaders(vertex, fragment));
  const auto find = [](const std::vector<ShaderPort>& ports, std::string_view name) {
    for (const ShaderPort& port : ports) {
      if (port.name == name) return port.location;
    }
    return -2;
  };
  const std::vector<ShaderPort> from = outputs_of(*vertex.module), to = inputs_of(*fragment.module);
  CHECK(find(from, "gl_FrontColor") == find(to, "gl_Color"));
  CHECK(find(from, "gl_TexCoord") == find(to, "gl_TexCoord"));
  CHECK(find(from, "gl_TexCoord") != find(from, "gl_FrontColor"));
  CHECK(find(from, "gl_TexCoord") >= 0);
  // Colours are clamped at the vertex.
  const float tint[] = {-1.0f, 0.5f, 3.0f, 1.0f};
  const VertexAttribute attributes[] = {{find(inputs_of(*vertex.module), "gl_Color"), 4,
                                         reinterpret_cast<const std::byte*>(tint), 16}};
  const int location = find(from, "gl_FrontColor");
  const ShaderVarying varyings[] = {{location, 0}, {location, 1}, {location, 2}, {location, 3}};
  std::array<std::uint32_t, 4> values{};
  ThreadPool pool{1};
  run_vertices(
      compile_shader(vertex, vertex.uniforms.words),
      {.vertex_count = 1, .attributes = attributes, .varyings = varyings, .values = values}, pool);
  CHECK(std::bit_cast<std::array<float, 4>>(values) == std::array{0.0f, 0.5f, 1.0f, 1.0f});
}

TEST_CASE(
    "what the version wants equal has to be: precision, interpolation, gl_FragCoord's invariance") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  struct Stages {
    std::string version, vertex, fragment, vertex_use = "0.0", fragment_use = "0.0";
  };
  const auto error = [](const Stages& of) {
    const bool is_old = of.version == "100" || of.version == "120";
    const std::string head = "#version " + of.version + "\n";
    UserShader vertex = shader_of(
        head + of.vertex + "\nvoid main() { gl_Position = vec4(" + of.vertex_use + "); }\n",
        ShaderStage::vertex);
    UserShader fragment = shader_of(
        head + of.fragment + (is_old ? "\n" : "\nout mediump vec4 result;\n") + "void main() { " +
            (is_old ? "gl_FragColor" : "result") + " = vec4(" + of.fragment_use + "); }\n",
        ShaderStage::fragment);
    return link_error(vertex, fragment);
  };
  const auto other = [](const std::string& what) {
    return "'v' has another " + what +
           " in the vertex shader than in the fragment shader; they must be equal";
  };
  const std::string high = "uniform highp float v;", medium = "uniform mediump float v;";
  CHECK(error({"100", high, medium, "v", "v"}) == other("precision"));
  CHECK(error({"100", high, medium, "v"}).empty());
  CHECK(error({"100", high, high, "v", "v"}).empty());
  CHECK(error({"300 es", high, medium}) == other("precision"));
  CHECK(error({"300 es", "struct S { highp vec2 a; }; uniform S v;",
               "struct S { mediump vec2 a; }; uniform S v;"}) == other("precision"));
  CHECK(error({"330", high, medium, "v", "v"}).empty());

  const std::string flat = "flat out float v;", smooth = "in float v;";
  CHECK(error({"330", flat, smooth, "v = 1.0", "v"}) == other("interpolation"));
  CHECK(error({"330", "noperspective out float v;", "smooth " + smooth, "v = 1.0", "v"}) ==
        other("interpolation"));
  CHECK(error({"330", flat, "flat " + smooth, "v = 1.0", "v"}).empty());
  CHECK(error({"440", flat, smooth, "v = 1.0", "v"}).empty());
  CHECK(error({"300 es", "flat out highp float v;", "in highp float v;", "v = 1.0", "v"}) ==
        other("interpolation"));
  CHECK(
      error({"300 es", "smooth out highp float v;", "centroid in mediump float v;", "v = 1.0", "v"})
          .empty());

  CHECK(error({"100", "", "invariant gl_FragCoord;", "0.0", "gl_FragCoord.x"}) ==
        "gl_FragCoord is invariant, and gl_Position is not; both are, or none");
  CHECK(error({"100", "invariant gl_Position;", "invariant gl_FragCoord;", "0.0", "gl_FragCoord.x"})
            .empty());
}

TEST_CASE("errors of linking name the varying that does not fit") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const std::string vertex_text = R"(#version 150
in vec3 position;
out vec2 uv;
void main() { gl_Position = vec4(position, 1.0); uv = position.xy; })";
  const auto error = [&](const std::string& input, const std::string& use) {
    UserShader vertex = shader_of(vertex_text, ShaderStage::vertex);
    UserShader fragment = shader_of(
        "#version 150\n" + input + "\nout vec4 result;\nvoid main() { result = " + use + "; }\n",
        ShaderStage::fragment);
    return link_error(vertex, fragment);
  };
  CHECK(error("in vec4 tint;", "tint") ==
        "the vertex shader has no output 'tint', which the fragment shader reads; it has 'uv'");
  CHECK(error("in vec3 uv;", "uv.xyzz") ==
        "'uv' has 2 floats in the vertex shader and 3 floats in the fragment shader; they must be "
        "equal");
  CHECK(error("flat in ivec2 uv;", "vec4(uv, uv)") ==
        "'uv' has 2 floats in the vertex shader and 2 integers in the fragment shader; they must "
        "be equal");
  const auto old_error = [](const std::string& writes) {
    UserShader before = shader_of("#version 120\nvarying vec4 v;\nvoid main() { " + writes + " }\n",
                                  ShaderStage::vertex);
    UserShader after =
        shader_of("#version 120\nvarying vec4 v;\nvoid main() { gl_FragColor = v; }\n",
                  ShaderStage::fragment);
    return link_error(before, after);
  };
  CHECK(old_error("gl_Position.x = 1.0; v = gl_Vertex;").empty());
  CHECK(old_error("gl_FrontColor = v = gl_Vertex;") ==
        "the vertex shader never writes gl_Position; without it nothing is drawn");
  CHECK(old_error("gl_Position = gl_Vertex;") ==
        "the vertex shader never writes 'v', which the fragment shader reads");
  UserShader vertex = shader_of(vertex_text, ShaderStage::vertex);
  UserShader other = shader_of(vertex_text, ShaderStage::vertex);
  CHECK_THROWS_WITH_AS(link_shaders(vertex, other),
                       "a vertex shader and a fragment shader are right, in this order",
                       ShaderError);
}
