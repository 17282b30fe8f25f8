// Claims about every method that works from one picture. The numbers by which methods differ
// are in one table.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "dof/dof.h"
#include "raster/images/texel.h"
#include "tests/support/sanitizers.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr double kHalfUlpBelowOne = 0x1p-11;

struct Claims {
  const char* name;
  /// Largest difference of a constant picture, in half-ULPs.
  int constant_ulp;
  /// Relative error of an isolated point's light at radius 8.
  double energy_error;
  /// Relative error of the radius of a point's image at radius 8. The image's radius is
  /// sqrt(2 E[d^2]), that of a disc with its second moment.
  double radius_error;
  /// Largest difference between the filtered mirror image and the mirrored filtered image, of
  /// colours from 0 to 1. Sums in another order differ by one half-ULP; post-process's
  /// pinwheel of taps has no mirror symmetry, but comes back after half a turn.
  double mirror_error;
  /// Width in pixels of the light that stands for a point: a method at half resolution does
  /// not see one pixel.
  int point_size = 1;
  /// Whether a blurred background sheds no light on a sharp object.
  bool keeps_background_out = true;
  /// Whether a blurred foreground sheds light on a sharp background.
  bool spreads_foreground = true;
  /// As mirror_error, for a picture turned by 180 degrees. ray-distribution-buffer keeps the
  /// first of two pixels that are equally near.
  double turn_error = kHalfUlpBelowOne;
};

constexpr std::array kClaims{
    Claims{"importance-ordered", 1, 0.01, 0.07, 0.01},
    Claims{"scatter", 1, 0.002, 0.01, 0.0, 1, false, true},
    Claims{"scatter-sorted", 1, 0.002, 0.01, 0.0},
    Claims{"scatter-aperture", 1, 0.002, 0.01, kHalfUlpBelowOne},
    Claims{"layers", 1, 0.002, 0.01, 0.0},
    Claims{"fields", 1, 0.002, 0.01, kHalfUlpBelowOne},
    Claims{"diffusion", 1, 0.002, 0.01, kHalfUlpBelowOne},
    Claims{"generalised-diffusion", 1, 0.002, 0.01, kHalfUlpBelowOne, 1, true, false},
    Claims{"ring-bucket", 1, 0.002, 0.01, kHalfUlpBelowOne},
    Claims{"circular-1", 1, 0.002, 0.01, kHalfUlpBelowOne},
    Claims{"circular-2", 1, 0.002, 0.01, kHalfUlpBelowOne},
    // Polygons in a circle have .88 and .91 of its second moment's radius; a pentagon is another
    // one upside down.
    Claims{"pentagonal", 1, 0.002, 0.13, 1.0, 1, true, true, 1.0},
    Claims{"hexagonal", 1, 0.002, 0.1, 0.15, 1, true, true, 0.15},
    Claims{"disc-layers", 1, 0.002, 0.02, 0.0},
    Claims{"layered", 1, 0.002, 0.02, 0.0},
    Claims{"post-process", 1, 0.01, 0.05, 0.12},
    Claims{"mipmap", 1, 0.002, 0.02, 0.0},
    Claims{"anisotropic-diffusion", 1, 0.002, 0.01, 0.0, 1, true, false},
    Claims{"object-identification", 1, 0.002, 0.02, kHalfUlpBelowOne},
    Claims{"ray-distribution-buffer", 1, 0.002, 0.01, 0.12, 1, true, true, 0.004},
};

Image filtered(const char* name, const Image& scene, const DofSettings& settings,
               ThreadPool& pool) {
  const Method* method = find_method(name);
  REQUIRE_MESSAGE(method != nullptr, name);
  // Its old contents must not show.
  Image result = random_scene_image(scene.width, scene.height, 99);
  apply(*method, {scene, settings, {}}, result, pool);
  return result;
}

DofSettings settings(float radius_at_infinity, float max_coc) {
  return {.coc = {radius_at_infinity, 2.0f}, .max_coc_px = max_coc};
}

// One colour over random depths.
Image constant_image(int width, int height, std::uint64_t seed) {
  Image image = random_scene_image(width, height, seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      store_texel(image, x, y, {0.5f, 0.25f, 3.0f, load_texel(image, x, y).w}, {});
    }
  }
  return image;
}

