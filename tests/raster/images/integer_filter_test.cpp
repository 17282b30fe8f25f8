// The standard texture unit's filter in integers, end to end, against the header that stands
// alone.

#include "raster/images/integer_filter.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;
using test::same_bits;

namespace {

constexpr int kWidth = 16, kHeight = 8;
constexpr Sampler kEdge{Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge};

Profile filtering(BilinearFilter filter) {
  Profile profile = profile_named("d3d11");
  profile.bilinear_filter = filter;
  return profile;
}
const Profile kIntegers = filtering(BilinearFilter::integers);

// Two levels of bytes or halves, of which none is infinite or NaN.
template <class Number>
Texture random_texture(Format format, test::Random& random) {
  Texture texture;
  for (const int halving : {1, 2}) {
    texture.levels.push_back(make_image(format, kWidth / halving, kHeight / halving));
    Image& level = texture.levels.back();
    for (int y = 0; y < level.height; ++y) {
      for (Number& number : row<Number>(level, y)) {
        number = static_cast<Number>(random.next());
        if (format == Format::rgba16f && !is_finite_half(static_cast<std::uint16_t>(number))) {
          number = static_cast<Number>(0x7BFF);
        }
      }
    }
  }
  return texture;
}

// Coordinates in 1/256 texel of the first level, whole ones of the second's too.
struct Place {
  int u_256, v_256;
  glm::vec2 uv() const {
    return {static_cast<float>(u_256) / (256.0f * kWidth),
            static_cast<float>(v_256) / (256.0f * kHeight)};
  }
};

Place any_place(test::Random& random) {
  return {2 * random.whole(-128 * 20, 128 * 36), 2 * random.whole(-128 * 20, 128 * 28)};
}

template <class Number>
std::array<Number, 4> corners(const Image& level, const IntegerTaps& u, const IntegerTaps& v,
                              int channel) {
  const auto at = [&](int x, int y) {
    return row<Number>(level,
                       y)[static_cast<std::size_t>(x * channel_count(level.format) + channel)];
  };
  return {at(u.first, v.first), at(u.second, v.first), at(u.first, v.second),
          at(u.second, v.second)};
}

// The sum of a channel in level 0 or 1.
template <class Number>
std::int64_t sum_at(const Texture& texture, int index, Place place, int channel) {
  const Image& level = texture.levels[static_cast<std::size_t>(index)];
  const IntegerTaps u = clamped_taps(from_centre(place.u_256 >> index), level.width);
  const IntegerTaps v = clamped_taps(from_centre(place.v_256 >> index), level.height);
  const auto c = corners<Number>(level, u, v, channel);
  if constexpr (sizeof(Number) == 1) {
    return bilinear_sum_unorm8(c[0], c[1], c[2], c[3], u.weight, v.weight);
  } else {
    return bilinear_sum_half(c[0], c[1], c[2], c[3], u.weight, v.weight);
  }
}

// Bytes: the sum in binary64, which holds it, is rounded to 24 bits, then divided.
float from_bytes(std::int64_t fine, std::int64_t coarse, int weight) {
  const std::int64_t sum = fine * (256 - weight) + coarse * weight;
  return static_cast<float>(static_cast<double>(sum)) / (255.0f * 0x1p24f);
}

float from_halves(std::int64_t fine, std::int64_t coarse, int weight) {
  return std::bit_cast<float>(mix_sums_half(fine, coarse, weight));
}

// How many of many fetches are not what the header gives.
template <class Number>
int count_wrong(Format format, float (*expected)(std::int64_t, std::int64_t, int)) {
  test::Random random{61};
  const Texture texture = random_texture<Number>(format, random);
  Sampler linear = kEdge;
  linear.filter = Filter::trilinear;
  int wrong = 0;
  for (int i = 0; i < 20000; ++i) {
    const Place place = any_place(random);
    const int weight = random.whole(0, 256);
    const glm::vec4 one = sample(texture, kEdge, place.uv(), 0.0f, kIntegers);
    const glm::vec4 both =
        sample(texture, linear, place.uv(), static_cast<float>(weight) / 256.0f, kIntegers);
    for (int c = 0; c < channel_count(format); ++c) {
      const std::int64_t fine = sum_at<Number>(texture, 0, place, c);
      const std::int64_t coarse = sum_at<Number>(texture, 1, place, c);
      wrong += std::bit_cast<std::uint32_t>(one[c]) !=
               std::bit_cast<std::uint32_t>(expected(fine, fine, 0));
      wrong += std::bit_cast<std::uint32_t>(both[c]) !=
               std::bit_cast<std::uint32_t>(expected(fine, coarse, weight));
    }
    if (format == Format::r8) wrong += !same_bits({0.0f, both.y, both.z, both.w}, {0, 0, 0, 1});
  }
  return wrong;
}

}  // namespace

TEST_CASE("bytes filtered in integers are the header's sums over 255, of one level and of two") {
  CHECK(count_wrong<std::uint8_t>(Format::r8, from_bytes) == 0);
  CHECK(count_wrong<std::uint8_t>(Format::rgba8, from_bytes) == 0);
}

TEST_CASE("halves filtered in integers are the header's sums, of one level and of two") {
  CHECK(count_wrong<std::uint16_t>(Format::rgba16f, from_halves) == 0);
}

