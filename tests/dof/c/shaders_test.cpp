// Shaders by the C interface: run_shader()'s bits, uniforms of every type, refusals by name.

#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "dof/c/softfocus.h"
#include "raster/images/texel.h"
#include "raster/shaders/glsl/glsl.h"
#include "raster/shaders/shader.h"
#include "tests/support/c_pictures.h"
#include "tests/support/skip.h"
#include "tests/support/test_images.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

struct ShaderFree {
  void operator()(softfocus_shader* shader) const { softfocus_free_shader(shader); }
};
using Shader = std::unique_ptr<softfocus_shader, ShaderFree>;

constexpr const char* kBlur =
    "#version 330\n"
    "uniform sampler2D picture;\n"
    "uniform vec2 step;\n"
    "uniform float weights[3];\n"
    "layout(location = 0) out vec4 sum;\n"
    "layout(location = 1) out vec4 place;\n"
    "void main() {\n"
    "  vec2 at = gl_FragCoord.xy * step;\n"
    "  sum = vec4(0.0);\n"
    "  for (int i = 0; i < 3; ++i) {\n"
    "    sum += weights[i] * texture(picture, at + float(i - 1) * vec2(step.x, 0.0));\n"
    "  }\n"
    "  place = vec4(at, sin(at));\n"
    "}\n";

softfocus_shader_source text_source(const char* text) {
  softfocus_shader_source source{};
  source.struct_size = sizeof source;
  source.stage = SOFTFOCUS_FRAGMENT;
  source.text = text;
  source.name = "mine.frag";
  return source;
}

Shader compiled_in_c(softfocus_context* context, const softfocus_shader_source& source) {
  softfocus_shader* shader = nullptr;
  const int status = softfocus_compile_shader(context, &source, &shader);
  CAPTURE(softfocus_message(context));
  CHECK(status == SOFTFOCUS_OK);
  return Shader{shader};
}

softfocus_texels texels_of(Image& image, int format) {
  softfocus_texels texels{};
  texels.struct_size = sizeof texels;
  texels.width = image.width;
  texels.height = image.height;
  texels.format = format;
  texels.first = image.bytes.data();
  texels.row_bytes = static_cast<std::ptrdiff_t>(image.stride_bytes);
  return texels;
}

softfocus_sampler sampler_of(int filter, int wrap) {
  softfocus_sampler sampler{};
  sampler.struct_size = sizeof sampler;
  sampler.filter = filter;
  sampler.wrap_u = sampler.wrap_v = wrap;
  return sampler;
}

struct Pass {
  std::vector<const softfocus_texels*> targets{};
  softfocus_pass pass{};
  explicit Pass(std::vector<const softfocus_texels*> of) : targets(std::move(of)) {
    pass.struct_size = sizeof pass;
    pass.targets = targets.data();
    pass.target_count = static_cast<std::int32_t>(targets.size());
  }
};

int set(softfocus_context* context, const Shader& shader, const char* name,
        const std::vector<double>& numbers) {
  return softfocus_set_uniform(context, shader.get(), name, numbers.data(), numbers.size());
}

/// The four numbers that a shader writes at its only pixel.
template <class Number>
std::array<Number, 4> pixel_of(softfocus_context* context, const Shader& shader, int format) {
  std::array<Number, 4> pixel{};
  softfocus_texels texels{};
  texels.struct_size = sizeof texels;
  texels.width = texels.height = 1;
  texels.format = format;
  texels.first = pixel.data();
  const Pass pass{{&texels}};
  const int status = softfocus_run_shader(context, shader.get(), &pass.pass);
  CAPTURE(softfocus_message(context));
  CHECK(status == SOFTFOCUS_OK);
  return pixel;
}

bool is_glsl_missing() {
  if (missing_glsl().empty()) return false;
  skip("GLSL", missing_glsl());
  return true;
}

}  // namespace

