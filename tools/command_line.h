#pragma once
// The program as a function: arguments in, exit status out.

#include <string>
#include <vector>

namespace softfocus {

/// What the program ends with. `compare` has its own meanings, as diff has:
/// 0 equal, 1 different, 2 error.
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kWrongUsage = 2;

/// Runs the subcommand that `arguments` (without the program's name) ask for. An error
/// is one line on standard error.
int run(std::vector<std::string> arguments);

}  // namespace softfocus
