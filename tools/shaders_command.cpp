// softfocus shaders: the project's GLSL, to read, to change and to lift.

#include <iostream>
#include <memory>

#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/errors.h"
#include "tools/gl/shaders.h"
#include "tools/option_values.h"
#include "tools/whole_file.h"

namespace softfocus {
namespace {

int write_all(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw UsageError("-o '" + folder.string() + "': there is no such folder");
  }
  for (const Shader& shader : built_in_shaders()) {
    WholeFile file{folder / shader.name};
    file.write(shader.source);
    file.commit();
  }
  return kDone;
}

}  // namespace

Command add_shaders_command(CLI::App& program) {
  CLI::App* parser = program.add_subcommand("shaders", "List the GLSL shaders, or write them out");
  const auto folder = std::make_shared<std::string>();
  add_value(*parser, "-o,--output", "DIR", "Write every shader into this folder",
            [folder](const std::string& text) { *folder = text; });
  return {parser, [folder] {
            if (!folder->empty()) return write_all(*folder);
            for (const Shader& shader : built_in_shaders()) std::cout << shader.name << '\n';
            return kDone;
          }};
}

}  // namespace softfocus