TEST_CASE("the C interface: a shader, as text or as words, gives run_shader()'s bits") {
  if (is_glsl_missing()) return;
  constexpr int kWidth = 61, kHeight = 35;
  Image picture = random_scene_image(kWidth, kHeight, 1);
  const std::vector<float> weights{0.25f, 0.5f, 0.125f};

  GlslSource text{.name = "mine.frag", .text = kBlur};
  const std::vector<std::uint32_t> spirv =
      compile_glsl(text, [](const std::string&) { return std::nullopt; }).words;
  const UserShader expected_shader = make_shader(spirv);
  std::vector<std::uint32_t> words = expected_shader.uniforms.words;
  const float step[2] = {1.0f / kWidth, 1.0f / kHeight};
  std::memcpy(&words[find_uniform(expected_shader, "step")->first], step, sizeof step);
  std::memcpy(&words[find_uniform(expected_shader, "weights")->first], weights.data(), 12);
  const Texture texture = make_texture(picture);

  const Context context = open_context();
  softfocus_shader_source by_words = text_source(nullptr);
  by_words.words = spirv.data();
  by_words.word_count = spirv.size();
  for (const softfocus_shader_source& source : {text_source(kBlur), by_words}) {
    const Shader shader = compiled_in_c(context.get(), source);
    REQUIRE(shader != nullptr);
    CHECK(set(context.get(), shader, "step", {1.0 / kWidth, 1.0 / kHeight}) == SOFTFOCUS_OK);
    // One after the other, and the last two at once.
    CHECK(set(context.get(), shader, "weights", {0.25, 7.0, 7.0}) == SOFTFOCUS_OK);
    CHECK(set(context.get(), shader, "weights[1]", {0.5, 0.125}) == SOFTFOCUS_OK);
    const softfocus_texels from = texels_of(picture, SOFTFOCUS_FORMAT_RGBA16F);
    const softfocus_sampler mirrored = sampler_of(SOFTFOCUS_BILINEAR, SOFTFOCUS_MIRROR);
    CHECK(softfocus_set_texture(context.get(), shader.get(), "picture", &from, &mirrored) ==
          SOFTFOCUS_OK);
    for (const char* profile : {"ieee", "llvmpipe"}) {
      CAPTURE(profile);
      Image sums = make_image(Format::rgba16f, kWidth, kHeight);
      Image places = make_image(Format::rgba8, kWidth, kHeight);
      Image their_sums = sums, their_places = places;
      const ImageView targets[] = {their_sums, their_places};
      const std::vector<ShaderTexture> textures{
          {&texture, {Filter::bilinear, Wrap::mirrored_repeat, Wrap::mirrored_repeat}}};
      ThreadPool pool{1};
      run_shader(compile_shader(expected_shader, words),
                 {.textures = textures, .targets = targets, .profile = *find_profile(profile)},
                 pool);
      const softfocus_texels first = texels_of(sums, SOFTFOCUS_FORMAT_RGBA16F);
      const softfocus_texels second = texels_of(places, SOFTFOCUS_FORMAT_RGBA8);
      Pass pass{{&first, &second}};
      pass.pass.profile = profile;
      CHECK(softfocus_run_shader(context.get(), shader.get(), &pass.pass) == SOFTFOCUS_OK);
      CHECK(equal(sums, their_sums));
      CHECK(equal(places, their_places));
      // Another run of the same shader, into one target.
      Image again = make_image(Format::rgba8, kWidth, kHeight);
      const softfocus_texels other = texels_of(again, SOFTFOCUS_FORMAT_RGBA8);
      Pass one{{nullptr, &other}};
      one.pass.profile = profile;
      CHECK(softfocus_run_shader(context.get(), shader.get(), &one.pass) == SOFTFOCUS_OK);
      CHECK(equal(again, places));
    }
  }
}

