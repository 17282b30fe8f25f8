// Shaders by the C interface: run_shader()'s bits, uniforms of every type, refusals by name.

#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "dof/c/softfocus.h"
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
    CHECK(softfocus_set_texture(context.get(), shader.get(), "picture", &from, SOFTFOCUS_BILINEAR,
                                SOFTFOCUS_MIRROR) == SOFTFOCUS_OK);
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
  CHECK(softfocus_set_texture(context.get(), shader.get(), "numbers", &texels, SOFTFOCUS_NEAREST,
                              SOFTFOCUS_CLAMP) == SOFTFOCUS_OK);
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
  status = softfocus_set_texture(context.get(), shader.get(), "picture", &texels, 9, 1);
  is_refused("filter: 9 is none");
  texels.format = 0;
  status = softfocus_set_texture(context.get(), shader.get(), "picture", &texels, 1, 1);
  is_refused("texels.format: 0 is no softfocus_format");
  texels.format = SOFTFOCUS_FORMAT_RGBA16F;
  texels.first = image.bytes.data() + 1;
  status = softfocus_set_texture(context.get(), shader.get(), "picture", &texels, 1, 1);
  is_refused("texels.first: it or row_bytes is not aligned to 2 bytes");

  source = text_source(
      "#version 330\nuniform samplerCube sky;\nout vec4 c;\n"
      "void main() { c = texture(sky, vec3(1.0)); }\n");
  const Shader cube = compiled_in_c(context.get(), source);
  texels = texels_of(image, SOFTFOCUS_FORMAT_RGBA16F);
  status = softfocus_set_texture(context.get(), cube.get(), "sky", &texels, 1, 1);
  is_refused("name: 'sky' is a cube or has layers");

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

  source = text_source("#version 330\nvoid main() { gl_Position = vec4(0.0); }\n");
  source.stage = SOFTFOCUS_VERTEX;
  const Shader vertex = compiled_in_c(context.get(), source);
  const Pass good{{&first}};
  status = softfocus_run_shader(context.get(), vertex.get(), &good.pass);
  is_refused("shader: it is a vertex shader");
  softfocus_free_shader(nullptr);
}
