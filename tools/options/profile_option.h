#pragma once
// --profile NAME|FILE, the same for every command that takes one.

#include <functional>
#include <string>

#include "tools/cli/parser.h"
#include "tools/files/profile_file.h"

namespace softfocus {

/// Adds --profile: the name of a known profile, or a profile's file (a name with a
/// slash or a dot in it).
void add_profile_option(CLI::App& parser, const std::string& help,
                        std::function<void(const ChosenProfile&)> take);

}  // namespace softfocus
