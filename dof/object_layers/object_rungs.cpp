#include "dof/object_layers/object_rungs.h"

#include <algorithm>
#include <bit>

namespace softfocus {
namespace {

// Where rung `number` begins behind the focus, and the rung before it begins before the focus.
LayerBegin far_begin(RungStep step) { return {step.slope, -step.begin * step.slope}; }
LayerBegin near_begin(RungStep step) { return {step.slope, 1.0f + step.begin * step.slope}; }

constexpr LayerBegin kEverything{0.0f, 1.0f}, kNothing{0.0f, 0.0f};

}  // namespace

std::uint64_t rungs_of(float square) {
  // A float's upper bits count half octaves from 2^-127: 254 is 1 to 3/2, where rung 1 begins.
  const auto bits = std::bit_cast<std::uint32_t>(square);
  const int rung = std::max(static_cast<int>(bits >> 22) - 253, 0);
  return std::uint64_t{(bits & 0x3FFFFF) == 0 ? 1u : 3u} << rung;
}

ObjectLadder make_object_ladder(float largest_px) {
  ObjectLadder ladder;
  ladder.levels = make_ladder(largest_px);
  const std::size_t levels = ladder.levels.size();
  // By a rung's number: the step that leads to it, and the rung with its level.
  std::vector<RungStep> steps;
  struct Place {
    const Rung* rung;
    std::size_t level;
  };
  std::vector<Place> places;
  for (std::size_t level = 0; level < levels; ++level) {
    const std::vector<Rung>& rungs = ladder.levels[level].rungs;
    for (std::size_t i = 0; i < rungs.size(); ++i) {
      const bool first = i == 0 && level > 0;
      steps.push_back(first ? ladder.levels[level - 1].beyond : rungs[i].step);
      places.push_back({&rungs[i], level});
    }
  }
  // The begins of all layers from the nearest to the farthest, 2 * count - 1.
  const std::size_t count = places.size();
  std::vector<LayerBegin> begins{kEverything};
  for (std::size_t i = count; i-- > 1;) begins.push_back(near_begin(steps[i]));
  for (std::size_t i = 1; i < count; ++i) begins.push_back(far_begin(steps[i]));
  begins.push_back(kNothing);
  ladder.near.resize(levels);
  ladder.far.resize(levels);
  for (std::size_t layer = 0; layer + 1 < begins.size(); ++layer) {
    const bool near = layer + 1 < count;
    const Place& place = places[near ? count - 1 - layer : layer + 1 - count];
    (near ? ladder.near : ladder.far)[place.level].push_back(
        {begins[layer == 0 ? 0 : layer - 1], begins[layer], begins[layer + 1], place.rung});
  }
  return ladder;
}

}  // namespace softfocus
