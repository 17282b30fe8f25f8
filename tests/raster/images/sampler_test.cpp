#include "raster/images/sampler.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>
#include <vector>

#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;
using test::random_texture;
using test::row_texture;
using test::same_bits;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::array kWraps{Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};
constexpr std::array kFilters{Filter::nearest, Filter::bilinear, Filter::trilinear};

// --- the oracle: binary64, and wrapping by walking ---

int wrap_by_walking(long index, int size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return static_cast<int>(std::clamp<long>(index, 0, size - 1));
  // Lay the texture, or texture and mirror image, side by side until the index is met.
  std::vector<int> pattern;
  pattern.reserve(2 * static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) pattern.push_back(i);
  if (wrap == Wrap::mirrored_repeat) {
    for (int i = size - 1; i >= 0; --i) pattern.push_back(i);
  }
  const auto period = static_cast<long>(pattern.size());
  while (index < 0) index += period;
  while (index >= period) index -= period;
  return pattern[static_cast<std::size_t>(index)];
}

glm::dvec4 texel_at(const Image& image, const Sampler& sampler, long x, long y) {
  return glm::dvec4{load_texel(image, wrap_by_walking(x, image.width, sampler.wrap_u),
                               wrap_by_walking(y, image.height, sampler.wrap_v))};
}

glm::dvec4 nearest_oracle(const Image& image, const Sampler& sampler, double u, double v) {
  return texel_at(image, sampler, static_cast<long>(std::floor(u * image.width)),
                  static_cast<long>(std::floor(v * image.height)));
}

double ties_to_even(double value) {
  double whole = std::floor(value);
  const double rest = value - whole;
  if (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0.0)) whole += 1.0;
  return whole;
}

glm::dvec4 bilinear_oracle(const Image& image, const Sampler& sampler, double u, double v,
                           BilinearWeights weights) {
  double x = u * image.width - 0.5;
  double y = v * image.height - 0.5;
  if (weights == BilinearWeights::fixed_8) {
    x = ties_to_even(x * 256.0) / 256.0;
    y = ties_to_even(y * 256.0) / 256.0;
  }
  const double s = x - std::floor(x);
  const double t = y - std::floor(y);
  const auto i = static_cast<long>(std::floor(x));
  const auto j = static_cast<long>(std::floor(y));
  const glm::dvec4 upper =
      texel_at(image, sampler, i, j) * (1.0 - s) + texel_at(image, sampler, i + 1, j) * s;
  const glm::dvec4 lower =
      texel_at(image, sampler, i, j + 1) * (1.0 - s) + texel_at(image, sampler, i + 1, j + 1) * s;
  return upper * (1.0 - t) + lower * t;
}

double largest_difference(glm::vec4 a, glm::dvec4 b) {
  double largest = 0.0;
  for (int i = 0; i < 4; ++i) {
    largest = std::max(largest, std::fabs(static_cast<double>(a[i]) - b[i]));
  }
  return largest;
}

// Coordinates that binary32 holds to the bit, products with small sizes too: multiples
// of 2^-10 in a wide range.
float dyadic(test::Random& random, int range) {
  return static_cast<float>(random.whole(-range * 1024, range * 1024)) / 1024.0f;
}

struct Size {
  int width, height;
};
constexpr std::array kSizes{Size{1, 1}, Size{1, 7}, Size{6, 1},
                            Size{3, 5}, Size{8, 4}, Size{17, 9}};

}  // namespace

TEST_CASE("a nearest fetch reads the texel that holds the point, for every wrap far outside") {
  test::Random random{21};
  int wrong = 0;
  for (const auto [width, height] : kSizes) {
    const Texture texture = random_texture(Format::rgba32f, width, height, 1);
    for (const Wrap wrap_u : kWraps) {
      for (const Wrap wrap_v : kWraps) {
        const Sampler sampler{Filter::nearest, wrap_u, wrap_v};
        for (int i = 0; i < 300; ++i) {
          const glm::vec2 uv{dyadic(random, 40), dyadic(random, 40)};
          wrong += glm::dvec4{sample(texture, sampler, uv, 0.0f, {})} !=
                   nearest_oracle(texture.levels[0], sampler, uv.x, uv.y);
        }
      }
    }
  }
  CHECK(wrong == 0);
}

