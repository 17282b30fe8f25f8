#pragma once
// A user's shader from a file: GLSL, with what it includes, or SPIR-V.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
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

/// How to read a shader: what its file leaves open.
struct ShaderReading {
  ShaderStage stage = ShaderStage::fragment;
  GlslConvention convention = GlslConvention::recognised;
  std::map<std::string, std::string> defines{};
  std::vector<std::string> include_folders{};  ///< as GlslSource has them
  bool is_of_several = false;  ///< files: SPIR-V is not refused for macros that others take
};

struct Section;

/// The keys `defines` (texts, whole numbers, or flags, as 1 or 0) and `include` of a pass or a
/// material, whose file is in the folder. Throws SceneError.
ShaderReading read_shader_keys(Section& section, const std::filesystem::path& folder);

/// Throws SceneError for a file that cannot be read, ShaderError for one that is no shader.
OpenedShader open_shader(const std::filesystem::path& file, const ShaderReading& reading = {});

/// GLSL that is in no file; `name` is for errors.
OpenedShader open_shader_text(std::string name, std::string text,
                              const ShaderReading& reading = {});

}  // namespace softfocus
