#include "tools/info/time_in_turn.h"

#include <algorithm>
#include <cstdio>

namespace softfocus {

void print_times(std::vector<Milliseconds>& all) {
  for (Milliseconds& of : all) {
    std::sort(of.ms.begin(), of.ms.end());
    std::sort(of.cpu_ms.begin(), of.cpu_ms.end());
    std::printf("%-26s %9.2f ms  (%.2f to %.2f; %.2f of CPU)\n", of.name.c_str(),
                of.ms[of.ms.size() / 2], of.ms.front(), of.ms.back(),
                of.cpu_ms[of.cpu_ms.size() / 2]);
  }
}

}  // namespace softfocus
