// What stands around shaders where they come from, and the versions that they are taken for.

#include <algorithm>
#include <cctype>
#include <iterator>

#include "raster/shaders/glsl/glsl_text.h"

namespace softfocus {
namespace {

constexpr GlslDeclared kShadertoyUniforms[] = {
    {"vec3", "iResolution"},
    {"float", "iTime"},
    {"float", "iGlobalTime"},
    {"float", "iTimeDelta"},
    {"float", "iFrameRate"},
    {"int", "iFrame"},
    {"vec4", "iMouse"},
    {"vec4", "iDate"},
    {"float", "iSampleRate"},
    {"float", "iChannelTime", "[4]"},
    {"vec3", "iChannelResolution", "[4]"},
    {"sampler2D", "iChannel0"},
    {"sampler2D", "iChannel1"},
    {"sampler2D", "iChannel2"},
    {"sampler2D", "iChannel3"},
};
constexpr GlslDeclared kTransitionUniforms[] = {
    {"float", "progress"}, {"float", "ratio"}, {"sampler2D", "from"}, {"sampler2D", "to"}};
/// What browsers let pass, or have switched on.
constexpr const char* kWebExtensions =
    R"(#extension GL_EXT_shader_non_constant_global_initializers : enable
#extension GL_EXT_shader_texture_lod : enable
)";
constexpr const char* kPrecisions = R"(precision highp float;
precision highp int;
)";
/// Of ES 3.00, that has no default for these.
constexpr const char* kSamplerPrecisions = R"(precision highp sampler2D;
precision highp sampler3D;
precision highp samplerCube;
precision highp sampler2DShadow;
precision highp samplerCubeShadow;
precision highp sampler2DArray;
precision highp sampler2DArrayShadow;
precision highp isampler2D;
precision highp isampler3D;
precision highp isamplerCube;
precision highp isampler2DArray;
precision highp usampler2D;
precision highp usampler3D;
precision highp usamplerCube;
precision highp usampler2DArray;
)";
/// ES 1.00's functions for a text of both versions, but those of GL_EXT_shader_texture_lod, which
/// glslang has. Macros of `texture` would not do: shaders name variables so.
constexpr const char* kOldTextures =
    R"(vec4 texture2D(sampler2D s, vec2 p) { return texture(s, p); }
vec4 textureCube(samplerCube s, vec3 p) { return texture(s, p); }
vec4 texture2DProj(sampler2D s, vec3 p) { return textureProj(s, p); }
vec4 texture2DProj(sampler2D s, vec4 p) { return textureProj(s, p); }
vec4 texture2DLod(sampler2D s, vec2 p, float l) { return textureLod(s, p, l); }
)";
constexpr const char* kOldTexturesOfFragments =
    R"(vec4 texture2D(sampler2D s, vec2 p, float b) { return texture(s, p, b); }
vec4 textureCube(samplerCube s, vec3 p, float b) { return texture(s, p, b); }
)";

/// Extensions, and the version of GLSL that has what they bring.
struct Extension {
  const char* name;
  int version;
};
constexpr Extension kExtensions[] = {
    {"GL_AMD_conservative_depth", 420},
    {"GL_ARB_arrays_of_arrays", 430},
    {"GL_ARB_conservative_depth", 420},
    {"GL_ARB_cull_distance", 450},
    {"GL_ARB_derivative_control", 450},
    {"GL_ARB_draw_instanced", 140},
    {"GL_ARB_enhanced_layouts", 440},
    {"GL_ARB_explicit_attrib_location", 330},
    {"GL_ARB_explicit_uniform_location", 430},
    {"GL_ARB_fragment_coord_conventions", 150},
    {"GL_ARB_gpu_shader5", 420},
    {"GL_ARB_sample_shading", 400},
    {"GL_ARB_separate_shader_objects", 410},
    {"GL_ARB_shader_bit_encoding", 330},
    {"GL_ARB_shader_texture_lod", 130},
    {"GL_ARB_shading_language_420pack", 420},
    {"GL_ARB_shading_language_packing", 420},
    {"GL_ARB_texture_cube_map_array", 400},
    {"GL_ARB_texture_gather", 400},
    {"GL_ARB_texture_multisample", 150},
    {"GL_ARB_texture_query_levels", 430},
    {"GL_ARB_texture_query_lod", 400},
    {"GL_ARB_texture_rectangle", 140},
    {"GL_ARB_uniform_buffer_object", 140},
    {"GL_EXT_gpu_shader4", 130},
    {"GL_EXT_texture_array", 130},
    {"GL_MESA_shader_integer_functions", 400},
};

