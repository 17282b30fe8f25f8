// Any text as GLSL: a ShaderError, or pixels. The first byte chooses the convention, the stage, and
// whether there are definitions.

#include <string>

#include "raster/shaders/glsl/glsl.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/support/shader_checks.h"

int softfocus::fuzz_glsl(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  GlslSource source{.stage = data[0] / 6 % 8 == 7 ? ShaderStage::vertex : ShaderStage::fragment,
                    .name = "fuzz.glsl",
                    .text{reinterpret_cast<const char*>(data) + 1, size - 1},
                    .convention = static_cast<GlslConvention>(data[0] % 6),
                    .include_folders = {"b"}};
  if (data[0] >= 192) source.defines = {{"A", "texture2D"}, {"B", "iTime"}, {"vUv", "A(t, uv)"}};
  const auto read = [](const std::string& path) {
    return path == "a" || path == "b/b" ? std::optional<std::string>{"float included;\n"}
                                        : std::nullopt;
  };
  try {
    CompiledGlsl compiled = compile_glsl(source, read);
    if (source.stage == ShaderStage::fragment) {
      test::run_any_shader(std::move(compiled.words), Isa::baseline);
    }
    return counted(true, data, size);
  } catch (const ShaderError&) {
    return counted(false, data, size);
  }
}
