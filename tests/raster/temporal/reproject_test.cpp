#include "raster/temporal/reproject.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

#include "tests/support/raster_helpers.h"
#include "tests/support/temporal_pictures.h"

using namespace softfocus;
using test::profile_named;

namespace {

Image reprojected(const ReprojectSettings& settings, const Image& depths, const Image& velocity,
                  const Image& before, const Image& frames) {
  ThreadPool pool{2};
  Image result = make_image(Format::rgba16f, depths.width, depths.height);
  reverse_reproject(settings, {depths, velocity, before, frames}, result, {}, pool);
  return result;
}

}  // namespace

TEST_CASE("reverse reprojection of a pan by whole pixels is exact") {
  const Image before = test::random_patches(37, 23, 1);
  constexpr int kRight = 3, kUp = 2;
  // Surfaces have moved kRight to the right and kUp upwards.
  Image now = make_image(Format::rgba16f, 37, 23);
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 37; ++x) {
      const int from_x = x - kRight, from_y = y + kUp;
      const bool was_seen = from_x >= 0 && from_y < 23;
      store_texel(now, x, y,
                  was_seen ? load_texel(before, from_x, from_y) : glm::vec4{0.0f, 0.0f, 0.0f, 9.0f},
                  {});
    }
  }
  for (const bool takes_neighbours : {false, true}) {
    const Image found = reprojected({0.1f, takes_neighbours, takes_neighbours}, now,
                                    test::even_motion(37, 23, kRight, -kUp), before,
                                    test::even_counts(37, 23, 5.0f));
    int wrong = 0;
    for (int y = 0; y < 23; ++y) {
      for (int x = 0; x < 37; ++x) {
        glm::vec4 expected = load_texel(now, x, y);
        expected.w = expected.w == 9.0f ? 0.0f : 5.0f;
        if (load_texel(found, x, y) != expected) ++wrong;
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("reverse reprojection is the bilinear mean of what fits in depth, to half a step") {
  const int width = 29, height = 21;
  const Image before = test::random_patches(width, height, 2);
  const Image depths = test::random_patches(width, height, 3);
  const Image velocity = test::random_motions(width, height, 4, 3.0);
  const Image found =
      reprojected({0.1f, false}, depths, velocity, before, test::even_counts(width, height, 2.0f));
  double worst = 0.0;
  int seen = 0, wrong_counts = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const glm::vec4 motion = load_texel(velocity, x, y);
      const double depth = static_cast<double>(load_texel(depths, x, y).w);
      const double u = x - static_cast<double>(motion.x), v = y - static_cast<double>(motion.y);
      glm::dvec3 sum{0.0};
      double all = 0.0;
      for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) {
          const double weight =
              std::max(0.0, 1 - std::fabs(u - i)) * std::max(0.0, 1 - std::fabs(v - j));
          const glm::dvec4 texel{load_texel(before, i, j)};
          if (weight <= 0.0 || std::fabs(texel.w - depth) > 0.1 * depth + 1e-6) continue;
          sum += weight * glm::dvec3{texel};
          all += weight;
        }
      }
      const glm::dvec4 got{load_texel(found, x, y)};
      if ((got.w == 2.0) != (all > 0.0)) ++wrong_counts;
      if (all <= 0.0) continue;
      ++seen;
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::fabs(sum[c] / all - got[c]));
    }
  }
  CHECK(wrong_counts == 0);
  CHECK(seen > width * height / 4);
  CHECK(worst < 0x1p-12 + 1e-6);
}

TEST_CASE(
    "reverse reprojection finds nothing of a surface at another depth, nor beyond the picture") {
  Image before = make_image(Format::rgba16f, 8, 8), depths = before;
  clear_image(before, {1.0f, 0.5f, 0.25f, 2.0f}, {});
  clear_image(depths, {0.0f, 0.0f, 0.0f, 3.0f}, {});
  const Image frames = test::even_counts(8, 8, 1.0f), still = test::even_motion(8, 8, 0.0f, 0.0f);
  const Image nothing = make_image(Format::rgba16f, 8, 8);
  CHECK(equal(reprojected({0.1f, true}, depths, still, before, frames), nothing));
  CHECK_FALSE(equal(reprojected({0.5f, true}, depths, still, before, frames), nothing));
  CHECK_FALSE(equal(reprojected({0.0f, true}, depths, still, before, frames), nothing));
  CHECK(
      equal(reprojected({0.0f, true}, depths, test::even_motion(8, 8, 8.0f, 0.0f), before, frames),
            nothing));
  CHECK(equal(
      reprojected({0.0f, true}, depths, test::even_motion(8, 8, 0.0f, -INFINITY), before, frames),
      nothing));
}

TEST_CASE("a cubic curve through pixels keeps a quadratic slope, which a bilinear mean does not") {
  Image before = make_image(Format::rgba16f, 16, 16);
  const auto slope = [](float x) { return 0.25f * x * x; };
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const float value = slope(static_cast<float>(x));
      store_texel(before, x, y, glm::vec4{value, value, value, 1.0f}, {});
    }
  }
  const Image frames = test::even_counts(16, 16, 1.0f);
  const Image motion = test::even_motion(16, 16, -0.5f, 0.25f);
  const Image cubic = reprojected({0.1f, false, true}, before, motion, before, frames);
  const Image linear = reprojected({0.1f, false, false}, before, motion, before, frames);
  CHECK(load_texel(cubic, 6, 7).x == doctest::Approx(slope(6.5f)).epsilon(0.0005));
  CHECK(load_texel(linear, 6, 7).x == doctest::Approx(slope(6.5f) + 0.0625f).epsilon(0.0005));
}

