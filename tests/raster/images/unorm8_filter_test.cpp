#include "raster/images/integer_filter.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "raster/numbers/srgb.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;
using test::same_bits;

namespace {

constexpr std::array kWraps{Wrap::repeat, Wrap::clamp_to_edge};

Texture random_texture(Format format, int width, int height, std::uint64_t seed, int low = 0,
                       int high = 255) {
  Texture texture;
  test::Random random{seed};
  for (;;) {
    Image image = make_image(format, width, height);
    for (int y = 0; y < height; ++y) {
      for (std::uint8_t& byte : row<std::uint8_t>(image, y)) {
        byte = static_cast<std::uint8_t>(random.whole(low, high));
      }
    }
    texture.levels.push_back(std::move(image));
    if (width == 1 && height == 1) return texture;
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
  }
}

// A row of grey texels.
Texture row_texture(const std::vector<int>& values) {
  Image image = make_image(Format::r8, static_cast<int>(values.size()), 1);
  for (std::size_t x = 0; x < values.size(); ++x) {
    row<std::uint8_t>(image, 0)[x] = static_cast<std::uint8_t>(values[x]);
  }
  return make_texture(std::move(image));
}

// The 8-bit value that a float stands for.
int code(float value) { return static_cast<int>(std::lround(value * 255.0f)); }

int at(const Texture& texture, Wrap wrap, float u) {
  return code(sample_unorm8(texture, {Filter::bilinear, wrap, wrap}, {u, 0.5f}, 0, 0.0f).x);
}

}  // namespace

