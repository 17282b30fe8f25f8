#include "raster/temporal/forward_reproject.h"

#include <doctest/doctest.h>

#include "tests/support/raster_helpers.h"
#include "tests/support/temporal_pictures.h"

using namespace softfocus;
using test::profile_named;

namespace {

struct Scattered {
  Image picture;
  std::int64_t holes;
};

Scattered scattered(const Image& before, const Image& velocity) {
  ThreadPool pool{2};
  Scattered result{make_image(Format::rgba16f, before.width, before.height), 0};
  result.holes = forward_reproject(before, velocity, result.picture, {}, pool);
  return result;
}

/// A row of depths, each with its column as red.
Image depth_row(std::initializer_list<float> depths) {
  Image image = make_image(Format::rgba16f, static_cast<int>(depths.size()), 1);
  int x = 0;
  for (const float depth : depths) {
    store_texel(image, x, 0, glm::vec4{static_cast<float>(x), 0.0f, 0.0f, depth}, {});
    ++x;
  }
  return image;
}

Image motion_row(std::initializer_list<float> motions) {
  Image image = make_image(Format::rg16f, static_cast<int>(motions.size()), 1);
  int x = 0;
  for (const float motion : motions) store_texel(image, x++, 0, {motion, 0.0f, 0.0f, 0.0f}, {});
  return image;
}

}  // namespace

TEST_CASE("forward reprojection of a pan by whole pixels is exact, and counts what was not seen") {
  const Image before = test::random_patches(37, 23, 1);
  const auto [picture, holes] = scattered(before, test::even_motion(37, 23, 3.0f, -2.0f));
  int wrong = 0;
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 37; ++x) {
      const bool was_seen = x >= 3 && y < 21;
      const glm::vec4 expected = was_seen ? load_texel(before, x - 3, y + 2) : glm::vec4{0.0f};
      if (load_texel(picture, x, y) != expected) ++wrong;
    }
  }
  CHECK(wrong == 0);
  CHECK(holes == 37 * 23 - 34 * 21);
}

TEST_CASE("of pixels that come to one place the nearest stays, and of equal ones the first") {
  const Scattered two = scattered(depth_row({2.0f, 1.0f, 3.0f, 1.0f}), motion_row({2, 1, 0, -1}));
  CHECK(load_texel(two.picture, 2, 0) == glm::vec4{1.0f, 0.0f, 0.0f, 1.0f});
  CHECK(two.holes == 3);
}

TEST_CASE("a pixel without a depth goes nowhere") {
  CHECK(scattered(depth_row({0.0f, -1.0f, NAN, 1.0f}), motion_row({0, 0, 0, 0})).holes == 3);
}

TEST_CASE("half a pixel is rounded to the right and down") {
  const Scattered moved = scattered(depth_row({1.0f, 1.0f, 1.0f}), motion_row({0.5f, 0.5f, 0.25f}));
  CHECK(load_texel(moved.picture, 1, 0).x == 0.0f);
  CHECK(load_texel(moved.picture, 2, 0).x == 1.0f);
}

TEST_CASE("a hole takes the farther surface beside it") {
  ThreadPool pool{1};
  const Image holes = depth_row({1.0f, 0.0f, 0.0f, 5.0f});
  Image filled = make_image(Format::rgba16f, 4, 1);
  CHECK(fill_holes(holes, filled, {}, pool) == 0);
  for (const int x : {1, 2}) CHECK(load_texel(filled, x, 0) == glm::vec4{3.0f, 0.0f, 0.0f, 5.0f});
  CHECK(load_texel(filled, 0, 0) == load_texel(holes, 0, 0));
}

TEST_CASE("a hole with nothing in reach stays and is counted") {
  ThreadPool pool{1};
  Image far = make_image(Format::rgba16f, kHoleReach + 3, 1), filled = far;
  store_texel(far, 0, 0, {1.0f, 1.0f, 1.0f, 1.0f}, {});
  CHECK(fill_holes(far, filled, {}, pool) == 2);
  CHECK(load_texel(filled, kHoleReach, 0).x == 1.0f);
  CHECK(load_texel(filled, kHoleReach + 1, 0).w == 0.0f);
}

TEST_CASE("forward reprojection has the same bits in any vectors and any number of threads") {
  for (const char* profile : {"ieee", "d3d11"}) {
    for (const Isa isa : available_isas()) {
      for (const int threads : {1, 3}) {
        for (const int width : {1, 19, 130}) {
          Image before = test::random_patches(width, 41, 5);
          Image velocity = test::random_motions(width, 41, 6, 30.0);
          for (Image* image : {&before, &velocity}) test::spoil(*image);
          ThreadPool pool{threads, isa}, of_four{1, Isa::scalar};
          Image expected = make_image(Format::rgba16f, width, 41), result = expected;
          const std::int64_t holes =
              forward_reproject(before, velocity, expected, profile_named(profile), of_four);
          CHECK(forward_reproject(before, velocity, result, profile_named(profile), pool) == holes);
          REQUIRE(equal(result, expected));
        }
      }
    }
  }
}

TEST_CASE("filled holes have the same bits in any vectors and any number of threads") {
  for (const char* profile : {"ieee", "d3d11", "swiftshader"}) {
    for (const int width : {1, 19, 130}) {
      Image scattered = test::random_patches(width, 41, 7);
      for (int y = 0; y < 41; ++y) {
        for (int x = y % 5; x < width; x += 5) store_texel(scattered, x, y, glm::vec4{0.0f}, {});
      }
      test::spoil(scattered);
      ThreadPool scalar{1, Isa::scalar};
      Image expected = make_image(Format::rgba16f, width, 41), result = expected;
      const std::int64_t left = fill_holes(scattered, expected, profile_named(profile), scalar);
      for (const Isa isa : available_isas()) {
        ThreadPool pool{3, isa};
        CHECK(fill_holes(scattered, result, profile_named(profile), pool) == left);
        REQUIRE(equal(result, expected));
      }
    }
  }
}
