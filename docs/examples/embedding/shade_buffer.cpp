// A shader on a picture in memory, by the software GPU: the corners darken. Prints a hash of the
// result's floats, which is the same on every machine.
#include <softfocus/glsl.h>
#include <softfocus/shaders.h>

#include <bit>
#include <cstdio>
#include <vector>

using namespace softfocus;

constexpr const char* kShader = R"(#version 330
uniform sampler2D picture;
uniform float strength;
out vec4 colour;
void main() {
  vec2 at = gl_FragCoord.xy / vec2(textureSize(picture, 0));
  vec2 from_middle = at - 0.5;
  colour = texture(picture, at) * (1.0 - strength * dot(from_middle, from_middle));
})";

int main() try {
  constexpr int kWidth = 250, kHeight = 130;
  Image picture = make_image(Format::rgba8, kWidth, kHeight);  // the program's own
  for (int y = 0; y < kHeight; ++y) {
    const auto codes = row<std::uint8_t>(picture, y);
    for (std::size_t i = 0; i < codes.size(); ++i) {
      codes[i] = static_cast<std::uint8_t>(i / 4 * (i % 4 + 1) ^ static_cast<std::size_t>(y));
    }
  }
  const Texture texture = make_texture(std::move(picture));

  const GlslSource source{.name = "corners.frag", .text = kShader};
  UserShader shader =
      make_shader(compile_glsl(source, [](const std::string&) { return std::nullopt; }).words);
  std::vector<std::uint32_t> uniforms = shader.uniforms.words;
  uniforms[find_uniform(shader, "strength")->first] = std::bit_cast<std::uint32_t>(1.5f);
  const ShaderProgram program = compile_shader(shader, uniforms);  // runs as often as one likes

  std::vector<float> result(4 * kWidth * kHeight);
  const ImageView target = view_of(Format::rgba32f, result.data(), kWidth, kHeight);
  const std::vector<ShaderTexture> textures{{&texture, {Filter::bilinear}}};
  ThreadPool pool(hardware_threads());
  run_shader(program, {.textures = textures, .targets = {&target, 1}}, pool);

  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const float value : result)
    hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 1099511628211u;
  std::printf("%016llx\n", static_cast<unsigned long long>(hash));
} catch (const ShaderError& error) {
  std::puts(error.what());  // FILE:LINE: what, and what would be right
  return 1;
}
