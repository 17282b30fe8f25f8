// What glslang has no stack, memory or time for, refused before it is asked.

#include <algorithm>
#include <array>
#include <cctype>
#include <unordered_map>

#include "raster/shaders/glsl/glsl_macros.h"

namespace softfocus {
namespace {

/// Of an expression, one inside the other: glslang walks them on the caller's stack.
constexpr double kMostOperators = 2000;
constexpr double kMostTokens = 1 << 19;  ///< some seconds of glslang's time
constexpr double kMostCases = 2000;
constexpr int kMostFunctions = 2000;           ///< each is compared with each, as cases are
constexpr double kMostMembers = kMostScalars;  ///< of a structure, with those inside
constexpr double kMostCompared = 1 << 22;      ///< numbers; an array's are compared one by one

/// The number that a word begins with, or 1.
double number_of(std::string_view word) {
  double number = 0;
  for (const char c : word) {
    if (std::isdigit(static_cast<unsigned char>(c)) == 0) break;
    number = 10 * number + (c - '0');
  }
  return std::max(number, 1.0);
}

/// Gives tokens the lines that `#line` says, and finds the file of each place.
class Places {
 public:
  Places(std::span<GlslToken> tokens, const std::string& name) : name_(name) {
    int shift = 0;
    for (std::size_t i = 0; i < tokens.size(); ++i) {
      if (tokens[i].is_first && tokens[i].text == "#" && i + 2 < tokens.size() &&
          tokens[i + 1].text == "line") {
        const int said = static_cast<int>(std::min(number_of(tokens[i + 2].text), kMostTokens));
        shift = said - tokens[i].line - 1;
        if (i + 3 < tokens.size() && tokens[i + 3].text.size() > 1 &&
            tokens[i + 3].text[0] == '"') {
          files_.push_back(tokens[i + 3].text);
        }
      }
      tokens[i].line += shift;
    }
  }

  [[noreturn]] void refuse(const GlslToken& token, const std::string& why) const {
    std::string file = name_;
    for (const std::string_view of : files_) {
      if (of.data() < token.text.data()) file = of.substr(1, of.size() - 2);
    }
    throw ShaderError(file + ":" + std::to_string(token.line) + ": " + why);
  }

 private:
  const std::string& name_;
  std::vector<std::string_view> files_{};  ///< with quotes, as they stand in the text
};

/// The members of the largest structure or elements of the largest array, as far as their lengths
/// are written as numbers.
double largest_value(const GlslMacros& macros, std::span<const GlslToken> tokens,
                     const Places& places) {
  std::unordered_map<std::string_view, double> structures;
  double largest = 1;
  const auto members_of = [&](std::string_view word) {
    double most = 1;
    for (const std::string_view meaning : macros.meanings(word)) {
      if (const auto at = structures.find(meaning); at != structures.end()) {
        most = std::max(most, at->second);
      }
    }
    return most;
  };
  /// Of `[2][3]` from `i` on, behind which it is left.
  const auto elements = [&](std::size_t& i) {
    double product = 1;
    while (i < tokens.size() && tokens[i].text == "[") {
      for (++i; i < tokens.size() && tokens[i].text != "]"; ++i) {
        double most = 1;
        for (const std::string_view meaning : macros.meanings(tokens[i].text)) {
          most = std::max(most, number_of(meaning));
        }
        product *= most;
      }
      ++i;
    }
    return product;
  };
  for (std::size_t i = 0; i < tokens.size();) {
    if (tokens[i].text == "[") {
      largest = std::max(largest, elements(i));
      continue;
    }
    if (tokens[i].text != "struct" || i + 2 >= tokens.size() || tokens[i + 2].text != "{") {
      ++i;
      continue;
    }
    const GlslToken& of = tokens[i + 1];
    double members = 0, of_type = 1, length = 1;
    for (i += 3; i < tokens.size() && tokens[i].text != "}";) {
      if (tokens[i].text == "[") {
        length *= elements(i);
        continue;
      }
      of_type = std::max(of_type, members_of(tokens[i].text));
      if (tokens[i].text == "," || tokens[i].text == ";") {
        members += of_type * length;
        length = 1;
        if (tokens[i].text == ";") of_type = 1;
      }
      ++i;
    }
    double& most = structures[of.text];
    most = std::max(most, members);
    largest = std::max(largest, members);
    if (members > kMostMembers) {
      places.refuse(of, "structure " + std::string(of.text) +
                            " has more than 65536 members, with those of its members");
    }
  }
  return largest;
}

}  // namespace

void check_limits(std::string_view text, const std::string& name) {
  std::vector<GlslToken> tokens = glsl_tokens(text);
  const Places places(tokens, name);
  const GlslMacros macros(tokens);
  GlslWeight sum;
  int functions = 0, depth = 0;
  for (const auto& part : macros.code) {
    if (part.empty()) continue;
    const GlslWeight of = macros.weight_of(part, [&](double operators, const GlslToken& token) {
      if (operators <= kMostOperators) return;
      places.refuse(token, "an expression of more than 2000 operators; it would have to be split");
    });
    sum.tokens += of.tokens;
    sum.cases += of.cases;
    sum.compared += of.compared;
    if (!(sum.tokens <= kMostTokens)) {
      places.refuse(part.front(), "macros make more than 524288 words and signs of the text");
    }
    if (!(sum.cases <= kMostCases)) places.refuse(part.front(), "more than 2000 cases");
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (part[i].text == "{" && depth++ == 0 && i > 0 && part[i - 1].text == ")") ++functions;
      if (part[i].text == "}") depth = std::max(0, depth - 1);
      // Arguments that are no constants end glslang.
      const bool is_barrier = part[i].text == "memoryBarrier" && i + 2 < part.size();
      if (is_barrier && part[i + 1].text == "(" && part[i + 2].text != ")") {
        places.refuse(part[i], "memoryBarrier() takes no arguments");
      }
      if (functions > kMostFunctions) places.refuse(part[i], "more than 2000 functions");
    }
  }
  if (!(sum.compared * largest_value(macros, tokens, places) <= kMostCompared)) {
    throw ShaderError(name + ": too many comparisons for arrays or structures of that size");
  }
}

void refuse_at_word(std::string_view text, const std::string& name, const std::string& why) {
  constexpr std::array<std::string_view, 11> kBegins{
      "image1D", "image2D", "image3D", "imageCube",     "iimage",          "uimage",
      "RW",      "subpass", "Subpass", "samplerBuffer", "StructuredBuffer"};
  std::vector<GlslToken> tokens = glsl_tokens(text);
  const Places places(tokens, name);
  for (const GlslToken& token : tokens) {
    const bool begins = std::any_of(kBegins.begin(), kBegins.end(), [&](std::string_view begin) {
      return token.text.starts_with(begin);
    });
    if (begins || token.text == "buffer" || token.text == "shared") places.refuse(token, why);
  }
  throw ShaderError(name + ": " + why);
}

}  // namespace softfocus
