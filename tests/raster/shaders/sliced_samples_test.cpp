// Shaders that read arrays, volumes and cubes: the oracle's bits on every vector unit, sizes and
// texels, and what is refused.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"
#include "raster/shaders/glsl/glsl.h"
#include "raster/shaders/shader.h"
#include "tests/support/random.h"
#include "tests/support/shader_checks.h"
#include "tests/support/skip.h"
#include "tests/support/sliced_oracle.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

UserShader slices_shader(const std::string& declared, const std::string& body,
                         const std::string& array = "") {
  const GlslSource source{.name = "slices.frag",
                          .text =
                              "#version 450\nlayout(location = 0) in vec2 uv;\n"
                              "layout(location = 0) out vec4 result;\nuniform " +
                              declared + " t" + array + ";\nvoid main() {\n" + body + "\n}\n"};
  return make_shader(compile_glsl(source, [](const std::string&) { return std::nullopt; }).words);
}

Texture slices_of_noise(TextureShape shape, int size, int count) {
  Random random{3};
  std::vector<Image> slices;
  slices.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    slices.push_back(random_texture(Format::rgba16f, size, random).levels[0]);
  }
  Texture texture = make_sliced_texture(shape, std::move(slices));
  generate_mipmaps(texture, {});
  return texture;
}

constexpr int kSlicesWidth = 40, kSlicesHeight = 6;

Image drawn_slices(const UserShader& shader, const ShaderTexture& texture, Isa isa) {
  Image found = make_image(Format::rgba32f, kSlicesWidth, kSlicesHeight);
  const ImageView view = found;
  ThreadPool pool{1, isa};
  run_shader(compile_shader(shader, shader.uniforms.words),
             {.textures = {&texture, 1}, .targets = {&view, 1}}, pool);
  return found;
}

/// A pixel's place in the picture, as the shader has it.
glm::vec2 uv_of(int x, int y) {
  return {(static_cast<float>(x) + 0.5f) / static_cast<float>(kSlicesWidth),
          (static_cast<float>(y) + 0.5f) / static_cast<float>(kSlicesHeight)};
}

/// Checks every unit against a pixel's value.
void check_slices(const UserShader& shader, const ShaderTexture& texture,
                  const std::function<glm::vec4(int, int)>& expected) {
  Image image = make_image(Format::rgba32f, kSlicesWidth, kSlicesHeight);
  for (int y = 0; y < kSlicesHeight; ++y) {
    for (int x = 0; x < kSlicesWidth; ++x) store_texel(image, x, y, expected(x, y), {});
  }
  for (const Isa isa : available_isas()) {
    CAPTURE(isa_name(isa));
    CHECK(first_difference(drawn_slices(shader, texture, isa), image) == "");
  }
}

int wrapped_index(int i, int size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return std::clamp(i, 0, size - 1);
  const int period = wrap == Wrap::repeat ? size : 2 * size;
  const int rest = (i % period + period) % period;
  return rest < size ? rest : period - 1 - rest;
}

