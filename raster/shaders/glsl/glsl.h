#pragma once
// GLSL as it is found in files, compiled to SPIR-V by glslang. Every version is read by its own
// rules; nothing is translated but the few lines that a convention puts around a shader.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raster/shaders/spirv_module.h"

namespace softfocus {

/// What stands around a shader where it comes from. `recognised` takes the first that fits:
///
/// | convention | if the text has |
/// |---|---|
/// | libretro | `#pragma stage` or `#pragma parameter`, or a condition on VERTEX or FRAGMENT |
/// | shadertoy | a function `mainImage`, and none `main` or an undeclared iResolution or iTime |
/// | gl_transitions | a function `transition`, and none `main` |
/// | three | an `#include <...>` of three.js'; or no `#version`, and vUv or tDiffuse, or in a
/// vertex
///   shader position, uv, modelViewMatrix or projectionMatrix undeclared |
/// | plain | anything else |
enum class GlslConvention : std::uint8_t {
  recognised,
  plain,
  shadertoy,
  three,
  libretro,
  gl_transitions
};

/// "plain", "shadertoy" and so on.
std::string_view name_of(GlslConvention convention);

struct GlslSource {
  ShaderStage stage = ShaderStage::fragment;
  std::string name{};  ///< for errors; its folder is where #include looks first
  std::string text{};
  GlslConvention convention = GlslConvention::recognised;
  std::map<std::string, std::string> defines{};
  /// Where #include looks next, in their order.
  std::vector<std::string> include_folders{};
  /// Types of the samplers that a convention declares, other than sampler2D: iChannel0 ->
  /// samplerCube.
  std::map<std::string, std::string> samplers{};
};

/// Reads a file that a shader includes: a path from the folder of the file that includes it, or
/// from an include folder. Nothing if it cannot be read, or must not.
using GlslReader = std::function<std::optional<std::string>(const std::string& path)>;

/// A value that a text offers to its user: gl-transitions' `uniform float a; // = 1.0`, libretro's
/// `#pragma parameter`. (A uniform's initialiser is in the SPIR-V.)
struct GlslParameter {
  std::string name{}, label{};
  std::vector<double> value{};           ///< one a component, or one for all
  double least = 0, most = 0, step = 0;  ///< step 0: not said
};

struct CompiledGlsl {
  /// For OpenGL (of libretro's .slang for Vulkan), with OpLine of the user's files. What GLSL
  /// leaves to linking has no Location or Binding, and is known by its name.
  std::vector<std::uint32_t> words{};
  GlslConvention convention{};       ///< never `recognised`
  std::vector<std::string> files{};  ///< that were included
  /// The shader for a driver: with its version, what it includes and what the convention declares.
  std::string text{};
  std::vector<GlslParameter> parameters{};
  std::vector<std::string> warnings{};  ///< "FILE:LINE: ..."
};

/// Why `#define NAME VALUE` cannot stand before a shader; empty if it can.
std::string definition_fault(std::string_view name, std::string_view value);

/// Adds the macro of a text "NAME", which is 1, or "NAME=VALUE"; a fault as definition_fault().
std::string add_definition(std::map<std::string, std::string>& defines, std::string_view text);

/// What a text may have at the most, with all that it includes.
inline constexpr std::size_t kMostGlslBytes = std::size_t{1} << 20;

/// A name that ends in .hlsl, or a text with SV_Target or SV_Position and no #version, is HLSL's,
/// of a function main(); it has no text for drivers. Throws ShaderError, "FILE:LINE: ...". Any
/// number of threads may call it at once. What would take glslang's stack or minutes is refused
/// beforehand (docs/shaders.md, "Limits").
CompiledGlsl compile_glsl(const GlslSource& source, const GlslReader& read);

/// Why this build compiles no GLSL; empty if it does.
std::string_view missing_glsl();

}  // namespace softfocus
