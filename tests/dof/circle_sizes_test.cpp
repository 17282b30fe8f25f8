#include "dof/lens.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dof/dof.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// 12 (z - 2) / z pixels.
constexpr PixelCoc kCoc{12.0f, 2.0f};

CircleSizes sizes_of(float depth_m, float limit_px) {
  Image image = random_scene_image(10, 8, 1);
  // A tenth of the picture; the rest is in focus.
  set_depth(image, [&](int x, int) { return x == 3 ? depth_m : 2.0f; });
  ThreadPool pool(2);
  return circle_sizes(image, kCoc, limit_px, pool);
}

}  // namespace

TEST_CASE("the largest circle and the share beyond a limit, before and behind the focus") {
  CHECK(sizes_of(4.0f, 5.9f).largest_px == 6.0f);
  CHECK(sizes_of(4.0f, 5.9f).beyond_limit == doctest::Approx(0.1));
  CHECK(sizes_of(4.0f, 6.0f).beyond_limit == 0.0);
  CHECK(sizes_of(0.5f, 35.0f).largest_px == 36.0f);
  CHECK(sizes_of(0.5f, 35.0f).beyond_limit == doctest::Approx(0.1));
}

TEST_CASE("an infinite depth has the horizon's circle, a NaN none, and zero the largest there is") {
  CHECK(sizes_of(std::numeric_limits<float>::infinity(), 1.0f).largest_px == 12.0f);
  CHECK(sizes_of(std::numeric_limits<float>::quiet_NaN(), 1.0f).largest_px == 0.0f);
  CHECK(sizes_of(std::numeric_limits<float>::quiet_NaN(), 1.0f).beyond_limit == 0.0);
  CHECK(sizes_of(0.0f, 1.0f).largest_px == kLargestMaxCoc);
}

TEST_CASE("a large picture has the circles of its pixels, one by one") {
  Image image = random_scene_image(320, 256, 7);
  set_depth(image, [&](int x, int y) {
    return x == y ? std::numeric_limits<float>::infinity()
                  : 0.25f + 0.01f * static_cast<float>(x + y);
  });
  float largest_px = 0.0f;
  int beyond = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float depth_m = load_texel<Format::rgba16f>(image, x, y).w;
      const float radius = x == y ? 12.0f : std::fabs(coc_radius_px(kCoc, depth_m));
      largest_px = std::max(largest_px, radius);
      beyond += radius > 5.0f;
    }
  }
  ThreadPool pool(2);
  const CircleSizes sizes = circle_sizes(image, kCoc, 5.0f, pool);
  CHECK(sizes.largest_px == largest_px);
  CHECK(sizes.beyond_limit == beyond / (320.0 * 256.0));
  CHECK(beyond > 1000);
}
