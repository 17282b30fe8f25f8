#include "dof/disc_layers/disc_hidden.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "dof/disc_layers/disc_layers.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// 16 (z - 2) / z: -16 at 1 m, 0 at 2 m, 8 at 4 m.
constexpr DofSettings kSettings{.coc = {16.0f, 2.0f}, .max_coc_px = 16.0f};
constexpr float kNearM = 1.0f, kFocusM = 2.0f;
constexpr int kSize = 128;

struct GreyPixel {
  float light, depth_m;
};
template <class PixelAt>
Image picture_of(const PixelAt& pixel_at) {
  Image image = make_image(Format::rgba16f, kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const GreyPixel pixel = pixel_at(x, y);
      store_texel(image, x, y, {pixel.light, pixel.light, pixel.light, pixel.depth_m}, {});
    }
  }
  return image;
}

Image blurred(const Image& scene) {
  ThreadPool pool(2);
  Image result = make_image(Format::rgba16f, scene.width, scene.height);
  disc_layers({scene, kSettings, {}}, result, pool);
  return result;
}

float light_of(const Image& image, int x, int y) { return load_texel(image, x, y).y; }

// Whether pictures are the same in hidden strips, where they are defined.
bool equal_where_hidden(const HiddenPicture& a, const HiddenPicture& b) {
  for (int y = 0; y < a.picture.height; ++y) {
    for (int x = 0; x < a.picture.width; ++x) {
      if (!a.strip(x / kHiddenStrip, y)) continue;
      const auto texel = static_cast<std::size_t>(4 * x);
      for (std::size_t i = texel; i < texel + 4; ++i) {
        if (row<std::uint16_t>(a.picture, y)[i] != row<std::uint16_t>(b.picture, y)[i])
          return false;
      }
    }
  }
  return true;
}

// The share of a disc about 0 that lies left of x.
double disc_left_of(double x, double radius) {
  const double t = std::fmin(std::fmax(x / radius, -1.0), 1.0);
  return 0.5 + (t * std::sqrt(1.0 - t * t) + std::asin(t)) / 3.14159265358979;
}

}  // namespace

TEST_CASE("what near things hide is its oracle's guess, to the bit") {
  struct Size {
    int width, height;
  };
  for (const Size size : {Size{1, 1}, {2, 3}, {17, 15}, {64, 40}, {129, 31}, {203, 101}}) {
    // Depths that repeat in blocks, so that ways are longer than a pixel.
    const Image blocks = random_scene_image(size.width, size.height, 5);
    Image scene = random_scene_image(size.width, size.height, 7);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        glm::vec4 texel = load_texel(scene, x, y);
        texel.w = load_texel(blocks, x / 5 * 5, y / 7 * 7).w;
        store_texel(scene, x, y, texel, {});
      }
    }
    for (const Image* picture : std::array<const Image*, 2>{&scene, &blocks}) {
      const DofInput input{*picture, {.coc = {30.0f, 2.0f}, .max_coc_px = 60.0f}, {}};
      const HiddenPicture expected = find_hidden_oracle(input);
      for (const Isa isa : available_isas()) {
        ThreadPool pool(3, isa);
        const HiddenPicture hidden = find_hidden(input, pool);
        INFO(std::string{isa_name(isa)}, ", ", size.width, "x", size.height);
        REQUIRE(hidden.empty() == expected.empty());
        CHECK(equal_where_hidden(hidden, expected));
        CHECK(hidden.strips == expected.strips);
        CHECK(hidden.rows == expected.rows);
        CHECK(hidden.blocks == expected.blocks);
      }
    }
  }
}

TEST_CASE("a slope through the focus hides nothing") {
  ThreadPool pool(2);
  const Image scene = picture_of([](int x, int) {
    return GreyPixel{1.0f, 1.0f + 0.05f * static_cast<float>(x)};
  });
  CHECK(find_hidden({scene, kSettings, {}}, pool).empty());
}

