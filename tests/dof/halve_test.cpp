#include "dof/halve.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

TEST_CASE("halve: a pixel is the mean of its four colours at the nearest of their depths") {
  const Image picture = random_scene_image(30, 22, 5);
  ThreadPool one{1}, three{3};
  const Image half = halve(picture, {}, three);
  REQUIRE(half.width == 15);
  REQUIRE(half.height == 11);
  CHECK(hash_image(half) == hash_image(halve(picture, {}, one)));
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      glm::dvec4 mean{0.0, 0.0, 0.0, std::numeric_limits<double>::infinity()};
      for (int i = 0; i < 4; ++i) {
        const glm::dvec4 texel{load_texel(picture, 2 * x + i % 2, 2 * y + i / 2)};
        for (int c = 0; c < 3; ++c) mean[c] += 0.25 * texel[c];
        mean.w = std::min(mean.w, texel.w);
      }
      // The sum of four halves of one size is exact in binary32: one rounding, to a half.
      for (int c = 0; c < 3; ++c) mean[c] = std::abs(mean[c] - double{load_texel(half, x, y)[c]});
      for (int c = 0; c < 3; ++c) CHECK(mean[c] <= 0x1p-12);
      CHECK(double{load_texel(half, x, y).w} == mean.w);
    }
  }
}

TEST_CASE("halve: what is stored is rounded as the profile rounds") {
  Image picture = make_image(Format::rgba16f, 2, 2);
  // The mean of 1 and three times the next half lies three quarters of the way between.
  for (int i = 0; i < 4; ++i) {
    const float value = i == 0 ? 1.0f : 1.0f + 0x1p-10f;
    store_texel(picture, i % 2, i / 2, {value, 65504.0f, 0.0f, 4.0f + static_cast<float>(i)}, {});
  }
  ThreadPool pool{1};
  const glm::vec4 nearest = load_texel(halve(picture, {}, pool), 0, 0);
  CHECK(nearest == glm::vec4{1.0f + 0x1p-10f, 65504.0f, 0.0f, 4.0f});
  Profile cuts;
  cuts.half_store = HalfRounding::toward_zero;
  CHECK(load_texel(halve(picture, cuts, pool), 0, 0).x == 1.0f);
}
