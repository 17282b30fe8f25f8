// The npm package as a WebAssembly module: softfocus.h, and those of the program's commands that it
// has no call for, on files in the module's memory.

#include "tools/program.h"

namespace {

std::vector<softfocus::Command> add_commands(CLI::App& program) {
  return {softfocus::add_render_command(program), softfocus::add_scenes_command(program),
          softfocus::add_effects_command(program), softfocus::add_lens_command(program),
          softfocus::add_compare_command(program)};
}

}  // namespace

/// Runs the program with these words, in UTF-8. Its exit status.
extern "C" int softfocus_program(const char* const* words, int count) {
  return softfocus::run_program(add_commands, {words, words + count});
}
