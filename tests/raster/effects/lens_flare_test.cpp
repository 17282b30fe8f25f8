#include "raster/effects/lens_flare.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

Image flared(const LensFlareSettings& settings, const Image& picture, ThreadPool& pool,
             const Profile& profile = {}) {
  Image result = make_image(Format::rgba16f, picture.width, picture.height);
  lens_flare(settings, picture, result, profile, pool);
  return result;
}

Image with_point(int width, int height, int x, int y, float light) {
  Image picture = make_image(Format::rgba16f, width, height);
  store_texel(picture, x, y, glm::vec4{light, light, light, 1.0f}, {});
  return picture;
}

/// The definition of scaled_copies(), in binary64.
double copied(const CopiesPass& pass, const Image& source, const Image& own, int x, int y, int c) {
  const auto light = [&](int i, int j) {
    const bool is_inside = i >= 0 && i < source.width && j >= 0 && j < source.height;
    return is_inside ? static_cast<double>(load_texel(source, i, j)[c]) : 0.0;
  };
  double sum = static_cast<double>(load_texel(own, x, y)[c]);
  for (const ScaledCopy& copy : pass.copies) {
    const auto place = [&](int pixel, float anchor) {
      return static_cast<double>(anchor) +
             static_cast<double>(copy.scale[c]) * (pixel + 0.5 - static_cast<double>(anchor));
    };
    const double u = place(x, pass.anchor.x), v = place(y, pass.anchor.y);
    const auto fade = [](double at, int size, float factor) {
      return std::clamp(std::min(at, size - at) * static_cast<double>(factor), 0.0, 1.0);
    };
    const double kept = fade(u, source.width, pass.fade.x) * fade(v, source.height, pass.fade.y);
    const int i = static_cast<int>(std::floor(u - 0.5)), j = static_cast<int>(std::floor(v - 0.5));
    const double s = u - 0.5 - i, t = v - 0.5 - j;
    const double sample = (1 - t) * ((1 - s) * light(i, j) + s * light(i + 1, j)) +
                          t * ((1 - s) * light(i, j + 1) + s * light(i + 1, j + 1));
    sum += static_cast<double>(copy.colour[c]) * kept * sample;
  }
  return sum;
}

glm::ivec2 brightest(const Image& picture) {
  glm::ivec2 found{0, 0};
  float most = -1.0f;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const float light = load_texel(picture, x, y).y;
      if (light > most) found = {x, y}, most = light;
    }
  }
  return found;
}

}  // namespace

TEST_CASE("scaled copies are what their definition says") {
  ThreadPool pool{2};
  const Image source = test::random_halves(37, 26, 5, 0.0, 4.0);
  const Image own = test::random_halves(37, 26, 6, 0.0, 1.0);
  for (const CopiesPass& pass :
       {rays_pass(0.7f, {9.25f, 20.5f}), ghosts_pass({.ghosts = 8, .fringe = 0.2f}, 37, 26)}) {
    Image result = make_image(Format::rgba16f, 37, 26);
    scaled_copies(pass, source, own, result, {}, pool);
    double worst = 0.0;
    for (int y = 0; y < 26; ++y) {
      for (int x = 0; x < 37; ++x) {
        for (int c = 0; c < 3; ++c) {
          const double expected = copied(pass, source, own, x, y, c);
          const double found = static_cast<double>(load_texel(result, x, y)[c]);
          worst = std::max(worst, std::abs(found - expected) / std::max(expected, 1.0));
        }
        REQUIRE(load_texel(result, x, y).w == load_texel(own, x, y).w);
      }
    }
    CHECK(worst < 6e-4);  // half a step of a half is 4.9e-4
  }
}

TEST_CASE("a ghost lies on the line through the light and the picture's middle") {
  ThreadPool pool{1};
  const Image light = with_point(101, 101, 80, 65, 100.0f), none = with_point(101, 101, 0, 0, 0.0f);
  for (const float scale : {-1.5f, -0.75f, 1.5f}) {
    const CopiesPass pass{{{glm::vec3{scale}, glm::vec3{1.0f}}}, {50.5f, 50.5f}, glm::vec2{1.0f}};
    Image result = make_image(Format::rgba16f, 101, 101);
    scaled_copies(pass, light, none, result, {}, pool);
    const glm::ivec2 found = brightest(result);
    CHECK(found.x == static_cast<int>(std::lround(50.0f + 30.0f / scale)));
    CHECK(found.y == static_cast<int>(std::lround(50.0f + 15.0f / scale)));
  }
}

TEST_CASE("a flare leaves a picture alone that has nothing bright, or at a strength of 0") {
  ThreadPool pool{2};
  const Image dark = test::random_halves(50, 41, 4, 0.0, 0.5);
  CHECK(equal(flared({.strength = 1.0f}, dark, pool), dark));
  const Image bright = with_point(40, 30, 10, 10, 50.0f);
  CHECK(equal(flared({.strength = 0.0f}, bright, pool), bright));
  CHECK(equal(
      flared({.strength = 1.0f, .ghosts = 0, .halo = 0, .streak_px = 0, .rays = 0}, bright, pool),
      bright));
}

