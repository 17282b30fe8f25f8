#include "raster/shaders/glsl/glsl.h"

#ifdef SOFTFOCUS_WITH_GLSL

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "raster/shaders/glsl/glsl_text.h"
#include "raster/shaders/spirv_module.h"

namespace softfocus {
namespace {

constexpr std::size_t kMostWarnings = 20;
constexpr std::uint32_t kSpirv10 = 0x10000;
/// glslang's name for what stands in front of the first string.
constexpr std::string_view kSurroundings = "what a convention puts around the text";

/// glslang's tables for a process: made once, and kept until it ends.
struct GlslangProcess {
  GlslangProcess() { glslang::InitializeProcess(); }
  ~GlslangProcess() { glslang::FinalizeProcess(); }
  GlslangProcess(const GlslangProcess&) = delete;
  GlslangProcess& operator=(const GlslangProcess&) = delete;
};

/// "FILE:12: 'x' : undeclared identifier" of "ERROR: FILE:12: 'x' : undeclared identifier", and a
/// source string's number as the file's name.
std::string said_of(std::string_view message, const std::string& name) {
  std::size_t end = 0;
  while ((end = message.find(':', end)) != std::string_view::npos) {
    std::size_t digit = ++end;
    while (digit < message.size() &&
           std::isdigit(static_cast<unsigned char>(message[digit])) != 0) {
      ++digit;
    }
    if (digit == end || digit >= message.size() || message[digit] != ':') continue;
    const std::string_view file = message.substr(0, end - 1);
    const bool is_number = file.find_first_not_of("-0123456789") == std::string_view::npos;
    std::string out;
    if (is_number && file.starts_with('-')) {
      out = name + ": in " + std::string(kSurroundings);
    } else {
      out = is_number ? name : std::string(file);
      out += message.substr(end - 1, digit - end + 1);
    }
    std::string said(message.substr(digit));
    if (const std::size_t colon = said.find("' : "); colon != std::string::npos) {
      said.erase(colon + 1, 1);
    }
    if (said.starts_with(": '': ")) said.erase(2, 4);
    while (!said.empty() && said.back() == ' ') said.pop_back();
    return out + said;
  }
  return name + ": " + std::string(message);
}

struct Messages {
  std::string first_error{};
  int errors = 0;
  std::vector<std::string> warnings{};
};

void add_messages(std::string_view log, const std::string& name, Messages& messages) {
  while (!log.empty()) {
    const std::string_view line = log.substr(0, log.find('\n'));
    log.remove_prefix(std::min(log.size(), line.size() + 1));
    if (line.starts_with("WARNING: ")) {
      if (line.starts_with("WARNING: -1:")) continue;  // of what stands around the text
      if (messages.warnings.size() < kMostWarnings) {
        messages.warnings.push_back(said_of(line.substr(9), name));
      }
    } else if (line.starts_with("ERROR: ")) {
      if (line.find("compilation errors.") != std::string_view::npos ||
          line.find("compilation terminated") != std::string_view::npos) {
        continue;
      }
      if (messages.errors++ == 0) messages.first_error = said_of(line.substr(7), name);
    }
  }
}

[[noreturn]] void refuse(const Messages& messages, const GlslText& text, const std::string& name) {
  std::string why = messages.first_error;
  if (why.find("Missing entry point") != std::string::npos) {
    why = name + ": no function main()";
    if (text.convention == GlslConvention::plain) why += ", mainImage() or transition()";
  } else if (why.empty()) {
    why = name + ": glslang refuses it, and does not say why";
  } else if (messages.errors > 1) {
    why += " (and " + std::to_string(messages.errors - 1) + " more)";
  }
  if (const std::size_t found = why.find(kMissingInclude); found != std::string::npos) {
    std::size_t number = 0;
    // A user's text may have the word, too.
    const std::size_t digits = std::min(found + kMissingInclude.size() + 1, why.size());
    const bool is_number =
        std::from_chars(why.data() + digits, why.data() + why.size(), number).ec == std::errc{};
    const std::size_t error = why.rfind("'#error': ", found);
    if (is_number && number < text.missing_includes.size() && error != std::string::npos) {
      throw ShaderError(why.substr(0, error) + text.missing_includes[number]);
    }
  }
  if (text.convention != GlslConvention::plain) {
    why += " (taken as " + std::string(name_of(text.convention)) + ")";
  } else if (!text.said_version) {
    const int number = text.taken_as.number;
    why += " (no #version: taken as GLSL ";
    if (text.taken_as.is_es) why += "ES ";
    why += std::to_string(number / 100) + "." + std::to_string(number / 10 % 10) + "0)";
  }
  throw ShaderError(why);
}

/// The length of what stands before all code, to the last `#extension` and its `#endif`.
std::size_t length_of_head(std::string_view text) {
  std::size_t head = 0;
  int conditions = 0;
  bool has_extension = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    std::string_view line = text.substr(begin, end - begin);
    line.remove_prefix(std::min(line.find_first_not_of(" \t\r\n"), line.size()));
    if (!line.empty() && !line.starts_with("#") && !line.starts_with("//")) break;
    begin = end;
    if (line.starts_with("#if")) ++conditions;
    if (line.starts_with("#endif")) --conditions;
    has_extension = has_extension || line.starts_with("#extension");
    if (has_extension && conditions == 0) head = end;
  }
  return head;
}

/// Drivers know no names in `#line`, and want `#extension` before all else. They need no profile
/// that the source does not name. Mesa's compute `mediump` of ES with halves; here it is binary32.
std::string text_for_drivers(const GlslText& text, const std::string& source) {
  std::string extensions, rest;
  int conditions = 0;
  const auto add = [&](std::string_view from) {
    const std::size_t behind_head = from.size() - (from == text.text ? length_of_head(from) : 0);
    while (!from.empty()) {
      const bool is_in_head = from.size() > behind_head;
      std::string_view line = from.substr(0, from.find('\n'));
      from.remove_prefix(std::min(from.size(), line.size() + 1));
      if (line.starts_with("#line ")) line = line.substr(0, line.find(" \""));
      if (line == "layout(std140) uniform;" ||
          line == "#extension GL_GOOGLE_include_directive : enable") {
        continue;
      }
      if (line.starts_with("#if")) ++conditions;
      if (line.starts_with("#endif")) --conditions;
      const bool is_extension = line.starts_with("#extension") && conditions == 0;
      const bool is_first =
          is_extension || (is_in_head && line.starts_with("#") && !line.starts_with("#line"));
      if (is_first) extensions.append(line).append("\n");
      rest.append(is_first ? "" : line).append("\n");  // later lines keep their numbers
    }
  };
  for (const std::string* part : {&text.before, &text.text, &text.after}) add(*part);
  if (text.taken_as.is_es) {
    extensions += "#define mediump highp\n#define lowp highp\n";
    // Else they are lowp, too. No #extension may stand behind.
    if (rest.find("#extension") == rest.npos) {
      extensions += "precision highp sampler2D;\nprecision highp samplerCube;\n";
    }
  }
  std::string version = text.version.substr(std::min(text.version.find('#'), text.version.size()));
  constexpr std::string_view kProfile = " compatibility";
  const std::size_t at = version.find(kProfile);
  const std::size_t line = std::min(source.find("#version"), source.size());
  const bool is_said =
      source.substr(line, source.find('\n', line) - line).find(kProfile) != source.npos;
  if (at != version.npos && !is_said) version.erase(at, kProfile.size());
  return version + extensions + rest;
}

CompiledGlsl compiled(const GlslSource& source, GlslText text, bool is_relaxed) {
  const EShLanguage stage = source.stage == ShaderStage::vertex ? EShLangVertex : EShLangFragment;
  glslang::TShader shader(stage);
  const char* const strings[] = {text.version.c_str(), text.text.c_str(), text.after.c_str()};
  const int lengths[] = {static_cast<int>(text.version.size()), static_cast<int>(text.text.size()),
                         static_cast<int>(text.after.size())};
  const std::string around(kSurroundings);
  const char* const names[] = {source.name.c_str(), source.name.c_str(), around.c_str()};
  shader.setStringsWithLengthsAndNames(strings, lengths, names, 3);
  shader.setPreamble(text.before.c_str());
  // OpenGL's GLSL is parsed without the rules for SPIR-V, which know neither versions below 1.40
  // and ES 3.10 nor the compatibility profile, and want a location of everything. What comes out
  // can be said in SPIR-V all the same.
  int rules = EShMsgDebugInfo | (is_relaxed ? EShMsgRelaxedErrors : EShMsgDefault);
  if (text.is_vulkan || text.is_hlsl) {
    const auto language = text.is_hlsl ? glslang::EShSourceHlsl : glslang::EShSourceGlsl;
    shader.setEnvInput(language, stage, glslang::EShClientVulkan, 100);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_0);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_0);
    rules |= EShMsgSpvRules | EShMsgVulkanRules;
  }
  if (text.is_hlsl) {
    rules |= EShMsgReadHlsl | EShMsgHlslOffsets;
    shader.setEntryPoint("main");
    shader.setAutoMapBindings(true);
    shader.setAutoMapLocations(true);
  }
  const auto flags = static_cast<EShMessages>(rules);

  CompiledGlsl out;
  Messages messages;
  if (text.is_hlsl) {
    std::string expanded;
    glslang::TShader::ForbidIncluder none;
    if (shader.preprocess(GetDefaultResources(), 110, ENoProfile, false, false, flags, &expanded,
                          none)) {
      check_hlsl_nesting(expanded, source.name);
    }
  }
  const bool is_parsed = shader.parse(GetDefaultResources(), 110, false, flags);
  add_messages(shader.getInfoLog(), source.name, messages);
  if (!is_parsed) refuse(messages, text, source.name);
  glslang::TProgram program;
  program.addShader(&shader);
  const bool is_linked = program.link(flags);
  add_messages(program.getInfoLog(), source.name, messages);
  if (!is_linked) refuse(messages, text, source.name);
  const auto is_lost = [](const std::string& warning) {
    return warning.find("Entry point not found") != std::string::npos;
  };
  if (text.is_hlsl && std::any_of(messages.warnings.begin(), messages.warnings.end(), is_lost)) {
    throw ShaderError(source.name + ": no function main()");
  }

  glslang::SpvOptions options;
  options.generateDebugInfo = true;
  spv::SpvBuildLogger logger;
  glslang::GlslangToSpv(*program.getIntermediate(stage), out.words, &logger, &options);
  add_messages(logger.getAllMessages(), source.name, messages);
  if (out.words.size() < 5) refuse(messages, text, source.name);
  out.words[1] = kSpirv10;
  try {
    read_spirv(out.words);
  } catch (const ShaderError& error) {
    const std::string why = error.what();
    for (std::size_t at = 0; (at = why.find(':', at)) != why.npos;) {  // "FILE:LINE: why"
      const std::size_t behind = why.find_first_not_of("0123456789", ++at);
      if (behind != why.npos && behind > at && why[behind] == ':') throw;
    }
    refuse_at_word(text.text, source.name, why);
  }
  out.convention = text.convention;
  if (!text.is_hlsl) out.text = text_for_drivers(text, source.text);
  out.files = std::move(text.files);
  out.parameters = std::move(text.parameters);
  out.warnings = std::move(messages.warnings);
  return out;
}

}  // namespace

