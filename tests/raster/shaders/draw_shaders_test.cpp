// Draws by a user's shaders against draws by C++ stages of the same arithmetic: no bit differs.

#include <doctest/doctest.h>

#include "raster/pipeline/draw.h"
#include "raster/shaders/draw_shaders.h"
#include "raster/shaders/glsl/glsl.h"
#include "tests/support/random.h"
#include "tests/support/raster_helpers.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

constexpr int kWidth = 150, kHeight = 90;

std::vector<std::uint32_t> words_of(const std::string& text, ShaderStage stage) {
  const char* const name = stage == ShaderStage::vertex ? "test.vert" : "test.frag";
  return compile_glsl({.stage = stage, .name = name, .text = text},
                      [](const std::string&) { return std::optional<std::string>{}; })
      .words;
}

ShaderDraw draw_of(const std::string& vertex, const std::string& fragment) {
  const ShaderPair pair = make_shader_pair(words_of(vertex, ShaderStage::vertex),
                                           words_of(fragment, ShaderStage::fragment));
  const auto compiled = [](const UserShader& shader) {
    return std::make_shared<const ShaderProgram>(compile_shader(shader, shader.uniforms.words));
  };
  ShaderDraw draw{.vertex = compiled(pair.vertex),
                  .fragment = compiled(pair.fragment),
                  .clip_space = ShaderClipSpace::y_down};
  return draw;
}

/// A vertex as both kinds of stages read it.
struct Vertex {
  glm::vec4 position;
  float smooth[4];
  float linear[2];
  float flat;
  std::int32_t number;
};

std::vector<VertexAttribute> attributes_of(const std::vector<Vertex>& vertices) {
  const auto attribute = [](int location, int components, const void* first) {
    return VertexAttribute{location, components, static_cast<const std::byte*>(first),
                           sizeof(Vertex)};
  };
  const Vertex& first = vertices.front();
  return {attribute(0, 4, &first.position), attribute(1, 4, first.smooth),
          attribute(2, 2, first.linear), attribute(3, 1, &first.flat),
          attribute(4, 1, &first.number)};
}

/// Triangles of all sizes, some of them cut by the near plane and the picture's sides.
std::vector<Vertex> random_vertices(int triangles, test::Random& random) {
  std::vector<Vertex> vertices;
  for (int t = 0; t < triangles; ++t) {
    const float size = random.between(0.02f, 1.0f) * random.between(0.1f, 3.0f);
    const glm::vec2 middle{random.between(-1.2f, 1.2f), random.between(-1.2f, 1.2f)};
    const float depth = random.between(-0.5f, 0.9f);
    for (int i = 0; i < 3; ++i) {
      Vertex vertex{};
      const float w = random.between(0.3f, 3.0f);
      vertex.position = {w * (middle.x + random.between(-size, size)),
                         w * (middle.y + random.between(-size, size)),
                         w * (depth + random.between(-0.6f, 0.3f)), w};
      for (float& x : vertex.smooth) x = random.between(-2.0f, 2.0f);
      for (float& x : vertex.linear) x = random.between(-2.0f, 2.0f);
      vertex.flat = random.between(0.0f, 1.0f);
      vertex.number = random.whole(-9, 9);
      vertices.push_back(vertex);
    }
  }
  return vertices;
}

struct CppVertices {
  const Vertex* vertices;
  VertexOutput<8> operator()(std::uint32_t i) const {
    const Vertex& v = vertices[i];
    VertexOutput<8> out{v.position * 1.5f, {}};
    for (std::size_t k = 0; k < 4; ++k) out.varyings[k] = v.smooth[k] * v.smooth[k] + 0.25f;
    out.varyings[4] = v.linear[0];
    out.varyings[5] = v.linear[1];
    out.varyings[6] = v.flat;
    out.varyings[7] = static_cast<float>(v.number * 3);
    return out;
  }
};