Image mirrored(const Image& image, bool across) {
  Image result = make_image(image.format, image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::vec4 texel = across ? load_texel(image, image.width - 1 - x, y)
                                     : load_texel(image, x, image.height - 1 - y);
      store_texel(result, x, y, texel, {});
    }
  }
  return result;
}

double largest_difference(const Image& a, const Image& b) {
  double largest = 0.0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const glm::vec4 p = load_texel(a, x, y), q = load_texel(b, x, y);
      for (int i = 0; i < 3; ++i) {
        largest = std::max(largest, static_cast<double>(std::fabs(p[i] - q[i])));
      }
    }
  }
  return largest;
}

// Bright pixels in the middle of a black picture of one depth.
Image point_image(int size, float depth_m, float light, int point_size) {
  Image image = make_image(Format::rgba16f, size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const int apart = std::max(std::abs(x - size / 2), std::abs(y - size / 2));
      const float value = apart <= point_size / 2 ? light : 0.0f;
      store_texel(image, x, y, {value, value, value, depth_m}, {});
    }
  }
  return image;
}

struct Moments {
  double light = 0.0;
  double square = 0.0;  ///< mean squared distance from the middle
};
Moments moments(const Image& image) {
  Moments sum;
  const int middle = image.width / 2;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double light = load_texel(image, x, y).y;
      sum.light += light;
      sum.square += light * ((x - middle) * (x - middle) + (y - middle) * (y - middle));
    }
  }
  sum.square /= sum.light;
  return sum;
}

}  // namespace

TEST_CASE("every method leaves a constant colour constant, borders included") {
  ThreadPool pool(2);
  for (const Claims& claims : kClaims) {
    for (const float max_coc : {1.5f, 6.0f, 40.0f}) {
      const Image scene = constant_image(70, 45, 1);
      const Image result = filtered(claims.name, scene, settings(20.0f, max_coc), pool);
      INFO(std::string{claims.name}, ", max_coc ", max_coc);
      CHECK(compare_images(result, scene).max_ulp <= claims.constant_ulp);
    }
  }
}

TEST_CASE("every method passes a picture in focus through unchanged") {
  ThreadPool pool(2);
  Image scene = random_scene_image(66, 50, 2);
  set_depth(scene, [](int, int) { return 2.0f; });
  const Image any_depth = random_scene_image(66, 50, 3);
  for (const Claims& claims : kClaims) {
    INFO(std::string{claims.name});
    CHECK(equal(filtered(claims.name, scene, settings(30.0f, 16.0f), pool), scene));
    CHECK(equal(filtered(claims.name, any_depth, settings(30.0f, 0.0f), pool), any_depth));
    CHECK(equal(filtered(claims.name, any_depth, settings(0.0f, 16.0f), pool), any_depth));
  }
}

