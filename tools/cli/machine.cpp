#include "tools/cli/machine.h"

#include <fstream>

namespace softfocus {

std::optional<std::string> cpu_name() {
  std::ifstream file{"/proc/cpuinfo"};
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t begin = line.find_first_not_of(": \t", line.find(':'));
    if (begin != line.npos) return line.substr(begin);
  }
  return std::nullopt;
}

std::string compiler_name() {
#ifdef __clang__
  return __VERSION__;  // with its name
#else
  return "g++ " __VERSION__;
#endif
}

}  // namespace softfocus