TEST_CASE("the C interface: macros, and files that a callback reads") {
  if (is_glsl_missing()) return;
  const Context context = open_context();
  softfocus_shader_source source = text_source(
      "#version 330\n#include \"parts/first.glsl\"\nout vec4 c;\n"
      "void main() { c = vec4(FIRST, SECOND, flag, 4.0); }\n");
  source.name = "folder/mine.frag";
  std::vector<const char*> defines{"flag", "SECOND=2.5"};
  std::vector<std::string> asked;
  source.defines = defines.data();
  source.define_count = defines.size();
  source.user = &asked;
  source.read_include = [](void* user, const char* path) -> const char* {
    auto& all = *static_cast<std::vector<std::string>*>(user);
    all.emplace_back(path);
    if (all.back() == "folder/parts/first.glsl") return "#include \"one.glsl\"\n";
    return all.back() == "folder/parts/one.glsl" ? "#define FIRST 7.0\n" : nullptr;
  };
  const Shader shader = compiled_in_c(context.get(), source);
  REQUIRE(shader != nullptr);
  CHECK(pixel_of<float>(context.get(), shader, SOFTFOCUS_FORMAT_RGBA32F) ==
        std::array{7.0f, 2.5f, 1.0f, 4.0f});
  CHECK(asked == std::vector<std::string>{"folder/parts/first.glsl", "folder/parts/one.glsl"});

  const auto message = [&](const softfocus_shader_source& of) {
    softfocus_shader* none = nullptr;
    CHECK(softfocus_compile_shader(context.get(), &of, &none) != SOFTFOCUS_OK);
    CHECK(none == nullptr);
    return std::string{softfocus_message(context.get())};
  };
  softfocus_shader_source alone = source;
  alone.read_include = nullptr;
  CHECK(message(alone).find("folder/mine.frag:2") == 0);
  defines[1] = "2ND=1";
  CHECK(message(source).find("source.defines: '2ND=1': the name has to be") == 0);
  defines[1] = nullptr;
  CHECK(message(source) == "source.defines: a null pointer");
  source.defines = nullptr;
  CHECK(message(source) == "source.defines: a null pointer");
  const std::uint32_t word = 0x07230203;
  source.text = nullptr;
  source.words = &word;
  source.word_count = 1;
  CHECK(message(source).find("source: words are compiled already") == 0);
}

TEST_CASE("the C interface: a late uniform gives the bits of a compiled one, run after run") {
  if (is_glsl_missing()) return;
  const Context context = open_context();
  const softfocus_shader_source source = text_source(
      "#version 330\nuniform int turns;\nuniform float weights[3];\nuniform vec2 shift;\n"
      "out vec4 color;\nvoid main() {\n  color = vec4(shift, 0.0, 1.0);\n"
      "  for (int i = 0; i < turns; ++i) color.z += sin(weights[i] + color.x) / color.y;\n}\n");
  const Shader late = compiled_in_c(context.get(), source);
  for (const char* name : {"turns", "weights", "shift"}) {
    CHECK(softfocus_make_uniform_late(context.get(), late.get(), name) == SOFTFOCUS_OK);
  }
  for (const double turns : {3.0, 0.0, 1.0}) {
    const Shader constant = compiled_in_c(context.get(), source);
    for (const Shader* shader : {&late, &constant}) {
      CHECK(set(context.get(), *shader, "turns", {turns}) == SOFTFOCUS_OK);
      CHECK(set(context.get(), *shader, "weights", {0.3, turns, 1e-3}) == SOFTFOCUS_OK);
      CHECK(set(context.get(), *shader, "shift", {turns / 3.0, 0.7}) == SOFTFOCUS_OK);
    }
    CHECK(pixel_of<float>(context.get(), late, SOFTFOCUS_FORMAT_RGBA32F) ==
          pixel_of<float>(context.get(), constant, SOFTFOCUS_FORMAT_RGBA32F));
  }
  CHECK(softfocus_make_uniform_late(context.get(), late.get(), "tint") == SOFTFOCUS_BAD_ARGUMENT);
  CHECK(std::string{softfocus_message(context.get())} ==
        "name: the shader has no uniform 'tint'; there are shift, turns, weights");
}

TEST_CASE("the C interface: uniforms of every type, by their parts in order") {
  if (is_glsl_missing()) return;
  const Context context = open_context(1);
  const Shader shader = compiled_in_c(
      context.get(), text_source("#version 330\n"
                                 "struct Light { ivec2 at; bool on; };\n"
                                 "uniform mat2x3 m;\n"
                                 "uniform Light lights[2];\n"
                                 "uniform uint most;\n"
                                 "uniform float preset = 0.5;\n"
                                 "out vec4 colour;\n"
                                 "void main() {\n"
                                 "  colour = vec4(m[1].y, float(lights[1].at.x),\n"
                                 "    float(most >> 31) + (lights[0].on ? 8.0 : 0.0), preset);\n"
                                 "}\n"));
  REQUIRE(shader != nullptr);
  CHECK(set(context.get(), shader, "m", {1, 2, 3, 4, 5, 6}) == SOFTFOCUS_OK);
  CHECK(set(context.get(), shader, "lights[1].at", {-7, 0}) == SOFTFOCUS_OK);
  CHECK(set(context.get(), shader, "lights[0].on", {1}) == SOFTFOCUS_OK);
  CHECK(set(context.get(), shader, "most", {4294967295.0}) == SOFTFOCUS_OK);
  CHECK(pixel_of<float>(context.get(), shader, SOFTFOCUS_FORMAT_RGBA32F) ==
        std::array<float, 4>{5.0f, -7.0f, 9.0f, 0.5f});
  std::vector<std::string> names;
  for (std::size_t i = 0; const char* name = softfocus_uniform_name(shader.get(), i); ++i) {
    names.emplace_back(name);
  }
  std::sort(names.begin(), names.end());
  CHECK(names == std::vector<std::string>{"lights[0].at", "lights[0].on", "lights[1].at",
                                          "lights[1].on", "m", "most", "preset"});
}

