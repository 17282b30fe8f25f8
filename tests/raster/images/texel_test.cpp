#include "raster/images/texel.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "raster/numbers/srgb.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;
using test::same_bits;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

constexpr std::array kFormats{Format::r8,   Format::rgba8,   Format::srgb8, Format::rgba16f,
                              Format::r32f, Format::rgba32f, Format::rg16f};

glm::vec4 stored(Format format, glm::vec4 value, const Profile& profile = {}) {
  Image image = make_image(format, 1, 1);
  store_texel(image, 0, 0, value, profile);
  return load_texel(image, 0, 0);
}

}  // namespace

TEST_CASE("a one-channel texel stores the first component and reads as (value, 0, 0, 1)") {
  CHECK(same_bits(stored(Format::r32f, {0.3f, 7.0f, 8.0f, 9.0f}), {0.3f, 0.0f, 0.0f, 1.0f}));
  CHECK(
      same_bits(stored(Format::r8, {0.2f, 7.0f, 8.0f, 9.0f}), {51.0f / 255.0f, 0.0f, 0.0f, 1.0f}));
}

TEST_CASE("a two-channel texel stores two components and reads as (first, second, 0, 1)") {
  CHECK(same_bits(stored(Format::rg16f, {0.5f, -7.0f, 8.0f, 9.0f}), {0.5f, -7.0f, 0.0f, 1.0f}));
}

TEST_CASE("a float texel keeps its bits, subnormals too") {
  const glm::vec4 value{0.1f, -0.0f, 1e-42f, -kInfinity};
  CHECK(same_bits(stored(Format::rgba32f, value), value));
  CHECK(stored(Format::r32f, {1e-42f, 0.0f, 0.0f, 0.0f}).x == 1e-42f);
}

TEST_CASE("any NaN is one in a float texel, its sign and payload forgotten") {
  const glm::vec4 value{std::bit_cast<float>(0x7FC12345u), std::bit_cast<float>(0xFFC00000u),
                        std::bit_cast<float>(0x7F800001u), kNan};
  CHECK(same_bits(stored(Format::rgba32f, value), glm::vec4{kNan}));
  CHECK(same_bits(stored(Format::r32f, value), {kNan, 0.0f, 0.0f, 1.0f}));
}

TEST_CASE("a half texel is rounded as the profile says") {
  const glm::vec4 value{1.0f + 0.75f / 1024.0f, -1.0f - 0.75f / 1024.0f, 65519.0f, 70000.0f};
  CHECK(same_bits(stored(Format::rgba16f, value, profile_named("ieee")),
                  {1.0f + 1.0f / 1024.0f, -1.0f - 1.0f / 1024.0f, 65504.0f, kInfinity}));
  CHECK(same_bits(stored(Format::rgba16f, value, profile_named("d3d11")),
                  {1.0f, -1.0f, 65504.0f, 65504.0f}));
}