/// A uniform, an input or an output of this name is declared, or a macro or parameter of main().
bool declares(std::span<const GlslToken> tokens, std::string_view name) {
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::string_view word = tokens[i].text;
    if (word == "define" && i > 0 && tokens[i - 1].text == "#" && i + 1 < tokens.size() &&
        tokens[i + 1].text == name) {
      return true;
    }
    if (word != "uniform" && word != "in" && word != "varying" && word != "attribute" &&
        word != "out") {
      continue;
    }
    bool is_block = false;
    for (++i; i < tokens.size(); ++i) {
      const std::string_view next = tokens[i].text;
      if (next == "{") is_block = true;
      if (next == "}") is_block = false;
      if ((next == ";" && !is_block) || next == ")") break;  // ")" ends a parameter
      if (next == name) return true;
    }
  }
  return false;
}

/// "[2](", or "float[2] name".
bool has_array_type(std::span<const GlslToken> tokens) {
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
    const char next = tokens[i + 1].text[0];
    if (tokens[i].text == "]" &&
        (next == '(' || std::isalpha(static_cast<unsigned char>(next)) != 0)) {
      return true;
    }
  }
  return false;
}

/// What GLSL has had from 1.10 on and ES never: a text with it is of a desktop.
bool has_desktop_words(std::span<const GlslToken> tokens) {
  for (const char* const word :
       {"sampler1D", "texture1D", "texture3D", "shadow1D", "shadow2D", "ftransform", "gl_Vertex",
        "gl_Normal", "gl_Color", "gl_FrontColor", "gl_TexCoord", "gl_MultiTexCoord0",
        "gl_ModelViewMatrix", "gl_ModelViewProjectionMatrix", "gl_NormalMatrix"}) {
    if (uses(tokens, word)) return true;
  }
  for (std::size_t i = 2; i < tokens.size(); ++i) {
    if (tokens[i - 2].text == "#" && tokens[i - 1].text == "extension" &&
        is_raising(tokens[i].text)) {
      return true;
    }
  }
  return false;
}

/// Functions and types that ES 1.00 has not.
bool has_es3_words(std::span<const GlslToken> tokens) {
  for (const char* const word :
       {"sampler3D", "sampler2DArray", "texelFetch", "textureLod", "textureSize", "textureGrad",
        "usampler2D", "isampler2D", "uint", "uvec2", "uvec3", "uvec4"}) {
    if (uses(tokens, word)) return true;
  }
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
    if (tokens[i].text == "texture" && tokens[i + 1].text == "(") return true;
  }
  return false;
}

/// ES 3.00 lets no function have a built-in's name, and glslang takes those of extensions that the
/// text has not switched on for built-in.
std::string renamed(std::span<const GlslToken> tokens) {
  std::string out;
  for (const char* const name :
       {"absoluteDifference", "addSaturate", "average", "averageRounded", "countLeadingZeros",
        "countTrailingZeros", "imageLoad", "imageStore", "multiply32x16", "subtractSaturate"}) {
    for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
      const std::string_view type = tokens[i].text;
      if (tokens[i + 1].text != name || tokens[i + 2].text != "(") continue;
      if (type != "float" && type != "int" && !type.substr(1).starts_with("vec") &&
          !type.starts_with("vec") && type != "void" && type != "bool") {
        continue;
      }
      out += "#define " + std::string(name) + " ";
      out += std::string(name) + "_\n";
      break;
    }
  }
  return out;
}

GlslSurroundings shadertoy(const GlslSource& source, std::span<const GlslToken> tokens,
                           const GlslVersion& version) {
  GlslSurroundings around;
  around.before = declarations("uniform", kShadertoyUniforms, source, tokens);
  if (lacks(tokens, "HW_PERFORMANCE") && !source.defines.contains("HW_PERFORMANCE")) {
    around.before += "#define HW_PERFORMANCE 1\n";
  }
  if (has_function(tokens, "void", "main")) return around;
  const char* const color = version.has_outputs() ? "softfocus_color" : "gl_FragColor";
  if (version.has_outputs()) around.before += "out vec4 softfocus_color;\n";
  around.after = "\nvoid main() { vec4 color = vec4(0.0); mainImage(color, gl_FragCoord.xy); ";
  around.after += std::string(color) + " = color; }\n";
  return around;
}

GlslSurroundings transition(const GlslSource& source, std::span<const GlslToken> tokens,
                            const GlslVersion& version) {
  GlslSurroundings around;
  const bool is_new = version.has_outputs();
  around.before = is_new ? "in vec2 _uv;\nout vec4 softfocus_color;\n" : "varying vec2 _uv;\n";
  for (const GlslDeclared& one : kTransitionUniforms) {
    if (declares(tokens, one.name)) continue;
    around.before += std::string("uniform ") + one.type;
    around.before += std::string(" ") + one.name + ";\n";
  }
  const std::string texture = is_new ? "texture" : "texture2D";
  around.before += "vec4 getFromColor(vec2 uv) { return " + texture + "(from, uv); }\n";
  around.before += "vec4 getToColor(vec2 uv) { return " + texture + "(to, uv); }\n";
  if (has_function(tokens, "void", "main")) return around;
  around.after = "\nvoid main() { ";
  around.after += is_new ? "softfocus_color" : "gl_FragColor";
  around.after += " = transition(_uv); }\n";
  static_cast<void>(source);
  return around;
}

}  // namespace

