#pragma once
// --profile NAME|FILE, the same for every command that takes one.

#include <functional>
#include <string>

#include "raster/numbers/profile.h"
#include "tools/cli/parser.h"

namespace softfocus {

/// Adds --profile: the name of a known profile, or a profile's file (a name with a
/// slash or a dot in it).
void add_profile_option(CLI::App& parser, const std::string& help,
                        std::function<void(const Profile&)> take);

}  // namespace softfocus
