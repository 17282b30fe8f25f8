#include "dof/ring_bucket/ring_bucket.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "dof/half_resolution/half_fields.h"
#include "dof/ring_bucket/ring_taps.h"
#include "raster/images/texel.h"
#include "tests/dof/half_resolution/merge_oracle.h"
#include "tests/support/test_images.h"

using namespace softfocus;
using test::BlurredCell;
using test::cell_value;
using test::saturated;

namespace {

// A level as a tap sees it: green times share, share, size, and whether it counts.
struct Seen {
  double colour = 0.0, share = 0.0, size = 0.0, all = 0.0;
};

struct Oracle {
  const HalfFields& fields;
  const RingTaps& taps;
  bool near;

  Seen seen(int level, int x, int y) const {
    const int width = fields.cells.width, height = fields.cells.height;
    x = std::clamp(x, 0, width - 1);
    y = std::clamp(y, 0, height - 1);
    if (level == 0) {
      const double share = cell_value(fields, near ? kNearOpacity : kFarWeight, x, y);
      const double colour = cell_value(fields, (near ? kNearColour : kFarColour) + 1, x, y);
      return {near ? colour : share * colour, share,
              cell_value(fields, near ? kNearSize : kFarSize, x, y), 1.0};
    }
    const int offset = level == 1 ? 1 : 1 << (level - 2);
    const auto least = static_cast<double>(taps.least_size[static_cast<std::size_t>(level)]);
    Seen mean;
    double weights = 0.0;
    for (int i = 0; i < 9; ++i) {
      const int dx = i % 3 - 1, dy = i / 3 - 1;
      const double tent = (dx == 0 ? 2.0 : 1.0) * (dy == 0 ? 2.0 : 1.0) / 16.0;
      const double part = level == 1 ? tent : dx != 0 && dy != 0 ? 0.25 : 0.0;
      const Seen p = seen(level - 1, x + dx * offset, y + dy * offset);
      const double count = part * saturated(p.size - least);
      const double weight = count * (p.share + (near ? p.all * 0x1p-20 : 0.0));
      mean.colour += count * p.colour;
      mean.share += count * p.share;
      mean.all += count * p.all;
      mean.size += weight * p.size;
      weights += weight;
    }
    mean.size = weights > 0.0 ? mean.size / weights : 0.0;
    return mean;
  }

  double light(double size) const {
    const auto entry = static_cast<std::size_t>(size * 16.0);
    return test::mixed(static_cast<double>(taps.light[entry]),
                       static_cast<double>(taps.light[entry + 1]),
                       size * 16.0 - static_cast<double>(entry));
  }

  // The sums of a tap: colour, share, size, all, and overlap.
  std::array<double, 5> sums(const BucketRing& ring, const BucketTap& tap, int x, int y) const {
    const Seen p = seen(ring.level, x + tap.dx, y + tap.dy);
    const double overlap = static_cast<double>(tap.area) *
                           saturated(p.size * static_cast<double>(ring.inverse_spacing) -
                                     static_cast<double>(tap.distance) + 0.5);
    const double lit = overlap * light(p.size);
    return {lit * p.colour, lit * p.share, lit * p.share * p.size, lit * p.all, overlap};
  }

  double far(int x, int y) const {
    if (cell_value(fields, kFarWeight, x, y) < 0x1p-10) {
      return cell_value(fields, kFarColour + 1, x, y);
    }
    std::array<double, 5> previous{};
    for (const BucketRing& ring : taps.rings) {
      std::array<double, 5> current{};
      for (int t = ring.first; t < ring.end; ++t) {
        const BucketTap& tap = taps.taps[static_cast<std::size_t>(t)];
        const std::array<double, 5> values = sums(ring, tap, x, y);
        const bool joins =
            seen(ring.level, x + tap.dx, y + tap.dy).size > static_cast<double>(ring.border);
        for (std::size_t i = 0; i < 5; ++i) (joins ? previous : current)[i] += values[i];
      }
      const auto mean = [](const std::array<double, 5>& b) {
        return b[1] > 0.0 ? b[2] / b[1] : 0.0;
      };
      const double occlusion = saturated(mean(previous) - mean(current));
      const double kept = 1.0 - current[4] * static_cast<double>(ring.inverse_area) * occlusion;
      for (std::size_t i = 0; i < 3; ++i) previous[i] = previous[i] * kept + current[i];
    }
    return previous[0] / previous[1];
  }

  std::array<double, 2> near_of(int x, int y) const {
    std::array<double, 5> all{};
    for (const BucketRing& ring : taps.rings) {
      for (int t = ring.first; t < ring.end; ++t) {
        const auto values = sums(ring, taps.taps[static_cast<std::size_t>(t)], x, y);
        for (std::size_t i = 0; i < 5; ++i) all[i] += values[i];
      }
    }
    const double ratio = all[3] > 0.0 ? all[1] / all[3] : 0.0;
    const double opacity = std::min(std::max(all[1], ratio), 1.0);
    return {all[1] > 0.0 ? all[0] / all[1] * opacity : 0.0, opacity};
  }
};

RingTaps taps_for(const std::vector<float>& reach) {
  return make_ring_taps(*std::max_element(reach.begin(), reach.end()));
}

}  // namespace