std::string refusal_of(const std::string& declared, const std::string& body) {
  try {
    const UserShader shader = slices_shader(declared, body);
    compile_shader(shader, shader.uniforms.words);
  } catch (const ShaderError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("texture() of a volume and a cube takes its level from a block's first pixel") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  for (const TextureShape shape : {TextureShape::volume, TextureShape::cube}) {
    const bool is_cube = shape == TextureShape::cube;
    const Texture texture = slices_of_noise(shape, 16, is_cube ? 6 : 9);
    const Sampler sampler{Filter::trilinear, Wrap::repeat, Wrap::mirrored_repeat,
                          Wrap::clamp_to_edge};
    // 3 and 7 are exact in both, and so is what comes of them by the same operations.
    const UserShader shader = slices_shader(
        std::string{sampler_name(shape)},
        "result = texture(t, vec3(uv.x * 7.0 - 3.0, uv.y * 3.0 - 1.0, uv.x - uv.y));");
    const auto place = [](int x, int y) {
      const glm::vec2 uv = uv_of(x, y);
      return glm::vec3{uv.x * 7.0f - 3.0f, uv.y * 3.0f - 1.0f, uv.x - uv.y};
    };
    check_slices(shader, {.texture = &texture, .sampler = sampler}, [&](int x, int y) {
      const int column = x & ~1, row = y & ~1;
      const glm::vec3 at = place(column, row);
      const float lod = sliced_level_of_detail(texture, at, place(column + 1, row) - at,
                                               place(column, row + 1) - at, {});
      return SlicedOracle{texture, sampler}.sampled(place(x, y), lod);
    });
  }
}

TEST_CASE("textureLod, textureGrad and offsets of a volume; textureLod of a cube") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Sampler sampler{Filter::trilinear};
  const Texture volume = slices_of_noise(TextureShape::volume, 8, 4);
  const Texture cube = slices_of_noise(TextureShape::cube, 8, 6);
  const auto at = [](int x, int y) { return glm::vec3{uv_of(x, y), 0.625f}; };
  check_slices(slices_shader("sampler3D", "result = textureLod(t, vec3(uv, 0.625), uv.x * 4.0);"),
               {.texture = &volume, .sampler = sampler}, [&](int x, int y) {
                 return SlicedOracle{volume, sampler}.sampled(at(x, y), uv_of(x, y).x * 4.0f);
               });
  check_slices(slices_shader("samplerCube", "result = textureLod(t, vec3(uv, 0.625), uv.x * 4.0);"),
               {.texture = &cube, .sampler = sampler}, [&](int x, int y) {
                 return SlicedOracle{cube, sampler}.sampled(at(x, y), uv_of(x, y).x * 4.0f);
               });
  check_slices(
      slices_shader("sampler3D",
                    "result = textureGradOffset(t, vec3(uv, 0.625), vec3(0.25, 0.0, 0.0),\n"
                    "                           vec3(0.0, 0.0, 0.75), ivec3(1, 0, -1));"),
      {.texture = &volume, .sampler = sampler}, [&](int x, int y) {
        const float lod =
            sliced_level_of_detail(volume, at(x, y), {0.25f, 0, 0}, {0, 0, 0.75f}, {});
        const glm::vec3 moved{at(x, y).x + 1.0f / 8.0f, at(x, y).y, at(x, y).z + -1.0f / 4.0f};
        return SlicedOracle{volume, sampler}.sampled(moved, lod);
      });
}

TEST_CASE("texelFetch, textureSize and gathers reach every slice, and 0 lies beyond them") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Texture volume = slices_of_noise(TextureShape::volume, 8, 5);
  const Texture array = slices_of_noise(TextureShape::array, 8, 5);
  const Texture cube = slices_of_noise(TextureShape::cube, 8, 6);
  const std::string fetch =
      "ivec2 p = ivec2(gl_FragCoord.xy); result = texelFetch(t, ivec3(p.x % 9, p.y, p.x % 7 - 1), "
      "1);";
  const auto fetched = [&](const Texture& texture) {
    check_slices(slices_shader(std::string{sampler_name(texture.shape)}, fetch),
                 {.texture = &texture}, [&](int x, int y) {
                   const int u = x % 9, k = x % 7 - 1;
                   const bool inside = u < 4 && y < 4 && k >= 0 && k < slice_count(texture, 1);
                   return inside ? load_texel(slice_level(texture, k, 1), u, y) : glm::vec4{0.0f};
                 });
  };
  fetched(volume);
  fetched(array);
  const auto constant = [](glm::vec4 value) { return [=](int, int) { return value; }; };
  check_slices(
      slices_shader("sampler3D", "result = vec4(textureSize(t, 1), textureQueryLevels(t));"),
      {.texture = &volume}, constant({4, 4, 2, 4}));
  check_slices(slices_shader("sampler2DArray", "result = vec4(textureSize(t, 1), 0.0);"),
               {.texture = &array}, constant({4, 4, 5, 0}));
  check_slices(slices_shader("samplerCube", "result = vec4(textureSize(t, 2), 0.0, 0.0);"),
               {.texture = &cube}, constant({2, 2, 0, 0}));
  check_slices(
      slices_shader("sampler2DArray", "result = textureGather(t, vec3(0.5, 0.5, 3.4), 1);"),
      {.texture = &array},
      constant({load_texel(array.behind[2].levels[0], 3, 4).y,
                load_texel(array.behind[2].levels[0], 4, 4).y,
                load_texel(array.behind[2].levels[0], 4, 3).y,
                load_texel(array.behind[2].levels[0], 3, 3).y}));
}