TEST_CASE("the C interface: whole numbers pass through textures and targets as they are") {
  if (is_glsl_missing()) return;
  const Context context = open_context(1);
  const Shader shader =
      compiled_in_c(context.get(), text_source("#version 330\n"
                                               "uniform isampler2D numbers;\n"
                                               "out ivec4 colour;\n"
                                               "void main() {\n"
                                               "  colour = texelFetch(numbers, ivec2(0), 0).wzyx;\n"
                                               "}\n"));
  REQUIRE(shader != nullptr);
  // A denormal, a NaN that signals, the least number: as floats none would stay as it is.
  std::array<std::int32_t, 4> numbers{1, 0x7f800001, INT32_MIN, -1};
  softfocus_texels texels{};
  texels.struct_size = sizeof texels;
  texels.width = texels.height = 1;
  texels.format = SOFTFOCUS_FORMAT_RGBA32I;
  texels.first = numbers.data();
  const softfocus_sampler nearest = sampler_of(SOFTFOCUS_NEAREST, SOFTFOCUS_CLAMP);
  CHECK(softfocus_set_texture(context.get(), shader.get(), "numbers", &texels, &nearest) ==
        SOFTFOCUS_OK);
  const auto found = pixel_of<std::int32_t>(context.get(), shader, SOFTFOCUS_FORMAT_RGBA32I);
  CHECK(found[0] == -1);
  CHECK(found[1] == INT32_MIN);
  CHECK(found[2] == 0x7f800001);
  CHECK(found[3] == 1);
}

TEST_CASE("the C interface: a shader's errors name its file and line") {
  if (is_glsl_missing()) return;
  const Context context = open_context(1);
  const auto message_of = [&](const char* text) {
    const softfocus_shader_source source = text_source(text);
    softfocus_shader* shader = nullptr;
    CHECK(softfocus_compile_shader(context.get(), &source, &shader) == SOFTFOCUS_BAD_SHADER);
    CHECK(shader == nullptr);
    return std::string{softfocus_message(context.get())};
  };
  CHECK(message_of("#version 330\nout vec4 c;\nvoid main() { c = vec4(x); }\n")
            .starts_with("mine.frag:3: 'x': undeclared identifier"));
  const Shader endless = compiled_in_c(
      context.get(), text_source("#version 330\nuniform int n;\nout vec4 c;\n"
                                 "void main() {\n  for (int i = 0; i >= n; ++i) c.x += 1.0;\n}\n"));
  std::array<float, 4> pixel{};
  softfocus_texels texels{};
  texels.struct_size = sizeof texels;
  texels.width = texels.height = 1;
  texels.format = SOFTFOCUS_FORMAT_RGBA32F;
  texels.first = pixel.data();
  Pass pass{{&texels}};
  pass.pass.budget = 100;
  CHECK(softfocus_run_shader(context.get(), endless.get(), &pass.pass) == SOFTFOCUS_BAD_SHADER);
  CHECK(std::string{softfocus_message(context.get())}.starts_with("mine.frag:5: a loop"));
}

namespace {

softfocus_shader_source vertex_source(const char* text) {
  softfocus_shader_source source = text_source(text);
  source.stage = SOFTFOCUS_VERTEX;
  source.name = "mine.vert";
  return source;
}

constexpr const char* kCorner =
    "#version 330\n"
    "in vec2 corner;\n"
    "in mat2 more;\n"
    "uniform vec4 tint = vec4(0.25, 0.5, 0.75, 1.0);\n"
    "out float row;\n"
    "void main() {\n"
    "  gl_Position = vec4(corner, 0.0, 1.0);\n"
    "  row = more[1].y;\n"
    "}\n";

}  // namespace