namespace {

// softpipe's mirrored fetch is wrong at the texels' centres in odd cells: a
// claim below says how.
bool mirrors_wrong(const Profile& profile, const Sampler& sampler) {
  return profile.texture_unit == TextureUnit::softpipe &&
         (sampler.wrap_u == Wrap::mirrored_repeat || sampler.wrap_v == Wrap::mirrored_repeat);
}

}  // namespace

TEST_CASE("a bilinear fetch agrees with binary64, for every profile and wrap far outside") {
  test::Random random{22};
  double worst = 0.0;
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    for (const auto [width, height] : kSizes) {
      const Texture texture = random_texture(Format::rgba32f, width, height, 2);
      for (const Wrap wrap_u : kWraps) {
        for (const Wrap wrap_v : kWraps) {
          const Sampler sampler{Filter::bilinear, wrap_u, wrap_v};
          if (mirrors_wrong(profile, sampler)) continue;
          for (int i = 0; i < 100; ++i) {
            const glm::vec2 uv{dyadic(random, 40), dyadic(random, 40)};
            const glm::dvec4 exact =
                bilinear_oracle(texture.levels[0], sampler, uv.x, uv.y, profile.bilinear_weights);
            worst = std::max(
                worst, largest_difference(sample(texture, sampler, uv, 0.0f, profile), exact));
          }
        }
      }
    }
  }
  // The position is exact here; two lerps, three roundings each, of values up to 1.
  CHECK(worst < 6 * 0x1p-24);
}

TEST_CASE("a bilinear fetch at any coordinate is as near as its position's rounding lets it") {
  test::Random random{23};
  const Texture texture = random_texture(Format::rgba32f, 13, 11, 3);
  const Sampler sampler{Filter::bilinear, Wrap::repeat, Wrap::mirrored_repeat};
  double worst = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const glm::vec2 uv{random.between(-3.0f, 3.0f), random.between(-3.0f, 3.0f)};
    const glm::dvec4 exact =
        bilinear_oracle(texture.levels[0], sampler, uv.x, uv.y, BilinearWeights::binary32);
    worst = std::max(worst, largest_difference(sample(texture, sampler, uv, 0.0f, {}), exact));
  }
  // Positions up to 39 are rounded to 2^-19 twice along each axis, texels differ by up to 1.
  CHECK(worst < 4 * 0x1p-19);
}

TEST_CASE("a trilinear fetch lies between the two levels by the fraction of the lod") {
  test::Random random{24};
  double worst = 0.0;
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    Texture texture = random_texture(Format::rgba32f, 16, 8, 4);
    generate_mipmaps(texture, profile_named("ieee"));
    const Sampler sampler{Filter::trilinear, Wrap::repeat, Wrap::clamp_to_edge};
    for (int i = 0; i < 3'000; ++i) {
      const glm::vec2 uv{dyadic(random, 3), dyadic(random, 3)};
      const float lod = static_cast<float>(random.whole(0, 4 * 256 - 1)) / 256.0f;
      const auto fine = static_cast<std::size_t>(lod);
      const double fraction = static_cast<double>(lod) - static_cast<double>(fine);
      const auto level = [&](std::size_t index) {
        return bilinear_oracle(texture.levels[index], sampler, uv.x, uv.y,
                               profile.bilinear_weights);
      };
      const glm::dvec4 exact = level(fine) * (1.0 - fraction) + level(fine + 1) * fraction;
      worst =
          std::max(worst, largest_difference(sample(texture, sampler, uv, lod, profile), exact));
    }
  }
  CHECK(worst < 9 * 0x1p-24);
}

