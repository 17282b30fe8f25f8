#include "dof/sharp_depths.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>

#include "dof/dof.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// Radii at infinity go as 1/focus, as of one aperture.
constexpr std::array kTwo{SharpDepths{{40.0f, 1.0f}, {20.0f, 2.0f}},
                          SharpDepths{{10.0f, 4.0f}, {8.0f, 5.0f}}};

}  // namespace

TEST_CASE("sharp depths: all in a range is sharp, its ends too") {
  for (const float depth_m : {1.0f, 1.5f, 2.0f, 4.0f, 4.5f, 5.0f}) {
    CHECK(sharp_depths_radius_px(kTwo, depth_m) == 0.0f);
  }
}

TEST_CASE("sharp depths: elsewhere the circle is the least of lenses focused at the ends") {
  CHECK(sharp_depths_radius_px(kTwo, 0.5f) == 40.0f);  // 40 (0.5 - 1) / 0.5
  CHECK(sharp_depths_radius_px(kTwo, 10.0f) == 4.0f);  // 8 (10 - 5) / 10
  CHECK(sharp_depths_radius_px(kTwo, 2.5f) == 4.0f);   // 20 (2.5 - 2) / 2.5, nearer than 6
  CHECK(sharp_depths_radius_px(kTwo, 3.2f) == doctest::Approx(2.5));  // 10 (3.2 - 4) / 3.2
}

TEST_CASE("sharp depths: any depth has a finite circle") {
  CHECK(sharp_depths_radius_px(kTwo, std::numeric_limits<float>::infinity()) == 8.0f);
  CHECK(sharp_depths_radius_px(kTwo, std::numeric_limits<float>::quiet_NaN()) == 8.0f);
  CHECK(sharp_depths_radius_px(kTwo, 0.0f) == kLargestMaxCoc);
  CHECK(sharp_depths_radius_px(kTwo, 1e-5f) == kLargestMaxCoc);
  CHECK(std::isfinite(sharp_depths_radius_px(kTwo, -1.0f)));
}

TEST_CASE("sharp depths: a picture has the radius of each pixel's depth, row by row") {
  ThreadPool pool(2);
  Image scene = random_scene_image(7, 5, 1);
  set_depth(scene, [](int x, int y) { return 0.5f + static_cast<float>(x + 7 * y) * 0.25f; });
  const std::vector<float> radii = sharp_depths_radii(scene, kTwo, pool);
  REQUIRE(radii.size() == 35);
  for (std::size_t i = 0; i < 35; ++i) {
    CHECK(radii[i] == sharp_depths_radius_px(kTwo, 0.5f + static_cast<float>(i) * 0.25f));
  }
}