TEST_CASE("the 8-bit lerp is the exact one, rounded to nearest, ties up, of every a, b and w") {
  int wrong = 0;
  for (int weight = 0; weight < 256; ++weight) {
    for (int a = 0; a < 256; ++a) {
      for (int b = 0; b < 256; ++b) {
        const double exact = a + weight * (b - a) / 256.0;
        wrong += lerp_unorm8(a, b, weight) != static_cast<int>(std::floor(exact + 0.5));
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("linear 8-bit formats that repeat or clamp are filtered in integers, and no others") {
  for (const Wrap wrap_u : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge}) {
    for (const Wrap wrap_v : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge}) {
      const Sampler sampler{Filter::bilinear, wrap_u, wrap_v};
      const bool mirrored = wrap_u == Wrap::mirrored_repeat || wrap_v == Wrap::mirrored_repeat;
      CHECK(is_filtered_in_integers(Format::r8, sampler) == !mirrored);
      CHECK(is_filtered_in_integers(Format::rgba8, sampler) == !mirrored);
      for (const Format format : {Format::srgb8, Format::rgba16f, Format::r32f, Format::rgba32f}) {
        CHECK_FALSE(is_filtered_in_integers(format, sampler));
      }
    }
  }
}

TEST_CASE("llvmpipe samples 8-bit textures so, and mirrored ones in floats") {
  test::Random random{51};
  const Texture texture = random_texture(Format::rgba8, 16, 16, 52);
  const auto is_whole = [](glm::vec4 value) {
    for (int i = 0; i < 4; ++i) {
      if (unorm8_by_reciprocal(static_cast<std::uint8_t>(code(value[i]))) != value[i]) return false;
    }
    return true;
  };
  int whole = 0;
  int whole_mirrored = 0;
  for (int i = 0; i < 1'000; ++i) {
    const glm::vec2 uv{random.between(-2.0f, 2.0f), random.between(-2.0f, 2.0f)};
    const float lod = random.between(0.0f, 4.0f);
    const auto fetch = [&](Wrap wrap) {
      return sample(texture, {Filter::trilinear, wrap, Wrap::repeat}, uv, lod,
                    profile_named("llvmpipe"));
    };
    whole += is_whole(fetch(Wrap::clamp_to_edge));
    whole_mirrored += is_whole(fetch(Wrap::mirrored_repeat));
  }
  CHECK(whole == 1'000);
  CHECK(whole_mirrored < 10);
}

TEST_CASE("a weight is the position rounded to 1/256 of a texel, ties to even") {
  const Texture texture = row_texture({0, 255});
  // Texel 0's centre is at u = 1/4, texel 1's at 3/4: 256 steps of 1/512.
  const auto value = [&](float steps) {
    return at(texture, Wrap::clamp_to_edge, 0.25f + steps / 512.0f);
  };
  for (int step = 0; step < 256; ++step) {
    CHECK(value(static_cast<float>(step)) == (step * 255 + 128) / 256);
  }
  CHECK(value(128.0f) == 128);
  CHECK(value(128.5f) == 128);
  CHECK(value(128.75f) == value(129.0f));
  CHECK(value(129.5f) == value(130.0f));
}

TEST_CASE("a side that is no power of two has 256 weights between texels as well") {
  const Texture texture = row_texture({0, 255, 0});
  int wrong = 0;
  for (int step = 0; step < 256; ++step) {
    const float u = (0.5f + static_cast<float>(step) / 256.0f) / 3.0f;
    wrong += at(texture, Wrap::repeat, u) != (step * 255 + 128) / 256;
  }
  CHECK(wrong == 0);
}

TEST_CASE("rows are rounded to 8 bits before they are mixed") {
  Image image = make_image(Format::r8, 2, 2);
  row<std::uint8_t>(image, 0)[1] = 1;
  row<std::uint8_t>(image, 1)[1] = 1;
  // Half of 1 rounds up in each row: 1, where the mean of the four is a half as well.
  row<std::uint8_t>(image, 1)[0] = 0;
  Texture texture = make_texture(std::move(image));
  CHECK(at(texture, Wrap::clamp_to_edge, 0.5f) == 1);
  // (0, 1) and (0, 0): 1 and 0, then 1. The mean is a quarter.
  row<std::uint8_t>(texture.levels[0], 1)[1] = 0;
  CHECK(at(texture, Wrap::clamp_to_edge, 0.5f) == 1);
}

TEST_CASE("a constant 8-bit texture samples to its constant, at every code") {
  test::Random random{53};
  int wrong = 0;
  for (int k = 0; k < 256; ++k) {
    for (const auto& [width, height] : {std::pair{8, 4}, {5, 3}}) {
      const Texture texture = random_texture(Format::rgba8, width, height, 54, k, k);
      for (const Wrap wrap : kWraps) {
        for (int i = 0; i < 20; ++i) {
          const glm::vec2 uv{random.between(-9.0f, 9.0f), random.between(-9.0f, 9.0f)};
          const glm::vec4 value = sample_unorm8(texture, {Filter::trilinear, wrap, wrap}, uv, 0,
                                                random.between(0.0f, 1.0f));
          wrong += value != glm::vec4{unorm8_by_reciprocal(static_cast<std::uint8_t>(k))};
        }
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a fetch in integers lies between the smallest and the largest texel") {
  test::Random random{55};
  int outside = 0;
  for (std::uint64_t t = 0; t < 50; ++t) {
    const int low = random.whole(0, 250);
    const int high = random.whole(low, 255);
    const Texture texture = random_texture(Format::rgba8, 7, 8, t, low, high);
    for (const Wrap wrap : kWraps) {
      for (int i = 0; i < 200; ++i) {
        const glm::vec2 uv{random.between(-3.0f, 3.0f), random.between(-3.0f, 3.0f)};
        const glm::vec4 value = sample_unorm8(texture, {Filter::trilinear, wrap, wrap}, uv, 1,
                                              random.between(0.0f, 1.0f));
        for (int c = 0; c < 4; ++c) outside += code(value[c]) < low || code(value[c]) > high;
      }
    }
  }
  CHECK(outside == 0);
}

TEST_CASE("a repeating texture meets its other end, whether its side is a power of two or not") {
  for (const std::vector<int>& texels : {std::vector{10, 20, 30, 50}, {10, 20, 50}}) {
    const Texture texture = row_texture(texels);
    // Half-way between the last texel and the first.
    CHECK(at(texture, Wrap::repeat, 0.0f) == 30);
    CHECK(at(texture, Wrap::repeat, 1.0f) == 30);
    CHECK(at(texture, Wrap::repeat, -7.0f) == 30);
    CHECK(at(texture, Wrap::clamp_to_edge, 0.0f) == 10);
    CHECK(at(texture, Wrap::clamp_to_edge, 1.0f) == 50);
    CHECK(at(texture, Wrap::clamp_to_edge, -7.0f) == 10);
  }
}

TEST_CASE("far coordinates that no integer holds clamp to the last texel, on both sides") {
  const Texture texture = row_texture({10, 20, 30, 50});
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float far : {1e7f, 1e20f, kInfinity}) {
    CHECK(at(texture, Wrap::clamp_to_edge, far) == 50);
    CHECK(at(texture, Wrap::clamp_to_edge, -far) == 50);
  }
  CHECK(at(texture, Wrap::clamp_to_edge, std::numeric_limits<float>::quiet_NaN()) == 50);
  CHECK(at(texture, Wrap::clamp_to_edge, -1e6f) == 10);
}

TEST_CASE("the second level's weight is cut to 8 bits, and 0 leaves the level alone") {
  Texture texture = row_texture({0, 0});
  texture.levels.push_back(make_image(Format::r8, 1, 1));
  row<std::uint8_t>(texture.levels[1], 0)[0] = 255;
  const auto value = [&](float weight) {
    return code(sample_unorm8(texture, {}, {0.5f, 0.5f}, 0, weight).x);
  };
  CHECK(value(0.0f) == 0);
  CHECK(value(0.999f / 256.0f) == 0);
  CHECK(value(1.0f / 256.0f) == 1);
  CHECK(value(1.999f / 256.0f) == 1);
  CHECK(value(1.0f - 0x1p-24f) == 254);
}

TEST_CASE("a one-channel texture comes out as (value, 0, 0, 1)") {
  const Texture texture = row_texture({255, 255});
  CHECK(same_bits(sample_unorm8(texture, {}, {0.3f, 0.3f}, 0, 0.0f), {1.0f, 0.0f, 0.0f, 1.0f}));
}
