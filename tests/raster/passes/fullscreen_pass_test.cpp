#include "raster/passes/fullscreen_pass.h"

#include <doctest/doctest.h>

#include <atomic>
#include <vector>

#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

TEST_CASE("a pass calls its kernel once a pixel, for any number of threads and rows" *
          doctest::test_suite("threads")) {
  for (const int threads : {1, 2, 3, 8}) {
    ThreadPool pool{threads};
    for (const int height : {1, 7, 8, 9, 33}) {
      const int width = 13;
      Image target = make_image(Format::r32f, width, height);
      std::vector<std::atomic<int>> calls(static_cast<std::size_t>(width * height));
      fullscreen_pass<Format::r32f>(target, {}, pool, [&](int x, int y) {
        ++calls[static_cast<std::size_t>(y * width + x)];
        return glm::vec4{1.0f};
      });
      int wrong = 0;
      for (const auto& count : calls) wrong += count != 1;
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("a pass stores what the kernel returns at the pixel it was asked for") {
  ThreadPool pool{2};
  Image target = make_image(Format::rgba32f, 17, 19);
  fullscreen_pass<Format::rgba32f>(target, {}, pool, [](int x, int y) {
    return glm::vec4{static_cast<float>(x), static_cast<float>(y), 3.0f, -4.0f};
  });
  int wrong = 0;
  for (int y = 0; y < 19; ++y) {
    for (int x = 0; x < 17; ++x) {
      wrong += load_texel(target, x, y) !=
               glm::vec4{static_cast<float>(x), static_cast<float>(y), 3.0f, -4.0f};
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a pass stores with the profile's rounding") {
  ThreadPool pool{1};
  Image target = make_image(Format::rgba16f, 1, 1);
  const auto kernel = [](int, int) { return glm::vec4{1.0f + 0.75f / 1024.0f}; };
  fullscreen_pass<Format::rgba16f>(target, profile_named("ieee"), pool, kernel);
  CHECK(load_texel(target, 0, 0).x == 1.0f + 1.0f / 1024.0f);
  fullscreen_pass<Format::rgba16f>(target, profile_named("d3d11"), pool, kernel);
  CHECK(load_texel(target, 0, 0).x == 1.0f);
}

TEST_CASE("a pass leaves the padding at zero") {
  ThreadPool pool{2};
  Image target = make_image(Format::rgba16f, 5, 9);
  fullscreen_pass<Format::rgba16f>(target, {}, pool, [](int, int) { return glm::vec4{1.0f}; });
  int dirty = 0;
  for (std::size_t i = 0; i < target.bytes.size(); ++i) {
    dirty += i % target.stride_bytes >= 5 * 8 && target.bytes[i] != std::byte{0};
  }
  CHECK(dirty == 0);
}

TEST_CASE("a pass gives the same image for 1, 2, 3 and 8 threads" *
          doctest::test_suite("threads")) {
  Image first = make_image(Format::rgba16f, 61, 67);
  for (const int threads : {1, 2, 3, 8}) {
    ThreadPool pool{threads};
    Image target = make_image(Format::rgba16f, 61, 67);
    fullscreen_pass<Format::rgba16f>(target, {}, pool, [](int x, int y) {
      const float value = static_cast<float>(x * 67 + y) / 7.0f;
      return glm::vec4{value, value / 3.0f, 1.0f / (1.0f + value), 1.0f};
    });
    if (threads == 1) {
      first = target;
    } else {
      CHECK(equal(first, target));
    }
  }
}