std::string_view missing_glsl() { return {}; }

CompiledGlsl compile_glsl(const GlslSource& source, const GlslReader& read) {
  static const GlslangProcess process;
  try {
    return compiled(source, glsl_text(source, read), false);
  } catch (const ShaderError& error) {
    // What drivers take and glslang, by the letter, refuses. If that fails too, the first error
    // says more.
    const std::string_view why = error.what();
    const bool is_relaxable =
        why.find("when expanded from macros") != std::string_view::npos ||
        why.find("'floating-point suffix'") != std::string_view::npos ||
        why.find("'#define': names containing consecutive") != std::string_view::npos;
    // Which functions a constant may be made with; since 4.20 any.
    constexpr int kInitialisers = 420;
    const bool is_constant = why.find("'non-constant initializer'") != std::string_view::npos;
    // min() and the like of ints are there since 1.30, the compatibility profile since 1.50.
    constexpr int kFunctionsOfInts = 150;
    const bool is_function = why.find("no matching overloaded function") != std::string_view::npos;
    const int least = is_constant ? kInitialisers : is_function ? kFunctionsOfInts : 0;
    GlslText raised = glsl_text(source, read, true, least);
    if (!is_relaxable && !raised.is_raised) throw;
    try {
      CompiledGlsl made = compiled(source, std::move(raised), is_relaxable);
      // Drivers know the extensions.
      if (!made.text.empty()) made.text = text_for_drivers(glsl_text(source, read), source.text);
      return made;
    } catch (const ShaderError&) {
    }
    throw;
  }
}

}  // namespace softfocus

#else

namespace softfocus {

std::string_view missing_glsl() {
  return "built without glslang, which compiles GLSL (Debian: glslang-dev); SPIR-V files are read";
}

CompiledGlsl compile_glsl(const GlslSource& source, const GlslReader& /*read*/) {
  throw ShaderError(source.name + ": " + std::string(missing_glsl()));
}

}  // namespace softfocus

#endif
