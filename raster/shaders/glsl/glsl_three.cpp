// What three.js puts around the shaders of its passes. The formulas of its helpers are well known;
// the text is ours.

#include <algorithm>
#include <iterator>

#include "raster/shaders/glsl/glsl_text.h"

namespace softfocus {
namespace {

constexpr GlslDeclared kThreeUniforms[] = {
    {"mat4", "viewMatrix"},   {"vec3", "cameraPosition"},      {"bool", "isOrthographic"},
    {"mat4", "modelMatrix"},  {"mat4", "modelViewMatrix"},     {"mat4", "projectionMatrix"},
    {"mat3", "normalMatrix"}, {"sampler2D", "tDiffuse"},       {"sampler2D", "tDepth"},
    {"float", "cameraNear"},  {"float", "cameraFar"},          {"vec2", "resolution"},
    {"float", "time"},        {"float", "toneMappingExposure"}};
constexpr GlslDeclared kThreeAttributes[] = {{"vec3", "position"}, {"vec3", "normal"},
                                             {"vec2", "uv"},       {"vec4", "tangent"},
                                             {"vec4", "color"},    {"vec2", "uv1"}};

constexpr const char* kThreeCommon = R"(#ifndef PI
#define PI 3.141592653589793
#endif
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate(x) clamp(x, 0.0, 1.0)
#endif
#define whiteComplement(x) (1.0 - saturate(x))
float pow2(const in float x) { return x * x; }
vec3 pow2(const in vec3 x) { return x * x; }
float pow3(const in float x) { return x * x * x; }
float pow4(const in float x) { return (x * x) * (x * x); }
float max3(const in vec3 v) { return max(v.x, max(v.y, v.z)); }
float average(const in vec3 v) { return dot(v, vec3(1.0 / 3.0)); }
highp float rand(const in vec2 p) {
  return fract(sin(mod(dot(p, vec2(12.9898, 78.233)), PI)) * 43758.5453);
}
float precisionSafeLength(vec3 v) { return length(v); }
vec3 transformDirection(in vec3 v, in mat4 m) { return normalize((m * vec4(v, 0.0)).xyz); }
vec3 inverseTransformDirection(in vec3 v, in mat4 m) { return normalize((vec4(v, 0.0) * m).xyz); }
bool isPerspectiveMatrix(mat4 m) { return m[2][3] == -1.0; }
)";
/// Depth 0 at -near, 1 at -far; viewZ is negative in front of the camera. The largest part of a
/// packed depth is in the first channel.
constexpr const char* kThreePacking =
    R"(vec3 packNormalToRGB(const in vec3 n) { return normalize(n) * 0.5 + 0.5; }
vec3 unpackRGBToNormal(const in vec3 c) { return 2.0 * c - 1.0; }
float unpackRGBAToDepth(const in vec4 c) {
  return dot(c, vec4(255.0 / 256.0, 255.0 / 65536.0, 255.0 / 16777216.0, 1.0 / 16777216.0));
}
float unpackRGBToDepth(const in vec3 c) {
  return dot(c, vec3(255.0 / 256.0, 255.0 / 65536.0, 1.0 / 65536.0));
}
float unpackRGToDepth(const in vec2 c) { return dot(c, vec2(255.0 / 256.0, 1.0 / 256.0)); }
vec4 packDepthToRGBA(const in float depth) {
  if (depth <= 0.0) return vec4(0.0);
  if (depth >= 1.0) return vec4(1.0);
  float first = floor(depth * 256.0), rest = fract(depth * 256.0);
  float second = floor(rest * 256.0);
  rest = fract(rest * 256.0);
  return vec4(first / 255.0, second / 255.0, floor(rest * 256.0) / 255.0, fract(rest * 256.0));
}
vec3 packDepthToRGB(const in float depth) {
  if (depth <= 0.0) return vec3(0.0);
  if (depth >= 1.0) return vec3(1.0);
  float first = floor(depth * 256.0), rest = fract(depth * 256.0) * 256.0;
  return vec3(first / 255.0, floor(rest) / 255.0, fract(rest));
}
vec2 packDepthToRG(const in float depth) {
  if (depth <= 0.0) return vec2(0.0);
  if (depth >= 1.0) return vec2(1.0);
  return vec2(floor(depth * 256.0) / 255.0, fract(depth * 256.0));
}
vec4 pack2HalfToRGBA(const in vec2 v) {
  vec2 low = fract(v * 255.0);
  return vec4(v.x - low.x / 255.0, low.x, v.y - low.y / 255.0, low.y);
}
vec2 unpackRGBATo2Half(const in vec4 c) { return c.xz + c.yw / 255.0; }
float viewZToOrthographicDepth(const in float z, const in float near, const in float far) {
  return (z + near) / (near - far);
}
float orthographicDepthToViewZ(const in float depth, const in float near, const in float far) {
  return depth * (near - far) - near;
}
float viewZToPerspectiveDepth(const in float z, const in float near, const in float far) {
  return (near + z) * far / ((far - near) * z);
}
float perspectiveDepthToViewZ(const in float depth, const in float near, const in float far) {
  return near * far / ((far - near) * depth - far);
}
)";
struct Include {
  const char* name;
  const char* text;
};
constexpr Include kThreeIncludes[] = {
    {"common", kThreeCommon},
    {"packing", kThreePacking},
    {"begin_vertex", "vec3 transformed = vec3(position);\n"},
    {"beginnormal_vertex", "vec3 objectNormal = vec3(normal);\n"},
    {"defaultnormal_vertex", "vec3 transformedNormal = normalMatrix * objectNormal;\n"},
    {"project_vertex",
     "vec4 mvPosition = modelViewMatrix * vec4(transformed, 1.0);\n"
     "gl_Position = projectionMatrix * mvPosition;\n"},
};

