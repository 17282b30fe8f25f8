#pragma once
// From a user's file to the texts that a GLSL compiler is given, without the compiler: what is
// cleaned, included, recognised and put around it.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raster/shaders/glsl/glsl.h"

namespace softfocus {

struct GlslVersion {
  int number = 0;  ///< 0: not said
  bool is_es = false;
  std::string profile{};  ///< as written
  bool has_blocks() const { return number >= (is_es ? 300 : 140); }
  /// in, out and texture() in place of varying, gl_FragColor and texture2D().
  bool has_outputs() const { return number >= (is_es ? 300 : 130); }
};

/// A word, number, string or sign, outside of comments.
struct GlslToken {
  std::string_view text{};
  int line = 1;
  bool is_first = false;  ///< of its line
};

/// Of a text that outlives them.
std::vector<GlslToken> glsl_tokens(std::string_view text);

bool uses(std::span<const GlslToken> tokens, std::string_view word);

/// "[qualifier] returns name(" occurs.
bool has_function(std::span<const GlslToken> tokens, std::string_view returns,
                  std::string_view name);

/// Parts in the order in which a compiler reads them.
struct GlslText {
  std::string version{}, before{}, text{}, after{};
  GlslConvention convention{};
  GlslVersion taken_as{};
  bool said_version = false;
  bool is_vulkan = false;
  bool is_hlsl = false;
  std::vector<std::string> files{};
  std::vector<GlslParameter> parameters{};
  /// Why the files of "#error kMissingInclude N" cannot be had.
  std::vector<std::string> missing_includes{};
  bool is_raised = false;
};
constexpr std::string_view kMissingInclude = "softfocus_missing_include";

/// A condition on VERTEX or FRAGMENT, by which libretro's .glsl files tell their stages apart.
bool has_stage_condition(std::span<const GlslToken> tokens);

/// Throws ShaderError. `raise`: to a later version, in whose compatibility profile stands what the
/// text's extensions bring and glslang knows of no earlier version; to `least` at the least, if
/// that is not 0. GlslText::is_raised says whether there is one.
GlslText glsl_text(const GlslSource& source, const GlslReader& read, bool raise = false,
                   int least = 0);

/// Throws ShaderError for what glslang would take too much stack, memory or time for: macros that
/// grow without end, expressions and structures too deep. `text`: all that a compiler is given.
void check_limits(std::string_view text, const std::string& name);

/// Throws ShaderError for what SPIR-V gives no line for: that of the first word which images that
/// are written, buffers and their kin are declared with, or of the file alone.
[[noreturn]] void refuse_at_word(std::string_view text, const std::string& name,
                                 const std::string& why);

/// What a convention declares for a shader that uses it and does not declare it itself. `is_web`:
/// of no version, which browsers' engines put in front with the precisions.
struct GlslSurroundings {
  std::string before{}, after{};
};
GlslSurroundings glsl_surroundings(GlslConvention convention, const GlslSource& source,
                                   std::span<const GlslToken> tokens, const GlslVersion& version,
                                   bool is_web);

/// By a file's name, or by the semantics of Direct3D 10 in a text without a #version.
bool is_hlsl(const GlslSource& source);

/// What HLSL of D3D9 needs before it: samplers with their textures, tex2D() and its kin.
std::string hlsl_surroundings(std::span<const GlslToken> tokens);

/// Throws ShaderError for HLSL, without macros, that is nested deeper than glslang's stack allows:
/// it reads HLSL by functions that call each other. `text` has #line.
void check_hlsl_nesting(std::string_view text, const std::string& name);

/// What `recognised` is; `has_version`: the text has a #version.
GlslConvention recognise(ShaderStage stage, std::span<const GlslToken> tokens, bool has_version);

/// The version that has the extensions that the text asks for, if it is above `version`.
GlslVersion raised_version(const GlslVersion& version, GlslConvention convention,
                           std::span<const GlslToken> tokens);
/// An extension that raised_version() counts.
bool is_raising(std::string_view extension);

/// The version of a text that says none.
GlslVersion version_of(GlslConvention convention, std::span<const GlslToken> tokens);

struct GlslDeclared {
  const char* type;
  const char* name;
  const char* array = "";
};

/// The name is used, and declared as no uniform, input, output or macro.
bool lacks(std::span<const GlslToken> tokens, std::string_view name);

/// Declarations of those that the text lacks.
std::string declarations(std::string_view qualifier, std::span<const GlslDeclared> all,
                         const GlslSource& source, std::span<const GlslToken> tokens);

GlslSurroundings three_surroundings(const GlslSource& source, std::span<const GlslToken> tokens,
                                    const GlslVersion& version);

/// What three.js' `#include <name>` is; nullptr if nothing.
const char* three_include(std::string_view name);

}  // namespace softfocus
