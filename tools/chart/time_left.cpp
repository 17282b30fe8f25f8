#include "tools/chart/time_left.h"

#include <algorithm>
#include <cmath>

namespace softfocus {

double TimeLeft::seconds() const {
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  return seconds(all_units_, done_units_, elapsed.count());
}

double TimeLeft::seconds(double all_units, double done_units, double elapsed_s) {
  if (done_units <= 0.0) return 0.0;
  return std::max(all_units - done_units, 0.0) / done_units * elapsed_s;
}

std::string time_left_text(double seconds) {
  constexpr int kMinute = 60, kStep = 10;
  if (seconds > kMinute) {
    return "about " + std::to_string(static_cast<int>(std::ceil(seconds / kMinute))) + " min left";
  }
  const int steps = std::max(static_cast<int>(std::ceil(seconds / kStep)), 1);
  return "about " + std::to_string(steps * kStep) + " s left";
}

}  // namespace softfocus
