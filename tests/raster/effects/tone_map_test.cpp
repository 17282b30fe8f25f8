#include "raster/effects/tone_map.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

/// Every half, as a colour.
Image all_halves() {
  Image image = make_image(Format::rgba16f, 256, 86);
  std::uint16_t next = 0;
  for (int y = 0; y < image.height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 4 == 3 ? 0x3C00 : next++;
  }
  return image;
}

float mapped(const NamedToneCurve& named, float light, float exposure = 1.0f) {
  ThreadPool pool{1};
  Image picture = make_image(Format::rgba16f, 1, 1), result = picture;
  store_texel(picture, 0, 0, glm::vec4{light}, {});
  tone_map(named.curve, exposure, picture, result, {}, pool);
  return load_texel(result, 0, 0).x;
}

}  // namespace

TEST_CASE("tone curves go from 0 to 1 and never fall") {
  for (const NamedToneCurve& named : kToneCurves) {
    CAPTURE(named.name);
    CHECK(find_tone_curve(named.name) == &named.curve);
    CHECK(mapped(named, 0.0f) == doctest::Approx(0.0).epsilon(1e-3));
    CHECK(mapped(named, 60000.0f) == doctest::Approx(1.0).epsilon(1e-3));
    float before = 0.0f;
    for (int step = -60; step <= 100; ++step) {
      const float now = mapped(named, std::exp2(static_cast<float>(step) / 10.0f));
      CHECK(now >= before);
      before = now;
    }
    CHECK(mapped(named, 0.5f, 4.0f) == mapped(named, 2.0f));
  }
  CHECK(find_tone_curve("none") == nullptr);
}

TEST_CASE("tone curves have their authors' values") {
  CHECK(mapped(kToneCurves[0], 1.0f) == 0.5f);
  CHECK(mapped(kToneCurves[1], 1.0f) == doctest::Approx(2.54 / 3.16).epsilon(1e-3));
  CHECK(mapped(kToneCurves[2], 11.2f) == doctest::Approx(1.0).epsilon(1e-3));
}

TEST_CASE("tone mapping of every half is finite, within 0 and 1, and the same in vectors") {
  const Image picture = all_halves();
  for (const NamedToneCurve& named : kToneCurves) {
    for (const char* profile : {"ieee", "d3d11", "swiftshader"}) {
      Image expected = make_image(Format::rgba16f, picture.width, picture.height);
      ThreadPool alone{1, Isa::scalar};
      tone_map(named.curve, 1.7f, picture, expected, profile_named(profile), alone);
      int wrong = 0;
      for (int y = 0; y < expected.height; ++y) {
        for (const std::uint16_t value : row<std::uint16_t>(expected, y)) {
          wrong += !(half_to_float(value) >= 0.0f && half_to_float(value) <= 1.0f);
        }
      }
      CHECK(wrong == 0);
      for (const Isa isa : available_isas()) {
        ThreadPool pool{2, isa};
        Image result = make_image(Format::rgba16f, picture.width, picture.height);
        tone_map(named.curve, 1.7f, picture, result, profile_named(profile), pool);
        CHECK(equal(result, expected));
      }
    }
  }
}