TEST_CASE("a pixel beside a nearer surface takes its motion") {
  Image before = make_image(Format::rgba16f, 8, 1), depths = before;
  for (int x = 0; x < 8; ++x) {
    store_texel(before, x, 0, glm::vec4{static_cast<float>(x), 0.0f, 0.0f, 1.0f}, {});
    store_texel(depths, x, 0, glm::vec4{0.0f, 0.0f, 0.0f, x == 4 ? 1.0f : 2.0f}, {});
  }
  Image velocity = test::even_motion(8, 1, 0.0f, 0.0f);
  store_texel(velocity, 4, 0, {2.0f, 0.0f, 0.0f, 0.0f}, {});
  const Image frames = test::even_counts(8, 1, 1.0f);
  const Image found = reprojected({0.0f, true}, depths, velocity, before, frames);
  for (const int x : {3, 4, 5}) CHECK(load_texel(found, x, 0).x == static_cast<float>(x - 2));
  for (const int x : {2, 6}) CHECK(load_texel(found, x, 0).x == static_cast<float>(x));
}

TEST_CASE("what is infinitely far is found again where it was, and not where something stood") {
  const float infinity = std::numeric_limits<float>::infinity();
  Image before = make_image(Format::rgba16f, 16, 8), depths = before;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 16; ++x) {
      store_texel(before, x, y, {static_cast<float>(x), 0.0f, 0.0f, x == 4 ? 2.0f : infinity}, {});
      store_texel(depths, x, y, {0.0f, 0.0f, 0.0f, infinity}, {});
    }
  }
  for (const float tolerance : {0.1f, 0.0f}) {
    for (const bool is_cubic : {false, true}) {
      const Image found =
          reprojected({tolerance, false, is_cubic}, depths, test::even_motion(16, 8, 1.0f, 0.0f),
                      before, test::even_counts(16, 8, 1.0f));
      CHECK(load_texel(found, 10, 4) == glm::vec4{9.0f, 0.0f, 0.0f, 1.0f});
      CHECK(load_texel(found, 5, 4).w == (tolerance > 0.0f ? 0.0f : 1.0f));
    }
  }
}

TEST_CASE("reverse reprojection has the same bits in all vectors, also of what is not finite") {
  for (const char* profile : {"ieee", "d3d11", "swiftshader"}) {
    for (const Isa isa : available_isas()) {
      for (const int width : {1, 3, 16, 19, 70}) {
        for (const int height : {1, 33}) {
          Image before = test::random_patches(width, height, 11);
          Image depths = test::random_patches(width, height, 12);
          Image velocity = test::random_motions(width, height, 13, 2.5);
          for (Image* image : {&before, &depths, &velocity}) test::spoil(*image);
          const Image frames = test::even_counts(width, height, 3.25f);
          ThreadPool pool{2, isa}, of_four{1, Isa::scalar};
          Image expected = make_image(Format::rgba16f, width, height), result = expected;
          for (const ReprojectSettings& settings :
               {ReprojectSettings{0.2f, true}, ReprojectSettings{0.0f, false},
                ReprojectSettings{0.3f, true, true}, ReprojectSettings{0.0f, false, true}}) {
            const ReprojectInput input{depths, velocity, before, frames};
            reverse_reproject(settings, input, expected, profile_named(profile), of_four);
            reverse_reproject(settings, input, result, profile_named(profile), pool);
            REQUIRE(equal(result, expected));
          }
        }
      }
    }
  }
}

TEST_CASE("what was found gets the frame's depth, and what was not stays, in any vectors") {
  for (const char* profile : {"ieee", "d3d11", "swiftshader"}) {
    for (const Isa isa : available_isas()) {
      for (const int width : {1, 19, 70}) {
        Image drawn = test::random_patches(width, 21, 14);
        Image found = test::random_patches(width, 21, 15);
        for (int x = 0; x < width; x += 3) store_texel(found, x, 9, glm::vec4{0.0f}, {});
        store_texel(found, 0, 10, {1.0f, 2.0f, 3.0f, 8.0f}, {});
        store_texel(drawn, 0, 10, {4.0f, 5.0f, 6.0f, 7.0f}, {});
        for (Image* image : {&drawn, &found}) test::spoil(*image);
        Image expected = found;
        ThreadPool pool{2, isa}, of_four{1, Isa::scalar};
        put_depths(drawn, expected, profile_named(profile), of_four);
        put_depths(drawn, found, profile_named(profile), pool);
        REQUIRE(equal(found, expected));
        CHECK(load_texel(found, 0, 9) == glm::vec4{0.0f});
        CHECK(load_texel(found, 0, 10) == glm::vec4{1.0f, 2.0f, 3.0f, 7.0f});
      }
    }
  }
}
