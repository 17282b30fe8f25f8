#include "raster/shaders/glsl/glsl_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <set>

namespace softfocus {
namespace {

constexpr std::string_view kOldTextureNames[] = {"texture1D",   "texture2D", "texture3D",
                                                 "textureCube", "shadow1D",  "shadow2D"};

constexpr int kMostIncludes = 1000, kMostIncludeDepth = 32;
/// Stands before a line number, until the version says what `#line` means.
constexpr char kLineMark = '\1';

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

std::string at(std::string_view name, int line) {
  std::string place(name);
  place += ':';
  place += std::to_string(line);
  return place + ": ";
}

/// Line ends become '\n', no-break spaces and control characters spaces; a byte-order mark goes.
std::string cleaned(std::string_view text, const std::string& name) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    throw ShaderError(at(name, 1) + "the text is UTF-16; it would have to be UTF-8");
  }
  std::string out;
  out.reserve(text.size() + 1);
  int line = 1;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte == '\n' || byte == '\r') {
      if (byte == '\r' && i + 1 < text.size() && text[i + 1] == '\n') ++i;
      out += '\n';
      ++line;
    } else if (byte == 0) {
      throw ShaderError(at(name, line) + "a byte of value 0; this is no text");
    } else if (byte < ' ' && byte != '\t') {
      out += ' ';
    } else if (byte == 0xC2 && i + 1 < text.size() && text[i + 1] == '\xA0') {
      out += ' ';
      ++i;
    } else if (text.substr(i).starts_with("\xE2\x80\x8B") ||
               text.substr(i).starts_with("\xEF\xBB\xBF")) {
      i += 2;  // a space without width
    } else {
      out += text[i];
    }
  }
  return out;
}

/// The same with comments as spaces, of the same length and lines.
std::string without_comments(std::string text) {
  for (std::size_t i = 0; i + 1 < text.size();) {
    if (text[i] == '"') {
      do {
        ++i;
      } while (i < text.size() && text[i] != '"' && text[i] != '\n');
      ++i;
      continue;
    }
    if (text[i] != '/' || (text[i + 1] != '/' && text[i + 1] != '*')) {
      ++i;
      continue;
    }
    const bool is_block = text[i + 1] == '*';
    std::size_t end = is_block ? text.find("*/", i + 2) : text.find('\n', i);
    end = end == std::string::npos ? text.size() : end + (is_block ? 2 : 0);
    for (; i < end; ++i) {
      if (text[i] != '\n') text[i] = ' ';
    }
  }
  return text;
}

/// Joins lines that end in a backslash, and makes up for their number behind them. Before GLSL 4.20
/// and ES 3.00 a comment to the end of a line does not go on, and glslang refuses the backslash:
/// it becomes a blank.
std::string spliced(const std::string& text, bool comments_go_on = false) {
  if (text.find("\\\n") == std::string::npos) return text;
  const std::string bare = without_comments(text);
  std::string out;
  std::size_t owed = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool ends_line = text[i] == '\\' && i + 1 < text.size() && text[i + 1] == '\n';
    if (ends_line && (comments_go_on || bare[i] == '\\')) {
      ++owed;
      ++i;
      continue;
    }
    out += ends_line ? ' ' : text[i];
    if (text[i] == '\n') {
      out.append(owed, '\n');
      owed = 0;
    }
  }
  return out;
}

std::string_view next_line(std::string_view text, std::size_t& from) {
  const std::size_t end = std::min(text.find('\n', from), text.size());
  const std::string_view line = text.substr(from, end - from);
  from = end + 1;
  return line;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) != 0) {
    text.remove_prefix(1);
  }
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) {
    text.remove_suffix(1);
  }
  return text;
}

/// What follows "# word" if the line is that directive.
std::optional<std::string_view> directive(std::string_view line, std::string_view word) {
  line = trimmed(line);
  if (!line.starts_with('#')) return {};
  line = trimmed(line.substr(1));
  if (!line.starts_with(word)) return {};
  line.remove_prefix(word.size());
  if (!line.empty() && is_word(line.front())) return {};
  return trimmed(line);
}

/// A name as it can stand in `#line`.
std::string quoted(std::string name) {
  for (char& c : name) {
    if (c == '"' || c == '\\' || c == '\n' || c == '\r' || c == kLineMark) c = '_';
  }
  return "\"" + name + "\"";
}