TEST_CASE("gathers of a cube go on on the next face, and beyond a corner lies the others' mean") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Texture cube = slices_of_noise(TextureShape::cube, 8, 6);
  const UserShader shader =
      slices_shader("samplerCube",
                    "result = textureGather(t, vec3(uv * 2.6 - 1.3, uv.x < 0.5 ? 1.0 : -1.0), 2);");
  check_slices(shader, {.texture = &cube}, [&](int x, int y) {
    const glm::vec2 uv = uv_of(x, y);
    const CubePlace place = cube_place({uv * 2.6f - 1.3f, uv.x < 0.5f ? 1.0f : -1.0f});
    const auto first = [](float u) { return static_cast<int>(std::floor(u * 8.0f - 0.5f)); };
    const int u = first(place.at.x), v = first(place.at.y);
    const auto channel = [&](int column, int row) {
      const CubeTexel at = oracle_cube_texel({place.face, column, row}, 8);
      return load_texel(slice_level(cube, at.face, 0), at.x, at.y).z;
    };
    const std::array<glm::ivec2, 4> four{{{u, v}, {u + 1, v}, {u, v + 1}, {u + 1, v + 1}}};
    const auto value = [&](int i) {
      const auto is_beyond = [](int of) { return of < 0 || of > 7; };
      const glm::ivec2 own = four[static_cast<std::size_t>(i)];
      if (!is_beyond(own.x) || !is_beyond(own.y)) return channel(own.x, own.y);
      std::vector<float> others;
      for (const glm::ivec2 other : four) {
        if (other != own) others.push_back(channel(other.x, other.y));
      }
      return ((others[0] + others[1]) + others[2]) * (1.0f / 3.0f);
    };
    return glm::vec4{value(2), value(3), value(1), value(0)};
  });
}

TEST_CASE("textureQueryLod of a volume and a cube gives the level that texture() takes") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Texture volume = slices_of_noise(TextureShape::volume, 16, 8);
  const Texture cube = slices_of_noise(TextureShape::cube, 16, 6);
  for (const Texture* texture : {&volume, &cube}) {
    const UserShader shader = slices_shader(
        std::string{sampler_name(texture->shape)},
        "vec3 at = vec3(uv, 1.25) * 4.0; result = vec4(textureQueryLod(t, at), 0.0, 0.0);");
    check_slices(shader, {.texture = texture}, [&](int x, int y) {
      const auto place = [](int column, int row) {
        return glm::vec3{uv_of(column, row), 1.25f} * 4.0f;
      };
      const int column = x & ~1, row = y & ~1;
      const glm::vec3 at = place(column, row);
      const float lod = sliced_level_of_detail(*texture, at, place(column + 1, row) - at,
                                               place(column, row + 1) - at, {});
      return glm::vec4{std::clamp(lod, 0.0f, 4.0f), lod, 0.0f, 0.0f};
    });
  }
}

TEST_CASE("shadow samplers of arrays and cubes compare the filtered texel") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  std::vector<Image> layers;
  for (int i = 0; i < 6; ++i) {
    layers.push_back(make_image(Format::r32f, 2, 2));
    clear_image(layers.back(), glm::vec4{static_cast<float>(i) / 8.0f}, {});
  }
  const Texture array = make_sliced_texture(TextureShape::array, layers);
  const Texture cube = make_sliced_texture(TextureShape::cube, layers);
  check_slices(slices_shader("sampler2DArrayShadow",
                             "float k = floor(gl_FragCoord.x);\n"
                             "result = vec4(texture(t, vec4(uv, k, 0.25)));"),
               {.texture = &array, .compare = Compare::less},
               [](int x, int) { return glm::vec4{x >= 3 ? 1.0f : 0.0f}; });
  check_slices(
      slices_shader("samplerCubeShadow", "result = vec4(texture(t, vec4(0, 0, -1, uv.x)));"),
      {.texture = &cube, .compare = Compare::less},
      [](int x, int y) { return glm::vec4{uv_of(x, y).x < 0.625f ? 1.0f : 0.0f}; });
}

