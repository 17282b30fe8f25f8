#include "raster/passes/pyramid.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

Image random_picture(int width, int height, std::uint64_t seed) {
  return test::random_halves(width, height, seed, 0.0, 4.0);
}

Image half_of(const Image& image) {
  return make_image(Format::rgba16f, (image.width + 1) / 2, (image.height + 1) / 2);
}

/// The mean of 4x4 pixels from (x, y) on.
double mean_of_16(const Image& image, int x, int y) {
  double sum = 0.0;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) sum += static_cast<double>(load_texel(image, x + i, y + j).x);
  }
  return sum / 16.0;
}

}  // namespace

TEST_CASE("the way down is five overlapping means, to half a step of the halves") {
  ThreadPool pool{2};
  const Image source = random_picture(40, 30, 1);
  Image result = half_of(source);
  downsample(source, result, {}, pool);
  double worst = 0.0;
  for (int y = 2; y < 13; ++y) {
    for (int x = 2; x < 18; ++x) {
      const int left = 2 * x - 2, top = 2 * y - 2;
      const double exact =
          0.5 * mean_of_16(source, left + 1, top + 1) +
          0.125 * (mean_of_16(source, left, top) + mean_of_16(source, left + 2, top) +
                   mean_of_16(source, left, top + 2) + mean_of_16(source, left + 2, top + 2));
      worst = std::max(worst, std::fabs(exact - static_cast<double>(load_texel(result, x, y).x)));
    }
  }
  CHECK(worst <= 0x1p-10 * 1.01);
}

TEST_CASE("the way up is a tent of bilinear samples, to half a step of the halves") {
  ThreadPool pool{2};
  const Image source = random_picture(20, 15, 2);
  const Image own = make_image(Format::rgba16f, 40, 30);
  Image result = make_image(Format::rgba16f, 40, 30);
  upsample(source, own, {1.0f}, result, {}, pool);
  const auto bilinear = [&](double x, double y) {
    const int column = static_cast<int>(std::floor(x)), line = static_cast<int>(std::floor(y));
    const double u = x - column, v = y - line;
    const auto at = [&](int i, int j) {
      return static_cast<double>(load_texel(source, column + i, line + j).x);
    };
    return (1 - v) * ((1 - u) * at(0, 0) + u * at(1, 0)) + v * ((1 - u) * at(0, 1) + u * at(1, 1));
  };
  double worst = 0.0;
  for (int y = 6; y < 24; ++y) {
    for (int x = 6; x < 34; ++x) {
      const double u = (x + 0.5) / 2 - 0.5, v = (y + 0.5) / 2 - 0.5;
      double exact = 0.0;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          exact += (2 - std::abs(i)) * (2 - std::abs(j)) / 16.0 * bilinear(u + i, v + j);
        }
      }
      worst = std::max(worst, std::fabs(exact - static_cast<double>(load_texel(result, x, y).x)));
    }
  }
  CHECK(worst <= 0x1p-10 * 1.01);
}

TEST_CASE("a pyramid keeps what is even, and the sum of light away from the edges") {
  ThreadPool pool{1};
  Image even = make_image(Format::rgba16f, 21, 13);
  for (int y = 0; y < 13; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(even, y)) value = 0x3A00;
  }
  Image down = half_of(even), up = make_image(Format::rgba16f, 21, 13);
  downsample(even, down, {}, pool);
  upsample(down, even, {1.0f}, up, {}, pool);
  CHECK(equal(up, even));

  Image point = make_image(Format::rgba16f, 32, 32);
  store_texel(point, 15, 17, glm::vec4{1024.0f}, {});
  Image half = half_of(point), back = make_image(Format::rgba16f, 32, 32);
  downsample(point, half, {}, pool);
  upsample(half, make_image(Format::rgba16f, 32, 32), {1.0f}, back, {}, pool);
  double sum = 0.0;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) sum += static_cast<double>(load_texel(back, x, y).x);
  }
  CHECK(sum == doctest::Approx(1024.0).epsilon(0.001));
}

TEST_CASE("upsample mixes by its share: with 0 nothing changes") {
  ThreadPool pool{1};
  const Image source = random_picture(9, 6, 3), own = random_picture(17, 12, 4);
  Image result = make_image(Format::rgba16f, 17, 12);
  upsample(source, own, {0.0f}, result, {}, pool);
  CHECK(equal(result, own));
}

