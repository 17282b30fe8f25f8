#include "raster/effects/bloom.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

Image bloomed(const BloomSettings& settings, const Image& picture, ThreadPool& pool,
              const Profile& profile = {}) {
  Image result = make_image(Format::rgba16f, picture.width, picture.height);
  bloom(settings, picture, result, profile, pool);
  return result;
}

Image with_point(int size, int x, int y, float light) {
  Image picture = make_image(Format::rgba16f, size, size);
  store_texel(picture, x, y, glm::vec4{light, light, light, 1.0f}, {});
  return picture;
}

Image by_gaussian(const GaussianBloomSettings& settings, const Image& picture, ThreadPool& pool,
                  const Profile& profile = {}) {
  Image result = make_image(Format::rgba16f, picture.width, picture.height);
  bloom_by_gaussian(settings, picture, result, profile, pool);
  return result;
}

double sum_of_red(const Image& picture) {
  double sum = 0.0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      sum += static_cast<double>(load_texel(picture, x, y).x);
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("bloom moves light and keeps its sum") {
  ThreadPool pool{2};
  const Image picture = with_point(256, 128, 127, 4000.0f);
  for (const float spread : {0.0f, 0.6f, 1.0f}) {
    const Image result = bloomed({.strength = 0.5f, .levels = 4, .spread = spread}, picture, pool);
    CHECK(sum_of_red(result) == doctest::Approx(4000.0).epsilon(0.004));
    CHECK(load_texel(result, 128, 127).x < 4000.0f);
    CHECK(load_texel(result, 131, 127).x > 0.0f);
  }
}

TEST_CASE("bloom leaves a picture alone that has nothing bright, or at a strength of 0") {
  ThreadPool pool{1};
  const Image dark = test::random_halves(50, 41, 4, 0.0, 0.5);
  CHECK(equal(bloomed({.strength = 1.0f}, dark, pool), dark));
  const Image bright = with_point(40, 10, 10, 50.0f);
  CHECK(equal(bloomed({.strength = 0.0f}, bright, pool), bright));
}

TEST_CASE("bloom begins softly at the threshold less the knee") {
  ThreadPool pool{1};
  const auto lost = [&](float light) {
    const Image picture = with_point(64, 32, 32, light);
    return light -
           load_texel(bloomed({.threshold = 2.0f, .knee = 1.0f, .strength = 1.0f}, picture, pool),
                      32, 32)
               .x;
  };
  CHECK(lost(1.0f) == 0.0f);
  CHECK(lost(1.5f) > 0.0f);
  CHECK(lost(2.0f) > lost(1.5f));
  CHECK(lost(2.0f) == doctest::Approx(0.25).epsilon(0.05));  // (2 - 1)^2 / 4, less what returns
  CHECK(lost(4.0f) == doctest::Approx(2.0).epsilon(0.05));
}

TEST_CASE("steady bloom of one pixel is darker than plain, and of an even area as bright") {
  ThreadPool pool{1};
  const Image point = with_point(128, 64, 64, 1000.0f);
  const BloomSettings plain{.strength = 1.0f}, steady{.strength = 1.0f, .is_steady = true};
  CHECK(sum_of_red(bloomed(steady, point, pool)) < 0.2 * sum_of_red(bloomed(plain, point, pool)));
  Image even = make_image(Format::rgba16f, 32, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) store_texel(even, x, y, glm::vec4{3.0f, 4.0f, 5.0f, 1.0f}, {});
  }
  const glm::vec4 colour = load_texel(bloomed(steady, even, pool), 16, 16);
  CHECK(colour.x == doctest::Approx(3.0).epsilon(0.005));
  CHECK(colour.z == doctest::Approx(5.0).epsilon(0.005));
}

TEST_CASE("bloom takes what is not finite, and gives nothing else that is not") {
  ThreadPool pool{2};
  Image picture = with_point(40, 20, 20, 3.0f);
  row<std::uint16_t>(picture, 5)[4 * 7] = 0x7C00;
  row<std::uint16_t>(picture, 9)[4 * 3 + 1] = 0x7E00;
  row<std::uint16_t>(picture, 30)[4 * 30 + 2] = 0xC400;
  const Image result = bloomed({.strength = 0.3f}, picture, pool);
  int not_finite = 0;
  for (int y = 0; y < 40; ++y) {
    for (const std::uint16_t value : row<std::uint16_t>(result, y)) {
      not_finite += !std::isfinite(half_to_float(value));
    }
  }
  CHECK(not_finite == 2);
}

TEST_CASE("bloom in vectors has the scalar form's bits") {
  for (const std::array<int, 2> size : {std::array{1, 1}, {3, 70}, {37, 18}, {64, 64}}) {
    const Image picture = test::random_halves(size[0], size[1], 40, -0.5, 5.0);
    for (const char* name : {"ieee", "d3d11", "swiftshader"}) {
      for (const bool is_steady : {false, true}) {
        const BloomSettings settings{.strength = 0.4f, .levels = 3, .is_steady = is_steady};
        ThreadPool alone{1, Isa::scalar};
        const Image expected = bloomed(settings, picture, alone, profile_named(name));
        for (const Isa isa : available_isas()) {
          ThreadPool pool{2, isa};
          REQUIRE(equal(bloomed(settings, picture, pool, profile_named(name)), expected));
        }
      }
    }
  }
}

