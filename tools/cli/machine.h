#pragma once
// The processor and the compiler, for reports of speed.

#include <optional>
#include <string>

namespace softfocus {

/// The processor's name, where Linux tells it in /proc/cpuinfo.
std::optional<std::string> cpu_name();

/// The compiler that this program was built with, and its version.
std::string compiler_name();

}  // namespace softfocus
