// The texture units of drivers, where they part from the plain one.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "raster/images/driver_samplers.h"
#include "raster/images/texel.h"
#include "raster/numbers/fixed_point.h"
#include "raster/numbers/lerp.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;
using test::row_texture;
using test::same_bits;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
constexpr std::array kWraps{Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};
constexpr std::array kDrivers{"llvmpipe", "llvmpipe-sse41", "softpipe"};

// Three levels whose texels are their numbers.
Texture numbered_levels() {
  Texture texture;
  for (int level = 0; level < 3; ++level) {
    texture.levels.push_back(make_image(Format::rgba32f, 4 >> level, 4 >> level));
    clear_image(texture.levels.back(), glm::vec4{static_cast<float>(level)}, {});
  }
  return texture;
}

float sample_row(const Texture& texture, Sampler sampler, float u, const char* name) {
  return sample(texture, sampler, {u, 0.5f}, 0.0f, profile_named(name)).x;
}

constexpr Sampler kEdge{Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge};

}  // namespace

TEST_CASE("a float that no int holds converts to the least one") {
  CHECK(truncate_to_int(-1.9f) == -1);
  CHECK(truncate_to_int(2147483520.0f) == 2147483520);
  CHECK(truncate_to_int(-0x1p31f) == kLeast);
  for (const float far : {0x1p31f, 1e30f, -1e30f, kInfinity, -kInfinity, kNan}) {
    CHECK(truncate_to_int(far) == kLeast);
    CHECK(round_to_int(far) == kLeast);
  }
}

TEST_CASE("rounding to an int takes ties to even") {
  CHECK(round_to_int(0.5f) == 0);
  CHECK(round_to_int(1.5f) == 2);
  CHECK(round_to_int(2.5f) == 2);
  CHECK(round_to_int(-0.5f) == 0);
  CHECK(round_to_int(-1.5f) == -2);
  CHECK(round_to_int(2.50001f) == 3);
}

TEST_CASE("softpipe's floor is floor up to 2^22, but for specks below 0") {
  test::Random random{61};
  int wrong = 0;
  for (int i = 0; i < 100'000; ++i) {
    const float value = std::ldexp(random.between(-1.0f, 1.0f), random.whole(-29, 22));
    if (value < 0.0f && value > -0x1p-30f) continue;
    wrong += softpipe_floor(value) != static_cast<int>(std::floor(value));
  }
  CHECK(wrong == 0);
  CHECK(softpipe_floor(-1e-20f) == 0);
  CHECK(softpipe_floor(kNan) == 0);
}

TEST_CASE("no coordinate leads a driver's unit outside the texture") {
  test::Random random{62};
  int outside = 0;
  for (const int size : {1, 2, 3, 7, 64, 100, 16384}) {
    for (const int base_size : {size, 3 * size}) {
      for (const Wrap wrap : kWraps) {
        // llvmpipe masks levels of power-of-two textures, so they must be one as well.
        for (int i = 0; i < 5'000; ++i) {
          float u = std::bit_cast<float>(static_cast<std::uint32_t>(random.next()));
          if (i % 3 == 0) u = random.between(-2.0f, 2.0f);
          const Taps a = llvmpipe_taps(u, size, base_size, wrap);
          const Taps b = softpipe_taps(u, size, wrap);
          const Taps c = swiftshader_taps(u, size, wrap);
          for (const int index :
               {a.first, a.second, b.first, b.second, c.first, c.second,
                llvmpipe_nearest(u, size, base_size, wrap), softpipe_nearest(u, size, wrap),
                swiftshader_nearest(u, size, wrap), swiftshader_nearest_byte(u, size, wrap)}) {
            outside += index < 0 || index >= size;
          }
        }
      }
    }
  }
  CHECK(outside == 0);
}

TEST_CASE("a far coordinate clamps to the near end in llvmpipe's nearest fetch") {
  // The 32-bit integer that it becomes is the least one.
  CHECK(llvmpipe_nearest(1e6f, 4, 4, Wrap::clamp_to_edge) == 3);
  CHECK(llvmpipe_nearest(1e10f, 4, 4, Wrap::clamp_to_edge) == 0);
  CHECK(llvmpipe_nearest(kNan, 4, 4, Wrap::clamp_to_edge) == 0);
}