TEST_CASE("light that is nearer than a flare begins has none") {
  ThreadPool pool{1};
  Image picture = with_point(64, 64, 20, 20, 500.0f);
  store_texel(picture, 20, 20, glm::vec4{500.0f, 500.0f, 500.0f, 9.5f}, {});
  CHECK(equal(flared({.beyond_m = 10.0f, .strength = 1.0f}, picture, pool), picture));
  CHECK_FALSE(equal(flared({.beyond_m = 9.5f, .strength = 1.0f}, picture, pool), picture));
}

TEST_CASE("streak and halo spread light, and neither makes nor loses any") {
  for (const float length : {0.5f, 7.0f, 1000.0f}) {
    const std::vector<float> weights = streak_weights(length);
    CHECK(weights.size() == 2 * static_cast<std::size_t>(length) + 1);
    CHECK(std::accumulate(weights.begin(), weights.end(), 0.0) == doctest::Approx(1.0));
    CHECK(std::equal(weights.begin(), weights.end(), weights.rbegin()));
    CHECK(std::is_sorted(weights.begin(), weights.begin() + std::ssize(weights) / 2 + 1));
    if (length > 1.0f) CHECK(weights.front() < 0.01f * weights[weights.size() / 2]);
  }
  for (const float radius : {0.1f, 3.0f, 12.0f}) {
    const Kernel halo = halo_kernel(radius);
    CHECK(std::accumulate(halo.weights.begin(), halo.weights.end(), 0.0) == doctest::Approx(1.0));
    const std::size_t middle = halo.weights.size() / 2;
    CHECK((halo.weights[middle] == 0.0f) == (radius > 2.0f));
    CHECK((halo.weights[middle + static_cast<std::size_t>(radius)] > 0.0f));
  }
}

TEST_CASE("the aperture's texture is a hexagon, brighter towards the rim, and keeps light's sum") {
  for (const float radius : {0.3f, 2.5f, 12.0f}) {
    CAPTURE(radius);
    const Kernel aperture = aperture_kernel(radius);
    CHECK(std::accumulate(aperture.weights.begin(), aperture.weights.end(), 0.0) ==
          doctest::Approx(1.0));
  }
  const Kernel wide = aperture_kernel(12.0f);
  const int reach = wide.width / 2;
  const auto at = [&](int x, int y) {
    return wide.weights[static_cast<std::size_t>((y + reach) * wide.width + x + reach)];
  };
  CHECK(at(11, 0) > at(0, 0));
  CHECK(at(11, 0) > 0.0f);   // a corner
  CHECK(at(0, 11) == 0.0f);  // beyond an edge, which is nearer than a corner
  CHECK(at(9, 9) == 0.0f);
}

TEST_CASE("scaled copies have the same bits in all vectors, whatever lies beyond the source") {
  const Image own = test::random_halves(41, 33, 6, -0.5, 1.0);
  Image source = test::random_halves(41, 33, 5, 0.0, 4.0);
  for (int y = 4; y < 20; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(source, y)) value = 0;
  }
  CopiesPass negative = ghosts_pass({.ghosts = 8, .fringe = 0.3f}, 41, 33);
  negative.anchor = {-7.5f, 50.25f};
  for (const CopiesPass& pass : {rays_pass(1.0f, {9.25f, 20.5f}),
                                 ghosts_pass({.ghosts = 8}, 41, 33), negative, CopiesPass{}}) {
    for (const char* name : {"ieee", "d3d11"}) {
      ThreadPool alone{1, Isa::scalar};
      Image expected = make_image(Format::rgba16f, 41, 33), result = expected;
      scaled_copies(pass, source, own, expected, profile_named(name), alone);
      for (const Isa isa : available_isas()) {
        ThreadPool pool{3, isa};
        scaled_copies(pass, source, own, result, profile_named(name), pool);
        REQUIRE(equal(result, expected));
      }
    }
  }
}

TEST_CASE("the middle of light is where most of it is, and the picture's if there is none") {
  CHECK(middle_of_light(with_point(40, 30, 11, 7, 3.0f)) == glm::vec2{11.5f, 7.5f});
  CHECK(middle_of_light(with_point(40, 30, 11, 7, 0.0f)) == glm::vec2{20.0f, 15.0f});
}

TEST_CASE("a flare in vectors and threads has the scalar form's bits") {
  const LensFlareSettings settings{.strength = 1.0f, .halo = 1.0f, .streak_px = 50.0f};
  for (const glm::ivec2 size : {glm::ivec2{1, 1}, {3, 70}, {37, 18}, {130, 110}}) {
    const Image picture = test::random_halves(size.x, size.y, 40, -0.5, 5.0);
    for (const char* name : {"ieee", "d3d11"}) {
      ThreadPool alone{1, Isa::scalar};
      const Image expected = flared(settings, picture, alone, profile_named(name));
      for (const Isa isa : available_isas()) {
        ThreadPool pool{3, isa};
        REQUIRE(equal(flared(settings, picture, pool, profile_named(name)), expected));
      }
    }
  }
}
