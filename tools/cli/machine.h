#pragma once
// What figures of speed depend on and do not show: the processor and the compiler.

#include <optional>
#include <string>

namespace softfocus {

/// The processor's name, where Linux tells it in /proc/cpuinfo.
std::optional<std::string> cpu_name();

/// The compiler that this program was built with, and its version.
std::string compiler_name();

}  // namespace softfocus
