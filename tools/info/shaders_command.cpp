// softfocus shaders: the project's GLSL, to read, to change and to lift.

#include <iostream>
#include <memory>
#include <optional>

#include "scenes/files/file_bytes.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/files/json.h"
#include "tools/files/whole_file.h"
#include "tools/gl/shaders.h"

namespace softfocus {
namespace {

// A file of another content may be the user's own work: it stays, and nothing is written.
void refuse_to_replace(const std::filesystem::path& folder) {
  for (const Shader& shader : built_in_shaders()) {
    const std::filesystem::path name = folder / shader.name;
    if (!std::filesystem::exists(name)) continue;
    if (read_file_bytes(name, shader.source.size() + 1) == shader.source) continue;
    throw FileError(name.string() +
                    ": is there and differs from the program's; give another folder");
  }
}

int write_shaders(const std::filesystem::path& folder) {
  std::error_code unknown;
  if (!std::filesystem::is_directory(folder, unknown)) {
    throw UsageError("-o '" + folder.string() + "': there is no such folder");
  }
  refuse_to_replace(folder);
  for (const Shader& shader : built_in_shaders()) {
    WholeFile file{folder / shader.name};
    file.write(shader.source);
    file.commit();
  }
  return kDone;
}

}  // namespace

Command add_shaders_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "shaders", "List the GLSL shaders, or write them out");
  const auto folder = std::make_shared<std::optional<std::string>>();
  add_value(*parser, "-o,--output", "DIR", "Write every shader into this folder",
            [folder](const std::string& text) { *folder = text; });
  const auto json = std::make_shared<bool>(false);
  add_flag(*parser, "--json", "Print the list as JSON", *json);
  return {parser, [folder, json] {
            if (*folder) return write_shaders(**folder);
            if (*json) {
              Json list = Json::array();
              for (const Shader& shader : built_in_shaders()) {
                list.push_back({{"name", shader.name}});
              }
              std::cout << json_text(list, 2) << '\n';
              return kDone;
            }
            for (const Shader& shader : built_in_shaders()) std::cout << shader.name << '\n';
            return kDone;
          }};
}

}  // namespace softfocus