std::string line_directive(int line, const std::string& name) {
  return std::string("#line ") + kLineMark + std::to_string(line) + " " + quoted(name) + "\n";
}

/// Puts included files where they are included. A file that cannot be had is an error where the
/// preprocessor comes past it, not behind an #if that leaves it out.
class Includes {
 public:
  Includes(const GlslReader& read, const std::vector<std::string>& folders,
           std::vector<std::string>& files)
      : read_(read), folders_(folders), files_(files) {}

  std::string expanded(const std::string& text, const std::string& name) {
    bytes_ += text.size();
    if (bytes_ > kMostGlslBytes) {
      throw ShaderError(at(name, 1) + "the text is longer than " +
                        std::to_string(kMostGlslBytes >> 10) + " KiB with all that it includes");
    }
    const std::string bare = without_comments(text);
    std::string out;
    chain_.push_back(name);
    std::size_t from = 0, bare_from = 0;
    for (int line = 1; from < text.size(); ++line) {
      const std::string_view whole = next_line(text, from);
      const auto header = directive(next_line(bare, bare_from), "include");
      if (header) {
        out += included(*header, name, line);
        out += line_directive(line + 1, name);
      } else {
        out += whole;
        out += '\n';
      }
    }
    chain_.pop_back();
    return out;
  }

  bool includes_three = false;  ///< a text of three_include()
  std::vector<std::string> missing{};

 private:
  std::string included(std::string_view header, const std::string& includer, int line) {
    const bool is_quoted = header.size() > 2 && header.front() == '"' && header.back() == '"';
    const bool is_angled = header.size() > 2 && header.front() == '<' && header.back() == '>';
    // OpenGL's own #include has no such form, but programs that include by themselves take it.
    const bool is_bare = header.find_first_of("\"<> \t") == header.npos && !header.empty();
    const auto error = [&](const std::string& why) {
      missing.push_back(why);
      return line_directive(line, includer) + "#error " + std::string(kMissingInclude) + " " +
             std::to_string(missing.size() - 1) + "\n";
    };
    if (!is_quoted && !is_angled && !is_bare) return error("#include wants \"FILE\"");
    const std::string wanted(is_bare ? header : header.substr(1, header.size() - 2));
    if (is_angled) {
      if (const char* const ours = three_include(wanted)) {
        includes_three = true;
        return line_directive(1, "<" + wanted + ">") + ours;
      }
    }
    if (wanted.front() == '/' || wanted.find(':') != std::string::npos) {
      return error("#include " + wanted + ": the path must be relative");
    }
    if (chain_.size() >= kMostIncludeDepth || ++count_ > kMostIncludes) {
      return error("#include " + wanted + ": too many files include others");
    }
    std::string tried;
    for (std::size_t i = 0; i <= folders_.size(); ++i) {
      std::filesystem::path folder = std::filesystem::path(includer).parent_path();
      if (i > 0) folder = folders_[i - 1];
      const std::string path = (folder / wanted).lexically_normal().generic_string();
      tried += (i == 0 ? "" : i < folders_.size() ? ", " : " or ") + path;
      if (std::find(chain_.begin(), chain_.end(), path) != chain_.end()) {
        return error("#include " + wanted + ": the file includes itself");
      }
      const std::optional<std::string> text = read_ ? read_(path) : std::nullopt;
      if (!text) continue;
      if (std::find(files_.begin(), files_.end(), path) == files_.end()) files_.push_back(path);
      return line_directive(1, path) + expanded(cleaned(*text, path), path);
    }
    return error("#include " + wanted + ": cannot read " + tried +
                 (is_angled ? ", and it is none of three.js' that are known here" : ""));
  }

  const GlslReader& read_;
  const std::vector<std::string>& folders_;
  std::vector<std::string>& files_;
  std::vector<std::string> chain_{};
  std::size_t bytes_ = 0;
  int count_ = 0;
};