/// Parts of three.js' materials that hold nothing unless JavaScript defines something; and a pass
/// draws into a linear target, where three.js changes neither tones nor colours.
constexpr std::string_view kEmptyIncludes[] = {"alphahash",
                                               "alphamap",
                                               "alphatest",
                                               "aomap",
                                               "batching",
                                               "color",
                                               "colorspace",
                                               "dithering",
                                               "displacementmap",
                                               "clipping_planes",
                                               "emissivemap",
                                               "encodings",
                                               "fog",
                                               "logdepthbuf",
                                               "map",
                                               "morphcolor",
                                               "morphnormal",
                                               "morphtarget",
                                               "premultiplied_alpha",
                                               "skinbase",
                                               "skinning",
                                               "skinnormal",
                                               "tonemapping",
                                               "uv"};

/// What three.js puts in front of every fragment shader. Its output is linear, as that of a pass
/// is.
constexpr Include kThreeHelpers[] = {
    {"luminance",
     "float luminance(const in vec3 c) { return dot(c, vec3(0.2126729, 0.7151522, 0.072175)); }\n"},
    {"linearToOutputTexel", "vec4 linearToOutputTexel(vec4 c) { return c; }\n"},
    {"sRGBTransferOETF",
     "vec4 sRGBTransferOETF(in vec4 c) {\n"
     "  vec3 curve = pow(c.rgb, vec3(1.0 / 2.4)) * 1.055 - 0.055;\n"
     "  return vec4(mix(curve, c.rgb * 12.92, vec3(lessThanEqual(c.rgb, vec3(0.0031308)))), c.a);\n"
     "}\n"},
    {"sRGBTransferEOTF",
     "vec4 sRGBTransferEOTF(in vec4 c) {\n"
     "  vec3 curve = pow((c.rgb + 0.055) / 1.055, vec3(2.4));\n"
     "  return vec4(mix(curve, c.rgb / 12.92, vec3(lessThanEqual(c.rgb, vec3(0.04045)))), c.a);\n"
     "}\n"},
};

/// An output that the text declares, outside of parentheses.
bool has_output(std::span<const GlslToken> tokens) {
  int depth = 0;
  for (const GlslToken& token : tokens) {
    depth += static_cast<int>(token.text == "(") - static_cast<int>(token.text == ")");
    if (depth == 0 && token.text == "out") return true;
  }
  return false;
}

}  // namespace

const char* three_include(std::string_view name) {
  for (const Include& include : kThreeIncludes) {
    if (include.name == name) return include.text;
  }
  for (const std::string_view end : {"_pars_fragment", "_pars_vertex", "_fragment", "_vertex"}) {
    if (!name.ends_with(end)) continue;
    name.remove_suffix(end.size());
    const auto* const end_of_names = std::end(kEmptyIncludes);
    return std::find(std::begin(kEmptyIncludes), end_of_names, name) != end_of_names ? "" : nullptr;
  }
  return nullptr;
}

GlslSurroundings three_surroundings(const GlslSource& source, std::span<const GlslToken> tokens,
                                    const GlslVersion& version) {
  GlslSurroundings around;
  const bool is_new = version.has_outputs(), is_vertex = source.stage == ShaderStage::vertex;
  if (is_new) {
    around.before += is_vertex ? "#define attribute in\n#define varying out\n"
                               : "#define varying in\n#define gl_FragDepthEXT gl_FragDepth\n";
    if (!is_vertex && !has_output(tokens)) {
      around.before += "out highp vec4 pc_fragColor;\n#define gl_FragColor pc_fragColor\n";
    }
  }
  for (const Include& helper : kThreeHelpers) {
    if (uses(tokens, helper.name) && !has_function(tokens, "float", helper.name) &&
        !has_function(tokens, "vec4", helper.name)) {
      around.before += helper.text;
    }
  }
  around.before += declarations("uniform", kThreeUniforms, source, tokens);
  if (is_vertex) {
    around.before += declarations(is_new ? "in" : "attribute", kThreeAttributes, source, tokens);
  } else if (lacks(tokens, "vUv")) {
    around.before += is_new ? "in vec2 vUv;\n" : "varying vec2 vUv;\n";
  }
  return around;
}

}  // namespace softfocus
