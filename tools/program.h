#pragma once
// A program of commands: which one the words name, and what becomes of an error.

#include <functional>
#include <string>
#include <vector>

#include "tools/cli/commands.h"

namespace softfocus {

/// Runs the command that the words, without the program's name, ask for. `add` adds all that there
/// are. The exit status.
int run_program(const std::function<std::vector<Command>(CLI::App&)>& add,
                std::vector<std::string> words);

}  // namespace softfocus
