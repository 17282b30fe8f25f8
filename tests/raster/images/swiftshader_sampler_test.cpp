#include "raster/images/driver_samplers.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "raster/images/texel.h"
#include "raster/numbers/srgb.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;
using test::row_texture;
using test::same_bits;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kBelowOne = 0x1.FFFFFEp-1f;
constexpr std::array kWraps{Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};
constexpr std::array kSizes{1, 2, 3, 37, 100, 16384};

// Every 2^14th float of either sign, and those beside it: all exponents, the ends of each.
template <class Visit>
void for_floats_of_all_kinds(const Visit& visit) {
  for (std::uint32_t bits = 0; bits < 0x7F800000; bits += 1u << 14) {
    for (std::uint32_t beside = 0; beside < 3; ++beside) {
      visit(std::bit_cast<float>(bits + beside - (bits > 0 ? 1 : 0)));
      visit(-std::bit_cast<float>(bits + beside - (bits > 0 ? 1 : 0)));
    }
  }
}

// The coordinate in binary64, which holds it but for specks left of a whole number.
double wrapped(double u, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return std::clamp(u, 0.0, 1.0);
  return wrap == Wrap::repeat ? u - std::floor(u) : std::fabs(std::remainder(u, 2.0));
}

// The texel of a whole place along an axis, by its mirror images or repetitions.
int texel_at(int place, int size, Wrap wrap) {
  if (wrap == Wrap::repeat) return (place % size + size) % size;
  return std::clamp(place, 0, size - 1);
}

int whole_65536ths(double u) { return static_cast<int>(std::trunc(u * 65536.0)); }

Profile profile() { return profile_named("swiftshader"); }

float sample_row(const Texture& texture, Wrap wrap, float u) {
  return sample(texture, {Filter::bilinear, wrap, wrap}, {u, 0.5f}, 0.0f, profile()).x;
}

Image bytes_image(Format format, int width, std::uint8_t byte) {
  Image image = make_image(format, width, 1);
  for (std::uint8_t& one : row<std::uint8_t>(image, 0)) one = byte;
  return image;
}

// Two levels of one texel, a number each.
Texture two_levels(float fine, float coarse) {
  Texture texture = row_texture({fine, fine});
  texture.levels.push_back(row_texture({coarse}).levels[0]);
  return texture;
}

}  // namespace

TEST_CASE("SwiftShader wraps a coordinate before it is scaled: all kinds of floats") {
  for (const Wrap wrap : kWraps) {
    int wrong = 0;
    for_floats_of_all_kinds([&](float u) {
      const float expected =
          std::min(static_cast<float>(wrapped(static_cast<double>(u), wrap)), kBelowOne);
      wrong += swiftshader_coordinate(u, wrap) != expected;
    });
    CHECK(wrong == 0);
  }
}

TEST_CASE("what is no coordinate lies at the far end, or clamped where it ought to") {
  for (const float far : {kNan, kInfinity, -kInfinity}) {
    CHECK(swiftshader_coordinate(far, Wrap::repeat) == kBelowOne);
    CHECK(swiftshader_coordinate(far, Wrap::mirrored_repeat) == kBelowOne);
  }
  CHECK(swiftshader_coordinate(kNan, Wrap::clamp_to_edge) == 0.0f);
  CHECK(swiftshader_coordinate(-kInfinity, Wrap::clamp_to_edge) == 0.0f);
  CHECK(swiftshader_coordinate(kInfinity, Wrap::clamp_to_edge) == kBelowOne);
}

TEST_CASE("its float filter reads the texels about the wrapped place: all kinds of floats") {
  for (const Wrap wrap : kWraps) {
    for (const int size : kSizes) {
      int wrong = 0;
      for_floats_of_all_kinds([&](float u) {
        const float scaled = swiftshader_coordinate(u, wrap) * static_cast<float>(size);
        const double position = static_cast<double>(scaled) - 0.5;
        const int place = static_cast<int>(std::floor(position));
        const Taps taps = swiftshader_taps(u, size, wrap);
        wrong += taps.first != texel_at(place, size, wrap);
        wrong += taps.second != texel_at(place + 1, size, wrap);
        const float left = static_cast<float>(position);
        wrong += taps.weight != left - static_cast<float>(place);
        wrong += swiftshader_nearest(u, size, wrap) != static_cast<int>(scaled);
      });
      CHECK_MESSAGE(wrong == 0, size);
    }
  }
}

