#include "tools/chart/contenders/bloom_truth.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/images/texel.h"

using namespace softfocus;

namespace {

constexpr int kSize = 64;

// Bloom of one bright pixel alone: what a pyramid scatters to each pixel.
std::vector<double> scattered(int x, int y, int levels) {
  ThreadPool pool{1};
  const BloomSettings settings{.threshold = 0.0f, .knee = 0.0f, .strength = 1.0f, .levels = levels};
  Image picture = make_image(Format::rgba16f, kSize, kSize);
  constexpr float kLight = 1024.0f;
  store_texel<Format::rgba16f>(picture, x, y, {kLight, 0, 0, 1}, {});
  Image result = make_image(Format::rgba16f, kSize, kSize);
  bloom(settings, picture, result, Profile{}, pool);
  std::vector<double> light;
  for (int v = 0; v < kSize; ++v) {
    for (int u = 0; u < kSize; ++u) {
      light.push_back(static_cast<double>(load_texel(result, u, v).x / kLight));
    }
  }
  return light;
}

}  // namespace

TEST_CASE("bloom's truth: the kernel sums to 1 and is the same on all sides") {
  for (const int levels : {1, 2, 4, 6}) {
    for (const double spread : {0.0, 0.6, 1.0}) {
      const BloomKernel kernel = bloom_kernel(levels, spread);
      double sum = 0.0;
      for (const double weight : kernel.weights) sum += weight;
      CHECK(sum == doctest::Approx(1.0).epsilon(1e-12));
      for (const int d : {1, 2, 5}) {
        CHECK(kernel.at(d, 1) == doctest::Approx(kernel.at(-d, 1)).epsilon(1e-12));
        CHECK(kernel.at(d, 1) == doctest::Approx(kernel.at(1, d)).epsilon(1e-12));
        CHECK(kernel.at(d, 1) == doctest::Approx(kernel.at(d, -1)).epsilon(1e-12));
      }
    }
  }
}

TEST_CASE("bloom's truth: the kernel is the mean of what the pyramid scatters from each place") {
  constexpr int kLevels = 2, kPlaces = 1 << kLevels, kFirst = 28;
  const BloomKernel kernel = bloom_kernel(kLevels, static_cast<double>(BloomSettings{}.spread));
  CHECK(kernel.reach == 18);
  std::vector<double> mean(
      static_cast<std::size_t>((2 * kernel.reach + 1) * (2 * kernel.reach + 1)));
  for (int py = 0; py < kPlaces; ++py) {
    for (int px = 0; px < kPlaces; ++px) {
      const std::vector<double> light = scattered(kFirst + px, kFirst + py, kLevels);
      std::size_t i = 0;
      for (int dy = -kernel.reach; dy <= kernel.reach; ++dy) {
        for (int dx = -kernel.reach; dx <= kernel.reach; ++dx, ++i) {
          mean[i] +=
              light[static_cast<std::size_t>((kFirst + py + dy) * kSize + kFirst + px + dx)] /
              (kPlaces * kPlaces);
        }
      }
    }
  }
  for (std::size_t i = 0; i < mean.size(); ++i) {
    // Halves on the way.
    CHECK(std::fabs(mean[i] - kernel.weights[i]) < 2e-3 * kernel.weights[i] + 1e-6);
  }
}

TEST_CASE("bloom's truth: light is moved, and neither lost nor made") {
  ThreadPool pool{2};
  Image picture = make_image(Format::rgba16f, 160, 160);
  for (int y = 78; y < 83; ++y) {
    for (int x = 70; x < 90; ++x) {
      store_texel<Format::rgba16f>(picture, x, y, {20, 10, 2, 3}, {});
    }
  }
  const Image result = bloom_truth({.strength = 0.5f, .levels = 3}, picture, pool);
  double before = 0.0, after = 0.0;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 160; ++x) {
      before += static_cast<double>(load_texel(picture, x, y).x);
      after += static_cast<double>(load_texel(result, x, y).x);
    }
  }
  CHECK(after == doctest::Approx(before).epsilon(1e-3));
  CHECK(load_texel(result, 80, 80).x < 20.0f);
  CHECK(load_texel(result, 80, 60).x > 0.0f);
  CHECK(load_texel(result, 75, 80).w == 3.0f);
}

TEST_CASE("bloom's truth: light at the border goes on outside of it") {
  ThreadPool pool{1};
  Image picture = make_image(Format::rgba16f, 40, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) store_texel<Format::rgba16f>(picture, x, y, {8, 8, 8, 1}, {});
  }
  CHECK(equal(bloom_truth({.strength = 1.0f, .levels = 2}, picture, pool), picture));
}