TEST_CASE("every 8-bit code reads as k / 255 and stores as itself, in each channel") {
  int wrong = 0;
  Image image = make_image(Format::rgba8, 1, 1);
  for (int k = 0; k < 256; ++k) {
    for (std::size_t channel = 0; channel < 4; ++channel) {
      auto texel = row<std::uint8_t>(image, 0);
      std::fill(texel.begin(), texel.end(), std::uint8_t{0});
      texel[channel] = static_cast<std::uint8_t>(k);
      const glm::vec4 value = load_texel(image, 0, 0);
      for (int i = 0; i < 4; ++i) {
        const float expected =
            static_cast<std::size_t>(i) == channel ? static_cast<float>(k) / 255.0f : 0.0f;
        wrong += value[i] != expected;
      }
      store_texel(image, 0, 0, value, {});
      wrong += texel[channel] != k;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("8-bit formats hold values outside 0 to 1 at the ends and take NaN for 0") {
  const glm::vec4 value{-2.0f, 2.0f, kNan, kInfinity};
  for (const Format format : {Format::rgba8, Format::srgb8}) {
    CHECK(same_bits(stored(format, value), {0.0f, 1.0f, 0.0f, 1.0f}));
  }
  CHECK(stored(Format::r8, {kNan, 0.0f, 0.0f, 0.0f}).x == 0.0f);
  CHECK(stored(Format::r8, {-kInfinity, 0.0f, 0.0f, 0.0f}).x == 0.0f);
}

TEST_CASE("an 8-bit texel half-way between codes is rounded as the profile says") {
  // 0.5 * 255 = 127.5; 126.5 / 255 is not quite a tie, its product in binary32 is.
  const glm::vec4 value{0.5f, 126.5f / 255.0f, 0.5f, 126.5f / 255.0f};
  const auto stored_as = [&](std::string_view name) {
    Image image = make_image(Format::rgba8, 1, 1);
    store_texel(image, 0, 0, value, profile_named(name));
    const auto texel = row<std::uint8_t>(image, 0);
    return std::array<int, 4>{texel[0], texel[1], texel[2], texel[3]};
  };
  constexpr std::array kUp{128, 127, 128, 127};
  constexpr std::array kEven{128, 126, 128, 126};
  for (const std::string_view name : {"ieee", "d3d11"}) {
    CHECK_MESSAGE(stored_as(name) == kUp, name);
  }
  for (const std::string_view name : {"llvmpipe", "llvmpipe-sse41", "softpipe"}) {
    CHECK_MESSAGE(stored_as(name) == kEven, name);
  }
}

TEST_CASE("a texel is fetched as each texture unit decodes it") {
  Image rgba = make_image(Format::rgba8, 1, 1);
  Image srgb = make_image(Format::srgb8, 1, 1);
  for (Image* image : {&rgba, &srgb}) {
    for (std::uint8_t& byte : row<std::uint8_t>(*image, 0)) byte = 30;
  }
  const auto red = [](const Image& image, std::string_view name) {
    return fetch_texel(image, 0, 0, profile_named(name)).x;
  };
  CHECK(red(rgba, "ieee") == unorm8_to_linear(30));
  CHECK(red(rgba, "llvmpipe") == unorm8_by_reciprocal(30));
  CHECK(red(rgba, "softpipe") == unorm8_by_reciprocal(30));
  CHECK(red(srgb, "d3d11") == srgb8_to_linear(30));
  CHECK(red(srgb, "llvmpipe") == srgb8_to_linear_by_cubic(30, Contraction::fused));
  CHECK(red(srgb, "llvmpipe-sse41") == srgb8_to_linear_by_cubic(30, Contraction::unfused));
  CHECK(red(srgb, "softpipe") == srgb8_to_linear_decimal(30));
  CHECK(fetch_texel(srgb, 0, 0, profile_named("softpipe")).w == unorm8_by_reciprocal(30));
}

TEST_CASE("fetched one-channel texels are (value, 0, 0, 1) in every profile") {
  for (const Format format : {Format::r8, Format::r32f}) {
    Image image = make_image(format, 1, 1);
    store_texel(image, 0, 0, glm::vec4{1.0f}, {});
    for (const NamedProfile& known : profiles()) {
      const Profile& profile = known.profile;
      CHECK(same_bits(fetch_texel(image, 0, 0, profile), {1.0f, 0.0f, 0.0f, 1.0f}));
    }
  }
}

TEST_CASE("a fetched float texel keeps its bits, subnormals too, in every profile") {
  Image image = make_image(Format::rgba32f, 1, 1);
  const glm::vec4 value{1e-42f, -kInfinity, -0.0f, 3e38f};
  store_texel(image, 0, 0, value, {});
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    CHECK(same_bits(fetch_texel(image, 0, 0, profile), value));
  }
}

TEST_CASE("an sRGB texel has an encoded colour and a linear alpha") {
  Image image = make_image(Format::srgb8, 1, 1);
  store_texel(image, 0, 0, glm::vec4{0.5f}, {});
  const auto texel = row<std::uint8_t>(image, 0);
  CHECK(texel[0] == 188);  // 0.5 light is sRGB 0.7354
  CHECK(texel[1] == 188);
  CHECK(texel[2] == 188);
  CHECK(texel[3] == 128);
  const glm::vec4 value = load_texel(image, 0, 0);
  CHECK(value.x == srgb8_to_linear(188));
  CHECK(value.w == 128.0f / 255.0f);
}

TEST_CASE("flushing profiles store float subnormals as zeros of their sign, others keep them") {
  const glm::vec4 value{1e-40f, -1e-40f, 0x1p-126f, -0x1p-126f};
  CHECK(same_bits(stored(Format::rgba32f, value, profile_named("d3d11")),
                  {0.0f, -0.0f, 0x1p-126f, -0x1p-126f}));
  CHECK(same_bits(stored(Format::rgba32f, value, profile_named("ieee")), value));
  CHECK(std::signbit(stored(Format::r32f, {-1e-40f, 0, 0, 0}, profile_named("llvmpipe")).x));
}

TEST_CASE("flushing profiles keep the subnormals of half texels") {
  CHECK(stored(Format::rgba16f, glm::vec4{0x1p-24f}, profile_named("d3d11")).x == 0x1p-24f);
}

TEST_CASE("storing one texel leaves all others alone") {
  for (const Format format : kFormats) {
    Image image = make_image(format, 5, 4);
    store_texel(image, 2, 1, glm::vec4{1.0f}, {});
    int changed = 0;
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 5; ++x) changed += load_texel(image, x, y).x != 0.0f;
    }
    CHECK(changed == 1);
    CHECK(load_texel(image, 2, 1).x == 1.0f);
  }
}

TEST_CASE("clearing sets every texel and no padding") {
  for (const Format format : kFormats) {
    Image image = make_image(format, 5, 4);
    clear_image(image, glm::vec4{1.0f}, {});
    int set = 0;
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 5; ++x) set += load_texel(image, x, y).x == 1.0f;
    }
    CHECK(set == 20);
    bool padding_clean = true;
    for (std::size_t i = 0; i < image.bytes.size(); ++i) {
      const bool is_padding = i % image.stride_bytes >= 5 * bytes_per_texel(format);
      if (is_padding && image.bytes[i] != std::byte{0}) padding_clean = false;
    }
    CHECK(padding_clean);
  }
}
