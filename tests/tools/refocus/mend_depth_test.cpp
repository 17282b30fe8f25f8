// Depth as it comes, mended.

#include "tools/refocus/depth/mend_depth.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/images/texel.h"

using namespace softfocus;

namespace {

/// A picture whose left part, up to column `edge`, is dark.
Image two_colours(int width, int height, int edge) {
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      store_texel(image, x, y,
                  x < edge ? glm::vec4{0.1f, 0.1f, 0.3f, 0} : glm::vec4{0.9f, 0.6f, 0.2f, 0}, {});
    }
  }
  return image;
}

}  // namespace

TEST_CASE("mending: a smaller map follows the edge of the colours, not its own pixels") {
  ThreadPool pool{1};
  const Image colour = two_colours(64, 32, 30);  // no multiple of 4
  DepthMap map{16, 8, {}};
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 16; ++x) map.metres.push_back(4 * x + 2 < 30 ? 1.0f : 5.0f);
  }
  const DepthMap large = upsampled_by_colour(map, colour, pool);
  const DepthMap plain = upsampled_to_nearest(map, 64, 32);
  int wrong = 0, wrong_plain = 0;
  for (std::size_t i = 0; i < large.metres.size(); ++i) {
    const float truth = i % 64 < 30 ? 1.0f : 5.0f;
    wrong += std::fabs(large.metres[i] - truth) > 0.01f;
    wrong_plain += plain.metres[i] != truth;
  }
  CHECK(wrong == 0);
  CHECK(wrong_plain == 2 * 32);
}

TEST_CASE("mending: between two surfaces of a smaller map no third one appears") {
  ThreadPool pool{1};
  const Image colour = two_colours(40, 40, 40);  // one colour
  DepthMap map{10, 10, {}};
  for (int i = 0; i < 100; ++i) map.metres.push_back(i % 10 < 5 ? 1.0f : 5.0f);
  for (const float metres : upsampled_by_colour(map, colour, pool).metres) {
    CHECK((metres == doctest::Approx(1.0f) || metres == doctest::Approx(5.0f)));
  }
}

TEST_CASE("mending: a slope stays one when it is upsampled") {
  ThreadPool pool{1};
  const Image colour = two_colours(80, 8, 80);
  DepthMap map{20, 2, {}};
  for (int i = 0; i < 40; ++i) map.metres.push_back(2.0f + 0.02f * static_cast<float>(i % 20));
  const DepthMap large = upsampled_by_colour(map, colour, pool);
  for (std::size_t x = 12; x < 68; ++x) {
    const float truth = 2.0f + 0.005f * (static_cast<float>(x) - 1.5f);
    CHECK(large.metres[x] == doctest::Approx(truth).epsilon(0.005));
  }
}

TEST_CASE("mending: on a smooth surface a pattern of colours moves nothing") {
  ThreadPool pool{1};
  Image colour = make_image(Format::rgba16f, 80, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 80; ++x) {
      const float c = (x / 6 + y / 6) % 2 == 0 ? 0.0f : 1.0f;
      store_texel(colour, x, y, {c, c, c, 0.0f}, {});
    }
  }
  DepthMap map{20, 10, {}};
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x)
      map.metres.push_back(1.0f / (0.2f + 0.05f * static_cast<float>(y)));
  }
  const DepthMap large = upsampled_by_colour(map, colour, pool);
  for (std::size_t y = 6; y < 34; ++y) {
    for (std::size_t x = 6; x < 74; ++x) {
      const float truth = 1.0f / (0.2f + 0.05f * ((static_cast<float>(y) + 0.5f) / 4.0f - 0.5f));
      CHECK(large.metres[80 * y + x] == doctest::Approx(truth).epsilon(1e-4));
    }
  }
}

TEST_CASE("mending: anti-aliased depth takes the side that the pixel shows more of") {
  ThreadPool pool{1};
  DepthMap map{9, 3, {}};
  for (int y = 0; y < 3; ++y) {
    for (const float z : {1.0f, 1.0f, 1.0f, 1.0f, 2.2f, 5.0f, 5.0f, 5.0f, 5.0f}) {
      map.metres.push_back(z);
    }
  }
  CHECK(mend_edges(map, pool) == 3);
  CHECK(map.metres[4] == 1.0f);
  map.metres[4] = 3.4f;
  CHECK(mend_edges(map, pool) == 1);
  CHECK(map.metres[4] == 5.0f);
}

TEST_CASE("mending: slopes, steps and flat surfaces stay as they are") {
  ThreadPool pool{1};
  for (const int kind : {0, 1, 2}) {
    DepthMap map{16, 4, {}};
    for (int i = 0; i < 64; ++i) {
      const auto x = static_cast<float>(i % 16);
      map.metres.push_back(kind == 0 ? 1.0f + 0.2f * x : kind == 1 ? (x < 8 ? 1.0f : 5.0f) : 3.0f);
    }
    const auto before = map.metres;
    CHECK(mend_edges(map, pool) == 0);
    CHECK(map.metres == before);
  }
}

TEST_CASE("mending: bands of a rounded slope become a slope within half a step") {
  ThreadPool pool{1};
  const int width = 120, height = 20;
  PlaneValues codes, truth;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      truth.push_back(100.0f + static_cast<float>(x) / 10.0f);
      codes.push_back(std::round(truth.back()));
    }
  }
  const PlaneValues mended = without_bands(codes, width, height, pool);
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    CHECK(std::fabs(mended[i] - codes[i]) <= 0.5f);
    before += std::fabs(static_cast<double>(codes[i] - truth[i]));
    after += std::fabs(static_cast<double>(mended[i] - truth[i]));
  }
  CHECK(after < 0.35 * before);
}

TEST_CASE("mending: an edge of two steps or more stays an edge, and a flat code flat") {
  ThreadPool pool{1};
  PlaneValues codes;
  for (int i = 0; i < 400; ++i) codes.push_back(i % 20 < 10 ? 50.0f : 52.0f);
  CHECK(without_bands(codes, 20, 20, pool) == codes);
}
