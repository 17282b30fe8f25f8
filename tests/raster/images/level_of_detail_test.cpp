#include "raster/images/sampler.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

TEST_CASE("log2_linear is exact at powers of two") {
  int wrong = 0;
  for (int k = -126; k <= 127; ++k)
    wrong += log2_linear(std::ldexp(1.0f, k)) != static_cast<float>(k);
  CHECK(wrong == 0);
}

TEST_CASE("log2_linear lies up to 0.0861 below the logarithm") {
  test::Random random{35};
  double lowest = 0.0;
  double highest = -1.0;
  for (int i = 0; i < 100'000; ++i) {
    const float x = std::ldexp(random.between(1.0f, 2.0f), random.whole(-126, 126));
    const double error = static_cast<double>(log2_linear(x)) - std::log2(static_cast<double>(x));
    lowest = std::min(lowest, error);
    highest = std::max(highest, error);
  }
  // One rounding of a sum up to 127.
  CHECK(lowest > -0.0861 - 0x1p-18);
  CHECK(lowest < -0.086);
  CHECK(highest <= 0x1p-18);
}

TEST_CASE("log2_linear is the exact straight line, rounded once") {
  test::Random random{36};
  int wrong = 0;
  for (int i = 0; i < 100'000; ++i) {
    const double mantissa = random.between(1.0f, 2.0f);
    const int exponent = random.whole(-126, 127);
    const auto x = static_cast<float>(std::ldexp(mantissa, exponent));
    wrong += log2_linear(x) != static_cast<float>(exponent - 1 + mantissa);
  }
  CHECK(wrong == 0);
}

TEST_CASE("log2_of_root_by_bits is exact at powers of two and lies up to 0.0216 below") {
  for (int k = -62; k <= 63; ++k)
    CHECK(log2_of_root_by_bits(std::ldexp(1.0f, k)) == 0.5f * static_cast<float>(k));
  test::Random random{38};
  double lowest = 0.0;
  double highest = -1.0;
  for (int i = 0; i < 100'000; ++i) {
    const float x = std::ldexp(random.between(1.0f, 2.0f), random.whole(-62, 62));
    const double error =
        static_cast<double>(log2_of_root_by_bits(x)) - 0.5 * std::log2(static_cast<double>(x));
    lowest = std::min(lowest, error);
    highest = std::max(highest, error);
  }
  // The integer is rounded to 24 bits of up to 2^30: 2^5 of 2^23ths, and a quarter of it.
  CHECK(lowest > -0.0861 / 4 - 0x1p-19);
  CHECK(lowest < -0.0215);
  CHECK(highest <= 0x1p-19);
}

TEST_CASE("log2_by_table is the logarithm of the value rounded to 9 bits") {
  test::Random random{37};
  int wrong = 0;
  for (int i = 0; i < 100'000; ++i) {
    const double mantissa = random.between(1.0f, 2.0f);
    const int exponent = random.whole(-126, 127);
    const auto x = static_cast<float>(std::ldexp(mantissa, exponent));
    const double rounded = std::floor(mantissa * 256.0 + 0.5) / 256.0;
    const auto expected = static_cast<float>(std::log2(rounded));
    wrong += log2_by_table(x) != static_cast<float>(exponent) + expected;
  }
  CHECK(wrong == 0);
}

TEST_CASE("log2_by_table of 0 is -127, as of 2^-127") {
  CHECK(log2_by_table(0.0f) == -127.0f);
  CHECK(log2_by_table(2.0f) == 1.0f);
}

TEST_CASE("softpipe's footprint is its longest side, where the others' is a length") {
  const Texture texture = make_texture(make_image(Format::r8, 64, 32));
  const glm::vec2 diagonal{4.0f / 64.0f, -4.0f / 32.0f};
  CHECK(level_of_detail(texture, diagonal, {}, profile_named("softpipe")) == 2.0f);
  CHECK(level_of_detail(texture, {}, diagonal, profile_named("softpipe")) == 2.0f);
  for (const std::string_view name : {"ieee", "d3d11", "llvmpipe", "llvmpipe-sse41"}) {
    CHECK(level_of_detail(texture, diagonal, {}, profile_named(name)) == 2.5f);
  }
}

TEST_CASE("softpipe's lod takes each of the four differences, of either sign") {
  const Texture texture = make_texture(make_image(Format::r8, 64, 32));
  const Profile profile = profile_named("softpipe");
  for (const float texels : {8.0f, -8.0f}) {
    const glm::vec2 along_u{texels / 64.0f, 0.0f};
    const glm::vec2 along_v{0.0f, texels / 32.0f};
    CHECK(level_of_detail(texture, along_u, {}, profile) == 3.0f);
    CHECK(level_of_detail(texture, along_v, {}, profile) == 3.0f);
    CHECK(level_of_detail(texture, {}, along_u, profile) == 3.0f);
    CHECK(level_of_detail(texture, {}, along_v, profile) == 3.0f);
  }
}

TEST_CASE("a footprint of one texel has lod 0, of two lod 1, of a half lod -1") {
  const Texture texture = make_texture(make_image(Format::r8, 16, 64));
  const glm::vec2 one_u{1.0f / 16.0f, 0.0f};
  const glm::vec2 one_v{0.0f, 1.0f / 64.0f};
  CHECK(level_of_detail(texture, one_u, one_v) == 0.0f);
  CHECK(level_of_detail(texture, one_u * 2.0f, one_v) == 1.0f);
  CHECK(level_of_detail(texture, one_u, one_v * 2.0f) == 1.0f);
  CHECK(level_of_detail(texture, one_u * 0.5f, one_v * 0.5f) == -1.0f);
  CHECK(level_of_detail(texture, one_u * 8.0f, -one_v * 32.0f) == 5.0f);
}

TEST_CASE("a footprint of length 0 has the most negative lod") {
  const Texture texture = make_texture(make_image(Format::r8, 16, 16));
  CHECK(level_of_detail(texture, {0.0f, 0.0f}, {0.0f, 0.0f}) == -63.5f);
}
