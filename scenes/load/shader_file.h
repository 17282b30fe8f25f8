#pragma once
// A user's shader from a file: GLSL, with what it includes, or SPIR-V.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "raster/numbers/parameter.h"
#include "raster/shaders/glsl/glsl.h"

namespace softfocus {

inline constexpr std::array kGlslConventions{
    Choice<GlslConvention>{"plain", GlslConvention::plain},
    Choice<GlslConvention>{"shadertoy", GlslConvention::shadertoy},
    Choice<GlslConvention>{"three", GlslConvention::three},
    Choice<GlslConvention>{"libretro", GlslConvention::libretro},
    Choice<GlslConvention>{"gl-transitions", GlslConvention::gl_transitions}};

struct OpenedShader {
  std::vector<std::uint32_t> words{};  ///< SPIR-V
  GlslConvention convention = GlslConvention::plain;
  std::vector<GlslParameter> parameters{};
  std::vector<std::string> warnings{};
  std::string text{};                ///< for a driver; empty of SPIR-V
  std::vector<std::string> files{};  ///< that were read
};

/// Throws SceneError for a file that cannot be read, ShaderError for one that is no shader.
OpenedShader open_shader(const std::filesystem::path& file, GlslConvention convention,
                         ShaderStage stage = ShaderStage::fragment);

/// GLSL that is in no file; `name` is for errors.
OpenedShader open_shader_text(std::string name, std::string text, GlslConvention convention,
                              ShaderStage stage = ShaderStage::fragment);

}  // namespace softfocus