TEST_CASE("every method keeps depth in alpha, bit for bit") {
  ThreadPool pool(2);
  const Image scene = random_scene_image(50, 41, 4);
  for (const Claims& claims : kClaims) {
    INFO(std::string{claims.name});
    const Image result = filtered(claims.name, scene, settings(20.0f, 9.0f), pool);
    int wrong = 0;
    for (int y = 0; y < 41; ++y) {
      for (std::size_t i = 3; i < 200; i += 4) {
        wrong += row<std::uint16_t>(result, y)[i] != row<std::uint16_t>(scene, y)[i];
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("every method keeps an isolated point's light, and spreads it as far as the lens") {
  ThreadPool pool(2);
  for (const Claims& claims : kClaims) {
    // Behind the focus and before it: 16 (z - 2) / z is 8, and -8.
    for (const float depth_m : {4.0f, 4.0f / 3.0f}) {
      const Image scene = point_image(129, depth_m, 1000.0f, claims.point_size);
      const Moments before = moments(scene);
      const Moments got = moments(filtered(claims.name, scene, settings(16.0f, 16.0f), pool));
      INFO(std::string{claims.name}, " at ", depth_m, " m");
      const double radius = std::sqrt(2.0 * (got.square - before.square));
      CHECK(std::fabs(got.light / before.light - 1.0) <= claims.energy_error);
      CHECK(std::fabs(radius / 8.0 - 1.0) <= claims.radius_error);
    }
  }
}

TEST_CASE("a background sheds no light on a sharp object, by every method that says so") {
  ThreadPool pool(2);
  Image scene = make_image(Format::rgba16f, 64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float light = x < 32 ? 0.0f : 10.0f;
      store_texel(scene, x, y, {light, light, light, x < 32 ? 2.0f : 50.0f}, {});
    }
  }
  for (const Claims& claims : kClaims) {
    const Image result = filtered(claims.name, scene, settings(12.0f, 16.0f), pool);
    INFO(std::string{claims.name});
    CHECK((load_texel(result, 31, 30).x == 0.0f) == claims.keeps_background_out);
  }
}

TEST_CASE("a blurred foreground sheds light on a sharp background, by every method that says so") {
  ThreadPool pool(2);
  Image scene = make_image(Format::rgba16f, 96, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const float light = x < 48 ? 10.0f : 0.0f;
      store_texel(scene, x, y, {light, light, light, x < 48 ? 1.0f : 2.0f}, {});
    }
  }
  for (const Claims& claims : kClaims) {
    const Image result = filtered(claims.name, scene, settings(10.0f, 16.0f), pool);
    INFO(std::string{claims.name});
    CHECK((load_texel(result, 50, 32).x > 0.5f) == claims.spreads_foreground);
    CHECK(load_texel(result, 70, 32).x < 1.0f);
  }
}

TEST_CASE("every method gives a mirrored picture's result mirrored, a turned one's turned") {
  ThreadPool pool(2);
  const Image scene = random_scene_image(64, 48, 5);
  for (const Claims& claims : kClaims) {
    const Image result = filtered(claims.name, scene, settings(14.0f, 11.0f), pool);
    for (const bool across : {true, false}) {
      INFO(std::string{claims.name}, across ? ", left and right" : ", top and bottom");
      const Image other =
          filtered(claims.name, mirrored(scene, across), settings(14.0f, 11.0f), pool);
      CHECK(largest_difference(mirrored(other, across), result) <= claims.mirror_error);
    }
    INFO(std::string{claims.name}, ", turned by 180 degrees");
    const Image turned = mirrored(mirrored(scene, true), false);
    const Image other = filtered(claims.name, turned, settings(14.0f, 11.0f), pool);
    CHECK(largest_difference(mirrored(mirrored(other, true), false), result) <= claims.turn_error);
  }
}

TEST_CASE("every method gives the same bits for any number of threads" *
          doctest::test_suite("threads long")) {
  const Image scene = random_scene_image(150, 71, 6);
  for (const Claims& claims : kClaims) {
    ThreadPool one(1);
    const Image expected = filtered(claims.name, scene, settings(14.0f, 12.0f), one);
    for (const int threads : {3, 8}) {
      ThreadPool pool(threads);
      INFO(std::string{claims.name}, " on ", threads, " threads");
      CHECK(equal(filtered(claims.name, scene, settings(14.0f, 12.0f), pool), expected));
    }
  }
}

TEST_CASE("every method gives the same bits on every vector unit, at any size") {
  struct Size {
    int width, height;
  };
  for (const Claims& claims : kClaims) {
    for (const Size size :
         {Size{1, 1}, {1, 40}, {40, 1}, {2, 3}, {16, 16}, {17, 15}, {33, 70}, {129, 31}}) {
      const Image scene = random_scene_image(size.width, size.height, 7);
      for (const float max_coc : {0.0f, 0.7f, 7.25f, 1024.0f}) {
        // Far past a small picture is as far as past a larger one.
        if (max_coc > 64.0f && size.width * size.height > 256) continue;
        if (kHasSanitizers && size.width * size.height > 2000) continue;
        ThreadPool scalar(2, Isa::scalar);
        const Image expected = filtered(claims.name, scene, settings(40.0f, max_coc), scalar);
        for (const Isa isa : available_isas().subspan(1)) {
          ThreadPool pool(2, isa);
          INFO(std::string{claims.name}, " on ", std::string{isa_name(isa)}, ", ", size.width, "x",
               size.height, ", max_coc ", max_coc);
          CHECK(equal(filtered(claims.name, scene, settings(40.0f, max_coc), pool), expected));
        }
      }
    }
  }
}

TEST_CASE("every method stays within range for the largest circles on a small picture") {
  ThreadPool pool(2);
  for (const Claims& claims : kClaims) {
    const Image scene = random_scene_image(19, 7, 8);
    const Image result = filtered(claims.name, scene, settings(1e6f, kLargestMaxCoc), pool);
    INFO(std::string{claims.name});
    for (int x = 0; x < 19; ++x) {
      CHECK(load_texel(result, x, 3).x >= 0.0f);
      CHECK(load_texel(result, x, 3).x <= 1.001f);
    }
  }
}

TEST_CASE("a method whose circles render does not cut leaves smaller ones as they are") {
  ThreadPool pool(2);
  Image scene = random_scene_image(60, 50, 8);
  set_depth(scene,
            [](int x, int y) { return 1.2f + 0.05f * static_cast<float>((x + 2 * y) % 97); });
  const auto by_limit = [&](const char* name, float max_coc) {
    return filtered(name, scene, settings(9.0f, max_coc), pool);
  };
  for (const char* name :
       {"diffusion", "generalised-diffusion", "disc-layers", "mipmap", "object-identification"}) {
    CHECK(find_method(name)->any_radius_costs_the_same);
    CHECK(equal(by_limit(name, 16.0f), by_limit(name, 64.0f)));
  }
  // Its widest picture is made for the limit: a larger one is not free.
  CHECK_FALSE(find_method("post-process")->any_radius_costs_the_same);
  CHECK_FALSE(equal(by_limit("post-process", 16.0f), by_limit("post-process", 64.0f)));
}

TEST_CASE("no method spreads a NaN, and an infinite colour counts as the largest half") {
  ThreadPool pool(2);
  for (const Claims& claims : kClaims) {
    Image scene = random_scene_image(48, 48, 9);
    set_depth(scene, [](int x, int y) { return x == 20 && y == 20 ? 2.0f : 6.0f; });
    const float nan = std::numeric_limits<float>::quiet_NaN();
    store_texel(scene, 20, 20, {nan, nan, nan, 6.0f}, {});
    store_texel(scene, 9, 9, {nan, nan, nan, 2.0f}, {});
    INFO(std::string{claims.name});
    int wrong = 0;
    const Image result = filtered(claims.name, scene, settings(12.0f, 12.0f), pool);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 48; ++x) wrong += !(load_texel(result, x, y).x <= 1.001f);
    }
    CHECK(wrong == 0);
    const float infinite = std::numeric_limits<float>::infinity();
    store_texel(scene, 20, 20, {infinite, -infinite, infinite, 6.0f}, {});
    const Image bright = filtered(claims.name, scene, settings(12.0f, 12.0f), pool);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 48; ++x) {
        const glm::vec4 texel = load_texel(bright, x, y);
        wrong += !(std::fabs(texel.x) <= 65504.0f) || !(std::fabs(texel.y) <= 65504.0f);
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("every method stays within range for zero, infinite, negative and NaN depths") {
  const float depths[] = {0.0f, std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::quiet_NaN(), 3.0f, -1.0f};
  for (const Claims& claims : kClaims) {
    Image scene = random_scene_image(40, 32, 10);
    set_depth(scene, [&](int x, int y) { return depths[(x + y) % 5]; });
    ThreadPool scalar(1, Isa::scalar);
    const Image expected = filtered(claims.name, scene, settings(10.0f, 6.0f), scalar);
    for (const Isa isa : available_isas()) {
      ThreadPool pool(2, isa);
      INFO(std::string{claims.name}, " on ", std::string{isa_name(isa)});
      const Image result = filtered(claims.name, scene, settings(10.0f, 6.0f), pool);
      CHECK(equal(result, expected));
      int wrong = 0;
      for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 40; ++x) {
          const float value = load_texel(result, x, y).x;
          wrong += !(value >= 0.0f && value <= 1.001f);
        }
      }
      CHECK(wrong == 0);
    }
  }
}
