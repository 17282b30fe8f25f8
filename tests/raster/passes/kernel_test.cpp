#include "raster/passes/kernel.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

Image random_picture(int width, int height, std::uint64_t seed) {
  return test::random_halves(width, height, seed, -2.0, 2.0);
}

/// The definition in binary64, of red, green and blue of one pixel.
double exact_sum(const Kernel& kernel, const Image& source, int x, int y, int channel) {
  double sum = 0.0;
  for (int j = 0; j < kernel.height; ++j) {
    for (int i = 0; i < kernel.width; ++i) {
      const int column = std::clamp(x + i - kernel.width / 2, 0, source.width - 1);
      const int line = std::clamp(y + j - kernel.height / 2, 0, source.height - 1);
      sum += static_cast<double>(kernel.weights[static_cast<std::size_t>(j * kernel.width + i)]) *
             static_cast<double>(load_texel(source, column, line)[channel]);
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("a kernel's sum is the definition's, to half a step of the halves") {
  ThreadPool pool{2};
  const Image source = random_picture(37, 23, 5);
  for (const NamedKernel& named : kernels()) {
    CAPTURE(named.name);
    Image result = make_image(Format::rgba16f, 37, 23);
    convolve(named.kernel, source, result, {}, pool);
    double worst = 0.0;
    int wrong_alphas = 0;
    for (int y = 0; y < 23; ++y) {
      for (int x = 0; x < 37; ++x) {
        for (int c = 0; c < 3; ++c) {
          const double exact = exact_sum(named.kernel, source, x, y, c);
          const double step = std::max(std::ldexp(1.0, std::ilogb(exact) - 10), 0x1p-24);
          worst = std::max(
              worst, std::fabs(exact - static_cast<double>(load_texel(result, x, y)[c])) / step);
        }
        wrong_alphas += load_texel(result, x, y).w != load_texel(source, x, y).w;
      }
    }
    CHECK(worst < 0.51);
    CHECK(wrong_alphas == 0);
  }
}

TEST_CASE("a kernel has the same bits in all vectors, of any size and rounding") {
  const auto kernel_of = [](int width, int height) {
    Kernel kernel{width, height, {}};
    for (int i = 0; i < width * height; ++i) {
      kernel.weights.push_back(static_cast<float>(i % 7 - 2) / 5.0f);
    }
    return kernel;
  };
  for (const char* profile : {"ieee", "d3d11", "swiftshader"}) {
    for (const Isa isa : available_isas()) {
      for (const int width : {1, 2, 3, 4, 5, 17, 40}) {
        for (const int height : {1, 2, 64, 65}) {
          for (const Kernel& kernel : {kernel_of(1, 1), kernel_of(3, 3), kernel_of(7, 1),
                                       kernel_of(1, 9), kernel_of(5, 3)}) {
            ThreadPool pool{2, isa}, of_four{1, Isa::scalar};
            Image source = random_picture(width, height, 9);
            row<std::uint16_t>(source, 0)[0] = 0x7C00;
            row<std::uint16_t>(source, height - 1)[3] = 0x7E01;
            Image expected = make_image(Format::rgba16f, width, height), result = expected;
            convolve(kernel, source, expected, profile_named(profile), of_four);
            convolve(kernel, source, result, profile_named(profile), pool);
            REQUIRE(equal(result, expected));
          }
        }
      }
    }
  }
}

TEST_CASE("a guard band takes the place of what lies beyond a picture") {
  ThreadPool pool{1};
  const Image wide = random_picture(24, 19, 3);
  Image all = make_image(Format::rgba16f, 24, 19), part = make_image(Format::rgba16f, 16, 15);
  convolve(*find_kernel("gaussian-5"), wide, all, {}, pool);
  convolve(*find_kernel("gaussian-5"), wide, part, {}, pool);
  int wrong = 0;
  for (int y = 0; y < 15; ++y) {
    for (int x = 0; x < 16; ++x) wrong += load_texel(part, x, y) != load_texel(all, x + 4, y + 2);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a row and a column give what their product gives, to two roundings") {
  ThreadPool pool{2};
  const Image source = random_picture(29, 31, 8);
  Image across = make_image(Format::rgba16f, 29, 31), both = across, at_once = across;
  const std::vector<float> binomials{1.0f / 16, 4.0f / 16, 6.0f / 16, 4.0f / 16, 1.0f / 16};
  convolve(row_kernel(binomials), source, across, {}, pool);
  convolve(column_kernel(binomials), across, both, {}, pool);
  convolve(*find_kernel("gaussian-5"), source, at_once, {}, pool);
  float largest = 0.0f;
  for (int y = 0; y < 31; ++y) {
    for (int x = 0; x < 29; ++x) {
      const glm::vec4 difference = load_texel(both, x, y) - load_texel(at_once, x, y);
      for (int c = 0; c < 3; ++c) largest = std::max(largest, std::fabs(difference[c]));
    }
  }
  CHECK(largest <= 0x1p-10f);
  CHECK(largest > 0.0f);
}

TEST_CASE("a Gaussian at once is that of two passes, to their roundings") {
  ThreadPool pool{2};
  const Image source = random_picture(40, 31, 8);
  const std::vector<float> weights = gaussian_weights(1.7);
  Image across = make_image(Format::rgba16f, 40, 31), both = across, at_once = across;
  convolve(row_kernel(weights), source, across, {}, pool);
  convolve(column_kernel(weights), across, both, {}, pool);
  convolve(square_kernel(weights), source, at_once, {}, pool);
  float largest = 0.0f;
  for (int y = 0; y < 31; ++y) {
    for (int x = 0; x < 40; ++x) {
      largest =
          std::max(largest, std::fabs(load_texel(both, x, y).x - load_texel(at_once, x, y).x));
    }
  }
  CHECK(largest <= 0x1p-10f);
  CHECK(largest > 0.0f);
}

TEST_CASE("a Gaussian's weights sum to 1, fall outwards and have its variance") {
  for (const double sigma : {0.0, 0.2, 0.5, 1.0, 3.7, 40.0, 341.0}) {
    CAPTURE(sigma);
    const std::vector<float> weights = gaussian_weights(sigma);
    CHECK(weights.size() == 2 * static_cast<std::size_t>(3.0 * sigma) + 1);
    double sum = 0.0, variance = 0.0;
    const auto middle = static_cast<std::ptrdiff_t>(weights.size() / 2);
    for (std::ptrdiff_t i = 0; i < std::ssize(weights); ++i) {
      const auto weight = static_cast<double>(weights[static_cast<std::size_t>(i)]);
      sum += weight;
      variance += weight * static_cast<double>((i - middle) * (i - middle));
    }
    CHECK(std::fabs(sum - 1.0) < 1e-6);
    CHECK(std::is_sorted(weights.begin(), weights.begin() + middle + 1));
    // 2.7 % of a Gaussian's variance lie beyond 3 sigma.
    if (sigma >= 1.0) CHECK(std::fabs(variance / (sigma * sigma) - 0.973) < 0.03);
  }
}

TEST_CASE(
    "a box in four bilinear reads is the box of nine, to what its coordinates are rounded by") {
  ThreadPool pool{2};
  for (const char* name : {"ieee", "d3d11"}) {
    CAPTURE(name);
    double worst = 0.0;
    for (const int width : {64, 1023}) {
      const Image source = test::random_halves(width, 40, 21, 0.0, 2.0);
      Image result = make_image(Format::rgba16f, width, 40);
      box_in_four_reads(make_texture(source), result, profile_named(name), pool);
      for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < width; ++x) {
          const double exact = exact_sum(*find_kernel("box-3"), source, x, y, 0);
          const double step = std::ldexp(1.0, std::ilogb(exact) - 10);
          worst = std::max(
              worst, std::fabs(exact - static_cast<double>(load_texel(result, x, y).x)) / step);
        }
      }
    }
    CHECK(worst < 1.2);
    CHECK(worst > 0.5);
  }
}
