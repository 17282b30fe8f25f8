#include "dof/measure/heat_map.h"

#include <doctest/doctest.h>

#include <limits>

#include "dof/measure/tone.h"
#include "tests/support/measure_pictures.h"

using namespace softfocus;

TEST_CASE("heat map: black for 0, and for 0 alone") {
  CHECK(heat_colour(0.0) == std::array{0.0, 0.0, 0.0});
  const auto least = heat_colour(1e-6);
  CHECK(least[2] > 0.0);
}

TEST_CASE("heat map: brighter all the way") {
  double before = -1.0;
  for (int i = 0; i <= 256; ++i) {
    const auto [red, green, blue] = heat_colour(i / 256.0);
    const double now = luminance(red, green, blue);
    CAPTURE(i);
    CHECK(now > before);
    before = now;
  }
}

TEST_CASE("heat map: past the ends it stays at them, and NaN is black") {
  CHECK(heat_colour(-1.0) == heat_colour(0.0));
  CHECK(heat_colour(2.0) == heat_colour(1.0));
  CHECK(heat_colour(std::numeric_limits<double>::quiet_NaN()) == heat_colour(0.0));
}

TEST_CASE("heat map: a picture has the colours of its map, as a PNG shows them") {
  PixelMap map = make_pixel_map(3, 2);
  row(map, 1)[2] = 1.0;
  const Image picture = heat_picture(map);
  const glm::vec4 black = load_texel(picture, 0, 0);
  CHECK(black.x + black.y + black.z == 0.0f);
  CHECK(black.w == 1.0f);
  const glm::vec4 hot = load_texel(picture, 2, 1);
  CHECK(linear_to_srgb8(hot.x) == 252);  // 0.99 * 255
  CHECK(linear_to_srgb8(hot.y) == 247);  // 0.97 * 255
  CHECK(linear_to_srgb8(hot.z) == 191);  // 0.75 * 255
}