TEST_CASE("the C interface: a vertex and a fragment shader draw triangles, the lowest row first") {
  if (is_glsl_missing()) return;
  const Context context = open_context(1);
  const Shader vertex = compiled_in_c(context.get(), vertex_source(kCorner));
  const Shader fragment =
      compiled_in_c(context.get(), text_source("#version 330\n"
                                               "in float row;\n"
                                               "uniform vec4 tint;\n"
                                               "out vec4 colour;\n"
                                               "void main() {\n"
                                               "  colour = vec4(row, gl_FragCoord.y, tint.zw);\n"
                                               "}\n"));
  REQUIRE(vertex != nullptr);
  REQUIRE(fragment != nullptr);
  // A rectangle over the lower half; of its matrices the last number is 0 below and 8 above.
  const float corners[4][2] = {{-1, -1}, {1, -1}, {-1, 0}, {1, 0}};
  const float matrices[4][4] = {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 8}, {0, 0, 0, 8}};
  const std::uint32_t indices[6] = {0, 1, 2, 2, 1, 3};
  softfocus_attribute corner{}, more{};
  corner.struct_size = more.struct_size = sizeof corner;
  corner.name = "corner";
  corner.first = corners;
  corner.numbers = 2;
  more.name = "more";
  more.first = matrices;
  more.numbers = 4;
  const softfocus_attribute* const attributes[] = {&corner, &more};
  softfocus_vertices vertices{};
  vertices.struct_size = sizeof vertices;
  vertices.attributes = attributes;
  vertices.attribute_count = 2;
  vertices.vertex_count = 4;
  vertices.indices = indices;
  vertices.index_count = 6;
  Image image = make_image(Format::rgba32f, 3, 4);
  clear_image(image, {-1, -1, -1, -1}, {});
  const softfocus_texels texels = texels_of(image, SOFTFOCUS_FORMAT_RGBA32F);
  const Pass pass{{&texels}};
  const auto draw = [&] {
    return softfocus_draw_shaders(context.get(), vertex.get(), fragment.get(), &vertices,
                                  &pass.pass);
  };
  CHECK(draw() == SOFTFOCUS_BAD_ARGUMENT);
  CHECK(softfocus_message(context.get()) ==
        std::string{"vertex: the shaders are not linked; softfocus_link_shaders() comes first"});
  REQUIRE(softfocus_link_shaders(context.get(), vertex.get(), fragment.get()) == SOFTFOCUS_OK);
  REQUIRE(draw() == SOFTFOCUS_OK);
  for (int x = 0; x < 3; ++x) {
    // The vertex shader's initial value is the fragment shader's.
    CHECK(load_texel(image, x, 0) == glm::vec4{2.0f, 0.5f, 0.75f, 1.0f});
    CHECK(load_texel(image, x, 1) == glm::vec4{6.0f, 1.5f, 0.75f, 1.0f});
    CHECK(load_texel(image, x, 2) == glm::vec4{-1.0f});
    CHECK(load_texel(image, x, 3) == glm::vec4{-1.0f});
  }
  const auto refused = [&](const std::string& words) {
    CHECK(draw() == SOFTFOCUS_BAD_ARGUMENT);
    const std::string message = softfocus_message(context.get());
    CAPTURE(message);
    CHECK(message.find(words) != message.npos);
  };
  more.numbers = 3;
  refused("vertices.attributes[1].numbers: 3; 'more' has 4");
  more.name = "less";
  refused("vertices.attributes[1].name: the vertex shader has no input 'less'; there are ");
  more.name = "more";
  more.numbers = 4;
  vertices.index_count = 5;
  refused("vertices.index_count: 5; a triangle has three");
  vertices.index_count = 6;
  vertices.vertex_count = 3;
  refused("vertices.indices[5]: 3; there are 3 vertices");
}

