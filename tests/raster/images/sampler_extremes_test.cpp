// Coordinates far outside of anything that a scene uses, and the smallest texture.

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>

#include "raster/images/sampler.h"
#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::random_texture;
using test::row_texture;
using test::same_bits;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::array kWraps{Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};
constexpr std::array kFilters{Filter::nearest, Filter::bilinear, Filter::trilinear};

struct Size {
  int width, height;
};
constexpr std::array kSizes{Size{1, 1}, Size{1, 7}, Size{6, 1},
                            Size{3, 5}, Size{8, 4}, Size{17, 9}};

}  // namespace

TEST_CASE("infinite and NaN coordinates read as 0") {
  const Texture texture = random_texture(Format::rgba32f, 4, 4, 9);
  for (const Filter filter : kFilters) {
    for (const Wrap wrap : kWraps) {
      const Sampler sampler{filter, wrap, wrap};
      for (const float odd : {kInfinity, -kInfinity, kNan}) {
        CHECK(same_bits(sample(texture, sampler, {odd, 0.6f}, 0.0f, {}),
                        sample(texture, sampler, {0.0f, 0.6f}, 0.0f, {})));
        CHECK(same_bits(sample(texture, sampler, {0.6f, odd}, 0.0f, {}),
                        sample(texture, sampler, {0.6f, 0.0f}, 0.0f, {})));
      }
    }
  }
}

TEST_CASE("clamping to the edge holds however far outside a finite coordinate lies") {
  const Texture texture = row_texture({1.0f, 2.0f, 3.0f, 4.0f});
  for (const Filter filter : kFilters) {
    const Sampler sampler{filter, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
    for (const float far : {2.0f, 1e4f, 1e6f, 2e6f, 1e20f, 3e38f}) {
      CHECK(sample(texture, sampler, {far, 0.5f}, 0.0f, {}).x == 4.0f);
      CHECK(sample(texture, sampler, {-far, 0.5f}, 0.0f, {}).x == 1.0f);
    }
  }
}

TEST_CASE("huge coordinates read some texel in every mode") {
  test::Random random{33};
  int wrong = 0;
  for (const auto [width, height] : kSizes) {
    const Texture texture = random_texture(Format::rgba8, width, height, 10, 0.5f, 1.0f);
    for (const Wrap wrap : kWraps) {
      for (const Filter filter : kFilters) {
        for (const NamedProfile& known : profiles()) {
          const Profile& profile = known.profile;
          for (int i = 0; i < 40; ++i) {
            const glm::vec2 uv{std::ldexp(random.between(-1.0f, 1.0f), random.whole(0, 127)),
                               std::ldexp(random.between(-1.0f, 1.0f), random.whole(0, 127))};
            const float value = sample(texture, {filter, wrap, wrap}, uv, 0.0f, profile).x;
            // softpipe's weights go wild past 2^22 texels; no address does.
            const bool wild = profile.texture_unit == TextureUnit::softpipe;
            wrong += !wild && !(value >= 0.49f && value <= 1.0f);
          }
        }
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a texture of one texel is that texel everywhere") {
  const Texture texture = random_texture(Format::rgba16f, 1, 1, 11);
  const glm::vec4 texel = load_texel(texture.levels[0], 0, 0);
  test::Random random{34};
  int wrong = 0;
  for (const Filter filter : kFilters) {
    for (const Wrap wrap : kWraps) {
      for (int i = 0; i < 200; ++i) {
        const glm::vec2 uv{random.between(-20.0f, 20.0f), random.between(-20.0f, 20.0f)};
        wrong += !same_bits(sample(texture, {filter, wrap, wrap}, uv, 3.0f, {}), texel);
      }
    }
  }
  CHECK(wrong == 0);
}
