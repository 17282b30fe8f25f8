#include "tools/options/scene_warnings.h"

#include <algorithm>
#include <iostream>

namespace softfocus {

void print_scene_warnings(const std::vector<std::string>& warnings, bool all) {
  constexpr std::size_t kMostLines = 3;
  const std::size_t lines = all ? warnings.size() : std::min(warnings.size(), kMostLines);
  for (std::size_t i = 0; i < lines; ++i)
    std::cerr << "softfocus: warning: " << warnings[i] << '\n';
  if (lines < warnings.size()) {
    std::cerr << "softfocus: warning: " << warnings.size() - lines << " more; -v lists them\n";
  }
}

}  // namespace softfocus