TEST_CASE("the C interface: an array of structures goes from vertices to pixels member by member") {
  if (is_glsl_missing()) return;
  const Context context = open_context(1);
  const Shader vertex = compiled_in_c(
      context.get(), vertex_source("#version 330\n"
                                   "struct Part { vec3 a; vec2 b; };\n"
                                   "out Part parts[2];\n"
                                   "in vec2 corner;\n"
                                   "void main() {\n"
                                   "  gl_Position = vec4(corner, 0.0, 1.0);\n"
                                   "  for (int i = 0; i < 2; ++i) {\n"
                                   "    parts[i].a = vec3(1.0, 2.0, 3.0) + 8.0 * float(i);\n"
                                   "    parts[i].b = vec2(4.0, 5.0) + 8.0 * float(i);\n"
                                   "  }\n"
                                   "}\n"));
  const Shader fragment =
      compiled_in_c(context.get(), text_source("#version 330\n"
                                               "struct Part { vec3 a; vec2 b; };\n"
                                               "in Part parts[2];\n"
                                               "out vec4 colour;\n"
                                               "void main() { colour = vec4(parts[0].a.z, "
                                               "parts[0].b.y, parts[1].a.x, parts[1].b.y); }\n"));
  REQUIRE(softfocus_link_shaders(context.get(), vertex.get(), fragment.get()) == SOFTFOCUS_OK);
  const float corners[3][2] = {{-1, -1}, {3, -1}, {-1, 3}};
  softfocus_attribute corner{};
  corner.struct_size = sizeof corner;
  corner.name = "corner";
  corner.first = corners;
  corner.numbers = 2;
  const softfocus_attribute* const attributes[] = {&corner};
  softfocus_vertices vertices{};
  vertices.struct_size = sizeof vertices;
  vertices.attributes = attributes;
  vertices.attribute_count = 1;
  vertices.vertex_count = 3;
  Image image = make_image(Format::rgba32f, 1, 1);
  const softfocus_texels texels = texels_of(image, SOFTFOCUS_FORMAT_RGBA32F);
  const Pass pass{{&texels}};
  REQUIRE(softfocus_draw_shaders(context.get(), vertex.get(), fragment.get(), &vertices,
                                 &pass.pass) == SOFTFOCUS_OK);
  CHECK(load_texel(image, 0, 0) == glm::vec4{3.0f, 5.0f, 9.0f, 13.0f});
}

TEST_CASE("the C interface: shaders that exchange what the other has not do not link") {
  if (is_glsl_missing()) return;
  const Context context = open_context(1);
  const auto message_of = [&](const char* declared, const char* value) {
    const std::string text = std::string{"#version 330\n"} + declared +
                             "\nout vec4 colour;\nvoid main() { colour = vec4(" + value + "); }\n";
    const Shader vertex = compiled_in_c(context.get(), vertex_source(kCorner));
    const Shader fragment = compiled_in_c(context.get(), text_source(text.c_str()));
    CHECK(softfocus_link_shaders(context.get(), vertex.get(), fragment.get()) ==
          SOFTFOCUS_BAD_SHADER);
    return std::string{softfocus_message(context.get())};
  };
  CHECK(message_of("in vec2 row;", "row, row").find("'row' has 1 floats in the vertex shader") !=
        std::string::npos);
  CHECK(message_of("in float column;", "column").find("has no output 'column'") !=
        std::string::npos);
  CHECK(message_of("uniform vec3 tint;", "tint, 1.0") ==
        "'tint' has another type in the vertex shader than in the fragment shader; they "
        "must be equal");
}

TEST_CASE("the C interface: a shadow sampler compares as it is told") {
  if (is_glsl_missing()) return;
  const Context context = open_context(1);
  const Shader shader = compiled_in_c(
      context.get(),
      text_source("#version 330\n"
                  "uniform sampler2DShadow depths;\n"
                  "uniform float z;\n"
                  "out vec4 colour;\n"
                  "void main() {\n"
                  "  colour = vec4(texture(depths, vec3(0.5, 0.5, z)),\n"
                  "                vec3(textureLod(depths, vec3(0.5, 0.5, z), 0.0)));\n"
                  "}\n"));
  REQUIRE(shader != nullptr);
  float depth = 0.5f;
  softfocus_texels texels{};
  texels.struct_size = sizeof texels;
  texels.width = texels.height = 1;
  texels.format = SOFTFOCUS_FORMAT_R32F;
  texels.first = &depth;
  softfocus_sampler sampler = sampler_of(SOFTFOCUS_NEAREST, SOFTFOCUS_CLAMP);
  const bool expected[8][3] = {{false, false, false}, {true, false, false}, {false, true, false},
                               {true, true, false},   {false, false, true}, {true, false, true},
                               {false, true, true},   {true, true, true}};
  for (int compare = SOFTFOCUS_NEVER; compare <= SOFTFOCUS_ALWAYS; ++compare) {
    CAPTURE(compare);
    sampler.compare = compare;
    REQUIRE(softfocus_set_texture(context.get(), shader.get(), "depths", &texels, &sampler) ==
            SOFTFOCUS_OK);
    for (int i = 0; i < 3; ++i) {
      CHECK(set(context.get(), shader, "z", {0.25 * (i + 1)}) == SOFTFOCUS_OK);
      const float passes = expected[compare - 1][i] ? 1.0f : 0.0f;
      CHECK(pixel_of<float>(context.get(), shader, SOFTFOCUS_FORMAT_RGBA32F) ==
            std::array<float, 4>{passes, passes, passes, passes});
    }
  }
}

