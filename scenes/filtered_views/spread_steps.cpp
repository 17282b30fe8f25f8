#include "scenes/filtered_views/spread_steps.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdlib>

namespace softfocus {

LevelList list_of(const LevelSet& levels) {
  LevelList list;
  for (int word = 0; word < LevelSet::kWords; ++word) {
    for (std::uint64_t left = levels.bits[word]; left != 0; left &= left - 1) {
      list.number[static_cast<std::size_t>(list.count++)] = 64 * word + std::countr_zero(left);
    }
  }
  return list;
}

SpreadSteps spread_steps(const ViewSpread& spread, std::span<const glm::dvec2> points,
                         glm::dvec2 in_pixel) {
  SpreadSteps steps{
      static_cast<int>(points.size()), ray_steps(spread, points, in_pixel), {}, {}, {}, {}};
  steps.reach_px.resize(kSpreadLevels);
  for (std::size_t i = 0; i < steps.steps.size(); ++i) {
    const PixelStep step = steps.steps[i];
    steps.offsets.push_back(step.y * kSpreadStride + step.x);
    std::int16_t& reach = steps.reach_px[i % kSpreadLevels];
    const int longest = std::max({int{reach}, std::abs(step.x), std::abs(step.y)});
    assert(longest <= kMostSpreadStep);
    reach = static_cast<std::int16_t>(longest);
  }
  steps.same_until.resize(steps.offsets.size());
  for (std::size_t i = steps.offsets.size(); i-- > 0;) {
    const bool last = i % kSpreadLevels == kSpreadLevels - 1;
    steps.same_until[i] = !last && steps.offsets[i] == steps.offsets[i + 1]
                              ? steps.same_until[i + 1]
                              : static_cast<std::int16_t>(i % kSpreadLevels);
  }
  // Rounding may take a pixel from a level's step. The reach of all from the focus to it does not.
  for (std::size_t away = 1; away <= kMostSpreadLevel; ++away) {
    std::int16_t* focus = steps.reach_px.data() + kMostSpreadLevel;
    focus[away] = std::max(focus[away], focus[away - 1]);
    std::int16_t* before = focus - away;
    *before = std::max(*before, before[1]);
  }
  for (int away = 0; away <= kMostSpreadStep / kReachStepPx; ++away) {
    LevelSet& reaching = steps.reaching.emplace_back();
    for (int level = 0; level < kSpreadLevels; ++level) {
      if (steps.reach_px[static_cast<std::size_t>(level)] <= away * kReachStepPx) continue;
      reaching.bits[level / 64] |= std::uint64_t{1} << level % 64;
    }
  }
  return steps;
}

void find_runs(const SpreadSteps& steps, const LevelList& sought, bool only_sought,
               RayRuns& found) {
  std::int32_t end = 0;
  found.all_certain = true;
  for (int ray = 0; ray < steps.rays; ++ray) {
    const std::int32_t* offsets = steps.offsets.data() + std::ptrdiff_t{ray} * kSpreadLevels;
    const std::int16_t* same_until = steps.same_until.data() + std::ptrdiff_t{ray} * kSpreadLevels;
    const std::int32_t begin = end;
    for (int i = 0; i < sought.count;) {
      const std::int32_t first = sought.number[static_cast<std::size_t>(i)];
      std::int32_t last = first;
      while (++i < sought.count &&
             sought.number[static_cast<std::size_t>(i)] <= same_until[first]) {
        last = sought.number[static_cast<std::size_t>(i)];
      }
      found.runs[static_cast<std::size_t>(end++)] = {offsets[first], first,
                                                     static_cast<std::uint32_t>(last - first)};
    }
    found.begin[static_cast<std::size_t>(ray)] = begin;
    const bool certain = only_sought && end - begin == 1;
    found.certain[static_cast<std::size_t>(ray)] = certain;
    found.all_certain = found.all_certain && certain;
  }
  found.begin[static_cast<std::size_t>(steps.rays)] = end;
}

}  // namespace softfocus