TEST_CASE("a fetch in integers is the header's fetch, of bytes to the half level that it rounds") {
  test::Random random{62};
  const Texture bytes = random_texture<std::uint8_t>(Format::rgba8, random);
  const Texture halves = random_texture<std::uint16_t>(Format::rgba16f, random);
  int wrong = 0;
  for (int i = 0; i < 20000; ++i) {
    const Place place = any_place(random);
    std::array<std::uint8_t, 4> stored{};
    std::array<std::uint32_t, 4> bits{};
    fetch_unorm8(row<std::uint8_t>(bytes.levels[0], 0).data(),
                 static_cast<int>(bytes.levels[0].stride_bytes), kWidth, kHeight, 4, place.u_256,
                 place.v_256, stored.data());
    fetch_half(row<std::uint16_t>(halves.levels[0], 0).data(),
               static_cast<int>(halves.levels[0].stride_bytes / 2), kWidth, kHeight, 4, place.u_256,
               place.v_256, bits.data());
    const glm::vec4 byte = sample(bytes, kEdge, place.uv(), 0.0f, kIntegers);
    const glm::vec4 half = sample(halves, kEdge, place.uv(), 0.0f, kIntegers);
    for (int c = 0; c < 4; ++c) {
      const auto channel = static_cast<std::size_t>(c);
      const double levels = static_cast<double>(byte[c]) * 255.0;
      wrong += std::fabs(levels - stored[channel]) > 0.5 + 0x1p-15;
      wrong += std::bit_cast<std::uint32_t>(half[c]) != bits[channel];
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("in integers a constant texture of bytes or halves gives what a nearest fetch gives") {
  test::Random random{63};
  int wrong = 0;
  for (int i = 0; i < 256; ++i) {
    for (const Format format : {Format::r8, Format::rgba8, Format::rgba16f}) {
      Texture texture;
      for (const int size : {4, 2, 1}) {
        texture.levels.push_back(make_image(format, size, size));
        const auto value = static_cast<float>(i) / 255.0f;
        clear_image(texture.levels.back(), glm::vec4{value, 1.0f - value, value * 1e-6f, 1.0f},
                    kIntegers);
      }
      for (const Filter filter : {Filter::bilinear, Filter::trilinear}) {
        const glm::vec2 uv{random.between(-2.0f, 2.0f), random.between(-2.0f, 2.0f)};
        const float lod = random.between(0.0f, 2.0f);
        wrong += !same_bits(sample(texture, {filter, {}, {}}, uv, lod, kIntegers),
                            load_texel(texture.levels[0], 0, 0));
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("in integers a fetch rises from a smaller byte or half to a larger, by level too") {
  test::Random random{64};
  int falls = 0;
  for (int t = 0; t < 50; ++t) {
    for (const Format format : {Format::r8, Format::rgba16f}) {
      const float a = random.between(0.0f, 1.0f), b = random.between(0.0f, 1.0f);
      Texture texture = test::row_texture({std::min(a, b), std::max(a, b)}, format);
      texture.levels.push_back(make_image(format, 1, 1));
      store_texel(texture.levels[1], 0, 0, glm::vec4{1.0f}, {});
      float last_along = -1.0f, last_level = -1.0f;
      for (int i = 0; i <= 512; ++i) {
        const float step = static_cast<float>(i) / 512.0f;
        const float along = sample(texture, kEdge, {0.25f + step / 2, 0.5f}, 0.0f, kIntegers).x;
        const float level =
            sample(texture, {Filter::trilinear, {}, {}}, {0.3f, 0.5f}, step, kIntegers).x;
        falls += along < last_along || level < last_level;
        last_along = along;
        last_level = level;
      }
    }
  }
  CHECK(falls == 0);
}

TEST_CASE("a channel with an infinite or NaN texel is filtered in floats, the others are not") {
  test::Random random{65};
  Texture texture = random_texture<std::uint16_t>(Format::rgba16f, random);
  for (Image& level : texture.levels) {
    for (int y = 0; y < level.height; ++y) {
      const auto halves = row<std::uint16_t>(level, y);
      for (std::size_t i = 0; i < halves.size(); i += 4) {
        constexpr std::array<std::uint16_t, 4> kOdd{0x7C00, 0xFC00, 0x7E00, 0x3C00};
        if (random.whole(0, 2) == 0) halves[i] = kOdd[random.next() % kOdd.size()];
      }
    }
  }
  const Profile floats = filtering(BilinearFilter::floats);
  int odd = 0, unlike = 0, other = 0;
  for (int i = 0; i < 5000; ++i) {
    const glm::vec2 uv = any_place(random).uv();
    const Sampler sampler{Filter::trilinear, Wrap::clamp_to_edge, Wrap::repeat};
    const float lod = random.between(-0.5f, 1.0f);
    const glm::vec4 value = sample(texture, sampler, uv, lod, kIntegers);
    const glm::vec4 in_floats = sample(texture, sampler, uv, lod, floats);
    odd += !std::isfinite(value.x);
    unlike += std::isfinite(value.x) != std::isfinite(in_floats.x) ||
              (!std::isfinite(value.x) && value.x != in_floats.x && value.x == value.x);
    other += std::isfinite(value.y) && std::isfinite(value.z) && std::isfinite(value.w);
  }
  CHECK(odd > 1000);
  CHECK(unlike == 0);
  CHECK(other == 5000);
}

TEST_CASE("texels of sRGB and of 32 bits are filtered in floats, whatever the profile says") {
  for (const Format format : {Format::srgb8, Format::r32f, Format::rgba32f}) {
    const Texture texture = test::random_texture(format, kWidth, kHeight, 66);
    CHECK(!has_integer_filter(format, kIntegers));
    const glm::vec2 uv{0.37f, 0.61f};
    CHECK(same_bits(sample(texture, kEdge, uv, 0.0f, kIntegers),
                    sample(texture, kEdge, uv, 0.0f, filtering(BilinearFilter::floats))));
  }
}
