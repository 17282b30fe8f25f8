#include "raster/numbers/fixed_point.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/raster_helpers.h"

using namespace softfocus;

TEST_CASE("the centre of pixel x snaps to exactly 256 x") {
  int wrong = 0;
  for (int x = -20'000; x <= 20'000; ++x) {
    wrong += snap_to_subpixel(static_cast<float>(x) + 0.5f) != 256 * x;
  }
  CHECK(wrong == 0);
}

TEST_CASE("a position midway between two snapped ones goes to the even one") {
  int wrong = 0;
  for (int k = -4000; k <= 4000; ++k) {
    // (k + 1/2) / 256 pixels from the centre of pixel 0.
    const float window = 0.5f + (static_cast<float>(k) + 0.5f) / 256.0f;
    const int even = k % 2 == 0 ? k : k + 1;
    wrong += snap_to_subpixel(window) != even;
  }
  CHECK(wrong == 0);
}

TEST_CASE("positions left of and above the picture snap to the nearer, not toward zero") {
  CHECK(snap_to_subpixel(0.5f - 0.75f / 256.0f) == -1);
  CHECK(snap_to_subpixel(0.5f - 1.25f / 256.0f) == -1);
  CHECK(snap_to_subpixel(-10.0f) == -2688);
  CHECK(snap_to_subpixel(-10.0f + 0.3f / 256.0f) == -2688);
  CHECK(snap_to_subpixel(-10.0f - 0.3f / 256.0f) == -2688);
}

TEST_CASE("snapping random positions is rounding in binary64 of the binary32 difference") {
  test::Random random{5};
  int wrong = 0;
  for (int i = 0; i < 200'000; ++i) {
    const float range = i % 2 == 0 ? 40.0f : 0x1p21f;
    const float window = random.between(-range, range);
    const double steps = static_cast<double>(window - 0.5f) * 256.0;
    double expected = std::floor(steps);
    const double rest = steps - expected;
    if (rest > 0.5 || (rest == 0.5 && std::fmod(expected, 2.0) != 0.0)) expected += 1.0;
    wrong += static_cast<double>(snap_to_subpixel(window)) != expected;
  }
  CHECK(wrong == 0);
}

TEST_CASE("a snapped position taken to the window and snapped again stays") {
  int wrong = 0;
  for (std::int32_t snapped = -(1 << 23) + 1; snapped < 1 << 23; snapped += 37) {
    wrong += snap_to_subpixel(subpixel_to_window(snapped)) != snapped;
  }
  CHECK(wrong == 0);
}