TEST_CASE("NaN is the last texel to llvmpipe's bilinear fetch, and the first to softpipe's") {
  const Texture texture = row_texture({1.0f, 2.0f, 3.0f, 4.0f});
  CHECK(sample_row(texture, kEdge, kNan, "llvmpipe") == 4.0f);
  CHECK(sample_row(texture, kEdge, kNan, "softpipe") == 1.0f);
}

TEST_CASE("repeating llvmpipe textures follow the size of level 0") {
  // A level of 2 texels: of a base of 4 it is masked, of a base of 5 taken as a fraction.
  // A coordinate of -2^-30 is then a fraction of 1, which lies right of the last texel.
  const Taps masked = llvmpipe_taps(-0x1p-30f, 2, 4, Wrap::repeat);
  const Taps fraction = llvmpipe_taps(-0x1p-30f, 2, 5, Wrap::repeat);
  CHECK(masked.first == 1);
  CHECK(masked.second == 0);
  CHECK(fraction.first == 1);
  CHECK(fraction.second == 0);
  CHECK(std::isfinite(llvmpipe_taps(1e38f, 2, 4, Wrap::repeat).weight));
  CHECK(std::isnan(llvmpipe_taps(kInfinity, 2, 5, Wrap::repeat).weight));
  CHECK(llvmpipe_taps(kInfinity, 2, 5, Wrap::repeat).first == 1);
}

TEST_CASE("softpipe reads the texel beside the one at whose centre a mirrored fetch stands") {
  const Texture texture = row_texture({1.0f, 2.0f, 3.0f, 4.0f});
  const Sampler mirrored{Filter::bilinear, Wrap::mirrored_repeat, Wrap::mirrored_repeat};
  // 1.125 is the centre of the first texel of the second cell, the last texel.
  CHECK(sample_row(texture, mirrored, 1.125f, "llvmpipe") == 4.0f);
  CHECK(sample_row(texture, mirrored, 1.375f, "llvmpipe") == 3.0f);
  CHECK(sample_row(texture, mirrored, 1.375f, "softpipe") == 4.0f);
  CHECK(sample_row(texture, mirrored, 1.25f, "softpipe") == 3.5f);
  CHECK(sample_row(texture, mirrored, 0.375f, "softpipe") == 2.0f);
}

TEST_CASE("llvmpipe rounds the lod to the nearest level, ties to even, and softpipe ties up") {
  const Texture texture = numbered_levels();
  const auto level = [&](float lod, const char* name) {
    return sample(texture, kEdge, {0.4f, 0.4f}, lod, profile_named(name)).x;
  };
  CHECK(level(0.5f, "llvmpipe") == 0.0f);
  CHECK(level(0.5f, "softpipe") == 1.0f);
  CHECK(level(1.5f, "llvmpipe") == 2.0f);
  CHECK(level(1.5f, "softpipe") == 2.0f);
  CHECK(level(0.51f, "llvmpipe") == 1.0f);
}

TEST_CASE("a lod that no integer holds is level 0 to llvmpipe and the last to softpipe") {
  const Texture texture = numbered_levels();
  for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::trilinear}) {
    const auto level = [&](float lod, const char* name) {
      return sample(texture, {filter, {}, {}}, {0.4f, 0.4f}, lod, profile_named(name)).x;
    };
    for (const char* name : kDrivers) {
      CHECK(level(1e9f, name) == 2.0f);
      CHECK(level(kNan, name) == 0.0f);
      CHECK(level(-kInfinity, name) == 0.0f);
    }
    CHECK(level(kInfinity, "llvmpipe") == 0.0f);
    CHECK(level(1e10f, "llvmpipe-sse41") == 0.0f);
    CHECK(level(kInfinity, "softpipe") == 2.0f);
  }
}

TEST_CASE("an infinite texel makes every bilinear fetch that reads it NaN, with weight 0 too") {
  const Texture texture = row_texture({1.0f, kInfinity});
  for (const char* name : kDrivers) {
    CHECK(std::isnan(sample_row(texture, kEdge, 0.25f, name)));
    CHECK(std::isnan(sample_row(texture, kEdge, 0.75f, name)));
    // Both rows are infinite here, and their difference has no value.
    CHECK(std::isnan(sample_row(texture, kEdge, 0.375f, name)));
    CHECK(sample_row(texture, {Filter::nearest, {}, {}}, 0.25f, name) == 1.0f);
  }
}

