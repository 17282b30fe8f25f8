#pragma once
// --driver NAME and other options that name a GL driver.

#include <functional>
#include <string>
#include <string_view>

#include "tools/gl/driver.h"
#include "tools/cli/parser.h"

namespace softfocus {

/// The driver of that name; throws UsageError, listing those there are.
const Driver& parse_driver(std::string_view option, const std::string& text);

/// Adds --driver, which may be repeated.
void add_driver_option(CLI::App& parser, const std::string& help,
                       std::function<void(const Driver&)> take);

}  // namespace softfocus
