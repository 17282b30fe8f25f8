#include "tools/chart/pareto.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace softfocus {
namespace {

bool beats(const TwoCosts& a, const TwoCosts& b) {
  return a.time <= b.time && a.error <= b.error && (a.time < b.time || a.error < b.error);
}

}  // namespace

std::vector<std::size_t> pareto_front(std::span<const TwoCosts> contenders) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    const TwoCosts& own = contenders[i];
    const bool beaten = std::any_of(contenders.begin(), contenders.end(),
                                    [&](const TwoCosts& other) { return beats(other, own); });
    if (!beaten && !std::isnan(own.time) && !std::isnan(own.error)) front.push_back(i);
  }
  std::stable_sort(front.begin(), front.end(), [&](std::size_t a, std::size_t b) {
    return contenders[a].time < contenders[b].time;
  });
  return front;
}

}  // namespace softfocus