TEST_CASE("a bilinear fetch at a texel's centre is that texel, in every profile") {
  const Texture texture = random_texture(Format::rgba16f, 8, 8, 5);
  int wrong = 0;
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        const glm::vec2 uv{(static_cast<float>(x) + 0.5f) / 8.0f,
                           (static_cast<float>(y) + 0.5f) / 8.0f};
        wrong +=
            !same_bits(sample(texture, {}, uv, 0.0f, profile), load_texel(texture.levels[0], x, y));
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("u runs along rows and v down them") {
  Image image = make_image(Format::r32f, 2, 2);
  for (int i = 0; i < 4; ++i)
    store_texel(image, i % 2, i / 2, glm::vec4{static_cast<float>(i)}, {});
  const Texture texture = make_texture(std::move(image));
  CHECK(sample(texture, {}, {0.75f, 0.25f}, 0.0f, {}).x == 1.0f);
  CHECK(sample(texture, {}, {0.25f, 0.75f}, 0.0f, {}).x == 2.0f);
}

TEST_CASE("a bilinear fetch is (a + s (b - a)) along rows, then along columns, in binary32") {
  // Coordinates whose position is exact, so that only the order of operations is tested.
  test::Random random{25};
  const Texture texture = random_texture(Format::rgba16f, 16, 16, 6, -8.0f, 8.0f);
  const Sampler sampler{Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
  for (const std::string_view name : {"ieee", "llvmpipe", "llvmpipe-sse41", "softpipe", "d3d11"}) {
    Profile profile = profile_named(name);
    profile.bilinear_filter = BilinearFilter::floats;
    const bool fused = profile.lerp == Contraction::fused;
    const auto mix = [&](float a, float b, float t) {
      const float difference = b - a;
      if (fused) return std::fma(t, difference, a);
      const float product = t * difference;
      return a + product;
    };
    int wrong = 0;
    for (int i = 0; i < 5'000; ++i) {
      // Position (k + m/256): the weights are m/256 whether quantised or not.
      const int x = random.whole(0, 14);
      const int y = random.whole(0, 14);
      const float s = static_cast<float>(random.whole(0, 255)) / 256.0f;
      const float t = static_cast<float>(random.whole(0, 255)) / 256.0f;
      const glm::vec2 uv{(static_cast<float>(x) + s + 0.5f) / 16.0f,
                         (static_cast<float>(y) + t + 0.5f) / 16.0f};
      const glm::vec4 value = sample(texture, sampler, uv, 0.0f, profile);
      const Image& image = texture.levels[0];
      for (int c = 0; c < 4; ++c) {
        const float upper = mix(load_texel(image, x, y)[c], load_texel(image, x + 1, y)[c], s);
        const float lower =
            mix(load_texel(image, x, y + 1)[c], load_texel(image, x + 1, y + 1)[c], s);
        wrong += value[c] != mix(upper, lower, t);
      }
    }
    CHECK_MESSAGE(wrong == 0, name);
  }
}

TEST_CASE("fused and unfused profiles differ somewhere") {
  test::Random random{26};
  const Texture texture = random_texture(Format::rgba16f, 16, 16, 7);
  int different = 0;
  for (int i = 0; i < 2'000; ++i) {
    const glm::vec2 uv{random.between(0.0f, 1.0f), random.between(0.0f, 1.0f)};
    different += !same_bits(sample(texture, {}, uv, 0.0f, profile_named("llvmpipe")),
                            sample(texture, {}, uv, 0.0f, profile_named("llvmpipe-sse41")));
  }
  CHECK(different > 100);
}

TEST_CASE("fixed weights take the 256 steps between two texels and no others") {
  const Texture texture = row_texture({0.0f, 1.0f});
  const Sampler sampler{Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
  std::set<float> fixed;
  std::set<float> real;
  for (int i = 0; i <= 1 << 14; ++i) {
    const float u = 0.25f + 0.5f * static_cast<float>(i) / static_cast<float>(1 << 14);
    fixed.insert(sample(texture, sampler, {u, 0.5f}, 0.0f, profile_named("d3d11")).x);
    real.insert(sample(texture, sampler, {u, 0.5f}, 0.0f, profile_named("ieee")).x);
  }
  CHECK(fixed.size() == 257);
  CHECK(std::all_of(fixed.begin(), fixed.end(),
                    [](float w) { return w * 256.0f == std::floor(w * 256.0f); }));
  CHECK(real.size() == (1 << 14) + 1);
}

TEST_CASE("fixed weights round to the nearest 1/256, ties to even") {
  const Texture texture = row_texture({0.0f, 1.0f});
  const Sampler sampler{Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
  const auto weight = [&](float steps) {  // position in 1/256 texel after texel 0
    const float u = (steps / 256.0f + 0.5f) / 2.0f;
    return sample(texture, sampler, {u, 0.5f}, 0.0f, profile_named("d3d11")).x * 256.0f;
  };
  CHECK(weight(10.25f) == 10.0f);
  CHECK(weight(10.5f) == 10.0f);
  CHECK(weight(11.5f) == 12.0f);
  CHECK(weight(11.75f) == 12.0f);
  CHECK(weight(255.75f) == 256.0f);
}

TEST_CASE("fixed weights quantise the fraction of the lod as well") {
  Texture texture = row_texture({0.0f, 0.0f});
  texture.levels.push_back(make_image(Format::rgba32f, 1, 1));
  store_texel(texture.levels[1], 0, 0, glm::vec4{1.0f}, {});
  std::set<float> values;
  for (int i = 0; i <= 1 << 12; ++i) {
    const float lod = static_cast<float>(i) / static_cast<float>(1 << 12);
    values.insert(
        sample(texture, {Filter::trilinear, {}, {}}, {0.5f, 0.5f}, lod, profile_named("d3d11")).x);
  }
  CHECK(values.size() == 257);
}

// D3D11.3 functional specification, 7.18.16.3: three properties of a linear filter.

TEST_CASE("a constant texture samples to its constant exactly, in every profile and filter") {
  test::Random random{27};
  int wrong = 0;
  for (const float constant : {0.1f, 1.0f / 3.0f, -7.7f, 65504.0f, 1e-30f}) {
    Image image = make_image(Format::rgba32f, 8, 8);
    clear_image(image, glm::vec4{constant}, {});
    Texture texture = make_texture(std::move(image));
    generate_mipmaps(texture, {});
    for (const NamedProfile& known : profiles()) {
      const Profile& profile = known.profile;
      for (const Filter filter : kFilters) {
        for (int i = 0; i < 200; ++i) {
          const glm::vec2 uv{random.between(-9.0f, 9.0f), random.between(-9.0f, 9.0f)};
          wrong += sample(texture, {filter, {}, {}}, uv, random.between(-1.0f, 5.0f), profile) !=
                   glm::vec4{constant};
        }
      }
    }
  }
  CHECK(wrong == 0);
}

namespace {

// How far a fetch of random texels gets outside the smallest and largest of those that
// it reads, as a multiple of 2^-24 of the largest magnitude.
double excess(const Profile& profile, Filter filter, std::uint64_t seed) {
  test::Random random{seed};
  double worst = 0.0;
  for (int t = 0; t < 200; ++t) {
    // Magnitudes far apart make rounding show.
    Image image = make_image(Format::rgba32f, 2, 2);
    double smallest = 1e30;
    double largest = -1e30;
    for (int i = 0; i < 4; ++i) {
      const auto value = static_cast<float>(
          std::ldexp(random.between(-1.0, 1.0), t % 2 == 0 ? random.whole(-20, 3) : 0));
      store_texel(image, i % 2, i / 2, glm::vec4{value}, {});
      smallest = std::min<double>(smallest, value);
      largest = std::max<double>(largest, value);
    }
    Texture texture = make_texture(std::move(image));
    generate_mipmaps(texture, {});
    const double scale = std::max(std::fabs(smallest), std::fabs(largest)) * 0x1p-24;
    for (int i = 0; i < 500; ++i) {
      const glm::vec2 uv{random.between(-1.0f, 2.0f), random.between(-1.0f, 2.0f)};
      const double value =
          sample(texture, {filter, {}, {}}, uv, random.between(0.0f, 1.1f), profile).x;
      worst = std::max({worst, (smallest - value) / scale, (value - largest) / scale});
    }
    // Just beside the texels' centres, where a float weight rounds to 1.
    for (const float u : {0.25f, 0.75f}) {
      for (int step = 1; step < 40; ++step) {
        const float near = u - std::ldexp(u, -step);
        for (const float lod : {0.0f, 1.0f - std::ldexp(1.0f, -step)}) {
          const double value = sample(texture, {filter, {}, {}}, {near, near}, lod, profile).x;
          worst = std::max({worst, (smallest - value) / scale, (value - largest) / scale});
        }
      }
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("with fixed weights a fetch lies between the smallest and the largest texel") {
  CHECK(excess(profile_named("d3d11"), Filter::bilinear, 28) == 0.0);
  CHECK(excess(profile_named("d3d11"), Filter::trilinear, 29) == 0.0);
}

TEST_CASE("with float weights a fetch gets outside its texels by rounding at most") {
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    CHECK_MESSAGE(excess(profile, Filter::bilinear, 30) < 3.0, known.name);
    CHECK_MESSAGE(excess(profile, Filter::trilinear, 31) < 4.0, known.name);
  }
}

TEST_CASE("a fetch rises with the weight from a smaller texel to a larger, in every profile") {
  test::Random random{32};
  int falls = 0;
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    for (int t = 0; t < 20; ++t) {
      const float a = random.between(-1.0f, 1.0f);
      const float b = random.between(-1.0f, 1.0f);
      const Texture texture = row_texture({std::min(a, b), std::max(a, b)});
      float last = -kInfinity;
      for (int i = 0; i <= 2'000; ++i) {
        const float u = 0.25f + 0.5f * static_cast<float>(i) / 2'000.0f;
        const float now = sample(texture, {}, {u, 0.5f}, 0.0f, profile).x;
        falls += now < last;
        last = now;
      }
    }
  }
  CHECK(falls == 0);
}

TEST_CASE("the lod is held to the levels there are, and NaN is level 0") {
  Texture texture = random_texture(Format::rgba32f, 8, 8, 12);
  generate_mipmaps(texture, {});
  const glm::vec2 uv{0.3f, 0.7f};
  for (const Filter filter : kFilters) {
    const Sampler sampler{filter, Wrap::repeat, Wrap::repeat};
    const glm::vec4 first = sample(texture, sampler, uv, 0.0f, {});
    const glm::vec4 last = sample(texture, sampler, uv, 3.0f, {});
    for (const float lod : {-1.0f, -kInfinity, kNan, -0.0f}) {
      CHECK(same_bits(sample(texture, sampler, uv, lod, {}), first));
    }
    for (const float lod : {3.5f, 100.0f, kInfinity}) {
      CHECK(same_bits(sample(texture, sampler, uv, lod, {}), last));
    }
    CHECK(same_bits(last, load_texel(texture.levels[3], 0, 0)));
  }
}

TEST_CASE("nearest and bilinear fetches read the level nearest to the lod") {
  Texture texture;
  for (int level = 0; level < 3; ++level) {
    texture.levels.push_back(make_image(Format::r32f, 4 >> level, 4 >> level));
    clear_image(texture.levels.back(), glm::vec4{static_cast<float>(level)}, {});
  }
  for (const Filter filter : {Filter::nearest, Filter::bilinear}) {
    const auto level = [&](float lod) {
      return sample(texture, {filter, {}, {}}, {0.4f, 0.4f}, lod, {}).x;
    };
    CHECK(level(0.49f) == 0.0f);
    CHECK(level(0.51f) == 1.0f);
    CHECK(level(1.49f) == 1.0f);
    CHECK(level(1.51f) == 2.0f);
    CHECK(level(9.0f) == 2.0f);
  }
}

TEST_CASE("sRGB texels are decoded before they are filtered") {
  Image image = make_image(Format::srgb8, 2, 1);
  store_texel(image, 1, 0, glm::vec4{1.0f}, {});
  const Texture texture = make_texture(std::move(image));
  const Sampler sampler{Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
  CHECK(sample(texture, sampler, {0.5f, 0.5f}, 0.0f, {}).x == 0.5f);
}
