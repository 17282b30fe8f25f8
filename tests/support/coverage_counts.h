#pragma once
// For tests of coverage: how often each pixel is drawn.

#include <vector>

#include "raster/pipeline/draw.h"
#include "tests/support/raster_helpers.h"

namespace softfocus::test {

using Vertices = std::vector<VertexOutput<0>>;

// How often each pixel is covered: every fragment adds one.
inline Image count_coverage(const Vertices& vertices, int width, int height,
                            const Profile& profile = {}, const DrawState& state = adding_state()) {
  Image counts = make_image(Format::r32f, width, height);
  draw_list({.colour = {&counts}}, state, vertices, OneColour{}, profile);
  return counts;
}

inline float count_at(const Image& counts, int x, int y) {
  return row<float>(counts, y)[static_cast<std::size_t>(x)];
}

// Pixels whose count is not the one that `expected(x, y)` says.
template <class Expected>
int wrong_pixels(const Image& counts, Expected expected) {
  int wrong = 0;
  for (int y = 0; y < counts.height; ++y) {
    for (int x = 0; x < counts.width; ++x) {
      wrong += count_at(counts, x, y) != static_cast<float>(expected(x, y));
    }
  }
  return wrong;
}

inline int pixels_not_covered_once(const Image& counts) {
  return wrong_pixels(counts, [](int, int) { return 1; });
}

}  // namespace softfocus::test
