#pragma once
// A shader over lanes, in every way that lanes run, against the oracle's pixels.

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "raster/images/texel.h"
#include "raster/shaders/shader.h"
#include "raster/shaders/simplify_tree.h"
#include "tests/support/random.h"
#include "tests/support/spirv_oracle.h"

namespace softfocus::test {

struct CheckResult {
  bool is_stopped = false;   ///< the oracle ran too many blocks: nothing is compared
  std::string difference{};  ///< the first, in words; empty if all bits are equal
};

inline constexpr glm::vec4 kBeforeShader{-7.0f, 2.0f, 0.0f, 1.0f};  ///< what killed pixels keep

inline Texture random_texture(Format format, int size, Random& random) {
  Image image = make_image(format, size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const auto number = [&] { return static_cast<float>(random.whole(-32, 64)) / 8.0f; };
      store_texel(image, x, y, {number(), number(), number(), number()}, {});
    }
  }
  return make_texture(std::move(image));
}

/// Small numbers, of a uniform's kind.
inline std::vector<std::uint32_t> random_uniforms(const ShaderUniforms& uniforms, Random& random) {
  std::vector<std::uint32_t> words = uniforms.words;
  for (const ShaderUniform& uniform : uniforms.all) {
    for (std::uint32_t i = uniform.first; i < uniform.first + uniform.words; ++i) {
      const int number = random.whole(-4, 9);
      if (uniform.kind == SpirvKind::floating) {
        words[i] = std::bit_cast<std::uint32_t>(static_cast<float>(number) / 2.0f);
      } else if (uniform.kind == SpirvKind::integer) {
        words[i] = static_cast<std::uint32_t>(number);
      } else if (uniform.kind == SpirvKind::boolean) {
        words[i] = number > 3 ? ~0u : 0u;
      }
    }
  }
  return words;
}

struct Expected {
  Image image{};
  bool is_stopped = false;
};

inline Expected expected_picture(const SpirvModule& module, OracleSettings& settings, int width,
                                 int height) {
  Expected made{make_image(Format::rgba32f, width, height)};
  for (int y = 0; y < height && !made.is_stopped; ++y) {
    for (int x = 0; x < width && !made.is_stopped; ++x) {
      settings.input = [&](const SpirvDecorations& of, std::uint32_t part) {
        const float at[4] = {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, 0.5f, 1};
        float value = 0.0f;
        if (of.builtin == static_cast<int>(SpirvBuiltin::frag_coord)) value = at[part];
        const float place[4] = {at[0] / static_cast<float>(width),
                                at[1] / static_cast<float>(height), 0.0f, 1.0f};
        if (of.builtin < 0) value = place[part];
        return std::bit_cast<std::uint32_t>(value);
      };
      const OracleResult result = run_oracle(module, settings);
      made.is_stopped = result.is_stopped;
      glm::vec4 texel = kBeforeShader;
      for (int i = 0; i < 4 && !result.is_killed; ++i) {
        texel[i] = std::bit_cast<float>(result.outputs[0][static_cast<std::size_t>(i)]);
      }
      store_texel(made.image, x, y, texel, settings.profile);
    }
  }
  return made;
}

/// "pixel 3, 1: 0.5 0.25 0 1, oracle: ...", or nothing.
inline std::string first_difference(const Image& found, const Image& expected) {
  for (int y = 0; y < found.height; ++y) {
    for (int x = 0; x < found.width; ++x) {
      const glm::vec4 a = load_texel(found, x, y), b = load_texel(expected, x, y);
      std::string text;
      for (int i = 0; i < 4; ++i) {
        if (std::bit_cast<std::uint32_t>(a[i]) == std::bit_cast<std::uint32_t>(b[i])) continue;
        text += " channel " + std::to_string(i) + " is " + std::to_string(a[i]) + ", not " +
                std::to_string(b[i]);
      }
      if (!text.empty()) {
        return "pixel " + std::to_string(x) + ", " + std::to_string(y) + ":" + text;
      }
    }
  }
  return {};
}

/// Compares a fragment shader's output 0: all vector units, several widths, sizes and numbers of
/// threads, simplified or not. Uniforms and textures are chosen by `seed`. Throws ShaderError.
inline CheckResult check_shader(const std::vector<std::uint32_t>& words, std::uint64_t seed) {
  Random random{seed};
  const UserShader shader = make_shader(words);
  const std::vector<std::uint32_t> uniforms = random_uniforms(shader.uniforms, random);
  const Format format = random.whole(0, 1) == 0 ? Format::rgba16f : Format::rgba32f;
  const Texture texture = random_texture(format, 8, random);
  const std::vector<ShaderTexture> textures(shader.uniforms.texture_count, {&texture, {}});

  ShaderTree tree = lower_spirv(*shader.module, uniforms);
  export_values(tree);
  const ShaderProgram plain = emit_program(tree);
  const ShaderProgram simplified = compile_shader(shader, uniforms);
  const ShaderProgram of_places = compile_shader(shader, uniforms, {}, true);

  constexpr std::array<std::array<int, 2>, 3> kSizes{{{131, 2}, {37, 3}, {1, 1}}};
  OracleSettings settings{.uniforms = uniforms, .textures = textures};
  for (const auto& [width, height] : kSizes) {
    const Expected expected = expected_picture(*shader.module, settings, width, height);
    if (expected.is_stopped) return {.is_stopped = true};
    for (const bool is_plain : {false, true}) {
      for (const Isa isa : available_isas()) {
        for (const int threads : {1, 3}) {
          ThreadPool pool{threads, isa};
          for (const int lanes : {32, 64, 128, 256}) {
            if (threads == 3 && lanes == 64) continue;
            Image found = make_image(Format::rgba32f, width, height);
            clear_image(found, kBeforeShader, {});
            const ImageView view = found;
            const ShaderPass pass{.textures = textures, .targets = {&view, 1}, .lanes = lanes};
            run_shader(is_plain                          ? plain
                       : (threads == 1) == (lanes < 128) ? simplified
                                                         : of_places,
                       pass, pool);
            const std::string difference = first_difference(found, expected.image);
            if (difference.empty()) continue;
            return {.difference = std::string{is_plain ? "not simplified, " : ""} +
                                  std::string{isa_name(isa)} + ", " + std::to_string(lanes) +
                                  " lanes, " + std::to_string(threads) + " threads, " +
                                  std::to_string(width) + "x" + std::to_string(height) + ": " +
                                  difference};
          }
        }
      }
    }
  }
  return {};
}

/// Compiles and runs any words over a few pixels. Throws ShaderError.
inline void run_any_shader(std::vector<std::uint32_t> words, Isa isa) {
  const UserShader shader = make_shader(std::move(words));
  const ShaderProgram program = compile_shader(shader, shader.uniforms.words);
  Random random;
  const Texture texture = random_texture(Format::rgba16f, 4, random);
  const std::vector<ShaderTexture> textures(std::min(shader.uniforms.texture_count, 4u),
                                            {&texture, {}});
  Image found = make_image(Format::rgba16f, 5, 3);
  const ImageView view = found;
  ThreadPool pool{1, isa};
  run_shader(program, {.textures = textures, .targets = {&view, 1}, .budget = 500, .lanes = 32},
             pool);
}

}  // namespace softfocus::test
