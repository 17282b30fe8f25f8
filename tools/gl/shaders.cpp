#include "tools/gl/shaders.h"

#include <algorithm>
#include <sstream>

#include "scenes/load/file_bytes.h"
#include "scenes/load/scene_error.h"
#include "tools/gl/driver.h"

namespace softfocus {
namespace {

constexpr std::size_t kMaxFileBytes = 1 << 20;
constexpr int kDeepestInclude = 16;

const Shader* find_built_in(std::string_view name) {
  for (const Shader& shader : built_in_shaders()) {
    if (shader.name == name) return &shader;
  }
  return nullptr;
}

std::string_view text_of(const Shaders& shaders, std::string_view name) {
  if (const auto own = shaders.own.find(name); own != shaders.own.end()) return own->second;
  if (const Shader* shader = find_built_in(name)) return shader->source;
  throw DriverError("there is no shader '" + std::string(name) + "'");
}

// The name in `#include "NAME"`, or nothing.
std::string_view included_name(std::string_view line) {
  constexpr std::string_view kInclude = "#include \"";
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == line.npos || !line.substr(begin).starts_with(kInclude)) return {};
  const std::string_view rest = line.substr(begin + kInclude.size());
  return rest.substr(0, rest.find('"'));
}

std::string expanded(const Shaders& shaders, std::string_view name, int depth) {
  if (depth > kDeepestInclude) {
    throw DriverError(std::string(name) + ": includes itself, or one that does");
  }
  std::istringstream lines{std::string{text_of(shaders, name)}};
  std::string result = "#line 1\n";
  int number = 1;
  for (std::string line; std::getline(lines, line); ++number) {
    if (line.ends_with('\r')) line.pop_back();
    const std::string_view included = included_name(line);
    if (included.empty()) {
      result += line + '\n';
    } else {
      result += expanded(shaders, included, depth + 1);
      result += "#line " + std::to_string(number + 1) + '\n';
    }
  }
  return result;
}

}  // namespace

bool has_shader(std::string_view method) { return method == "two-pass" || method == "one-pass"; }

Shaders read_shaders(const std::filesystem::path& folder) {
  Shaders shaders;
  bool any = false;
  for (const auto& entry : std::filesystem::directory_iterator{folder}) {
    const std::string name = entry.path().filename().string();
    const std::string extension = entry.path().extension().string();
    if (extension != ".vert" && extension != ".frag" && extension != ".glsl") continue;
    const bool replaces = find_built_in(name) != nullptr;
    if (!replaces && extension != ".glsl") {
      throw SceneError(entry.path().string() +
                       ": stands in for none of the shaders that softfocus shaders lists; one of "
                       "their names would be right");
    }
    shaders.own[name] = read_file_bytes(entry.path(), kMaxFileBytes);
    any = any || replaces;
  }
  if (!any) {
    throw SceneError(folder.string() +
                     ": has none of the shaders that softfocus shaders lists; a file of such a "
                     "name would stand in for it");
  }
  return shaders;
}

std::string shader_source(const Shaders& shaders, std::string_view name) {
  return expanded(shaders, name, 0);
}

}  // namespace softfocus
