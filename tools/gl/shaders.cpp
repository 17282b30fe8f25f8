#include "tools/gl/shaders.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

#include "tools/gl/driver.h"

namespace softfocus {
namespace {

std::string text_of(const Shaders& shaders, std::string_view name) {
  if (!shaders.folder.empty()) {
    std::ifstream file{shaders.folder / name, std::ios::binary};
    if (file) return {std::istreambuf_iterator<char>{file}, {}};
  }
  const auto& all = built_in_shaders();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [name](const Shader& shader) { return shader.name == name; });
  if (found == all.end()) throw DriverError("there is no shader '" + std::string(name) + "'");
  return std::string{found->source};
}

}  // namespace

std::string Shaders::source(std::string_view name) const {
  constexpr std::string_view kInclude = "#include \"";
  std::istringstream lines{text_of(*this, name)};
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(kInclude) && line.ends_with('"')) {
      result += source(line.substr(kInclude.size(), line.size() - kInclude.size() - 1));
    } else {
      result += line + '\n';
    }
  }
  return result;
}

}  // namespace softfocus