TEST_CASE("an infinite next level of weight 0 shows in softpipe, and not in llvmpipe") {
  Texture texture = numbered_levels();
  clear_image(texture.levels[2], glm::vec4{kInfinity}, {});
  const Sampler sampler{Filter::trilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
  const auto value = [&](const char* name) {
    return sample(texture, sampler, {0.4f, 0.4f}, 1.0f, profile_named(name)).x;
  };
  CHECK(value("llvmpipe") == 1.0f);
  CHECK(std::isnan(value("softpipe")));
}

TEST_CASE("filters flush subnormals in llvmpipe, and nearest fetches keep them") {
  const Texture texture = row_texture({1e-40f, 1e-40f});
  const Sampler nearest{Filter::nearest, {}, {}};
  for (const char* name : {"llvmpipe", "llvmpipe-sse41"}) {
    CHECK(sample_row(texture, kEdge, 0.5f, name) == 0.0f);
    CHECK(sample_row(texture, nearest, 0.5f, name) == 1e-40f);
  }
  CHECK(sample_row(texture, kEdge, 0.5f, "softpipe") == 1e-40f);
  CHECK(sample_row(texture, nearest, 0.5f, "softpipe") == 1e-40f);
}

TEST_CASE("half subnormals are no float subnormals: every filter keeps them") {
  const Texture texture = row_texture({0x1p-24f, 0x1p-24f}, Format::rgba16f);
  for (const char* name : kDrivers) CHECK(sample_row(texture, kEdge, 0.5f, name) == 0x1p-24f);
}

TEST_CASE("what a one-channel texture lacks is 0, 0 and 1, whatever the weights") {
  const Texture texture = row_texture({1.0f, 2.0f, 3.0f}, Format::r32f);
  for (const char* name : {"llvmpipe", "softpipe"}) {
    const glm::vec4 value = sample(texture, {Filter::bilinear, Wrap::repeat, Wrap::repeat},
                                   {kInfinity, 0.5f}, 0.0f, profile_named(name));
    CHECK(std::isnan(value.x));
    CHECK(same_bits({0.0f, value.y, value.z, value.w}, {0.0f, 0.0f, 0.0f, 1.0f}));
  }
}

TEST_CASE("a flushing lerp takes subnormals for zeros, before and after each operation") {
  for (const char* name : {"llvmpipe", "llvmpipe-sse41"}) {
    Profile profile = profile_named(name);
    CHECK(lerp(0x1p-127f, 0x1p-126f, 1.0f, profile) == 0x1p-126f);    // a: 0
    CHECK(lerp(0.0f, 1e38f, 1e-40f, profile) == 0.0f);                // t: 0
    CHECK(lerp(0x1p-126f, 0x1.8p-126f, 0.5f, profile) == 0x1p-126f);  // b - a: 0
    CHECK(lerp(0.0f, 0x1p-126f, 0.5f, profile) == 0.0f);              // the result
    profile.denormals = Denormals::keep;
    CHECK(lerp(0x1p-127f, 0x1p-126f, 0.0f, profile) == 0x1p-127f);
    CHECK(lerp(0.0f, 1e38f, 1e-40f, profile) > 0.0f);
    CHECK(lerp(0x1p-126f, 0x1.8p-126f, 0.5f, profile) == 0x1.4p-126f);
    CHECK(lerp(0.0f, 0x1p-126f, 0.5f, profile) == 0x1p-127f);
  }
}

TEST_CASE("softpipe's cache hands out another tile's texel where two of a fetch share a slot") {
  // Texels are their own numbers, y * 256 + x.
  Image image = make_image(Format::rgba32f, 256, 256);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      store_texel(image, x, y, glm::vec4{static_cast<float>(y * 256 + x)}, {});
    }
  }
  const Texture texture = make_texture(std::move(image));
  const Sampler sampler{Filter::bilinear, Wrap::repeat, Wrap::repeat};
  // Half-way between columns 255 and 0, on row y.
  const auto on_seam = [&](int y) {
    const float v = (static_cast<float>(y) + 0.5f) / 256.0f;
    return sample(texture, sampler, {0.0f, v}, 0.0f, profile_named("softpipe")).x;
  };
  const auto mean = [](int a, int b) { return static_cast<float>(a + b) * 0.5f; };
  CHECK(on_seam(30) == mean(30 * 256 + 255, 30 * 256));
  // Rows 31 and 32 are in two tiles: that of (0, 31) has the slot of that of (255, 32),
  // in whose place (224, 63) is where (0, 31) would be.
  CHECK(on_seam(31) == mean(31 * 256 + 255, 63 * 256 + 224));
  CHECK(on_seam(32) == mean(32 * 256 + 255, 32 * 256));
}