/// Of a .slang file the lines of one stage, others empty.
std::string stage_of(const std::string& text, ShaderStage stage) {
  const std::string_view wanted = stage == ShaderStage::vertex ? "vertex" : "fragment";
  std::string out;
  bool is_wanted = true;
  for (std::size_t from = 0; from < text.size();) {
    const std::string_view line = next_line(text, from);
    const auto pragma = directive(line, "pragma");
    if (pragma && pragma->starts_with("stage")) is_wanted = trimmed(pragma->substr(5)) == wanted;
    if (is_wanted || line.find(kLineMark) != std::string_view::npos) out += line;
    out += '\n';
  }
  return out;
}

/// The number that a text begins with, which is taken off; nothing if it begins with none.
std::optional<double> take_number(std::string_view& text) {
  double number = 0.0;
#ifdef __cpp_lib_to_chars
  const char* const begin = text.data();
  const auto [end, error] = std::from_chars(begin, begin + text.size(), number);
  if (error != std::errc{}) return {};
  text.remove_prefix(static_cast<std::size_t>(end - begin));
#else  // WebAssembly's library has it for whole numbers alone
  const std::string copy{text};
  char* end = nullptr;
  number = std::strtod(copy.c_str(), &end);
  if (end == copy.c_str()) return {};
  text.remove_prefix(static_cast<std::size_t>(end - copy.c_str()));
#endif
  return number;
}

/// Numbers of "vec2(1.0, -2)", "0.5" or "true".
std::vector<double> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  if (text.starts_with("true") || text.starts_with("false")) return {text[0] == 't' ? 1.0 : 0.0};
  if (const std::size_t open = text.find('('); open != std::string_view::npos) {
    text = text.substr(open + 1, text.find(')') - open - 1);
  }
  while (!text.empty()) {
    text = trimmed(text);
    if (text.starts_with('+')) text.remove_prefix(1);
    const std::optional<double> number = take_number(text);
    if (!number) break;
    numbers.push_back(*number);
    text = trimmed(text);
    if (text.starts_with('f')) text = trimmed(text.substr(1));
    if (!text.starts_with(',')) break;
    text.remove_prefix(1);
  }
  return numbers;
}

/// `uniform float a; // = 1.0` and `uniform float a /* = 1.0 */;`
std::optional<GlslParameter> commented_default(std::string_view line) {
  line = trimmed(line);
  if (!line.starts_with("uniform ")) return {};
  std::size_t comment = line.find("//");
  if (comment == std::string_view::npos) comment = line.find("/*");
  if (comment == std::string_view::npos) return {};
  std::string_view said = trimmed(line.substr(comment + 2));
  if (!said.starts_with('=')) return {};
  said = trimmed(said.substr(1));
  std::string_view declared = trimmed(line.substr(0, comment));
  while (!declared.empty() && !is_word(declared.back())) declared.remove_suffix(1);
  std::size_t begin = declared.size();
  while (begin > 0 && is_word(declared[begin - 1])) --begin;
  GlslParameter parameter;
  parameter.name = declared.substr(begin);
  parameter.value = numbers_of(said);
  if (parameter.name.empty() || parameter.value.empty()) return {};
  return parameter;
}

/// `#pragma parameter NAME "label" default least most step`
std::optional<GlslParameter> pragma_parameter(std::string_view line) {
  const auto pragma = directive(line, "pragma");
  if (!pragma || !pragma->starts_with("parameter ")) return {};
  std::string_view rest = trimmed(pragma->substr(10));
  const std::size_t open = rest.find('"'), close = rest.rfind('"');
  if (open == std::string_view::npos || close == open) return {};
  GlslParameter parameter;
  parameter.name = trimmed(rest.substr(0, open));
  parameter.label = rest.substr(open + 1, close - open - 1);
  rest.remove_prefix(close + 1);
  std::array<double, 4> values{};  // default, least, most, step
  for (double& value : values) {
    rest = trimmed(rest);
    const std::optional<double> number = take_number(rest);
    if (!number) break;
    value = *number;
    rest = rest.substr(std::min(rest.size(), rest.find_first_of(" \t")));
  }
  parameter.value = {values[0]};
  parameter.least = values[1];
  parameter.most = values[2];
  parameter.step = values[3];
  return parameter;
}