template <bool discarding, bool differing>
struct CppFragments {
  static constexpr std::array<Interpolation, 8> kInterpolation{
      Interpolation::perspective, Interpolation::perspective, Interpolation::perspective,
      Interpolation::perspective, Interpolation::linear,      Interpolation::linear,
      Interpolation::flat,        Interpolation::flat};
  static constexpr bool kNeedsDerivatives = differing;
  static constexpr bool kDiscards = discarding;
  FragmentOutput<2> operator()(const Fragment<8>& in) const {
    const auto& v = in.varyings;
    FragmentOutput<2> out;
    if (discarding && v[0] > 1.0f) return {{}, true};
    out.colour[0] = {v[0] * v[4], v[1], v[6], in.front_facing ? in.depth : 2.0f};
    out.colour[1] = {v[7], static_cast<float>(in.x) + 0.5f, static_cast<float>(in.y) + 0.5f,
                     v[2] + v[5]};
    if (differing) out.colour[1] = {in.ddx[0], in.ddy[0], in.ddx[3], in.ddy[5]};
    return out;
  }
};

constexpr const char* kVertex = R"(#version 450
layout(location = 0) in vec4 position;
layout(location = 1) in vec4 smooth_in;
layout(location = 2) in vec2 linear_in;
layout(location = 3) in float flat_in;
layout(location = 4) in int number;
out vec4 smoothed;
noperspective out vec2 along;
flat out float kept;
flat out int kept_number;
void main() {
  gl_Position = position * 1.5;
  smoothed = smooth_in * smooth_in + 0.25;
  along = linear_in;
  kept = flat_in;
  kept_number = number * 3;
})";

std::string fragment_text(bool discarding, bool differing) {
  std::string text = R"(#version 450
in vec4 smoothed;
noperspective in vec2 along;
flat in float kept;
flat in int kept_number;
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() {
  first = vec4(smoothed.x * along.x, smoothed.y, kept, gl_FrontFacing ? gl_FragCoord.z : 2.0);
  second = vec4(float(kept_number), gl_FragCoord.xy, smoothed.z + along.y);
)";
  if (differing) {
    text +=
        "  second = vec4(dFdxCoarse(smoothed.x), dFdyCoarse(smoothed.x), "
        "dFdxCoarse(smoothed.w), dFdyCoarse(along.y));\n";
  }
  if (discarding) text += "  if (smoothed.x > 1.0) discard;\n";
  return text + "}\n";
}

struct Pictures {
  int samples = 1;
  Image first = make_image(Format::rgba32f, kWidth, kHeight* samples);
  Image second = make_image(Format::rgba32f, kWidth, kHeight* samples);
  Image depth = make_image(Format::r32f, kWidth, kHeight* samples);
  RenderTargets targets() {
    return {.colour = {&first, &second}, .depth = &depth, .samples = samples};
  }
  RenderPass pass(const Profile& profile, Isa isa) {
    return {.targets = targets(),
            .profile = profile,
            .clear_colour = glm::vec4{0.5f},
            .clear_depth = 1.0f,
            .isa = isa,
            .draws = {}};
  }
};

int differing_bytes(const Pictures& a, const Pictures& b) {
  int differing = 0;
  for (std::size_t i = 0; i < a.first.bytes.size(); ++i) {
    differing += a.first.bytes[i] != b.first.bytes[i];
    differing += a.second.bytes[i] != b.second.bytes[i];
  }
  for (std::size_t i = 0; i < a.depth.bytes.size(); ++i) {
    differing += a.depth.bytes[i] != b.depth.bytes[i];
  }
  return differing;
}

template <bool discarding, bool differing>
void compare_to_cpp(std::initializer_list<const char*> profiles, int samples = 1) {
  const ShaderDraw draw_by_shaders = draw_of(kVertex, fragment_text(discarding, differing));
  test::Random random{7};
  for (const char* const name : profiles) {
    CAPTURE(name);
    const Profile profile = test::profile_named(name);
    const std::vector<Vertex> vertices = random_vertices(300, random);
    const std::vector<std::uint32_t> indices = test::indices_up_to(vertices.size());
    const auto count = static_cast<std::uint32_t>(vertices.size());
    for (const Cull cull : {Cull::none, Cull::back}) {
      DrawState state;
      state.cull = cull;
      if (cull == Cull::back) state.provoking_vertex = ProvokingVertex::first;
      state.alpha_to_coverage = cull == Cull::back;
      Pictures by_cpp{.samples = samples};
      {
        ThreadPool pool{1};
        RenderPass pass = by_cpp.pass(profile, Isa::scalar);
        draw(pass, state, indices, count, CppVertices{vertices.data()},
             CppFragments<discarding, differing>{});
        finish(pass, pool);
      }
      for (const Isa isa : available_isas()) {
        for (const int threads : {1, 4}) {
          for (const int lanes : {32, 0}) {
            ShaderDraw with = draw_by_shaders;
            with.attributes = attributes_of(vertices);
            with.lanes = lanes;
            Pictures by_shaders{.samples = samples};
            ThreadPool pool{threads, isa};
            RenderPass pass = by_shaders.pass(profile, isa);
            draw_shaders(pass, state, indices, count, with);
            finish(pass, pool);
            CHECK(differing_bytes(by_cpp, by_shaders) == 0);
          }
        }
      }
    }
  }
}

}  // namespace

