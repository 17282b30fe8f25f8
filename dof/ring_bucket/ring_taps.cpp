#include "dof/ring_bucket/ring_taps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace softfocus {
namespace {

// Level 0 ends at this radius, each further one at twice the radius.
constexpr int kFinestRadius = 6;

// The part of a square that lies in an annulus, in cells. Cells on its sides count half, as in
// the levels' means.
float area_inside(int cx, int cy, int spacing, std::int64_t inner, std::int64_t outer) {
  const auto square_of = [](std::int64_t x, std::int64_t y) { return x * x + y * y; };
  const int half = spacing / 2;
  if (spacing == 1) {
    const std::int64_t square = square_of(cx, cy);
    return square > inner && square <= outer ? 1.0f : 0.0f;
  }
  const std::int64_t far = square_of(std::abs(cx) + half, std::abs(cy) + half);
  const std::int64_t near =
      square_of(std::max(std::abs(cx) - half, 0), std::max(std::abs(cy) - half, 0));
  if (far <= outer && near > inner) return static_cast<float>(spacing * spacing);
  if (near > outer || far <= inner) return 0.0f;
  int quarters = 0;
  for (int y = -half; y <= half; ++y) {
    for (int x = -half; x <= half; ++x) {
      const std::int64_t square = square_of(cx + x, cy + y);
      if (square <= inner || square > outer) continue;
      quarters += (std::abs(x) == half ? 1 : 2) * (std::abs(y) == half ? 1 : 2);
    }
  }
  return 0.25f * static_cast<float>(quarters);
}

void add_level(RingTaps& all, int level, int from, int to) {
  const int spacing = 1 << level;
  const int steps = to / spacing + 1;
  const auto square = [](std::int64_t r) { return r * r; };
  const std::int64_t inner = level == 0 ? -1 : square(from), outer = square(to);
  std::vector<std::vector<BucketTap>> by_ring(static_cast<std::size_t>(2 * steps + 1));
  for (int y = -steps; y <= steps; ++y) {
    for (int x = -steps; x <= steps; ++x) {
      const float area = area_inside(x * spacing, y * spacing, spacing, inner, outer);
      if (area < 0.125f * static_cast<float>(spacing * spacing)) continue;
      const float distance = std::sqrt(static_cast<float>(x * x + y * y));
      by_ring[static_cast<std::size_t>(distance + 0.5f)].push_back(
          {x * spacing, y * spacing, distance, area});
      all.reach = std::max({all.reach, std::abs(x * spacing), std::abs(y * spacing)});
    }
  }
  for (std::size_t i = 0; i < by_ring.size(); ++i) {
    if (by_ring[i].empty()) continue;
    BucketRing ring{static_cast<int>(all.taps.size()),
                    0,
                    level,
                    1.0f / static_cast<float>(spacing),
                    (static_cast<float>(i) + 0.5f) * static_cast<float>(spacing),
                    0.0f};
    float area = 0.0f;
    for (const BucketTap& tap : by_ring[i]) {
      all.taps.push_back(tap);
      area += tap.area;
    }
    ring.end = static_cast<int>(all.taps.size());
    ring.inverse_area = 1.0f / area;
    all.rings.push_back(ring);
  }
}

}  // namespace

RingTaps make_ring_taps(float largest) {
  RingTaps all{};
  const int farthest = static_cast<int>(largest) + 2;
  for (int from = 0, to = kFinestRadius; from < farthest; from = to, to *= 2) {
    all.least_size.push_back(static_cast<float>(from) - static_cast<float>(1 << all.levels));
    add_level(all, all.levels++, from, std::min(to, farthest));
  }
  std::reverse(all.rings.begin(), all.rings.end());
  const int entries = static_cast<int>(16.0f * largest) + 3;
  for (int i = 0; i < entries; ++i) {
    const float size = std::max(static_cast<float>(i) / 16.0f, 0.5f);
    float sum = 0.0f;
    for (const BucketRing& ring : all.rings) {
      for (int tap = ring.first; tap < ring.end; ++tap) {
        const BucketTap& at = all.taps[static_cast<std::size_t>(tap)];
        const float overlap =
            std::clamp(size * ring.inverse_spacing - at.distance + 0.5f, 0.0f, 1.0f);
        sum += at.area * overlap;
      }
    }
    all.light.push_back(1.0f / sum);
  }
  return all;
}

int rings_outside(const RingTaps& taps, float size) {
  int count = 0;
  for (const BucketRing& ring : taps.rings) {
    const BucketTap* tap = &taps.taps[static_cast<std::size_t>(ring.first)];
    float nearest = tap->distance;
    for (; tap != &taps.taps[static_cast<std::size_t>(ring.first)] + (ring.end - ring.first); ++tap)
      nearest = std::min(nearest, tap->distance);
    if (size * ring.inverse_spacing - nearest + 0.5f > 0.0f) break;
    ++count;
  }
  return count;
}

}  // namespace softfocus