TEST_CASE("bloom without bright light has the bits of all its passes, specials too") {
  // A light too weak for a half makes all passes run, and adds nothing.
  const Image picture = test::random_halves(53, 31, 12, -1.0, 0.5);
  Image faint = picture;
  row<std::uint16_t>(faint, 30)[4 * 52] = float_to_half(0.501f, HalfRounding::nearest_even);
  for (const char* name : {"ieee", "d3d11"}) {
    for (const Isa isa : available_isas()) {
      ThreadPool pool{2, isa};
      const BrightPass pass = bright_pass_of(BloomSettings{.knee = 0.4991f});
      CHECK_FALSE(has_bright_light(pass, picture, pool));
      CHECK(has_bright_light(pass, faint, pool));
      Image skipped =
          bloomed({.knee = 0.4991f, .strength = 1.0f}, picture, pool, profile_named(name));
      const Image run =
          bloomed({.knee = 0.4991f, .strength = 1.0f}, faint, pool, profile_named(name));
      row<std::uint16_t>(skipped, 30)[4 * 52] = row<std::uint16_t>(run, 30)[4 * 52];
      CHECK(equal(skipped, run));
    }
  }
}

TEST_CASE("bloom by a Gaussian is picture + strength (scattered - bright), in binary64") {
  constexpr int kWidth = 23, kHeight = 17;
  constexpr double kSigma = 2.5;
  constexpr int kReach = 7;  // whole distances up to 3 sigma
  const Image picture = test::random_halves(kWidth, kHeight, 31, 0.0, 6.0);
  // The light of channel c.
  const auto light = [&](int x, int y, int c) {
    const glm::dvec4 texel{
        load_texel(picture, std::clamp(x, 0, kWidth - 1), std::clamp(y, 0, kHeight - 1))};
    const double most = std::max({texel.x, texel.y, texel.z});
    const double soft = std::pow(std::clamp(most - 1.5, 0.0, 1.0), 2) / 2.0;
    return texel[c] * std::max(most - 2.0, soft) / most;
  };
  const auto weight = [](int x, int y) {
    return std::exp(-(x * x + y * y) / (2 * kSigma * kSigma));
  };
  double whole = 0.0;
  for (int j = -kReach; j <= kReach; ++j) {
    for (int i = -kReach; i <= kReach; ++i) whole += weight(i, j);
  }
  ThreadPool pool{2};
  const Image result = by_gaussian(
      {.threshold = 2.0f, .knee = 0.5f, .strength = 0.5f, .sigma_px = kSigma}, picture, pool);
  double most_off = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) {
        double scattered = 0.0;
        for (int j = -kReach; j <= kReach; ++j) {
          for (int i = -kReach; i <= kReach; ++i) {
            scattered += weight(i, j) / whole * light(x + i, y + j, c);
          }
        }
        const double truth =
            static_cast<double>(load_texel(picture, x, y)[c]) + 0.5 * (scattered - light(x, y, c));
        most_off =
            std::max(most_off, std::abs(static_cast<double>(load_texel(result, x, y)[c]) - truth));
      }
    }
  }
  // Halves below 8 are 2^-8 apart; those of the passes before weigh half.
  CHECK(most_off < 1.0 / 256.0);
}

TEST_CASE("bloom by a Gaussian moves light, keeps its sum, and no more than a pixel with sigma 0") {
  ThreadPool pool{2};
  const Image point = with_point(128, 64, 63, 4000.0f);
  for (const double sigma : {0.0, 1.0, 8.0}) {
    const Image result = by_gaussian({.strength = 0.5f, .sigma_px = sigma}, point, pool);
    CHECK(sum_of_red(result) == doctest::Approx(4000.0).epsilon(0.004));
    CHECK((load_texel(result, 66, 63).x > 0.0f) == (sigma > 0.0));
  }
}

TEST_CASE("bloom by a Gaussian leaves a picture alone that has nothing bright") {
  ThreadPool pool{1};
  const Image dark = test::random_halves(50, 41, 4, 0.0, 0.5);
  CHECK(equal(by_gaussian({.strength = 1.0f}, dark, pool), dark));
}

TEST_CASE("bloom by a Gaussian in vectors has the scalar form's bits") {
  for (const std::array<int, 2> size : {std::array{1, 1}, {3, 70}, {37, 18}, {64, 64}}) {
    const Image picture = test::random_halves(size[0], size[1], 41, -0.5, 5.0);
    for (const char* name : {"ieee", "d3d11", "swiftshader"}) {
      const GaussianBloomSettings settings{.strength = 0.4f, .sigma_px = 3.0};
      ThreadPool alone{1, Isa::scalar};
      const Image expected = by_gaussian(settings, picture, alone, profile_named(name));
      for (const Isa isa : available_isas()) {
        ThreadPool pool{2, isa};
        REQUIRE(equal(by_gaussian(settings, picture, pool, profile_named(name)), expected));
      }
    }
  }
}