TEST_CASE("ring-bucket is what its steps say") {
  ThreadPool pool(2);
  for (const float max_coc : {3.0f, 9.0f, 21.0f}) {
    constexpr int kWidth = 31, kHeight = 28;  // a single tile
    const Image scene = random_scene_image(kWidth, kHeight, 1);
    const DofInput input{scene, {.coc = {18.0f, 2.0f}, .max_coc_px = max_coc}, {}};
    const HalfFields fields = make_half_fields(input, pool);
    REQUIRE(fields.highlights.reach < 0);
    const HalfTiles tiles = make_half_tiles(fields, 1.0f, false, pool);
    const RingTaps far_taps = taps_for(tiles.far_reach), near_taps = taps_for(tiles.near_reach);
    const Oracle far{fields, far_taps, false}, near{fields, near_taps, true};
    Image result = make_image(Format::rgba16f, kWidth, kHeight);
    ring_bucket(input, result, pool);
    const double worst = test::merge_error(input, fields, result, [&](int x, int y) {
      const std::array<double, 2> before = near.near_of(x, y);
      return BlurredCell{far.far(x, y), before[0], before[1]};
    });
    INFO("max_coc ", max_coc);
    CHECK(worst < 0x1p-10);
  }
}

TEST_CASE("the taps of a ring pattern cover each cell of their disc about once") {
  const RingTaps taps = make_ring_taps(40.0f);
  REQUIRE(taps.levels > 2);
  constexpr int kReach = 60;
  std::vector<double> covered(static_cast<std::size_t>((2 * kReach + 1) * (2 * kReach + 1)));
  for (const BucketRing& ring : taps.rings) {
    const int spacing = 1 << ring.level, half = spacing / 2;
    for (int t = ring.first; t < ring.end; ++t) {
      const BucketTap& tap = taps.taps[static_cast<std::size_t>(t)];
      for (int y = -half; y <= half; ++y) {
        for (int x = -half; x <= half; ++x) {
          const double part =
              spacing == 1 ? 1.0
                           : (std::abs(x) == half ? 0.5 : 1.0) * (std::abs(y) == half ? 0.5 : 1.0) *
                                 static_cast<double>(tap.area) / (spacing * spacing);
          covered[static_cast<std::size_t>((tap.dy + y + kReach) * (2 * kReach + 1) + tap.dx + x +
                                           kReach)] += part;
        }
      }
    }
  }
  double sum = 0.0;
  for (int y = -38; y <= 38; ++y) {
    for (int x = -38; x <= 38; ++x) {
      if (x * x + y * y > 38 * 38) continue;
      const double part =
          covered[static_cast<std::size_t>((y + kReach) * (2 * kReach + 1) + x + kReach)];
      // Between two levels squares of two sizes meet.
      CHECK(part > 0.3);
      CHECK(part < 1.8);
      sum += part;
    }
  }
  CHECK(std::fabs(sum / (3.14159265 * 38 * 38) - 1.0) < 0.03);
}

TEST_CASE("ring-bucket's taps grow with the logarithm of the radius") {
  const std::size_t at_8 = make_ring_taps(8.0f).taps.size();
  const std::size_t at_32 = make_ring_taps(32.0f).taps.size();
  const std::size_t at_512 = make_ring_taps(512.0f).taps.size();
  CHECK(at_8 < 300);
  CHECK(at_32 < 2 * at_8);
  CHECK(at_512 < 5 * at_8);
}

TEST_CASE("ring-bucket blurs a lamp of many pixels to an even disc without dots") {
  ThreadPool pool(2);
  for (const float radius : {16.0f, 48.0f}) {
    Image scene = make_image(Format::rgba16f, 193, 193);
    for (int y = 0; y < 193; ++y) {
      for (int x = 0; x < 193; ++x) {
        const float light = std::max(std::abs(x - 96), std::abs(y - 96)) <= 6 ? 1.0f : 0.0f;
        store_texel(scene, x, y, {light, light, light, 4.0f}, {});
      }
    }
    Image result = make_image(Format::rgba16f, 193, 193);
    ring_bucket({scene, {.coc = {2.0f * radius, 2.0f}, .max_coc_px = 64.0f}, {}}, result, pool);
    float least = 1e9f, most = 0.0f;
    for (int y = 0; y < 193; ++y) {
      for (int x = 0; x < 193; ++x) {
        if (std::hypot(x - 96, y - 96) > static_cast<double>(radius) - 12.0) continue;
        least = std::min(least, load_texel(result, x, y).x);
        most = std::max(most, load_texel(result, x, y).x);
      }
    }
    INFO("radius ", radius);
    CHECK(most / least < 1.35f);
  }
}