/// The #version, if nothing but comments stands in front.
GlslVersion said_version(std::span<const GlslToken> tokens, const std::string& name) {
  GlslVersion version;
  if (tokens.size() < 2 || tokens[0].text != "#" || tokens[1].text != "version") return version;
  const int line = tokens[0].line;
  std::string written;
  for (std::size_t i = 2; i < tokens.size() && tokens[i].line == line; ++i) {
    if (i == 3) version.profile = tokens[i].text;
    written += ' ';
    written += tokens[i].text;
  }
  if (tokens.size() > 2) {
    const std::string_view number = tokens[2].text;
    std::from_chars(number.data(), number.data() + number.size(), version.number);
  }
  const int n = version.number;
  version.is_es = version.profile == "es" || n == 100;
  const bool is_known =
      version.profile == "es"
          ? n == 300 || n == 310 || n == 320
          : n % 10 == 0 && ((n >= 100 && n <= 150) || n == 330 || (n >= 400 && n <= 460)) &&
                (version.profile.empty() ||
                 (n >= 150 && (version.profile == "core" || version.profile == "compatibility")));
  if (!is_known) {
    throw ShaderError(at(name, line) + "#version" + written +
                      "; there are 100, 110 to 460, 300 es, 310 es and 320 es");
  }
  return version;
}

bool is_vulkan(std::span<const GlslToken> tokens) {
  for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
    if (tokens[i].text != "layout") continue;
    for (++i; i + 1 < tokens.size() && tokens[i].text != ")"; ++i) {
      if (tokens[i].text == "push_constant" || tokens[i].text == "constant_id" ||
          tokens[i].text == "input_attachment_index") {
        return true;
      }
      if (tokens[i].text == "set" && tokens[i + 1].text == "=") return true;
    }
  }
  return false;
}

/// An extension whose types glslang accepts and then fails on.
GlslToken refused_extension(std::span<const GlslToken> tokens) {
  for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
    if (tokens[i].text == "#" && tokens[i + 1].text == "extension" &&
        tokens[i + 2].text == "GL_ARB_bindless_texture") {
      return tokens[i + 2];
    }
  }
  return {};
}

/// Functions such as texture2D() are there in core profiles before 4.20, too, but glslang makes
/// SPIR-V of them in the compatibility profile alone.
bool wants_compatibility(std::span<const GlslToken> tokens, const GlslVersion& version) {
  if (version.is_es || version.number < 150 || version.number >= 420) return false;
  for (std::size_t i = 1; i < tokens.size(); ++i) {
    if (tokens[i - 1].text == "#" && tokens[i].text == "#") return true;  // may make such a name
  }
  return std::any_of(tokens.begin(), tokens.end(), [](const GlslToken& token) {
    return std::any_of(std::begin(kOldTextureNames), std::end(kOldTextureNames),
                       [&](std::string_view begin) { return token.text.starts_with(begin); });
  });
}

/// Lines that switch on what a raised version has are left empty.
std::string without_raising(const std::string& text) {
  std::string out;
  for (std::size_t from = 0; from < text.size();) {
    const std::string_view line = next_line(text, from);
    const auto extension = directive(line, "extension");
    if (!extension || !is_raising(extension->substr(0, extension->find_first_of(" \t:")))) {
      out += line;
    }
    out += '\n';
  }
  return out;
}

/// Layouts that are left to the implementation are std140.
std::string with_known_layouts(const std::string& text) {
  std::string out;
  std::size_t done = 0;
  const std::vector<GlslToken> tokens = glsl_tokens(text);
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
    if (tokens[i].text != "layout" || tokens[i + 1].text != "(") continue;
    for (i += 2; i < tokens.size() && tokens[i].text != ")"; ++i) {
      if (tokens[i].text != "shared" && tokens[i].text != "packed") continue;
      const auto begin = static_cast<std::size_t>(tokens[i].text.data() - text.data());
      out += text.substr(done, begin - done);
      out += "std140";
      done = begin + tokens[i].text.size();
    }
  }
  return out + text.substr(done);
}

std::string with_lines(const std::string& text, bool sets_next) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != kLineMark) {
      out += text[i];
      continue;
    }
    int line = 0;
    const char* const begin = text.data() + i + 1;
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), line);
    out += std::to_string(sets_next ? line : line - 1);
    i += static_cast<std::size_t>(end - begin);
  }
  return out;
}

}  // namespace