bool lacks(std::span<const GlslToken> tokens, std::string_view name) {
  return uses(tokens, name) && !declares(tokens, name);
}

std::string declarations(std::string_view qualifier, std::span<const GlslDeclared> all,
                         const GlslSource& source, std::span<const GlslToken> tokens) {
  std::string out;
  for (const GlslDeclared& one : all) {
    if (!lacks(tokens, one.name)) continue;
    std::string type = one.type;
    if (const auto found = source.samplers.find(one.name);
        found != source.samplers.end() && type == "sampler2D") {
      type = found->second;
    }
    out += qualifier;
    for (const std::string_view part :
         {std::string_view(" "), std::string_view(type), std::string_view(" "),
          std::string_view(one.name), std::string_view(one.array), std::string_view(";\n")}) {
      out += part;
    }
  }
  return out;
}

std::string_view name_of(GlslConvention convention) {
  switch (convention) {
    case GlslConvention::recognised: return "recognised";
    case GlslConvention::plain: return "plain";
    case GlslConvention::shadertoy: return "shadertoy";
    case GlslConvention::three: return "three";
    case GlslConvention::libretro: return "libretro";
    case GlslConvention::gl_transitions: return "gl-transitions";
  }
  return "";
}

bool has_stage_condition(std::span<const GlslToken> tokens) {
  for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
    const std::string_view word = tokens[i + 1].text;
    if (tokens[i].text != "#" || (word != "if" && word != "ifdef" && word != "elif")) continue;
    for (std::size_t k = i + 2; k < tokens.size() && tokens[k].line == tokens[i].line; ++k) {
      if (tokens[k].text == "VERTEX" || tokens[k].text == "FRAGMENT") return true;
    }
  }
  return false;
}

GlslConvention recognise(ShaderStage stage, std::span<const GlslToken> tokens, bool has_version) {
  for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
    if (tokens[i].text != "#" || !tokens[i].is_first) continue;
    const std::string_view word = tokens[i + 1].text, next = tokens[i + 2].text;
    if (word == "pragma" && (next == "stage" || next == "parameter")) {
      return GlslConvention::libretro;
    }
  }
  if (has_stage_condition(tokens)) return GlslConvention::libretro;
  const bool has_main = has_function(tokens, "void", "main");
  if (stage == ShaderStage::fragment) {
    if (has_function(tokens, "void", "mainImage") &&
        (!has_main || lacks(tokens, "iResolution") || lacks(tokens, "iTime"))) {
      return GlslConvention::shadertoy;
    }
    if (!has_main && has_function(tokens, "vec4", "transition")) {
      return GlslConvention::gl_transitions;
    }
  }
  if (has_version) return GlslConvention::plain;
  if (uses(tokens, "vUv") || uses(tokens, "tDiffuse")) return GlslConvention::three;
  // It mixes both versions of ES, which three.js and its like allow.
  if ((has_es3_words(tokens) || has_array_type(tokens)) && !has_desktop_words(tokens) &&
      (uses(tokens, "varying") || uses(tokens, "gl_FragColor"))) {
    return GlslConvention::three;
  }
  for (const char* const name : {"modelViewMatrix", "projectionMatrix", "position", "uv"}) {
    if (stage == ShaderStage::vertex && lacks(tokens, name)) return GlslConvention::three;
  }
  return GlslConvention::plain;
}

bool is_raising(std::string_view extension) {
  return std::any_of(std::begin(kExtensions), std::end(kExtensions),
                     [&](const Extension& one) { return extension == one.name; });
}

GlslVersion raised_version(const GlslVersion& version, GlslConvention convention,
                           std::span<const GlslToken> tokens) {
  if (version.is_es) return version;
  int number =
      convention == GlslConvention::libretro ? std::max(version.number, 330) : version.number;
  for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
    if (tokens[i].text != "#" || tokens[i + 1].text != "extension") continue;
    for (const Extension& one : kExtensions) {
      if (tokens[i + 2].text == one.name) number = std::max(number, one.version);
    }
  }
  if (number == version.number) return version;
  return {number, false, number >= 150 ? "compatibility" : ""};
}