TEST_CASE("shaders draw the bits of C++ stages with their arithmetic") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  compare_to_cpp<false, false>({"ieee", "d3d11", "llvmpipe", "softpipe"});
}

TEST_CASE("shaders that discard draw the bits of stages that do") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  compare_to_cpp<true, false>({"ieee", "softpipe"});
}

TEST_CASE("shaders draw samples as stages do, and cover by alpha") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  for (const int samples : {4, 8}) {
    compare_to_cpp<false, false>({"ieee", "llvmpipe"}, samples);
    compare_to_cpp<true, true>({"ieee"}, samples);
  }
}

TEST_CASE("coarse derivatives of varyings are those of stages, also of pixels that discard") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  compare_to_cpp<false, true>({"ieee", "llvmpipe", "softpipe"});
  compare_to_cpp<true, true>({"ieee"});
}

TEST_CASE("a shader over a picture has the bits of a draw of the triangle over it") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const std::string fragment = R"(#version 450
layout(location = 0) in vec4 place;
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() {
  if (place.x > 0.6 && place.y < 0.1) discard;
  first = place;
  second = vec4(dFdx(place.x), dFdy(place.xy), gl_FragCoord.z / gl_FragCoord.w);
})";
  ShaderDraw by_triangle = draw_of(R"(#version 450
layout(location = 0) in vec2 corner;
layout(location = 0) out vec4 place;
void main() {
  gl_Position = vec4(corner, 0.0, 1.0);
  place = vec4(corner * 0.5 + 0.5, 0.0, 1.0);
})",
                                   fragment);
  constexpr std::array kCorners{-1.0f, -1.0f, 3.0f, -1.0f, -1.0f, 3.0f};
  by_triangle.attributes = {
      {0, 2, reinterpret_cast<const std::byte*>(kCorners.data()), 2 * sizeof(float)}};
  const std::vector<std::uint32_t> indices{0, 1, 2};
  const UserShader over = make_shader(words_of(fragment, ShaderStage::fragment));
  DrawState state;
  state.cull = Cull::none;
  state.depth.reset();
  for (const char* const name : {"llvmpipe", "llvmpipe-sse41", "softpipe"}) {
    for (const auto& [width, height] : {std::pair{300, 200}, {257, 131}, {1, 1}, {67, 1080}}) {
      const std::string where = std::string{name} + " " + std::to_string(width);
      CAPTURE(where);
      const Profile profile = test::profile_named(name);
      std::array<std::array<Image, 2>, 2> drawn;
      ThreadPool pool{2};
      for (auto& images : drawn) {
        for (Image& image : images) image = make_image(Format::rgba32f, width, height);
      }
      RenderPass pass{
          .targets = {.colour = {&drawn[0][0], &drawn[0][1]}}, .profile = profile, .draws = {}};
      draw_shaders(pass, state, indices, 3, by_triangle);
      finish(pass, pool);
      const std::array<ImageView, 2> targets{drawn[1][0], drawn[1][1]};
      run_shader(compile_shader(over, over.uniforms.words),
                 {.targets = targets, .profile = profile}, pool);
      CHECK(drawn[0][0].bytes == drawn[1][0].bytes);
      CHECK(drawn[0][1].bytes == drawn[1][1].bytes);
    }
  }
}

