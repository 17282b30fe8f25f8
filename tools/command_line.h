#pragma once
// The program as a function: arguments in, exit status out.

#include <string>
#include <vector>

namespace softfocus {

/// Runs the subcommand that `arguments` (without the program's name) ask for. An error
/// is one line on standard error.
int run(std::vector<std::string> arguments);

}  // namespace softfocus