TEST_CASE(
    "arrays, volumes and cubes have in lanes the bits that they have a lane after the other") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  // A texture whose number varies is read a lane after the other. Some places are NaN or infinite,
  // and some lanes are elsewhere.
  const std::string place =
      "ivec2 p = ivec2(gl_FragCoord.xy);\n"
      "vec3 at = vec3(uv.x * 7.0 - 3.0, uv.y * 3.0 - 1.0, uv.x - uv.y);\n"
      "if (p.x % 11 == 3) at[p.y % 3] = 1.0 / float(p.x % 2) * (p.y > 2 ? -1.0 : 1.0);\n"
      "if (p.x % 13 == 5) at[p.y % 3] *= 0.0 / float(p.x % 2);\n"
      "result = vec4(9.0);\nint i = NUMBER;\n";
  for (const TextureShape shape : {TextureShape::array, TextureShape::volume, TextureShape::cube}) {
    const std::string sampler{sampler_name(shape)};
    const bool is_cube = shape == TextureShape::cube;
    const Texture texture = slices_of_noise(shape, 16, is_cube ? 6 : 9);
    const std::string gradients = shape == TextureShape::array ? "vec2(uv.x, 0.3), vec2(0.2)"
                                                               : "vec3(uv.x, 0.3, 0.1), vec3(0.2)";
    std::vector<std::string> reads{"texture(t[i], at)", "texture(t[i], at, 1.5)",
                                   "textureLod(t[i], at, uv.x * 6.0 - 1.0)",
                                   "textureGrad(t[i], at, " + gradients + ")"};
    if (!is_cube) {
      const std::string offset = shape == TextureShape::array ? "ivec2(2, -1)" : "ivec3(2, -1, 3)";
      reads.push_back("textureOffset(t[i], at, " + offset + ")");
      reads.push_back("texelFetch(t[i], ivec3(p.x - 3, p.y - 1, p.x % 11 - 1), 0)");
      reads.push_back("texelFetch(t[i], ivec3(p.x % 9, p.y, p.x % 11 - 1), p.y)");
    }
    for (const std::string& read : reads) {
      const auto drawn = [&](const std::string& number, const Profile& profile, Isa isa) {
        std::string text = place;
        text.replace(text.find("NUMBER"), 6, number);
        const UserShader shader = slices_shader(
            sampler, text + "if ((p.x ^ p.y) % 5 != 4) result = " + read + ";\n", "[2]");
        const ShaderTexture one{.texture = &texture,
                                .sampler = {Filter::trilinear, Wrap::repeat, Wrap::mirrored_repeat,
                                            Wrap::clamp_to_edge}};
        const std::array<ShaderTexture, 2> both{one, one};
        Image found = make_image(Format::rgba32f, kSlicesWidth, kSlicesHeight);
        const ImageView view = found;
        ThreadPool pool{1, isa};
        run_shader(compile_shader(shader, shader.uniforms.words),
                   {.textures = both, .targets = {&view, 1}, .profile = profile}, pool);
        return found;
      };
      for (const NamedProfile& known : profiles()) {
        const Image expected = drawn("p.x & 1", known.profile, Isa::scalar);
        for (const Isa isa : available_isas()) {
          CAPTURE(sampler);
          CAPTURE(read);
          CAPTURE(known.name);
          CAPTURE(isa_name(isa));
          CHECK(first_difference(drawn("0", known.profile, isa), expected) == "");
        }
      }
    }
  }
}

TEST_CASE("textures of another shape than the shader's, and samplers that are none, are refused") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Texture volume = slices_of_noise(TextureShape::volume, 4, 2);
  const UserShader flat = slices_shader("sampler2D", "result = texture(t, uv);");
  CHECK_THROWS_WITH_AS(drawn_slices(flat, {.texture = &volume}, Isa::scalar),
                       "texture 0 is one of a sampler3D, and the shader reads a sampler2D",
                       ShaderError);
  CHECK(refusal_of("samplerCubeArray", "result = texture(t, vec4(uv, 1.0, 0.0));") ==
        "slices.frag:6: samplerCubeArray is not supported; samplerCube and sampler2DArray are");
}

TEST_CASE("a sampler1DArray reads the middle of a sampler2DArray's rows") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Texture texture = slices_of_noise(TextureShape::array, 9, 5);
  const ShaderTexture bound{.texture = &texture,
                            .sampler = {Filter::trilinear, Wrap::repeat, Wrap::repeat}};
  const std::pair<const char*, const char*> same[] = {
      {"result = texture(t, vec2(uv.x * 9.0, uv.y * 5.0));",
       "result = texture(t, vec3(uv.x * 9.0, 0.5, uv.y * 5.0));"},
      {"result = textureGrad(t, uv, 0.3, uv.y);",
       "result = textureGrad(t, vec3(uv.x, 0.5, uv.y), vec2(0.3, 0.0), vec2(uv.y, 0.0));"},
      {"result = texelFetch(t, ivec2(uv * 9.0), 1);",
       "result = texelFetch(t, ivec3(uv.x * 9.0, 0, uv.y * 9.0), 1);"},
      {"result = vec4(textureSize(t, 0), textureQueryLod(t, uv.x * 9.0));",
       "result = vec4(textureSize(t, 0).xz, textureQueryLod(t, vec2(uv.x * 9.0, 0.5)));"}};
  for (const auto& [of_line, of_layer] : same) {
    const UserShader line = slices_shader("sampler1DArray", of_line);
    const UserShader layer = slices_shader("sampler2DArray", of_layer);
    for (const Isa isa : available_isas()) {
      const Image expected = drawn_slices(layer, bound, isa);
      CHECK(first_difference(drawn_slices(line, bound, isa), expected) == "");
    }
  }
}

