#include "raster/passes/bilateral.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "raster/numbers/random_bits.h"
#include "raster/passes/kernel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

/// Colours from 0 to 1, depths of a few steps.
Image random_picture(int width, int height, std::uint64_t seed) {
  RandomSequence random{seed};
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = next_between(random, 0.0, 1.0);
      values[i] = float_to_half(static_cast<float>(i % 4 == 3 ? std::floor(4.0 * value) : value),
                                HalfRounding::nearest_even);
    }
  }
  return image;
}

/// The definition in binary64.
double exact_mean(const BilateralSettings& settings, const Image& source, int x, int y, int c) {
  const std::vector<float> weights = gaussian_weights(settings.sigma_px);
  const int reach = static_cast<int>(weights.size() / 2);
  const auto texel = [&](int column, int line) {
    return glm::dvec4{load_texel(source, std::clamp(column, 0, source.width - 1),
                                 std::clamp(line, 0, source.height - 1))};
  };
  const auto likeness = [](double square) {
    return square < 1.0 ? (1 - square) * (1 - square) : 0;
  };
  const glm::dvec4 own = texel(x, y);
  double sum = 0.0, all = 0.0;
  for (int j = -reach; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      const glm::dvec4 other = texel(x + i, y + j), off = other - own;
      double weight = static_cast<double>(weights[static_cast<std::size_t>(reach + i)]) *
                      static_cast<double>(weights[static_cast<std::size_t>(reach + j)]);
      const auto tolerance = static_cast<double>(settings.colour_tolerance);
      if (tolerance > 0.0 && (i != 0 || j != 0)) {
        weight *= likeness((off.x * off.x + off.y * off.y + off.z * off.z) / tolerance / tolerance);
      }
      const double scale = static_cast<double>(settings.depth_tolerance) * own.w;
      if (settings.depth_tolerance > 0.0f && (i != 0 || j != 0)) {
        const double ratio = off.w / scale;
        weight *= ratio == ratio ? likeness(ratio * ratio) : 0.0;
      }
      sum += weight * other[c];
      all += weight;
    }
  }
  return sum / all;
}

}  // namespace

TEST_CASE("a bilateral mean is the definition's, to half a step of the halves") {
  ThreadPool pool{2};
  const Image source = random_picture(31, 22, 4);
  for (const BilateralSettings& settings :
       {BilateralSettings{1.5, 0.5f, 0.0f}, BilateralSettings{1.5, 0.0f, 0.3f},
        BilateralSettings{2.0, 0.7f, 0.6f}, BilateralSettings{0.0, 0.1f, 0.1f}}) {
    Image result = make_image(Format::rgba16f, 31, 22);
    bilateral(settings, source, result, {}, pool);
    double worst = 0.0;
    for (int y = 0; y < 22; ++y) {
      for (int x = 0; x < 31; ++x) {
        for (int c = 0; c < 3; ++c) {
          worst = std::max(worst, std::fabs(exact_mean(settings, source, x, y, c) -
                                            static_cast<double>(load_texel(result, x, y)[c])));
        }
      }
    }
    CHECK(worst < 0x1p-12 + 1e-6);
  }
}

TEST_CASE("a bilateral filter without tolerances is a Gaussian") {
  ThreadPool pool{2};
  const Image source = random_picture(25, 18, 6);
  Image result = make_image(Format::rgba16f, 25, 18), gaussian = result;
  const std::vector<float> weights = gaussian_weights(1.2);
  Kernel kernel{static_cast<int>(weights.size()), static_cast<int>(weights.size()), {}};
  for (const float a : weights) {
    for (const float b : weights) kernel.weights.push_back(a * b);
  }
  bilateral({1.2, 0.0f, 0.0f}, source, result, {}, pool);
  convolve(kernel, source, gaussian, {}, pool);
  float largest = 0.0f;
  for (int y = 0; y < 18; ++y) {
    for (int x = 0; x < 25; ++x) {
      const glm::vec4 off = load_texel(result, x, y) - load_texel(gaussian, x, y);
      largest = std::max({largest, std::fabs(off.x), std::fabs(off.y), std::fabs(off.z)});
    }
  }
  CHECK(largest <= 0x1p-11f);
}

TEST_CASE("a bilateral filter keeps an edge that a Gaussian blurs") {
  ThreadPool pool{1};
  Image source = make_image(Format::rgba16f, 20, 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 20; ++x) {
      store_texel(source, x, y, glm::vec4{x < 10 ? 0.25f : 0.75f, 0.5f, 0.5f, x < 10 ? 1.0f : 9.0f},
                  {});
    }
  }
  Image result = make_image(Format::rgba16f, 20, 5);
  bilateral({3.0, 0.2f, 0.0f}, source, result, {}, pool);
  CHECK(equal(result, source));
  bilateral({3.0, 0.0f, 0.2f}, source, result, {}, pool);
  CHECK(equal(result, source));
  bilateral({3.0, 0.0f, 0.0f}, source, result, {}, pool);
  CHECK_FALSE(equal(result, source));
}

TEST_CASE("a bilateral filter by depth takes all that is infinitely far for alike") {
  for (const Isa isa : available_isas()) {
    ThreadPool pool{1, isa};
    Image far = random_picture(20, 5, 3), farther = far;
    for (int x = 0; x < 20; ++x) {
      for (int y = 0; y < 5; ++y) {
        row<std::uint16_t>(far, y)[static_cast<std::size_t>(4 * x + 3)] = x < 7 ? 0x4000 : 0x7BFF;
        row<std::uint16_t>(farther, y)[static_cast<std::size_t>(4 * x + 3)] =
            x < 7 ? 0x4000 : 0x7C00;
      }
    }
    Image expected = far, result = far;
    bilateral({2.0, 0.0f, 0.2f}, far, expected, {}, pool);
    bilateral({2.0, 0.0f, 0.2f}, farther, result, {}, pool);
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 20; ++x) {
        const glm::vec4 a = load_texel(result, x, y), b = load_texel(expected, x, y);
        CHECK(a.x == b.x);
        CHECK((a.w == b.w) == (x < 7));
      }
    }
    CHECK_FALSE(load_texel(result, 12, 2).x == load_texel(farther, 12, 2).x);
  }
}

TEST_CASE("a bilateral filter has the same bits in all vectors, also of what is not finite") {
  for (const char* profile : {"ieee", "d3d11", "swiftshader"}) {
    for (const Isa isa : available_isas()) {
      for (const int width : {1, 3, 16, 19}) {
        for (const int height : {1, 33}) {
          Image source = random_picture(width, height, 11);
          row<std::uint16_t>(source, 0)[0] = 0x7C00;
          row<std::uint16_t>(source, 0)[3] = 0x7C00;
          row<std::uint16_t>(source, height - 1)[1] = 0x7E01;
          ThreadPool pool{2, isa}, of_four{1, Isa::scalar};
          Image expected = make_image(Format::rgba16f, width, height), result = expected;
          const BilateralSettings settings{1.4, 0.6f, 0.5f};
          bilateral(settings, source, expected, profile_named(profile), of_four);
          bilateral(settings, source, result, profile_named(profile), pool);
          REQUIRE(equal(result, expected));
        }
      }
    }
  }
}