std::vector<GlslToken> glsl_tokens(std::string_view text) {
  std::vector<GlslToken> tokens;
  int line = 1;
  bool is_first = true;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (text.substr(i).starts_with("//")) {
      i = std::min(text.find('\n', i), text.size());
    } else if (text.substr(i).starts_with("/*")) {
      const std::size_t end = std::min(text.find("*/", i + 2), text.size() - 2) + 2;
      line += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(i),
                                          text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
      i = end;
    } else if (c == '\n') {
      ++line;
      ++i;
      is_first = true;
    } else if (std::isspace(static_cast<unsigned char>(c)) != 0 || c == kLineMark) {
      ++i;
    } else {
      std::size_t end = i + 1;
      if (is_word(c)) {
        while (end < text.size() && is_word(text[end])) ++end;
      } else if (c == '"') {
        while (end < text.size() && text[end] != '"' && text[end] != '\n') ++end;
        end = std::min(end + 1, text.size());
      }
      tokens.push_back({text.substr(i, end - i), line, is_first});
      is_first = false;
      i = end;
    }
  }
  return tokens;
}

bool uses(std::span<const GlslToken> tokens, std::string_view word) {
  return std::any_of(tokens.begin(), tokens.end(),
                     [&](const GlslToken& token) { return token.text == word; });
}

bool has_function(std::span<const GlslToken> tokens, std::string_view returns,
                  std::string_view name) {
  for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
    if (tokens[i].text == returns && tokens[i + 1].text == name && tokens[i + 2].text == "(") {
      return true;
    }
  }
  return false;
}

namespace {

std::string definitions(const GlslSource& source) {
  std::string made;
  for (const auto& [name, value] : source.defines) {
    if (const std::string fault = definition_fault(name, value); !fault.empty()) {
      throw ShaderError(source.name + ": the definition '" + name + "': " + fault);
    }
    made.append("#define ").append(name).append(" ").append(value).append("\n");
  }
  return made;
}

GlslText hlsl_text(const GlslSource& source, const GlslReader& read) {
  GlslText out{.convention = GlslConvention::plain, .said_version = true, .is_hlsl = true};
  Includes includes(read, source.include_folders, out.files);
  const std::string text =
      spliced(includes.expanded(cleaned(source.text, source.name), source.name), true);
  out.missing_includes = std::move(includes.missing);
  const std::string whole = definitions(source) + line_directive(1, source.name) + text;
  out.before = hlsl_surroundings(glsl_tokens(whole));
  check_limits(out.before + whole, source.name);
  out.text = with_lines(whole, true);
  return out;
}

}  // namespace

std::string definition_fault(std::string_view name, std::string_view value) {
  const bool is_name = !name.empty() && std::all_of(name.begin(), name.end(), is_word) &&
                       std::isdigit(static_cast<unsigned char>(name.front())) == 0;
  if (!is_name) return "the name has to be of letters, digits and _, and begin with no digit";
  const bool is_line = std::all_of(value.begin(), value.end(), [](char c) {
    return c == '\t' || (static_cast<unsigned char>(c) >= ' ' && c != '\\');
  });
  if (!is_line || value.find("//") != value.npos || value.find("/*") != value.npos ||
      std::count(value.begin(), value.end(), '"') % 2 != 0) {
    return "the value has to be a line without a backslash, a comment and half a string";
  }
  return {};
}

std::string add_definition(std::map<std::string, std::string>& defines, std::string_view text) {
  const std::size_t end = std::min(text.find('='), text.size());
  const std::string name{text.substr(0, end)};
  std::string value{end < text.size() ? text.substr(end + 1) : "1"};
  std::string fault = definition_fault(name, value);
  if (fault.empty()) defines[name] = std::move(value);
  return fault;
}