TEST_CASE("a near thing's corner hides as much as its sides") {
  ThreadPool pool(2);
  // Near but for the lower right quarter: the pixels left above it see it only round a corner.
  const Image scene = picture_of([](int x, int y) {
    return GreyPixel{0.0f, x >= 64 && y >= 64 ? kFocusM : kNearM};
  });
  const HiddenPicture hidden = find_hidden({scene, kSettings, {}}, pool);
  REQUIRE(!hidden.empty());
  const auto depth_m = [&](int x, int y) {
    const ConstImageView of_scene = scene;
    const bool defined = hidden.strip(x / kHiddenStrip, y);
    return load_texel<Format::rgba16f>(defined ? hidden.picture : of_scene, x, y).w;
  };
  for (const int away : {1, 5, 10}) CHECK(depth_m(64 - away, 64 - away) == kFocusM);
  CHECK(depth_m(64 - 17, 64 - 17) == kNearM);
  CHECK(depth_m(100, 100) == kFocusM);
}

TEST_CASE("the outline of something near before something sharp is as soft inside as outside") {
  const Image result = blurred(picture_of([](int x, int) {
    return GreyPixel{x < 64 ? 1.0f : 0.1f, x < 64 ? kNearM : kFocusM};
  }));
  for (int x = 40; x < 88; ++x) {
    const double expected = 0.1 + 0.9 * disc_left_of(63.5 - x, 16.0);
    INFO(x);
    CHECK(std::fabs(static_cast<double>(light_of(result, x, 64)) - expected) < 0.03);
  }
}

TEST_CASE("stripes go on behind a thin near bar") {
  const auto stripe = [](int y) { return y / 4 % 2 == 0 ? 0.2f : 0.8f; };
  const Image result = blurred(picture_of([&](int x, int y) {
    return x >= 60 && x < 68 ? GreyPixel{0.5f, kNearM} : GreyPixel{stripe(y), kFocusM};
  }));
  for (int x = 50; x < 78; ++x) {
    const double cover = disc_left_of(67.5 - x, 16.0) - disc_left_of(59.5 - x, 16.0);
    const double shown =
        static_cast<double>(light_of(result, x, 61) - light_of(result, x, 57)) / 0.6;
    INFO(x);
    CHECK(std::fabs(std::fabs(shown) - (1.0 - cover)) < 0.03);
  }
}

TEST_CASE("a near lamp before something sharp has no bright middle") {
  const Image result = blurred(picture_of([](int x, int y) {
    return x == 64 && y == 64 ? GreyPixel{3000.0f, kNearM} : GreyPixel{0.25f, kFocusM};
  }));
  const float expected = 0.25f + 3000.0f / (3.14159265f * 16.0f * 16.0f);
  for (const int x : {52, 60, 63, 64, 65, 70}) {
    CHECK(light_of(result, x, 64) == doctest::Approx(expected).epsilon(0.02));
  }
}

TEST_CASE("a near thing of many radii is opaque away from its outline") {
  // From -6 to -16 across 40 pixels.
  const Image result = blurred(picture_of([](int x, int) {
    const bool near = x >= 30 && x < 90;
    const float radius = -6.0f - 10.0f * static_cast<float>(x - 30) / 60.0f;
    return near ? GreyPixel{1.0f, 32.0f / (16.0f - radius)} : GreyPixel{0.0f, kFocusM};
  }));
  for (int x = 44; x < 70; ++x) {
    INFO(x);
    CHECK(light_of(result, x, 64) > 0.99f);
  }
}

TEST_CASE("something sharp out of reach of near things keeps its bits") {
  const Image noise = random_scene_image(kSize, kSize, 4);
  Image scene = picture_of([](int x, int) { return GreyPixel{0.5f, x < 20 ? kNearM : kFocusM}; });
  for (int y = 0; y < kSize; ++y) {
    for (int x = 20; x < kSize; ++x) {
      glm::vec4 texel = load_texel(noise, x, y);
      texel.w = kFocusM;
      store_texel(scene, x, y, texel, {});
    }
  }
  const Image result = blurred(scene);
  for (int y = 0; y < kSize; y += 5) {
    for (int x = 48; x < kSize; ++x) {
      CHECK(load_texel(result, x, y) == load_texel(scene, x, y));
    }
  }
}