TEST_CASE("blended and peeled fragments merge in the order of submission") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  ShaderDraw by_shaders = draw_of(kVertex, R"(#version 450
in vec4 smoothed;
layout(location = 0) out vec4 first;
void main() { first = smoothed; })");
  struct OneTarget : CppFragments<false, false> {
    FragmentOutput<1> operator()(const Fragment<8>& in) const {
      const auto& v = in.varyings;
      return {{glm::vec4{v[0], v[1], v[2], v[3]}}, false};
    }
  };
  test::Random random{3};
  const std::vector<Vertex> vertices = random_vertices(400, random);
  const std::vector<std::uint32_t> indices = test::indices_up_to(vertices.size());
  const auto count = static_cast<std::uint32_t>(vertices.size());
  by_shaders.attributes = attributes_of(vertices);
  for (const bool peels : {false, true}) {
    CAPTURE(peels);
    DrawState state;
    state.cull = Cull::none;
    if (!peels) {
      const BlendEquation over{BlendFactor::source_alpha, BlendFactor::one_minus_source_alpha,
                               BlendOp::add};
      state.depth.reset();
      state.colour[0].blend = BlendState{over, over};
    }
    std::array<std::array<Image, 3>, 2> colours, depths;
    for (std::size_t way = 0; way < 2; ++way) {
      RenderPass pass{.targets = {}, .profile = {}, .draws = {}};
      for (std::size_t i = 0; i < 3; ++i) {
        colours[way][i] = make_image(Format::rgba16f, kWidth, kHeight);
        depths[way][i] = make_image(Format::r32f, kWidth, kHeight);
        const LayerTarget layer{&colours[way][i], &depths[way][i]};
        if (i == 0) {
          pass.targets.colour[0] = layer.colour;
          pass.targets.depth = layer.depth;
        } else if (peels) {
          pass.targets.behind[i - 1] = layer;
        }
      }
      pass.clear_colour = glm::vec4{0.25f};
      pass.clear_depth = 1.0f;
      ThreadPool pool{2};
      if (way == 0) {
        draw(pass, state, indices, count, CppVertices{vertices.data()}, OneTarget{});
      } else {
        draw_shaders(pass, state, indices, count, by_shaders);
      }
      finish(pass, pool);
    }
    for (std::size_t i = 0; i < (peels ? 3u : 1u); ++i) {
      CHECK(colours[0][i].bytes == colours[1][i].bytes);
      CHECK(depths[0][i].bytes == depths[1][i].bytes);
    }
  }
}

TEST_CASE("more varyings than a C++ stage may have keep their bits") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const ShaderDraw many = draw_of(R"(#version 450
layout(location = 0) in vec4 position;
layout(location = 1) in vec4 smooth_in;
layout(location = 2) in vec2 linear_in;
out vec4 many[10];
noperspective out vec4 last;
void main() {
  gl_Position = position * 1.5;
  for (int i = 0; i < 10; ++i) many[i] = vec4(float(i));
  many[3] = smooth_in * smooth_in + 0.25;
  many[9] = many[3];
  last = vec4(linear_in, linear_in);
})",
                                  R"(#version 450
in vec4 many[10];
noperspective in vec4 last;
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() {
  float sum = 0.0;
  for (int i = 0; i < 10; ++i) { if (i != 3 && i != 9) sum += many[i].y; }
  first = many[9] + 0.0 * sum;
  second = vec4(many[3].xy, last.xw);
})");
  struct Cpp : CppFragments<false, false> {
    FragmentOutput<2> operator()(const Fragment<8>& in) const {
      const auto& v = in.varyings;
      return {{glm::vec4{v[0], v[1], v[2], v[3]}, glm::vec4{v[0], v[1], v[4], v[5]}}, false};
    }
  };
  test::Random random{11};
  const std::vector<Vertex> vertices = random_vertices(200, random);
  const std::vector<std::uint32_t> indices = test::indices_up_to(vertices.size());
  const auto count = static_cast<std::uint32_t>(vertices.size());
  for (const char* const name : {"ieee", "llvmpipe", "softpipe"}) {
    CAPTURE(name);
    Pictures by_cpp, by_shaders;
    ThreadPool pool{2};
    RenderPass cpp_pass = by_cpp.pass(test::profile_named(name), Isa::scalar);
    draw(cpp_pass, {}, indices, count, CppVertices{vertices.data()}, Cpp{});
    finish(cpp_pass, pool);
    RenderPass pass = by_shaders.pass(test::profile_named(name), pool.isa());
    ShaderDraw with = many;
    with.attributes = attributes_of(vertices);
    draw_shaders(pass, {}, indices, count, with);
    finish(pass, pool);
    CHECK(differing_bytes(by_cpp, by_shaders) == 0);
  }
}

TEST_CASE("a shader's own depth is tested, and targets without an output stay") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const ShaderDraw with = draw_of(R"(#version 450
void main() {
  vec2 at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = 2.0 * vec4(at, 0.0, 1.0);
})",
                                  R"(#version 450
