#include "dof/measure/flicker.h"

#include <cassert>
#include <cmath>

namespace softfocus {

double flicker(const FlickerStep& step, const ToneTable& tone) {
  const auto& [before, after, truth_before, truth_after] = step;
  for (const Image* image : {&before, &after, &truth_before, &truth_after}) {
    assert(image->format == Format::rgba16f);
    assert(image->width == before.width && image->height == before.height);
  }
  double sum = 0.0;
  for (int y = 0; y < before.height; ++y) {
    const auto was = row<std::uint16_t>(before, y);
    const auto is = row<std::uint16_t>(after, y);
    const auto should_have_been = row<std::uint16_t>(truth_before, y);
    const auto should_be = row<std::uint16_t>(truth_after, y);
    for (std::size_t i = 0; i < was.size(); ++i) {
      if (i % 4 == 3) continue;
      const double change = toned(tone, is[i]) - toned(tone, was[i]);
      const double true_change = toned(tone, should_be[i]) - toned(tone, should_have_been[i]);
      sum += std::fabs(change - true_change);
    }
  }
  return sum / (3.0 * before.width * before.height);
}

double flicker(std::span<const Image> frames, std::span<const Image> truth, const ToneTable& tone) {
  assert(frames.size() >= 2 && frames.size() == truth.size());
  double sum = 0.0;
  for (std::size_t t = 1; t < frames.size(); ++t) {
    sum += flicker({frames[t - 1], frames[t], truth[t - 1], truth[t]}, tone);
  }
  return sum / static_cast<double>(frames.size() - 1);
}

}  // namespace softfocus