TEST_CASE("a nearest fetch of bytes cuts the coordinate to 65536ths, toward 0") {
  for (const Wrap wrap : kWraps) {
    for (const int size : kSizes) {
      int wrong = 0;
      for_floats_of_all_kinds([&](float u) {
        if (std::fabs(u) >= 32768.0f && wrap != Wrap::clamp_to_edge) return;
        std::int64_t place = 0;
        if (wrap == Wrap::clamp_to_edge) {
          place =
              std::clamp(whole_65536ths(std::clamp(static_cast<double>(u), 0.0, 1.0)), 0, 65535);
        } else {
          place = whole_65536ths(static_cast<double>(u));
          const auto cell = static_cast<int>(std::floor(static_cast<double>(place) / 65536.0));
          place -= cell * 65536;
          if (wrap == Wrap::mirrored_repeat && cell % 2 != 0) place = 65535 - place;
        }
        wrong += swiftshader_nearest_byte(u, size, wrap) != place * size / 65536;
      });
      CHECK_MESSAGE(wrong == 0, size);
    }
    // 2^31 and more become the least integer, which has no fraction.
    if (wrap == Wrap::clamp_to_edge) continue;
    for (const float far : {32768.0f, 1e30f, -1e30f, kInfinity, -kInfinity, kNan}) {
      CHECK(swiftshader_nearest_byte(far, 37, wrap) == 0);
    }
  }
}

TEST_CASE("bytes are filtered as multiples of 256, and divided by 65280 last") {
  Image image = make_image(Format::r8, 2, 1);
  row<std::uint8_t>(image, 0)[0] = 10;
  row<std::uint8_t>(image, 0)[1] = 200;
  const Texture texture = make_texture(std::move(image));
  CHECK(sample_row(texture, Wrap::clamp_to_edge, 0.0f) == 2560.0f * (1.0f / 65280.0f));
  CHECK(sample_row(texture, Wrap::clamp_to_edge, 0.5f) == 26880.0f * (1.0f / 65280.0f));
  CHECK(sample_row(texture, Wrap::repeat, 0.0f) == 26880.0f * (1.0f / 65280.0f));
  const float u = 0.4f;
  const float weight = u * 2.0f - 0.5f;
  CHECK(sample_row(texture, Wrap::clamp_to_edge, u) ==
        (2560.0f + weight * (51200.0f - 2560.0f)) * (1.0f / 65280.0f));
}

TEST_CASE("sRGB bytes are decoded to 65280ths before they are filtered") {
  int wrong = 0;
  for (int code = 0; code < 256; ++code) {
    const auto byte = static_cast<std::uint8_t>(code);
    const double linear = static_cast<double>(srgb8_to_linear(byte)) * 65280.0;
    // In binary32 the curve at 149 comes out just above the middle.
    const int above = code == 149 ? 1 : 0;
    wrong += srgb8_in_65280ths(byte) != static_cast<int>(std::floor(linear + 0.5)) + above;
    const Texture texture = make_texture(bytes_image(Format::srgb8, 1, byte));
    const glm::vec4 fetched =
        sample(texture, {Filter::nearest, Wrap::repeat, Wrap::repeat}, {0.5f, 0.5f}, 0, profile());
    wrong += fetched.x != static_cast<float>(srgb8_in_65280ths(byte)) * (1.0f / 65280.0f);
    wrong += !same_bits(fetched, fetch_texel(texture.levels[0], 0, 0, profile()));
  }
  CHECK(wrong == 0);
}

TEST_CASE("a nearest level is the nearest, ties to even") {
  const Texture texture = two_levels(1.0f, 2.0f);
  const Sampler sampler{Filter::bilinear, Wrap::repeat, Wrap::repeat};
  const auto at = [&](float lod) { return sample(texture, sampler, {0, 0}, lod, profile()).x; };
  CHECK(at(0.5f) == 1.0f);
  CHECK(at(std::nextafter(0.5f, 1.0f)) == 2.0f);
  CHECK(at(kNan) == 1.0f);
  CHECK(at(kInfinity) == 2.0f);
}

TEST_CASE("two levels are always mixed: at weight 0 an infinity becomes NaN") {
  const Sampler sampler{Filter::trilinear, Wrap::repeat, Wrap::repeat};
  const auto at = [&](const Texture& texture, float lod) {
    return sample(texture, sampler, {0, 0}, lod, profile()).x;
  };
  CHECK(at(two_levels(1.0f, 3.0f), 0.5f) == 2.0f);
  CHECK(at(two_levels(1.0f, 3.0f), 0.0f) == 1.0f);
  CHECK(at(two_levels(1.0f, 3.0f), 7.5f) == 3.0f);
  CHECK(std::isnan(at(two_levels(1.0f, kInfinity), 0.0f)));
  CHECK(std::isnan(at(two_levels(1.0f, kInfinity), 2.0f)));
}