layout(location = 0) out vec4 first;
void main() {
  gl_FragDepth = gl_FragCoord.x < 10.0 ? 0.25 : gl_FragCoord.x < 20.0 ? 7.0 : -1.0;
  first = vec4(abs(gl_FragCoord.w - 0.5) < 1e-6, gl_FragCoord.z, gl_PrimitiveID, 1.0);
})");
  Pictures pictures;
  ThreadPool pool{1};
  RenderPass pass = pictures.pass({}, pool.isa());
  DrawState state;
  state.cull = Cull::none;
  const std::vector<std::uint32_t> indices{0, 1, 2};
  draw_shaders(pass, state, indices, 3, with);
  finish(pass, pool);
  CHECK(row<float>(pictures.depth, 5)[4] == 0.25f);
  CHECK(row<float>(pictures.depth, 5)[14] == 1.0f);  // 7 is cut to 1, which is not less
  CHECK(row<float>(pictures.depth, 5)[24] == 0.0f);
  CHECK(load_texel(pictures.first, 4, 5) == glm::vec4{1.0f, 0.5f, 0.0f, 1.0f});
  CHECK(load_texel(pictures.first, 14, 5) == glm::vec4{0.5f});
  CHECK(load_texel(pictures.second, 4, 5) == glm::vec4{0.5f});
}

TEST_CASE("with y upwards row 0 is the last, and dFdy points upwards") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  ShaderDraw with = draw_of(R"(#version 450
out vec2 at;
void main() {
  at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(at, 0.0, 1.0);
})",
                            R"(#version 450
in vec2 at;
layout(location = 0) out vec4 first;
void main() {
  first = vec4(at.y > 0.0, gl_FragCoord.y, dFdy(gl_FragCoord.y), gl_FrontFacing);
})");
  with.clip_space = ShaderClipSpace::y_up;
  Pictures pictures;
  ThreadPool pool{1};
  RenderPass pass = pictures.pass({}, pool.isa());
  const std::vector<std::uint32_t> indices{0, 1, 2};
  draw_shaders(pass, {}, indices, 3, with);
  finish(pass, pool);
  CHECK(load_texel(pictures.first, 7, 0) == glm::vec4{1.0f, kHeight - 0.5f, 1.0f, 1.0f});
  CHECK(load_texel(pictures.first, 7, kHeight - 1) == glm::vec4{0.0f, 0.5f, 1.0f, 1.0f});
}

TEST_CASE("an endless loop ends the draw with its line") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  ShaderDraw with = draw_of(R"(#version 450
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
})",
                            "#version 450\nout vec4 c;\nvoid main() {\n  float s = 0.0;\n"
                            "  while (gl_FragCoord.x > s) {\n    s -= 1.0;\n  }\n"
                            "  c = vec4(s);\n}\n");
  with.budget = 1000;
  Pictures pictures;
  ThreadPool pool{2};
  RenderPass pass = pictures.pass({}, pool.isa());
  const std::vector<std::uint32_t> indices{0, 1, 2};
  DrawState state;
  state.cull = Cull::none;
  draw_shaders(pass, state, indices, 3, with);
  CHECK_THROWS_WITH_AS(finish(pass, pool),
                       "test.frag:6: a loop takes more turns than the budget of 1000", ShaderError);
}

TEST_CASE("a viewport is where clip space comes to lie, and nothing is drawn outside of it") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  ShaderDraw draw = draw_of(
      "#version 330\nvoid main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1,"
      " gl_VertexID == 2 ? 3 : -1, 0, 1); }\n",
      "#version 330\nout vec4 colour;\nvoid main() { colour = vec4(gl_FragCoord.xy, 0, 1); }\n");
  draw.viewport = Rectangle{-3, 1, 2, 4};
  Image image = make_image(Format::rgba32f, 5, 5);
  RenderPass pass;
  pass.targets.colour[0] = &image;
  DrawState state;
  state.cull = Cull::none;
  state.depth.reset();
  ThreadPool pool{1};
  const std::vector<std::uint32_t> indices{0, 1, 2};
  draw_shaders(pass, state, indices, 3, draw);
  finish(pass, pool);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) {
      const bool is_inside = x < 2 && y >= 1 && y < 4;
      const glm::vec4 place{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, 0, 1};
      CHECK(load_texel(image, x, y) == (is_inside ? place : glm::vec4{0.0f}));
    }
  }
}
