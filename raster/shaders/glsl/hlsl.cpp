// HLSL, as far as glslang has to be helped with it.

#include <algorithm>
#include <array>
#include <cctype>

#include "raster/shaders/glsl/glsl_text.h"

namespace softfocus {
namespace {

/// What one thread's stack holds, with room: a level takes some kilobytes of it.
constexpr int kDeepestHlsl = 500;

bool is_any_of(std::string_view word, std::span<const std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

constexpr std::array<std::string_view, 16> kOld{
    "tex1D",       "tex2D",     "tex3D",     "texCUBE",     "tex2Dlod",  "tex3Dlod",
    "texCUBElod",  "tex2Dbias", "tex3Dbias", "texCUBEbias", "tex2Dgrad", "tex3Dgrad",
    "texCUBEgrad", "tex2Dproj", "tex3Dproj", "texCUBEproj"};

}  // namespace

bool is_hlsl(const GlslSource& source) {
  if (source.name.ends_with(".hlsl")) return true;
  if (source.convention != GlslConvention::recognised) return false;
  const std::vector<GlslToken> tokens = glsl_tokens(source.text);
  const auto is_semantic = [](const GlslToken& token) {
    std::string word{token.text};
    std::transform(word.begin(), word.end(), word.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return word.starts_with("SV_TARGET") || word == "SV_POSITION";
  };
  const auto says_version = [](const GlslToken& sign, const GlslToken& word) {
    return sign.text == "#" && word.text == "version";
  };
  return std::any_of(tokens.begin(), tokens.end(), is_semantic) &&
         std::adjacent_find(tokens.begin(), tokens.end(), says_version) == tokens.end();
}

std::string hlsl_surroundings(std::span<const GlslToken> tokens) {
  const bool is_old = std::any_of(tokens.begin(), tokens.end(), [](const GlslToken& token) {
    return is_any_of(token.text, kOld);
  });
  if (!is_old) return {};
  // glslang gives such a sampler no texture. Here it is a texture, with one sampler for all.
  return "SamplerState softfocus_sampler;\n"
         "#define sampler Texture2D\n"
         "#define sampler2D Texture2D\n"
         "#define sampler3D Texture3D\n"
         "#define samplerCUBE TextureCube\n"
         "#define tex2D(s, at) s.Sample(softfocus_sampler, at)\n"
         "#define tex3D(s, at) s.Sample(softfocus_sampler, at)\n"
         "#define texCUBE(s, at) s.Sample(softfocus_sampler, at)\n"
         "#define tex2Dlod(s, at) s.SampleLevel(softfocus_sampler, (at).xy, (at).w)\n"
         "#define tex3Dlod(s, at) s.SampleLevel(softfocus_sampler, (at).xyz, (at).w)\n"
         "#define texCUBElod(s, at) s.SampleLevel(softfocus_sampler, (at).xyz, (at).w)\n"
         "#define tex2Dbias(s, at) s.SampleBias(softfocus_sampler, (at).xy, (at).w)\n"
         "#define tex2Dgrad(s, at, x, y) s.SampleGrad(softfocus_sampler, at, x, y)\n"
         "#define tex2Dproj(s, at) s.Sample(softfocus_sampler, (at).xy / (at).w)\n";
}

void check_hlsl_nesting(std::string_view text, const std::string& name) {
  constexpr std::array<std::string_view, 3> kOpen{"(", "[", "{"}, kClose{")", "]", "}"};
  // Of each bracket that is open, the levels about it; behind them those of the statement.
  std::vector<int> about{0};
  int depth = 0;
  for (const GlslToken& token : glsl_tokens(text)) {
    if (is_any_of(token.text, kOpen)) {
      about.push_back(++depth);
    } else if (is_any_of(token.text, kClose)) {
      depth = std::max(0, about.back() - 1);
      if (about.size() > 1) about.pop_back();
      if (token.text == "}") depth = about.back();
    } else if (token.text == ";" || token.text == ",") {
      depth = about.back();
    } else if (token.text == "else") {
      depth = ++about.back();
    } else {
      const auto first = static_cast<unsigned char>(token.text.front());
      const bool is_word = std::isalnum(first) != 0 || first == '_';
      const bool nests = token.text == "if" || token.text == "for" || token.text == "while" ||
                         token.text == "do" || token.text == "switch";
      if ((!is_word && token.text != ".") || nests) ++depth;
    }
    if (depth > kDeepestHlsl) {
      throw ShaderError(name + ": HLSL of more than " + std::to_string(kDeepestHlsl) +
                        " operators, brackets and branches, one inside the other");
    }
  }
}

}  // namespace softfocus