TEST_CASE("the C interface: arrays, volumes and cubes are set from memory, slice by slice") {
  if (is_glsl_missing()) return;
  const Context context = open_context(1);
  // Red counts texels: two a slice, of a row each.
  std::array<float, 16> memory{};
  for (std::size_t i = 0; i < memory.size(); ++i) memory[i] = static_cast<float>(i);
  softfocus_texels texels{};
  texels.struct_size = sizeof texels;
  texels.width = texels.height = 1;
  texels.format = SOFTFOCUS_FORMAT_R32F;
  texels.first = memory.data();
  softfocus_sampler sampler = sampler_of(SOFTFOCUS_NEAREST, SOFTFOCUS_CLAMP);
  sampler.wrap_w = SOFTFOCUS_CLAMP;
  const auto read = [&](const std::string& type, const std::string& at) {
    const std::string text = "#version 330\nuniform " + type + " t;\nout vec4 colour;\n" +
                             "void main() { colour = texture(t, " + at + "); }\n";
    const Shader shader = compiled_in_c(context.get(), text_source(text.c_str()));
    REQUIRE(shader != nullptr);
    const int status = softfocus_set_texture(context.get(), shader.get(), "t", &texels, &sampler);
    if (status != SOFTFOCUS_OK) return std::string{softfocus_message(context.get())};
    const float red = pixel_of<float>(context.get(), shader, SOFTFOCUS_FORMAT_RGBA32F)[0];
    return std::to_string(static_cast<int>(red));
  };
  texels.slices = 6;
  CHECK(read("samplerCube", "vec3(0, 0, -1)") == "5");
  CHECK(read("sampler3D", "vec3(0.5, 0.5, 0.7)") == "4");
  CHECK(read("sampler2DArray", "vec3(0.5, 0.5, 3)") == "3");
  texels.slice_bytes = 8;
  CHECK(read("samplerCube", "vec3(0, 0, -1)") == "10");
  texels.first = memory.data() + 15;
  texels.slice_bytes = -4;
  CHECK(read("sampler2DArray", "vec3(0.5, 0.5, 3)") == "12");
  const auto is_in = [](const std::string& words, const std::string& message) {
    CAPTURE(message);
    CHECK(message.find(words) != message.npos);
  };
  is_in("texels.slices: 6; 't' is a sampler2D, and reads one", read("sampler2D", "vec2(0)"));
  texels.slice_bytes = 2;
  is_in("texels.slice_bytes: 2 is no multiple", read("sampler3D", "vec3(0)"));
  texels.slice_bytes = 0;
  texels.slices = 1;
  is_in("texels.slices: 1; 't' is a samplerCube, and reads six faces",
        read("samplerCube", "vec3(1)"));
  texels.slices = -1;
  is_in("texels.slices: -1; 't' is a sampler3D, and reads 1 to", read("sampler3D", "vec3(0)"));
  texels.slices = 6;
  texels.width = 2;
  is_in("'t' is a samplerCube, of square faces", read("samplerCube", "vec3(1)"));
}

