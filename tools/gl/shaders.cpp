#include "tools/gl/shaders.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <sstream>

#include "scenes/files/file_bytes.h"
#include "scenes/files/scene_error.h"
#include "tools/gl/driver/driver.h"

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

// As the user knows it.
std::string shown_name(const Shaders& shaders, std::string_view name) {
  return shaders.own.contains(name) ? (shaders.folder / name).string() : std::string{name};
}

void expand(const Shaders& shaders, std::string_view name, int depth, ShaderSource& source) {
  if (depth > kDeepestInclude) {
    throw ShaderError(shown_name(shaders, name) + ": includes itself, or one that does");
  }
  const std::string file = std::to_string(source.files.size());
  source.files.push_back(shown_name(shaders, name));
  std::istringstream lines{std::string{text_of(shaders, name)}};
  source.text += "#line 1 " + file + '\n';
  int number = 1;
  for (std::string line; std::getline(lines, line); ++number) {
    if (line.ends_with('\r')) line.pop_back();
    const std::string_view included = included_name(line);
    if (included.empty()) {
      source.text += line + '\n';
    } else {
      expand(shaders, included, depth + 1, source);
      source.text += "#line " + std::to_string(number + 1) + ' ' + file + '\n';
    }
  }
}

// A name that is nowhere is for shader_source() to refuse.
void add_with_included(const Shaders& shaders, std::string_view name,
                       std::set<std::string, std::less<>>& names) {
  const bool is_there = shaders.own.contains(name) || find_built_in(name) != nullptr;
  if (!is_there || !names.emplace(name).second) return;
  std::istringstream lines{std::string{text_of(shaders, name)}};
  for (std::string line; std::getline(lines, line);) {
    add_with_included(shaders, included_name(line), names);
  }
}

}  // namespace

bool has_shader(std::string_view method) { return method == "two-pass" || method == "one-pass"; }

Shaders read_shaders(const std::filesystem::path& folder) {
  Shaders shaders{.own = {}, .folder = folder};
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

ShaderSource shader_source(const Shaders& shaders, std::string_view name) {
  ShaderSource source;
  expand(shaders, name, 0, source);
  return source;
}

std::string first_error(std::string_view log, const std::vector<std::string>& files) {
  const auto first_line = [](std::string_view text) { return text.substr(0, text.find('\n')); };
  std::string_view line = first_line(log);
  // Warnings may stand before it.
  for (std::string_view rest = log; !rest.empty();) {
    const std::string_view next = first_line(rest);
    if (next.find("error") != next.npos || next.find("ERROR") != next.npos) {
      line = next;
      break;
    }
    rest.remove_prefix(std::min(rest.size(), next.size() + 1));
  }
  std::string_view place = line;
  if (place.starts_with("ERROR: ")) place.remove_prefix(7);
  std::size_t file = 0;
  const auto [end, error] = std::from_chars(place.data(), place.data() + place.size(), file);
  place.remove_prefix(static_cast<std::size_t>(end - place.data()));
  const bool has_place = place.starts_with(':') || place.starts_with('(');
  if (error != std::errc{} || !has_place || file >= files.size()) {
    return files.front() + ": " + std::string{line};
  }
  return files[file] + std::string{place};
}

std::vector<std::string_view> frame_shaders(std::string_view method) {
  std::vector<std::string_view> names{"surface.vert", "surface.frag"};
  if (!has_shader(method)) return names;
  names.insert(names.end(),
               {"fullscreen.vert", method == "one-pass" ? "one_pass.frag" : "two_pass.frag"});
  return names;
}

bool has_no_part(const Shaders& shaders, const std::vector<std::string_view>& names) {
  std::set<std::string, std::less<>> used;
  for (const std::string_view name : names) add_with_included(shaders, name, used);
  bool differs = false;
  for (const auto& [name, text] : shaders.own) {
    const Shader* const ours = find_built_in(name);
    if (ours != nullptr && ours->source == text) continue;
    if (used.contains(name)) return false;
    differs = true;
  }
  return differs;
}

}  // namespace softfocus
