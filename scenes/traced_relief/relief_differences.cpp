#include <algorithm>
#include <cassert>
#include <cstdlib>

#include "scenes/traced_relief/traced_relief.h"

namespace softfocus {
namespace {

/// The depths around a texel, of both reliefs.
struct Around {
  int least = last_depth(16), most = 0;
  bool has_empty = false;
};

void look_around(const ReliefTexture& relief, int x, int y, Around& around) {
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, relief.height - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, relief.width - 1); ++u) {
      const int code =
          relief.depths[static_cast<std::size_t>(v) * static_cast<std::size_t>(relief.width) +
                        static_cast<std::size_t>(u)];
      if (code == empty_depth(relief.depth_bits)) {
        around.has_empty = around.has_empty || u != x || v != y;
        continue;
      }
      around.least = std::min(around.least, code);
      around.most = std::max(around.most, code);
    }
  }
}

bool is_other_colour(std::uint32_t a, std::uint32_t b) {
  for (int shift = 0; shift < 24; shift += 8) {
    if (std::abs(static_cast<int>(a >> shift & 255u) - static_cast<int>(b >> shift & 255u)) > 1) {
      return true;
    }
  }
  return false;
}

}  // namespace

ReliefDifferences relief_differences(const ReliefTexture& one, const ReliefTexture& other) {
  assert(one.width == other.width && one.height == other.height &&
         one.depth_bits == other.depth_bits);
  ReliefDifferences found;
  const int step = one.depth_bits == 8 ? kStepCodes : 256 * kStepCodes;
  for (int y = 0; y < one.height; ++y) {
    for (int x = 0; x < one.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(one.width) +
                             static_cast<std::size_t>(x);
      const bool is_one = one.colours[at] != 0, is_other = other.colours[at] != 0;
      if (!is_one && !is_other) continue;
      ++found.shown;
      Around around;
      look_around(one, x, y, around);
      look_around(other, x, y, around);
      if (is_one != is_other) {
        ++found.by_one;
        found.by_one_inside += around.has_empty ? 0 : 1;
        continue;
      }
      const bool is_step = around.has_empty || around.most - around.least > step;
      const int apart = std::abs(one.depths[at] - other.depths[at]);
      found.code += apart == 1 ? 1 : 0;
      found.codes += apart > 1 ? 1 : 0;
      found.codes_off_step += apart > 1 && !is_step ? 1 : 0;
      const bool is_other_light = is_other_colour(one.colours[at], other.colours[at]);
      found.colour += is_other_light ? 1 : 0;
      found.colour_off_step += is_other_light && !is_step ? 1 : 0;
    }
  }
  return found;
}

}  // namespace softfocus