TEST_CASE("the C interface: wrong arguments of shaders are refused by name") {
  if (is_glsl_missing()) return;
  const Context context = open_context(1);
  const Shader shader = compiled_in_c(context.get(), text_source(kBlur));
  REQUIRE(shader != nullptr);
  int status = SOFTFOCUS_OK;
  const auto is_refused = [&](const std::string& words) {
    const std::string message = softfocus_message(context.get());
    CAPTURE(message);
    CAPTURE(words);
    CHECK(status == SOFTFOCUS_BAD_ARGUMENT);
    CHECK(message.find(words) != message.npos);
  };

  softfocus_shader* none = nullptr;
  const auto refused_source = [&](const softfocus_shader_source& source, const char* words) {
    status = softfocus_compile_shader(context.get(), &source, &none);
    is_refused(words);
  };
  refused_source(text_source(nullptr), "source: neither text nor words");
  softfocus_shader_source source = text_source(kBlur);
  source.stage = 7;
  refused_source(source, "source.stage: 7 is no stage");
  source = text_source(kBlur);
  source.convention = "toy";
  refused_source(source, "source.convention: there is no 'toy'; there are plain, shadertoy");
  source = text_source(kBlur);
  status = softfocus_compile_shader(context.get(), &source, nullptr);
  is_refused("shader: a null pointer");

  status = set(context.get(), shader, "stop", {1, 2});
  is_refused("name: the shader has no uniform 'stop'; there are ");
  status = set(context.get(), shader, "picture", {1});
  is_refused("no uniform 'picture'");
  status = set(context.get(), shader, "step", {1});
  is_refused("count: 1; 'step' takes 2");
  status = set(context.get(), shader, "weights[3]", {1});
  is_refused("no uniform 'weights[3]'");
  status = set(context.get(), shader, "weights[2]", {1, 2});
  is_refused("count: 2; 'weights' takes 1");
  status = softfocus_set_uniform(context.get(), shader.get(), "step", nullptr, 2);
  is_refused("numbers: a null pointer");

  Image image = make_image(Format::rgba16f, 8, 4), other = image;
  softfocus_texels texels = texels_of(image, SOFTFOCUS_FORMAT_RGBA16F);
  const softfocus_sampler sampler = sampler_of(9, SOFTFOCUS_CLAMP);
  status = softfocus_set_texture(context.get(), shader.get(), "picture", &texels, &sampler);
  is_refused("sampler.filter: 9 is none");
  texels.format = 0;
  status = softfocus_set_texture(context.get(), shader.get(), "picture", &texels, nullptr);
  is_refused("texels.format: 0 is no softfocus_format");
  texels.format = SOFTFOCUS_FORMAT_RGBA16F;
  texels.first = image.bytes.data() + 1;
  status = softfocus_set_texture(context.get(), shader.get(), "picture", &texels, nullptr);
  is_refused("texels.first: it or row_bytes is not aligned to 2 bytes");

  source = text_source(
      "#version 330\nuniform samplerCube sky;\nout vec4 c;\n"
      "void main() { c = texture(sky, vec3(1.0)); }\n");
  const Shader cube = compiled_in_c(context.get(), source);
  texels = texels_of(image, SOFTFOCUS_FORMAT_RGBA16F);
  status = softfocus_set_texture(context.get(), cube.get(), "sky", &texels, nullptr);
  is_refused("texels.slices: 0; 'sky' is a samplerCube, and reads six faces");

  const softfocus_texels first = texels_of(image, SOFTFOCUS_FORMAT_RGBA16F);
  softfocus_texels second = texels_of(other, SOFTFOCUS_FORMAT_RGBA16F);
  const auto refused_pass = [&](const Pass& pass, const char* words) {
    const Image before = image;
    status = softfocus_run_shader(context.get(), shader.get(), &pass.pass);
    is_refused(words);
    CHECK(image.bytes == before.bytes);
  };
  refused_pass(Pass{{}}, "pass.target_count: 0 is not from 1 to 8");
  refused_pass(Pass{{nullptr}}, "pass.targets: all are null");
  refused_pass(Pass{{&first, &first}}, "pass.targets[1]: it lies over another target");
  second.height = 3;
  refused_pass(Pass{{&first, &second}}, "pass.targets[1]: it has not the size of the others");
  Pass pass{{&first}};
  pass.pass.profile = "gpu";
  refused_pass(pass, "pass.profile: there is no 'gpu'");

  const Shader vertex = compiled_in_c(context.get(), vertex_source(kCorner));
  const Pass good{{&first}};
  status = softfocus_run_shader(context.get(), vertex.get(), &good.pass);
  is_refused("shader: it is a vertex shader");
  softfocus_free_shader(nullptr);
}