TEST_CASE("textureGather reads the four texels round a place, by every wrap and of every format") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const UserShader channel =
      slices_shader("sampler2D",
                    "vec2 at = uv * 7.3 - 3.1;\nif (uv.x > 0.95) at *= 1e30;\n"
                    "if (uv.x < 0.03) at = vec2(0.0) / 0.0;\nresult = textureGather(t, at, 1);");
  const UserShader shadow =
      slices_shader("sampler2DShadow", "result = textureGather(t, uv * 7.3 - 3.1, 0.5);");
  Random random{9};
  for (const glm::ivec2 sides : {glm::ivec2{8, 4}, {7, 5}, {1, 1}}) {
    const int width = sides.x, height = sides.y;
    for (const Format format : {Format::rgba8, Format::srgb8, Format::rgba16f, Format::rgba32f}) {
      Image image = make_image(format, width, height);
      for (int i = 0; i < width * height; ++i) {
        const auto number = [&] { return random.between(0.0f, 1.0f); };
        store_texel(image, i % width, i / width, {number(), number(), number(), number()}, {});
      }
      const Texture texture = make_texture(image);
      for (const Wrap wrap : {Wrap::repeat, Wrap::clamp_to_edge, Wrap::mirrored_repeat}) {
        const auto texel = [&](float u, float v, int right, int lower) {
          const auto first = [](float at, int size) {
            if (!std::isfinite(at)) at = 0.0f;
            const float texels = at * static_cast<float>(size) - 0.5f;
            return static_cast<int>(std::floor(std::clamp(texels, -0x1p22f, 0x1p22f)));
          };
          return fetch_texel(image, wrapped_index(first(u, width) + right, width, wrap),
                             wrapped_index(first(v, height) + lower, height, wrap), {});
        };
        const auto gathered = [&](float u, float v, const auto& number) {
          return glm::vec4{number(texel(u, v, 0, 1)), number(texel(u, v, 1, 1)),
                           number(texel(u, v, 1, 0)), number(texel(u, v, 0, 0))};
        };
        const ShaderTexture bound{.texture = &texture,
                                  .sampler = {.wrap_u = wrap, .wrap_v = wrap},
                                  .compare = Compare::greater};
        check_slices(channel, bound, [&](int x, int y) {
          const glm::vec2 uv = uv_of(x, y);
          glm::vec2 at{uv.x * 7.3f - 3.1f, uv.y * 7.3f - 3.1f};
          if (uv.x > 0.95f) at *= 1e30f;
          if (uv.x < 0.03f) at = glm::vec2{0.0f};
          return gathered(at.x, at.y, [](const glm::vec4& of) { return of.y; });
        });
        check_slices(shadow, bound, [&](int x, int y) {
          const glm::vec2 uv = uv_of(x, y);
          return gathered(uv.x * 7.3f - 3.1f, uv.y * 7.3f - 3.1f,
                          [](const glm::vec4& of) { return 0.5f > of.x ? 1.0f : 0.0f; });
        });
      }
    }
  }
}

TEST_CASE("textureGatherOffsets reads a texel for each of its offsets") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Texture texture = slices_of_noise(TextureShape::flat, 16, 1);
  const ShaderTexture bound{.texture = &texture, .sampler = {.wrap_u = Wrap::repeat}};
  const std::string offsets = "ivec2(1, 2), ivec2(-3, 0), ivec2(0, 4), ivec2(-7, -8)";
  std::string each = "result = vec4(";
  for (const char* one : {"1, 2", "-3, 0", "0, 4", "-7, -8"}) {
    each += std::string{"textureGatherOffset(t, uv, ivec2("} + one + "), 2).w, ";
  }
  each.replace(each.size() - 2, 2, ");");
  const UserShader all =
      slices_shader("sampler2D", "const ivec2 o[4] = ivec2[4](" + offsets +
                                     ");\nresult = textureGatherOffsets(t, uv, o, 2);");
  const UserShader single = slices_shader("sampler2D", each);
  for (const Isa isa : available_isas()) {
    const Image expected = drawn_slices(single, bound, isa);
    CHECK(first_difference(drawn_slices(all, bound, isa), expected) == "");
  }
}