GlslText glsl_text(const GlslSource& source, const GlslReader& read, bool raise, int least) {
  if (is_hlsl(source)) return hlsl_text(source, read);
  GlslText out;
  std::string text = cleaned(source.text, source.name);
  Includes includes(read, source.include_folders, out.files);
  text = includes.expanded(text, source.name);
  const std::string defined = definitions(source);
  {
    const std::vector<GlslToken> of_text = glsl_tokens(text);
    std::vector<GlslToken> tokens = glsl_tokens(defined);
    tokens.insert(tokens.end(), of_text.begin(), of_text.end());
    out.taken_as = said_version(of_text, source.name);
    out.said_version = out.taken_as.number != 0;
    out.convention = source.convention != GlslConvention::recognised
                         ? source.convention
                         : recognise(source.stage, tokens, out.said_version);
    if (source.convention == GlslConvention::recognised && includes.includes_three) {
      out.convention = GlslConvention::three;
    }
    if (!out.said_version) out.taken_as = version_of(out.convention, tokens);
    if (wants_compatibility(tokens, out.taken_as)) out.taken_as.profile = "compatibility";
    if (const auto refused = refused_extension(tokens); !refused.text.empty()) {
      throw ShaderError(at(source.name, refused.line) + std::string(refused.text) +
                        " is not supported; a sampler is a uniform");
    }
    GlslVersion raised = out.taken_as;
    if (raise) raised = raised_version(out.taken_as, out.convention, tokens);
    if (raised.number < least && !raised.is_es) raised = {least, false, "compatibility"};
    out.is_raised = raised.number > out.taken_as.number;
    if (out.said_version) {
      // In front of everything, where it belongs and comments often stand.
      const int line = of_text[0].line;
      if (!out.taken_as.is_es) out.version.append(static_cast<std::size_t>(line - 1), '\n');
      std::size_t from = 0, begin = 0;
      for (int i = 1; i < line; ++i) next_line(text, from);
      begin = static_cast<std::size_t>(of_text[0].text.data() - text.data());
      if (wants_compatibility(tokens, out.taken_as)) {
        out.version += "#version " + std::to_string(out.taken_as.number) + " compatibility\n";
      } else {
        out.version += text.substr(begin, text.find('\n', begin) - begin) + "\n";
      }
      text.replace(begin, text.find('\n', begin) - begin, "");
    }
    if (out.is_raised) out.taken_as = raised;
  }
  out.missing_includes = std::move(includes.missing);
  const GlslVersion& version = out.taken_as;
  if (out.is_raised) text = without_raising(text);
  if (!out.said_version || out.is_raised) {
    out.version = "#version " + std::to_string(version.number);
    if (version.number > 100 && !version.profile.empty()) out.version += " " + version.profile;
    out.version += "\n";
  }
  if (out.convention == GlslConvention::libretro) {
    for (std::size_t from = 0; from < text.size();) {
      if (auto parameter = pragma_parameter(next_line(text, from))) {
        out.parameters.push_back(std::move(*parameter));
      }
    }
    if (!has_stage_condition(glsl_tokens(text))) text = stage_of(text, source.stage);
  } else if (out.convention == GlslConvention::gl_transitions) {
    for (std::size_t from = 0; from < text.size();) {
      if (auto parameter = commented_default(next_line(text, from))) {
        out.parameters.push_back(std::move(*parameter));
      }
    }
  }
  if (version.is_es ? version.number < 300 : version.number < 420) text = spliced(text);
  // As if they stood in the text: what is recognised and put around it heeds them.
  text = defined + line_directive(1, source.name) + with_known_layouts(text);
  const std::vector<GlslToken> tokens = glsl_tokens(text);
  out.is_vulkan = is_vulkan(tokens);

  out.before = "#extension GL_GOOGLE_include_directive : enable\n";  // and with it #line 1 "FILE"
  if (version.has_blocks() && !out.is_vulkan) {
    out.before += "layout(std140) uniform;\n";
  } else if (uses(tokens, "GL_ARB_uniform_buffer_object")) {
    out.before += "#extension GL_ARB_uniform_buffer_object : enable\nlayout(std140) uniform;\n";
  }
  GlslSurroundings around =
      glsl_surroundings(out.convention, source, tokens, version, !out.said_version);
  out.before += around.before;
  out.after = around.after;
  if (out.after.empty()) {  // an error at the end is one of the last line
    const auto lines = std::count(source.text.begin(), source.text.end(), '\n');
    out.after = line_directive(static_cast<int>(lines) + 1, source.name);
  }
  check_limits(spliced(out.before + text + out.after), source.name);
  const bool sets_next = version.is_es || version.number >= 330;
  out.text = with_lines(text, sets_next);
  out.after = with_lines(out.after, sets_next);
  return out;
}

}  // namespace softfocus