TEST_CASE("a pyramid has the same bits in all vectors") {
  for (const char* profile : {"ieee", "d3d11", "swiftshader"}) {
    for (const Isa isa : available_isas()) {
      ThreadPool pool{2, isa}, of_four{1, Isa::scalar};
      for (const int width : {1, 2, 3, 7, 16, 33, 64}) {
        for (const int height : {1, 2, 5, 64, 131}) {
          const Image source = random_picture(width, height, 5);
          Image expected = half_of(source), result = expected;
          downsample(source, expected, profile_named(profile), of_four);
          downsample(source, result, profile_named(profile), pool);
          REQUIRE(equal(result, expected));
          Image up = make_image(Format::rgba16f, width, height), expected_up = up;
          upsample(expected, source, {0.4f}, expected_up, profile_named(profile), of_four);
          upsample(expected, source, {0.4f}, up, profile_named(profile), pool);
          REQUIRE(equal(up, expected_up));
        }
      }
    }
  }
}

TEST_CASE("the bilinear way up is one bilinear sample, to half a step of the halves") {
  ThreadPool pool{2};
  const Image source = random_picture(20, 15, 2), own = random_picture(40, 30, 3);
  Image result = make_image(Format::rgba16f, 40, 30);
  upsample(source, own, {.widening = Widening::bilinear, .alone = true}, result, {}, pool);
  double worst = 0.0;
  int wrong_alphas = 0;
  for (int y = 1; y < 29; ++y) {
    for (int x = 1; x < 39; ++x) {
      const double u = (x + 0.5) / 2 - 0.5, v = (y + 0.5) / 2 - 0.5;
      const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
      const auto across = [&](int line) {
        return std::lerp(static_cast<double>(load_texel(source, i, line).x),
                         static_cast<double>(load_texel(source, i + 1, line).x), u - i);
      };
      const double exact = std::lerp(across(j), across(j + 1), v - j);
      worst = std::max(worst, std::fabs(exact - static_cast<double>(load_texel(result, x, y).x)));
      wrong_alphas += load_texel(result, x, y).w != load_texel(own, x, y).w;
    }
  }
  CHECK(worst <= 0x1p-10 * 1.01);
  CHECK(wrong_alphas == 0);
}

TEST_CASE("each way up has the same bits in all vectors, alone or mixed") {
  for (const Isa isa : available_isas()) {
    ThreadPool pool{2, isa}, of_four{1, Isa::scalar};
    for (const int width : {1, 2, 17, 64}) {
      const Image own = random_picture(width, 37, 11);
      Image source = half_of(own);
      downsample(own, source, {}, pool);
      Image expected = make_image(Format::rgba16f, width, 37), result = expected;
      for (const Widening widening : {Widening::tent, Widening::bilinear}) {
        for (const bool alone : {false, true}) {
          const Upsampling how{0.3f, widening, alone};
          upsample(source, own, how, expected, {}, of_four);
          upsample(source, own, how, result, {}, pool);
          REQUIRE(equal(result, expected));
        }
      }
    }
  }
}

TEST_CASE("a dual filter twice as deep spreads a point twice as far, and keeps its sum") {
  ThreadPool pool{2};
  Image point = make_image(Format::rgba16f, 256, 256);
  store_texel(point, 128, 127, glm::vec4{4096.0f}, {});
  double before = 0.0;
  for (const int levels : {1, 2, 3, 4}) {
    CAPTURE(levels);
    Image result = make_image(Format::rgba16f, 256, 256);
    dual_filter(levels, Widening::tent, point, result, {}, pool);
    double sum = 0.0, across = 0.0, mean = 0.0;
    for (int y = 0; y < 256; ++y) {
      for (int x = 0; x < 256; ++x) {
        const auto light = static_cast<double>(load_texel(result, x, y).x);
        sum += light;
        mean += light * x;
        across += light * x * x;
      }
    }
    const double sigma = std::sqrt(across / sum - std::pow(mean / sum, 2));
    CHECK(sum == doctest::Approx(4096.0).epsilon(0.002));
    if (before > 0.0) CHECK(sigma / before == doctest::Approx(2.0).epsilon(0.1));
    before = sigma;
  }
}