namespace {

/// Inputs and outputs as `in` and `out`, which are parameters' in versions before 1.30.
bool has_global_outputs(std::span<const GlslToken> tokens) {
  int depth = 0;
  for (const GlslToken& token : tokens) {
    if (token.text == "{" || token.text == "(") ++depth;
    if (token.text == "}" || token.text == ")") --depth;
    if (depth == 0 && (token.text == "in" || token.text == "out")) return true;
  }
  return false;
}

}  // namespace

GlslVersion version_of(GlslConvention convention, std::span<const GlslToken> tokens) {
  GlslVersion es3{300, true, "es"}, es1{100, true, ""};
  switch (convention) {
    case GlslConvention::shadertoy: return es3;
    case GlslConvention::three:  // ES 3.00 has a function of that name
      return declares(tokens, "texture") && !has_es3_words(tokens) ? es1 : es3;
    case GlslConvention::gl_transitions: return has_array_type(tokens) ? es3 : es1;
    case GlslConvention::libretro: return {130, false, ""};
    default: break;
  }
  // Precisions are WebGL's, whose version without a #version is ES 1.00.
  for (const char* const word : {"precision", "highp", "mediump", "lowp", "GL_ES"}) {
    if (uses(tokens, word)) {
      return has_es3_words(tokens) || has_global_outputs(tokens) ? es3 : es1;
    }
  }
  if (uses(tokens, "precise")) return {400, false, "core"};
  if (has_global_outputs(tokens)) return {330, false, "core"};
  return {110, false, ""};
}

GlslSurroundings glsl_surroundings(GlslConvention convention, const GlslSource& source,
                                   std::span<const GlslToken> tokens, const GlslVersion& version,
                                   bool is_web) {
  GlslSurroundings around;
  if (convention == GlslConvention::shadertoy) around = shadertoy(source, tokens, version);
  if (convention == GlslConvention::gl_transitions) around = transition(source, tokens, version);
  if (convention == GlslConvention::three) around = three_surroundings(source, tokens, version);
  if (convention == GlslConvention::libretro) {
    for (const char* const name :
         {source.stage == ShaderStage::vertex ? "VERTEX" : "FRAGMENT", "PARAMETER_UNIFORM"}) {
      if (!source.defines.contains(name)) around.before.append("#define ").append(name) += '\n';
    }
    if (!version.is_es && version.number < 420) {
      around.before = "#extension GL_ARB_shading_language_420pack : enable\n" + around.before;
    }
  }
  // WebGL's compilers take what is not constant there.
  if (version.is_es) {
    around.before =
        "#extension GL_EXT_shader_non_constant_global_initializers : enable\n" + around.before;
  }
  // Reserved in ES 3.00, and browsers take it all the same.
  if (version.is_es && version.number < 320 && convention == GlslConvention::plain &&
      uses(tokens, "sample")) {
    around.before += "#define sample sample_\n";
  }
  // glslang knows these, and makes no SPIR-V of them. Noise is 0 with every driver.
  if (!version.is_es && uses(tokens, "ftransform")) {
    around.before += "#define ftransform() (gl_ModelViewProjectionMatrix * gl_Vertex)\n";
  }
  for (const char* const size : {"1", "2", "3", "4"}) {
    const std::string name = std::string("noise") + size;
    const std::string type = *size == '1' ? "float" : std::string("vec") + size;
    if (version.is_es || !uses(tokens, name) || has_function(tokens, type, name)) continue;
    for (const std::string_view part :
         {std::string_view("#define "), std::string_view(name), std::string_view("(x) "),
          std::string_view(type), std::string_view("(0.0)\n")}) {
      around.before += part;
    }
  }
  if (uses(tokens, "textureQueryLOD")) around.before += "#define textureQueryLOD textureQueryLod\n";
  if (version.is_es && version.number >= 300) around.before = renamed(tokens) + around.before;
  if (version.is_es && (is_web || convention != GlslConvention::plain)) {
    if (uses(tokens, "sample") && convention != GlslConvention::plain) {
      around.before = "#define sample sample_\n" + around.before;
    }
    std::string front = kWebExtensions;
    front += kPrecisions;
    if (version.number >= 300) {
      front += kSamplerPrecisions;
      // Drivers let no function of ES 3.00 have the name of one that is built into ES 1.00.
      std::string names;
      bool uses_old = false;
      for (const std::string old : {"texture2D", "textureCube", "texture2DProj", "texture2DLod"}) {
        uses_old = uses_old || uses(tokens, old);
        if (declares(tokens, old) || source.defines.contains(old)) continue;
        names.append("#define ").append(old) += " softfocus_" + old + "\n";
      }
      if (uses_old) {
        front += names + kOldTextures;
        if (source.stage == ShaderStage::fragment) front += kOldTexturesOfFragments;
      }
    }
    around.before = front + around.before;
  }
  return around;
}

}  // namespace softfocus
